//! The blind trial: specimens whose effect, size, noise and test are drawn from a seed that the tracer never sees.

mod absorbed;
mod blocks;
mod described;
mod families;
mod flat;
mod floors;
mod judge;
mod motion;
mod path;
mod programme;
mod sensors;
mod summary;
mod test_rig;
mod trial;

use std::ops::Range;

use rayon::iter::{Either, IntoParallelIterator, ParallelIterator};

pub use blocks::GROUP;
pub(crate) use blocks::rms;
pub use described::{DescribedEffect, described};
pub use families::Version;
pub(crate) use families::log_uniform;
pub use flat::MotionOutcome;
pub use floors::{Floors, PART};
pub use judge::{Mark, Outcome, Said, VelocityError, judge};
pub(crate) use judge::{WORSE, within_band};
pub use path::{Kind, Path};
pub use programme::{Programme, TestShape};
pub use sensors::{Flaw, MotionSensors};
pub use summary::{Rate, Ratios, Results, Row, Summary};
pub(crate) use summary::{grouped, if_any, name};
pub use test_rig::{Sensors, Truth, answer, record};
pub use trial::{AnyMotion, Blocks, Class, Hidden, Secret, Sized, Test, Trial};

/// A trial counts if the residual of eq 13 for the hidden effect is at least this multiple of the noise.
pub const LEAST_VISIBLE: f64 = 3.0;

/// How a seed makes a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draw {
    /// Specimens with separate physics, tested with blocks of sines.
    Specimens,
    /// Those of them with an unlisted effect.
    Unlisted,
    /// The effects that the crate describes, tested with blocks of sines.
    Described,
    /// Specimens with separate physics, tested over any motion.
    Motions,
}

impl Draw {
    /// Its requirements.
    pub fn floors(self) -> Floors {
        match self {
            Self::Specimens => Floors::Specimens,
            Self::Unlisted => Floors::Unlisted,
            Self::Described => Floors::Described,
            Self::Motions => Floors::Motions,
        }
    }

    /// Seeds of a run that gives no number: four of each effect that the crate describes, for which its requirements are.
    pub fn seeds(self) -> u64 {
        match self {
            Self::Described => 4 * described(),
            _ => 50,
        }
    }

    /// The trial of `seed`, the same for the same `version`; `None` if no test shows its effect. The version does not matter for
    /// the effects that the crate describes.
    pub fn trial(self, version: Version, seed: u64) -> Option<Trial> {
        match self {
            Self::Specimens => Some(blocks::draw(version, seed)),
            Self::Unlisted => Some(blocks::draw_unlisted(version, seed)),
            Self::Described => described::draw_described(seed),
            Self::Motions => Some(motion::draw(version, seed)),
        }
    }
}

/// Runs the trials of `seeds`; `done` is called after each seed.
pub fn run(seeds: Range<u64>, draw: Draw, version: Version, done: &(dyn Fn() + Sync)) -> Summary {
    let (outcomes, not_shown) = seeds.into_par_iter().partition_map(|seed| {
        let outcome = draw.trial(version, seed).map(|trial| judge(&trial));
        done();
        outcome.map_or(Either::Right(seed), Either::Left)
    });
    Summary::of(version, outcomes, not_shown)
}
