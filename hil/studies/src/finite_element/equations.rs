//! The sparse symmetric equations of a mesh: their pattern, made once, and their solution.

use faer::Side;
use faer::linalg::solvers::Solve as _;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};

use super::FiniteElementError;

/// Where the entries of a symmetric matrix go. Only its lower triangle is kept.
pub(super) struct Pattern {
    columns: SymbolicSparseColMat<usize>,
    symbolic: SymbolicLlt<usize>,
}

impl Pattern {
    /// Of `size` equations, of which those of one group in `groups` are coupled with each other.
    ///
    /// # Errors
    /// [`FiniteElementError::TooLarge`] when the factor would not fit into memory.
    pub fn new(
        size: usize,
        groups: impl Iterator<Item = Vec<usize>>,
    ) -> Result<Self, FiniteElementError> {
        let mut rows = vec![Vec::<usize>::new(); size];
        for group in groups {
            for &column in &group {
                rows[column].extend(group.iter().filter(|&&row| row >= column));
            }
        }
        let mut starts = vec![0];
        let mut indices = Vec::new();
        for mut column in rows {
            column.sort_unstable();
            column.dedup();
            indices.extend(column);
            starts.push(indices.len());
        }
        let columns = SymbolicSparseColMat::new_checked(size, size, starts, None, indices);
        let symbolic = SymbolicLlt::try_new(columns.as_ref(), Side::Lower)
            .map_err(|_| FiniteElementError::TooLarge)?;
        Ok(Self { columns, symbolic })
    }

    /// How many entries the lower triangle has.
    pub fn entries(&self) -> usize {
        self.columns.row_idx().len()
    }

    /// Which entry of the lower triangle is in `row` and `column`, `row` ≥ `column`.
    pub fn entry(&self, row: usize, column: usize) -> usize {
        let range = self.columns.col_range(column);
        let within = self.columns.row_idx()[range.clone()].binary_search(&row);
        range.start + within.expect("the pattern has every coupling of its groups")
    }

    /// Solves the equations with `values` as the entries of the lower triangle, in place.
    ///
    /// # Errors
    /// [`FiniteElementError::Unstable`] when the matrix is not positive definite: the body would leave its equilibrium.
    pub fn solve(&self, values: &[f64], right: &mut [f64]) -> Result<(), FiniteElementError> {
        let matrix = SparseColMatRef::new(self.columns.as_ref(), values);
        let factor = Llt::try_new_with_symbolic(self.symbolic.clone(), matrix, Side::Lower)
            .map_err(|_| FiniteElementError::Unstable)?;
        let size = right.len();
        factor.solve_in_place(faer::MatMut::from_column_major_slice_mut(right, size, 1));
        Ok(())
    }
}
