//! The trial of conditions: does the written model predict other conditions of the same device at least as well as the law alone,
//! and does its stated band hold there?
//!
//! A seed draws a device, fits a model to some amplitudes, frequencies, speeds or levels of a control input, and judges it on others.
//! The devices were written from the literature, without a look at the effects that the tracer knows: a model of its own physics
//! would predict too well.

mod device;
mod judge;
mod programme;
mod sensors;
mod summary;
mod trial;
mod waves;

use std::ops::Range;

use rayon::iter::{IntoParallelIterator, ParallelIterator};

pub use device::{Device, Family, Scale};
pub use judge::{Outcome, Said, judge};
pub use programme::{Condition, Kind, Programme};
pub use sensors::Sensors;
pub use summary::{Row, Summary};
pub use trial::{Secret, Trial, trial};
pub use waves::Wave;

/// Runs the trials of `seeds`; `done` is called after each seed.
pub fn run(seeds: Range<u64>, done: &(dyn Fn() + Sync)) -> Summary {
    let outcomes = seeds.into_par_iter().map(|seed| {
        let outcome = judge(&trial(seed));
        done();
        outcome
    });
    Summary::of(outcomes.collect())
}
