//! What a fit found.

use super::rows::Rows;
use super::term::{TermValue, added_effects};
use crate::model::{Family, LawNode, Model};

/// What a fit found.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Eq 13 at each node.
    pub law: Vec<LawNode>,
    /// The added terms.
    pub terms: Vec<TermValue>,
    /// Exponents of the nodes, then the terms' searched parameters: logarithms of shapes, and temperature's β.
    pub(super) search: Vec<f64>,
}

impl Solution {
    /// What temperature scales the law by at a row.
    pub(super) fn scale(&self, rows: &Rows, index: usize) -> f64 {
        self.terms
            .iter()
            .find(|value| value.term.family == Family::Temperature)
            .map_or(1.0, |value| {
                1.0 - value.size * (rows.temperature[index] - value.term.reference)
            })
    }

    /// The model that the crate runs.
    pub fn model(&self) -> Model {
        Model {
            law: self.law.clone(),
            effects: added_effects(&self.terms),
        }
    }
}
