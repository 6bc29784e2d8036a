//! The paper's range analysis: the sums of a result over the runs of every level, and their range.

use mesh_damper_recording::extremes::least_and_largest;
use serde::Serialize;

use super::array::LEVELS;
use super::experiment::{Factor, Response};

/// Sums for the levels of one factor.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LevelSums {
    /// The factor.
    pub factor: String,
    /// The levels of the factor.
    pub levels: [String; LEVELS],
    /// Level sums ΣK: for each level, the sum of the means of its three runs, in the result's unit.
    pub sums: [f64; LEVELS],
    /// Range R: the largest of the sums minus the smallest, in the result's unit.
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

/// The indices of `ranges` from the largest to the smallest; equal ones keep their order.
pub fn order(ranges: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..ranges.len()).collect();
    order.sort_by(|&a, &b| ranges[b].total_cmp(&ranges[a]));
    order
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
