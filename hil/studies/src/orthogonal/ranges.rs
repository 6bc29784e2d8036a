//! The paper's range analysis: the sums of a result over the runs of every level, and how far they are apart.

use mesh_damper_recording::extremes::least_and_largest;
use serde::Serialize;

use super::array::LEVELS;
use super::experiment::{Factor, Response};

/// What the levels of one factor came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LevelSums {
    /// The factor.
    pub factor: String,
    /// Its levels.
    pub levels: [String; LEVELS],
    /// ΣK of every level: the sum over its three runs, each by its mean, in the result's unit.
    pub sums: [f64; LEVELS],
    /// R, the largest of the sums less the smallest, in the result's unit.
    pub range: f64,
}

impl LevelSums {
    pub(super) fn of(factor: &Factor, response: &Response) -> Self {
        let mut sums = [0.0; LEVELS];
        for (&level, values) in factor.column.iter().zip(&response.runs) {
            sums[level] += mean(values);
        }
        let (low, high) = least_and_largest(sums);
        Self {
            factor: factor.name.clone(),
            levels: factor.levels.clone(),
            sums,
            range: high - low,
        }
    }
}

/// The indices of `ranges` from the largest to the smallest; equal ones in the order in which they stand.
pub fn order(ranges: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..ranges.len()).collect();
    order.sort_by(|&a, &b| ranges[b].total_cmp(&ranges[a]));
    order
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
