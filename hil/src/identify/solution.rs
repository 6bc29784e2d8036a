//! What a fit found.

use super::term::{Form, Term, TermValue, added_effects};
use crate::model::{LawNode, Model};
use crate::predict::predict;
use crate::recording::trajectory::Trajectory;

/// What a fit found.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Eq 13 at each node.
    pub law: Vec<LawNode>,
    /// The added terms.
    pub terms: Vec<TermValue>,
    /// Exponents of the nodes, then the terms' searched parameters: logarithms of shapes, and temperature's β.
    pub(super) search: Vec<f64>,
    /// Sum of the squared weighted errors, kN².
    pub squares: f64,
}

impl Solution {
    /// The model that the crate runs.
    pub fn model(&self) -> Model {
        Model {
            law: self.law.clone(),
            effects: added_effects(&self.terms),
        }
    }

    /// The added terms, whatever their values.
    pub fn terms(&self) -> Vec<Term> {
        self.terms.iter().map(|value| value.term).collect()
    }

    /// The same without one of its terms, whose place the others have not taken.
    #[must_use]
    pub fn without(&self, index: usize) -> Self {
        let mut rest = self.clone();
        let before: usize = self.terms[..index]
            .iter()
            .map(|value| value.term.form.searched())
            .sum();
        let from = self.law.len() + before;
        rest.search
            .drain(from..from + self.terms[index].term.form.searched());
        rest.terms.remove(index);
        rest
    }

    /// k1, k3 and c of every node, then the sizes of the terms that have a force of their own.
    pub(super) fn linear(&self) -> Vec<f64> {
        let law = self.law.iter().flat_map(|node| [node.k1, node.k3, node.c]);
        let added = self
            .terms
            .iter()
            .filter(|value| value.term.form != Form::Temperature);
        law.chain(added.flat_map(|value| value.sizes.iter().copied()))
            .collect()
    }

    /// The force before it is delayed, kN at every sample.
    pub(super) fn force_inside(&self, trajectories: &[Trajectory]) -> Vec<Vec<f64>> {
        let inside: Vec<TermValue> = self
            .terms
            .iter()
            .filter(|value| value.term.form != Form::Delay)
            .cloned()
            .collect();
        let model = Model {
            law: self.law.clone(),
            effects: added_effects(&inside),
        };
        trajectories
            .iter()
            .map(|trajectory| {
                // Where the crate refuses to run it, the measured force is the best that is known.
                predict(&model, trajectory).unwrap_or_else(|_| trajectory.force.clone())
            })
            .collect()
    }
}
