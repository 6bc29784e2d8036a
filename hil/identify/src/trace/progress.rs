//! What a trace is doing, and how long it will take.

use std::time::Instant;

use mesh_damper_output::terminal::duration;

/// Before this, in s, nothing is said of the time. Convention: whoever waits has not asked yet.
const SILENT: f64 = 2.0;

/// The present part of a trace.
#[derive(Clone, Copy)]
pub(crate) struct Progress<'p> {
    say: &'p (dyn Fn(&str) + Sync),
    begun: Instant,
    /// Where the present part begins and where it ends, as fractions of the whole trace.
    part: [f64; 2],
}

impl<'p> Progress<'p> {
    /// A trace that begins now. `say` receives what is done, with the time that it may still take.
    pub fn of(say: &'p (dyn Fn(&str) + Sync)) -> Self {
        Self {
            say,
            begun: Instant::now(),
            part: [0.0, 1.0],
        }
    }

    /// That of a part of the present one. Its ends are rough: a trace does not know what it will find.
    #[must_use]
    pub fn within(self, [from, to]: [f64; 2]) -> Self {
        Self {
            part: [from, to].map(|at| self.whole(at)),
            ..self
        }
    }

    /// Says what is done next, at this fraction of the present part.
    pub fn at(&self, part: f64, what: &str) {
        let elapsed = self.begun.elapsed().as_secs_f64();
        (self.say)(&timed(what, elapsed, self.whole(part)));
    }

    fn whole(&self, part: f64) -> f64 {
        let [from, to] = self.part;
        from + part * (to - from)
    }
}

/// The text with the time that is left after `elapsed` s, in which this fraction was done.
fn timed(what: &str, elapsed: f64, done: f64) -> String {
    let left = elapsed * (1.0 - done) / done;
    if elapsed < SILENT || done <= 0.0 {
        return what.to_owned();
    }
    // It is not known to the second.
    let rounded = match left {
        ..10.0 => left,
        _ => 10.0 * (left / 10.0).ceil(),
    };
    format!("{what}; about {} left", duration(rounded))
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    #[test]
    fn what_is_left_is_as_long_as_what_is_done_took() {
        for (elapsed, done, expected) in [
            (1.9, 0.1, "fitting"),
            (3.0, 0.0, "fitting"),
            (3.0, 0.5, "fitting; about 3 s left"),
            (20.0, 0.4, "fitting; about 30 s left"),
            (21.0, 0.4, "fitting; about 40 s left"),
            (60.0, 0.2, "fitting; about 4 min left"),
            (5.0, 1.0, "fitting; about 0 s left"),
        ] {
            assert_eq!(timed("fitting", elapsed, done), expected);
        }
    }

    #[test]
    fn parts_of_parts_follow_each_other() {
        let said = Mutex::new(Vec::new());
        let say = |what: &str| said.lock().unwrap().push(what.to_owned());
        let all = Progress::of(&say);
        let part = all.within([0.2, 0.6]).within([0.5, 1.0]);
        assert!((part.whole(0.0) - 0.4).abs() < 1e-12 && (part.whole(1.0) - 0.6).abs() < 1e-12);
        part.at(0.5, "searching");
        assert_eq!(
            *said.lock().unwrap(),
            ["searching"],
            "at the beginning no time is said"
        );
    }
}
