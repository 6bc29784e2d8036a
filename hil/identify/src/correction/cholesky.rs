//! Cholesky factorisation of a dense matrix in blocks. Most of the work is products of matrices, which nalgebra's version computes
//! column by column.

use nalgebra::{DMatrix, DVector};

/// Columns of a block. Convention: as many as fit into the second-level cache with a few hundred rows, some 75 KB.
const BLOCK: usize = 32;

/// L of A = L·Lᵀ, below the diagonal and on it.
pub(crate) struct Cholesky(DMatrix<f64>);

impl Cholesky {
    /// Factors a symmetric matrix, reading its lower triangle; `None` if it is not positive definite.
    pub fn new(mut matrix: DMatrix<f64>) -> Option<Self> {
        let size = matrix.nrows();
        for first in (0..size).step_by(BLOCK) {
            let end = (first + BLOCK).min(size);
            for column in first..end {
                let (left, right) = matrix.as_mut_slice().split_at_mut(column * size);
                let below = &mut right[column..size];
                for before in left[first * size..].chunks_exact(size) {
                    let part = before[column];
                    for (entry, factor) in below.iter_mut().zip(&before[column..]) {
                        *entry -= part * factor;
                    }
                }
                // NaN is no pivot either.
                if !(below[0] > 0.0 && below[0].is_finite()) {
                    return None;
                }
                let pivot = below[0].sqrt();
                for entry in below {
                    *entry /= pivot;
                }
            }
            let done = matrix
                .view((end, first), (size - end, end - first))
                .clone_owned();
            for start in (end..size).step_by(BLOCK) {
                let width = BLOCK.min(size - start);
                let across = done.rows(start - end, width).transpose();
                matrix.view_mut((start, start), (size - start, width)).gemm(
                    -1.0,
                    &done.rows(start - end, size - start),
                    &across,
                    1.0,
                );
            }
        }
        Some(Self(matrix))
    }

    /// Solves A·x = `right` for x, in place.
    pub fn solve(&self, right: &mut DVector<f64>) {
        // The pivots are above 0, so neither call fails.
        self.0.solve_lower_triangular_mut(right);
        self.0.tr_solve_lower_triangular_mut(right);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    fn definite(size: usize, seed: u64) -> DMatrix<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let root = DMatrix::from_fn(size, size, |_, _| rng.random_range(-1.0..1.0));
        &root * root.transpose() + DMatrix::identity(size, size)
    }

    #[test]
    fn what_is_solved_solves_the_equations_in_blocks_and_at_their_edges() {
        for size in [
            0,
            1,
            2,
            BLOCK - 1,
            BLOCK,
            BLOCK + 1,
            3 * BLOCK,
            5 * BLOCK + 7,
        ] {
            let matrix = definite(size, size as u64);
            let x = DVector::from_fn(size, |i, _| (i as f64).sin());
            let mut solved = &matrix * &x;
            // The upper triangle is not read.
            let mut lower = matrix.clone();
            lower.fill_upper_triangle(f64::NAN, 1);
            Cholesky::new(lower).unwrap().solve(&mut solved);
            assert!((solved - x).amax() <= 1e-9, "{size}");
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factor() {
        for place in [0, BLOCK - 1, BLOCK, 2 * BLOCK + 3] {
            let mut matrix = definite(2 * BLOCK + 4, 1);
            for spoilt in [0.0, -1e3, f64::NAN, f64::INFINITY] {
                matrix[(place, place)] = spoilt;
                assert!(Cholesky::new(matrix.clone()).is_none(), "{place}, {spoilt}");
            }
        }
    }
}
