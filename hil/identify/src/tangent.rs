//! The derivatives of a fitted force with respect to all fitted parameters: the effect of a small change.

use super::basis::{Basis, Columns};
use super::solution::Solution;

/// Derivatives of the force at every row.
pub(super) struct Tangent {
    /// The node at each row.
    pub node: Vec<usize>,
    /// With respect to k1, k3, c and α of that node.
    pub local: Vec<[f64; 4]>,
    /// With respect to the sizes, then the searched parameters, term by term.
    pub shared: Vec<Vec<f64>>,
}

impl Tangent {
    /// At `columns` of `basis` with the coefficients of `solution`. There are no derivatives with respect to the parameters of a
    /// term that `solution` lacks.
    pub fn of(basis: &Basis, columns: &Columns, solution: &Solution) -> Self {
        let motion = basis.motion(columns);
        let linear = solution.linear();
        let local = columns
            .law()
            .iter()
            .zip(motion.node.iter().zip(columns.by_exponent()))
            .map(|(&[y, y3, damping], (&node, slope))| {
                [y, y3, damping, solution.law[node].c * slope]
            })
            .collect();
        let mut added = columns.added().into_iter();
        let mut shared = Vec::new();
        for (index, value) in solution.terms.iter().enumerate() {
            let count = value.term.fitted_sizes();
            shared.extend(added.by_ref().take(count).map(<[f64]>::to_vec));
            shared.extend(
                basis
                    .slot(index)
                    .map(|slot| basis.slope(columns, &linear, slot)),
            );
        }
        Self {
            node: motion.node.clone(),
            local,
            shared,
        }
    }
}
