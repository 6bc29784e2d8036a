//! The mass of a fixture between specimen and load cell. It is hidden below the noise of many a recording, and still distorts what is found
//! there.

use super::{Candidate, Search};
use crate::screen::Screen;
use crate::trace::fitted::Fitted;

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
        let Ok(predicted) = law.solution.predicted(self.trajectories) else {
            return false;
        };
        let screen = Screen::at(&self.rows, &self.extent, &law.solution);
        let of_mass = |&(which, sample): &(usize, usize)| {
            let motion = &self.trajectories[which].motion;
            motion.acceleration[sample]
        };
        let mass: Vec<f64> = self.rows.origin.iter().map(of_mass).collect();
        let time = self.rows.rate_of(&predicted);
        screen.saving(&mass) > screen.saving(&time)
    }
}
