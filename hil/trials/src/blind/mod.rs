//! The blind trial: specimens whose effect, size, noise and test are drawn from a seed that the tracer never sees.

mod absorbed;
mod described;
mod draw;
mod families;
mod floors;
mod judge;
pub mod motions;
mod programme;
mod summary;
mod test_rig;

use std::ops::Range;

use rayon::iter::{Either, IntoParallelIterator, ParallelIterator};

pub use described::{DescribedEffect, described, draw_described};
pub use draw::{Class, GROUP, Hidden, Secret, Sized, Trial, draw, draw_unlisted};
pub use floors::{
    FLOORS, FLOORS_OF_A_PART, FLOORS_OF_THE_DESCRIBED, FLOORS_OF_THE_UNLISTED, Floors, PART,
};
pub use judge::{Mark, Outcome, Said, judge};
pub use programme::{Programme, TestShape};
pub use summary::{Rate, Ratios, Summary};
pub use test_rig::{Sensors, Truth, answer, record};

/// A trial counts if the residual of eq 13 for the hidden effect is at least this multiple of the noise.
pub const LEAST_VISIBLE: f64 = 3.0;

/// How a seed makes a trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draw {
    /// [`draw()`]: specimens with separate physics.
    Specimens,
    /// [`draw_unlisted`]: those of them with an unlisted effect.
    Unlisted,
    /// [`draw_described`]: the effects that the crate describes.
    Described,
}

impl Draw {
    /// Its requirements.
    pub fn floors(self) -> &'static Floors {
        match self {
            Self::Specimens => &FLOORS,
            Self::Unlisted => &FLOORS_OF_THE_UNLISTED,
            Self::Described => &FLOORS_OF_THE_DESCRIBED,
        }
    }

    /// The trial of `seed`; `None` if no test shows its effect.
    pub fn trial(self, seed: u64) -> Option<Trial> {
        match self {
            Self::Specimens => Some(draw(seed)),
            Self::Unlisted => Some(draw_unlisted(seed)),
            Self::Described => draw_described(seed),
        }
    }
}

/// Runs the trials of `seeds`; `done` is called after each seed.
pub fn run(seeds: Range<u64>, draw: Draw, done: &(dyn Fn() + Sync)) -> Summary {
    let (outcomes, not_shown) = seeds.into_par_iter().partition_map(|seed| {
        let outcome = draw.trial(seed).map(|trial| judge(&trial));
        done();
        outcome.map_or(Either::Right(seed), Either::Left)
    });
    Summary::of(outcomes, not_shown)
}
