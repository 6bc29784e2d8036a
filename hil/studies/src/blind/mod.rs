//! The blind trial: specimens whose effect, size, noise and test are drawn by a seed that the tracer never sees.

mod absorbed;
mod draw;
mod families;
mod floors;
mod judge;
mod programme;
mod summary;
mod test_rig;

use std::ops::Range;

use rayon::iter::{IntoParallelIterator, ParallelIterator};

pub use draw::{Class, GROUP, Secret, Sized, Trial, draw};
pub use floors::{FLOORS, FLOORS_OF_A_PART, Floors, PART};
pub use judge::{Mark, Outcome, Said, judge};
pub use programme::{Programme, Shape};
pub use summary::{Rate, Ratios, Summary};
pub use test_rig::{Sensors, Truth, answer, record};

/// What eq 13 leaves of a hidden effect is at least so many times the noise where its trial counts.
pub const LEAST_VISIBLE: f64 = 3.0;

/// Runs the trials of `seeds`; `done` is called after each.
pub fn run(seeds: Range<u64>, done: &(dyn Fn(&Outcome) + Sync)) -> Summary {
    let outcomes = seeds
        .into_par_iter()
        .map(|seed| {
            let outcome = judge(&draw(seed));
            done(&outcome);
            outcome
        })
        .collect();
    Summary::of(outcomes)
}
