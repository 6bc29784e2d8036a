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
        let linear = solution.linear();
        Self::with_slopes(basis, columns, solution, |slot, _| {
            basis.slope(columns, &linear, slot)
        })
    }

    /// The same with the derivatives by the searched parameters of terms from another motion: where it differs little, they do too, and
    /// each takes a run of its term.
    pub fn moved(&self, basis: &Basis, columns: &Columns, solution: &Solution) -> Self {
        Self::with_slopes(basis, columns, solution, |_, place| {
            self.shared[place].clone()
        })
    }

    /// `slope` gives the derivative by the searched parameter at a slot, which is at a place among the shared ones.
    fn with_slopes(
        basis: &Basis,
        columns: &Columns,
        solution: &Solution,
        slope: impl Fn(usize, usize) -> Vec<f64>,
    ) -> Self {
        let motion = basis.motion(columns);
        let local = columns
            .law()
            .iter()
            .zip(motion.node.iter().zip(columns.by_exponent()))
            .map(|(&[y, y3, damping], (&node, slope))| {
                [y, y3, damping, solution.law[node].c * slope]
            })
            .collect();
        let mut added = columns.added().into_iter();
        let mut shared: Vec<Vec<f64>> = Vec::new();
        for (index, value) in solution.terms.iter().enumerate() {
            let count = value.term.fitted_sizes();
            shared.extend(added.by_ref().take(count).map(<[f64]>::to_vec));
            for slot in basis.slot(index) {
                shared.push(slope(slot, shared.len()));
            }
        }
        Self {
            node: motion.node.clone(),
            local,
            shared,
        }
    }
}
