//! Processors of the harness and of the emulators that it runs.
//!
//! Only one of harness and emulator works at a time. If each has a processor of its own, neither needs to sleep: it polls for the
//! next frame. If no two processors are free, because this process runs other emulators or other programs keep them busy, both stay
//! on one: the other continues as soon as this one sleeps. On two busy processors each tick would wake a sleeping processor twice;
//! a tick then took six times as long.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Numbers of the processors in use.
static TAKEN: Mutex<Vec<usize>> = Mutex::new(Vec::new());

fn taken() -> MutexGuard<'static, Vec<usize>> {
    // It is valid even after a panic.
    TAKEN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// While it exists, this thread stays on one processor, and the emulator on another or the same. On systems without affinity the
/// processors are only counted.
#[derive(Debug)]
pub(super) struct Pin {
    harness: usize,
    emulator: usize,
    before: affinity::Before,
}

impl Pin {
    /// Takes processors: two if two are free that this thread may use. Processes that the thread starts from now on stay on the
    /// emulator's.
    pub(super) fn of_emulator() -> Self {
        let (here, before) = affinity::now();
        let mut taken = taken();
        let mut free = before.processors();
        free.retain(|processor| !taken.contains(processor));
        // The present processor first, if it is free.
        free.sort_by_key(|processor| *processor != here);
        let (harness, emulator) = match free[..] {
            [harness, emulator, ..] => (harness, emulator),
            [one] => (one, one),
            [] => (here, here),
        };
        taken.extend([harness, emulator]);
        affinity::stay_on(emulator);
        Self {
            harness,
            emulator,
            before,
        }
    }

    /// Moves this thread to the harness's processor, if it is to be `apart`, and to the emulator's otherwise.
    pub(super) fn of_harness(&self, apart: bool) {
        affinity::stay_on(if apart { self.harness } else { self.emulator });
    }

    /// Whether each has a processor of its own.
    pub(super) fn is_apart(&self) -> bool {
        self.harness != self.emulator
    }
}

impl Drop for Pin {
    fn drop(&mut self) {
        let mut taken = taken();
        for given in [self.harness, self.emulator] {
            if let Some(at) = taken.iter().position(|processor| *processor == given) {
                taken.swap_remove(at);
            }
        }
        self.before.restore();
    }
}

#[cfg(target_os = "linux")]
mod affinity {
    use rustix::thread::{CpuSet, Pid, gettid, sched_getaffinity, sched_getcpu, sched_setaffinity};

    /// The processors on which a thread could run.
    #[derive(Debug)]
    pub struct Before(Option<(Pid, CpuSet)>);

    /// The processor on which this thread runs, and those on which it may.
    pub fn now() -> (usize, Before) {
        let set = sched_getaffinity(None).ok();
        (sched_getcpu(), Before(set.map(|set| (gettid(), set))))
    }

    /// Keeps this thread on `processor`. If this is not permitted, the link is slower, but as correct.
    pub fn stay_on(processor: usize) {
        let mut set = CpuSet::new();
        set.set(processor);
        let _ = sched_setaffinity(None, &set);
    }

    impl Before {
        pub fn processors(&self) -> Vec<usize> {
            let Some((_, set)) = &self.0 else {
                return Vec::new();
            };
            (0..CpuSet::MAX_CPU).filter(|at| set.is_set(*at)).collect()
        }

        pub fn restore(&self) {
            if let Some((thread, set)) = &self.0 {
                let _ = sched_setaffinity(Some(*thread), set);
            }
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod affinity {
    #[derive(Debug)]
    pub struct Before;

    pub fn now() -> (usize, Before) {
        (0, Before)
    }

    pub fn stay_on(_: usize) {}

    impl Before {
        pub fn processors(&self) -> Vec<usize> {
            (0..std::thread::available_parallelism().map_or(1, usize::from)).collect()
        }

        pub fn restore(&self) {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_has_its_own_processor_as_long_as_two_are_free() {
        let count = affinity::now().1.processors().len();
        // Each in its own thread, because a thread stays on one processor from then on.
        let pins: Vec<Pin> = std::thread::scope(|scope| {
            (0..count)
                .map(|_| scope.spawn(Pin::of_emulator).join().unwrap())
                .collect()
        });
        let apart = pins.iter().filter(|pin| pin.is_apart()).count();
        assert_eq!(apart, count / 2);
        assert!(pins[..apart].iter().all(Pin::is_apart));
        let mut given = taken().clone();
        assert_eq!(given.len(), 2 * count);
        given.sort_unstable();
        given.dedup();
        assert_eq!(given.len(), count);
        drop(pins);
        assert!(taken().is_empty());
    }
}
