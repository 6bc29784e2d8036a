//! The mass of a fixture between specimen and load cell, and the time of the force, which looks like one. Both are hidden below the noise of
//! many a recording, and still distort what is found there.

use super::{Candidate, Search};
use crate::families::delay;
use crate::screen::Screen;
use crate::solution::Solution;
use crate::trace::fitted::Fitted;

/// A time is clear beyond this many of its deviations. Convention: three in a thousand are by chance.
const CLEARLY: f64 = 3.0;

impl Search<'_> {
    /// The fit of a candidate that is `law` with a mass in addition, if that is better.
    pub(super) fn heavier(&self, candidate: &Candidate, law: &Fitted) -> Option<Fitted> {
        let heavier = self.refit(&candidate.fitted.solution).ok()?;
        (heavier.is_admissible() && self.is_better(&heavier, law)).then_some(heavier)
    }

    /// Whether `law` is better than `other` on the validation cycles. A mass need not save much, if nothing but a mass saves that: what is
    /// left of a force that is early or late looks like one.
    pub(super) fn is_better(&self, law: &Fitted, other: &Fitted) -> bool {
        law.score.beats(&other.score)
            || law.is_with_mass(other)
                && law.score.gains_throughout(&other.score)
                && self.is_no_time(other)
    }

    /// Whether a mass beside `law` saves more than a force that comes earlier or later, to first order.
    fn is_no_time(&self, law: &Fitted) -> bool {
        let Some(time) = self.rate_of(&law.solution) else {
            return false;
        };
        let screen = Screen::at(&self.rows, &self.extent, &law.solution);
        let of_mass = |&(which, sample): &(usize, usize)| {
            let motion = &self.trajectories[which].motion;
            motion.acceleration[sample]
        };
        let mass: Vec<f64> = self.rows.origin.iter().map(of_mass).collect();
        screen.saving(&mass) > screen.saving(&time)
    }

    /// By how much the force of the recordings that were `moved` is earlier than that of `law` with its delay left out, in s: to first order,
    /// beside a change of all its parameters. None if that is not clear.
    pub fn early_by(&self, law: &Solution, moved: &[bool]) -> Option<f64> {
        let law = law.without_family(delay::FORMS[0].family());
        let law = self.refit(&law).ok()?.solution;
        let mut rate = self.rate_of(&law)?;
        for (rate, &(which, _)) in rate.iter_mut().zip(&self.rows.origin) {
            if !moved[which] {
                *rate = 0.0;
            }
        }
        let screen = Screen::at(&self.rows, &self.extent, &law);
        let (early, deviation) = screen.size_of(&rate)?;
        (early.abs() > CLEARLY * deviation).then_some(early)
    }

    /// The rate of change of a law's force at the rows, kN/s; none if the crate refuses it.
    fn rate_of(&self, law: &Solution) -> Option<Vec<f64>> {
        let predicted = law.predicted(self.trajectories).ok()?;
        Some(self.rows.rate_of(&predicted))
    }
}
