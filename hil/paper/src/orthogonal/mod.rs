//! Orthogonal tests: which of up to four factors matters, from nine runs on an L9(3⁴) instead of 81.
//!
//! The paper orders factors by the ranges of their level sums. A range neither distinguishes an effect from error nor shows the
//! size of the error. So this module adds an analysis of variance, which also shows when the data allow no conclusion.
//!
//! ```
//! use mesh_damper_paper::orthogonal::{Experiment, analyse};
//! use mesh_damper_reference::orthogonal_test::STIFFNESS;
//!
//! let analysis = &analyse(&Experiment::published(&[STIFFNESS]))[0];
//! assert_eq!(analysis.order[0], "mesh density");
//! // Yet four factors in nine runs done once leave no error: not even density can be told from it.
//! assert!(analysis.variance.told.is_empty());
//! ```

mod array;
mod experiment;
mod published;
mod ranges;
mod read;
mod variance;

pub use array::{COLUMNS, LEVELS, RUNS, l9};
pub use experiment::{Defect, Experiment, Factor, Response};
pub use published::{AgainstPrint, Misprint, against_print};
pub use ranges::{LevelSums, order};
pub use variance::{Effect, ErrorSource, FREE_COLUMNS, SIGNIFICANCE, Variance};

use serde::Serialize;

/// The analysis of one result of an experiment.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Analysis {
    /// The name of the result.
    pub response: String,
    /// Level sums and ranges by factor.
    pub ranges: Vec<LevelSums>,
    /// The factors from the largest range to the smallest.
    pub order: Vec<String>,
    /// Analysis of variance.
    pub variance: Variance,
}

/// Ranges and variance of every result.
pub fn analyse(experiment: &Experiment) -> Vec<Analysis> {
    let of = |response: &Response| {
        let factors = experiment.factors().iter();
        let ranges: Vec<LevelSums> = factors
            .map(|factor| LevelSums::of(factor, response))
            .collect();
        let sizes: Vec<f64> = ranges.iter().map(|one| one.range).collect();
        let order = order(&sizes).into_iter();
        Analysis {
            response: response.name.clone(),
            order: order.map(|index| ranges[index].factor.clone()).collect(),
            variance: Variance::of(experiment, response),
            ranges,
        }
    };
    experiment.responses().iter().map(of).collect()
}
