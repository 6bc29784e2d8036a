//! The symmetric equations of a mesh, and their solution by a Cholesky factorisation within their envelope.
//!
//! Each row stores the entries from its first one to the diagonal: the factor has no entries outside. A ring's nodes are numbered
//! around it, so that the envelope is as narrow as a cross-section.

use nalgebra::DVectorView;

use super::FiniteElementError;

/// The places of the entries of a symmetric matrix. Only its lower triangle is stored, row after row.
pub(super) struct Pattern {
    /// The column of each row's first entry.
    first: Vec<usize>,
    /// The place of each row's first entry, and the end of all.
    starts: Vec<usize>,
}

impl Pattern {
    /// For `size` equations; those within each of `groups` are coupled with each other.
    ///
    /// # Errors
    /// [`FiniteElementError::TooLarge`] if the factor would not fit into memory.
    pub fn new(
        size: usize,
        groups: impl Iterator<Item = Vec<usize>>,
    ) -> Result<Self, FiniteElementError> {
        let mut first: Vec<usize> = (0..size).collect();
        for group in groups {
            if let Some(&least) = group.iter().min() {
                for row in group {
                    first[row] = first[row].min(least);
                }
            }
        }
        let mut starts = vec![0];
        let mut end = 0_usize;
        for (row, first) in first.iter().enumerate() {
            end = (end.checked_add(row - first + 1)).ok_or(FiniteElementError::TooLarge)?;
            starts.push(end);
        }
        Vec::<f64>::new()
            .try_reserve_exact(end)
            .map_err(|_| FiniteElementError::TooLarge)?;
        Ok(Self { first, starts })
    }

    /// The number of entries in the lower triangle.
    pub fn entries(&self) -> usize {
        self.starts[self.first.len()]
    }

    /// The index in the lower triangle of the entry in `row` and `column`, `row` ≥ `column`, of one group.
    ///
    /// # Panics
    /// If the row begins after `column`: the entry would belong to the row before.
    pub fn entry(&self, row: usize, column: usize) -> usize {
        let place = column.checked_sub(self.first[row]);
        self.starts[row] + place.expect("row and column are of one group")
    }

    /// The entries of `row`, from `column` on.
    fn row<'v>(&self, values: &'v [f64], row: usize, column: usize) -> &'v [f64] {
        &values[self.entry(row, column)..self.starts[row + 1]]
    }

    /// Solves the equations with `values` as the entries of the lower triangle, in place.
    ///
    /// # Errors
    /// [`FiniteElementError::Unstable`] if the matrix is not positive definite: the body would leave its equilibrium.
    pub fn solve(&self, values: &[f64], right: &mut [f64]) -> Result<(), FiniteElementError> {
        let mut factor = values.to_vec();
        for row in 0..self.first.len() {
            let (above, own) = factor.split_at_mut(self.starts[row]);
            let first = self.first[row];
            for column in first..row {
                // Σ L(row, k)·L(column, k) over the k < column that both rows have.
                let both = first.max(self.first[column]);
                let other = self.row(above, column, both);
                let (other, pivot) = (&other[..column - both], other[column - both]);
                let known = &own[both - first..column - first];
                own[column - first] = (own[column - first] - dot(known, other)) / pivot;
            }
            let known = &own[..row - first];
            let square = own[row - first] - dot(known, known);
            if !(square > 0.0 && square.is_finite()) {
                return Err(FiniteElementError::Unstable);
            }
            own[row - first] = square.sqrt();
        }
        for row in 0..self.first.len() {
            let first = self.first[row];
            let (known, pivot) = split_last(self.row(&factor, row, first));
            right[row] = (right[row] - dot(known, &right[first..row])) / pivot;
        }
        for row in (0..self.first.len()).rev() {
            let first = self.first[row];
            let (known, pivot) = split_last(self.row(&factor, row, first));
            right[row] /= pivot;
            let x = right[row];
            for (left, entry) in right[first..row].iter_mut().zip(known) {
                *left -= x * entry;
            }
        }
        Ok(())
    }
}

/// A row's entries before the diagonal, and the one on it.
fn split_last(row: &[f64]) -> (&[f64], f64) {
    let (last, before) = row.split_last().expect("a row has its diagonal");
    (before, *last)
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    DVectorView::from_slice(a, a.len()).dot(&DVectorView::from_slice(b, b.len()))
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    use super::*;

    /// Two bars, with three equations and one in common, on springs: K = Σ groups.
    fn matrix(pattern: &Pattern, spring: f64) -> Vec<f64> {
        let mut values = vec![0.0; pattern.entries()];
        for (row, column, value) in [
            (0, 0, 4.0),
            (2, 0, 1.0),
            (2, 2, 5.0),
            (3, 2, 2.0),
            (1, 1, 3.0),
            (3, 3, 6.0),
            (4, 1, -1.0),
            (4, 4, spring),
        ] {
            values[pattern.entry(row, column)] = value;
        }
        values
    }

    fn pattern() -> Pattern {
        let groups = [vec![2, 0], vec![3, 2], vec![4, 1]];
        Pattern::new(5, groups.into_iter()).unwrap()
    }

    #[test]
    fn what_is_solved_solves_the_equations() {
        let pattern = pattern();
        let values = matrix(&pattern, 2.0);
        let x = [1.0, -2.0, 3.0, 0.5, -0.25];
        let mut right = [0.0; 5];
        for row in 0..5 {
            for column in pattern.first[row]..=row {
                let value = values[pattern.entry(row, column)];
                right[row] += value * x[column];
                if row != column {
                    right[column] += value * x[row];
                }
            }
        }
        pattern.solve(&values, &mut right).unwrap();
        for (solved, x) in right.iter().zip(x) {
            assert!((solved - x).abs() < 1e-12, "{right:?}");
        }
    }

    /// Groups of 3 to 6 of `size` unknowns, which may overlap and leave gaps in rows. Each comes with the entries of its own
    /// square.
    fn groups(size: usize) -> impl Strategy<Value = Vec<(Vec<usize>, Vec<f64>)>> {
        let unknowns: Vec<usize> = (0..size).collect();
        let group = proptest::sample::subsequence(unknowns, 3..=6);
        let square = proptest::collection::vec(-1.0..1.0, 36);
        proptest::collection::vec((group, square), 1..=size)
    }

    proptest! {
        /// Σ B·Bᵀ over the groups, on springs: positive definite. Overlapping groups fill entries that no group has.
        #[test]
        fn groups_that_overlap_are_solved_as_a_dense_matrix_is(
            (size, groups) in (6_usize..40).prop_flat_map(|size| (Just(size), groups(size))),
            right in proptest::collection::vec(-1.0..1.0, 40),
        ) {
            let unknowns = groups.iter().map(|(group, _)| group.clone());
            let pattern = Pattern::new(size, unknowns).unwrap();
            let mut values = vec![0.0; pattern.entries()];
            let mut dense = DMatrix::<f64>::identity(size, size) * SPRING;
            for row in 0..size {
                values[pattern.entry(row, row)] = SPRING;
            }
            for (group, square) in &groups {
                let square = DMatrix::from_row_slice(6, 6, square);
                let part = &square * square.transpose();
                for (i, &row) in group.iter().enumerate() {
                    for (j, &column) in group.iter().enumerate() {
                        dense[(row, column)] += part[(i, j)];
                        if column <= row {
                            values[pattern.entry(row, column)] += part[(i, j)];
                        }
                    }
                }
            }
            let right = DVector::from_column_slice(&right[..size]);
            let expected = dense.cholesky().unwrap().solve(&right);
            let mut solved = right;
            pattern.solve(&values, solved.as_mut_slice()).unwrap();
            // Between the springs' stiffness and 36 from each of 40 groups lies a factor of 15 000.
            let error = (&solved - &expected).amax();
            prop_assert!(error < 1e-10 * (1.0 + expected.amax()), "{error}");
        }
    }

    /// Stiffness of the softest motion of the random matrices.
    const SPRING: f64 = 0.1;

    #[test]
    #[should_panic(expected = "of one group")]
    fn an_entry_before_a_row_begins_is_not_one_of_the_row_before() {
        pattern().entry(3, 1);
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_unstable() {
        let pattern = pattern();
        // The square of the coupling, 1, over the other's stiffness, 3.
        for spring in [1.0 / 3.0 - 1e-9, -1.0, f64::NAN] {
            let solved = pattern.solve(&matrix(&pattern, spring), &mut [1.0; 5]);
            assert!(
                matches!(solved, Err(FiniteElementError::Unstable)),
                "{spring}"
            );
        }
    }
}
