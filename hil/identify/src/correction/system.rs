//! The penalties that keep the table smooth and the coefficients of eq 13 close to each other, and the solution of the normal
//! equations with them.

use mesh_damper::effects::residual_table::{DISPLACEMENTS, FINE, NODES};
use mesh_damper_model::correction::Remembered;
use nalgebra::{DMatrix, DVector};

use super::cholesky::Cholesky;
use super::design::{Coefficients, Design};
use super::gram::{BlockSums, Layout, TableForm};
use super::hat::KNOTS;

mesh_damper_recording::numbers! {
    /// How smooth a residual table is.
    SystemPolicy {
        /// Penalty on a bend of a coefficient of the law over three neighbouring amplitudes, relative to the weight of the data.
        bend: f64 = 1e-3, Tuned("the blind trial");
        /// Penalty on the change of an exponent in one step of the search, relative to the weight of the data. Later steps continue the
        /// change.
        step: f64 = 1e-3, Tuned("the blind trial");
        /// Penalty on a slope of the residual table, relative to the penalty on its curvature, so that the table ends flat where there are
        /// no data.
        slope: f64 = 1e-3, Tuned("the blind trial");
        /// Penalty on the force of a residual table, relative to the weight of the data in a cell, so that the table takes no
        /// force that the law can describe, and is small where there are no data. At 1e-3 a friction that fades is worse than with the
        /// law alone.
        level: f64 = 1e-4, Tuned("the blind trial");
    }
}

/// Added to the diagonal of the scaled normal equations. Derived: above rounding, below the weight of the data.
const RIDGE: f64 = 1e-10;
/// Weight that holds a coefficient at the end of its range. Derived: above the weight of all data.
const PIN: f64 = 1e9;

/// The penalties.
#[derive(Clone)]
pub(super) struct System {
    penalty: DMatrix<f64>,
    pull: DVector<f64>,
}

impl System {
    pub fn new(
        design: &Design,
        at: &Coefficients,
        layout: &Layout,
        form: TableForm<'_>,
        total: &BlockSums,
    ) -> Self {
        let width = layout.width();
        let mut system = Self {
            penalty: DMatrix::zeros(width, width),
            pull: DVector::zeros(width),
        };
        if layout.law > 0 {
            system.law(design, at, total);
        }
        let per_cell = total.count / (2 * KNOTS * DISPLACEMENTS) as f64;
        let first = layout.law + layout.trends;
        if let Some(smoothness) = form.table {
            let weight = smoothness * per_cell;
            match layout.of {
                // A straight line over speed costs nothing; the distance between nodes doubles each time.
                None => system.table(first, [DISPLACEMENTS, KNOTS], 2.0, weight),
                Some(Remembered::Place) => system.table(first, [FINE, 1], 1.0, weight),
                Some(Remembered::Sides { .. }) => {
                    for side in [first, first + layout.hats / 2] {
                        system.table(side, [1, KNOTS], 2.0, weight);
                    }
                }
                Some(_) => system.table(first, [DISPLACEMENTS, NODES], 1.0, weight),
            }
        }
        let level = SystemPolicy::in_use().level * per_cell;
        for hat in first..first + layout.hats {
            system.add(&[(hat, 1.0)], 0.0, level);
        }
        system
    }

    /// Adds weight·(Σ aᵢ·xᵢ − target)².
    fn add(&mut self, terms: &[(usize, f64)], target: f64, weight: f64) {
        for &(i, a) in terms {
            self.pull[i] += weight * a * target;
            for &(j, b) in terms {
                self.penalty[(i, j)] += weight * a * b;
            }
        }
    }

    /// Penalises bends of the coefficients of eq 13 over amplitude, and large changes of α.
    fn law(&mut self, design: &Design, at: &Coefficients, total: &BlockSums) {
        let count = at.0.len();
        for i in 0..4 {
            let power = |node: usize| total.gram[(4 * node + i, 4 * node + i)];
            if i == 3 {
                for node in 0..count {
                    let weight = SystemPolicy::in_use().step * power(node) + f64::MIN_POSITIVE;
                    self.add(&[(4 * node + 3, 1.0)], 0.0, weight);
                }
                continue;
            }
            for node in 0..count.saturating_sub(2) {
                let [low, middle, high] = [0, 1, 2].map(|next| design.nodes[node + next]);
                let part = (middle - low) / (high - low);
                let weights = [1.0 - part, -1.0, part];
                let terms = [0, 1, 2].map(|next| (4 * (node + next) + i, weights[next]));
                let bend = (0..3)
                    .map(|next| weights[next] * at.0[node + next][i])
                    .sum::<f64>();
                // The smallest of the three: y⁶ of large amplitudes would outweigh all data on the k3 of a small one.
                let least = (node..node + 3).map(power).fold(f64::INFINITY, f64::min);
                self.add(&terms, -bend, SystemPolicy::in_use().bend * least);
            }
        }
    }

    /// The bends of a table over its nodes `across` displacement, and `along` its other variable, where each step is `ratio` times
    /// as long as the one before.
    fn table(&mut self, first: usize, [across, along]: [usize; 2], ratio: f64, weight: f64) {
        for direction in 0..2 {
            for j in 0..along {
                for i in 0..across {
                    let cell = |i: usize, j: usize| first + (direction * along + j) * across + i;
                    if i + 1 < across {
                        self.add(
                            &[(cell(i, j), -1.0), (cell(i + 1, j), 1.0)],
                            0.0,
                            SystemPolicy::in_use().slope * weight,
                        );
                    }
                    if j + 1 < along {
                        self.add(
                            &[(cell(i, j), -1.0), (cell(i, j + 1), 1.0)],
                            0.0,
                            SystemPolicy::in_use().slope * weight,
                        );
                    }
                    if i + 2 < across {
                        let bend = [
                            (cell(i, j), 1.0),
                            (cell(i + 1, j), -2.0),
                            (cell(i + 2, j), 1.0),
                        ];
                        self.add(&bend, 0.0, weight);
                    }
                    if j + 2 < along {
                        let bend = [
                            (cell(i, j), ratio),
                            (cell(i, j + 1), -1.0 - ratio),
                            (cell(i, j + 2), 1.0),
                        ];
                        self.add(&bend, 0.0, weight);
                    }
                }
            }
        }
    }

    /// Holds an unknown at `value`.
    pub fn pin(&mut self, unknown: usize, value: f64) {
        let weight = PIN * self.penalty[(unknown, unknown)].max(1.0);
        self.add(&[(unknown, 1.0)], value, weight);
    }

    /// The unknowns for these sums.
    pub fn solve(&self, gram: DMatrix<f64>, right: DVector<f64>) -> Option<DVector<f64>> {
        Some(self.solver(gram)?.solve(right))
    }

    /// A solver for several right-hand sides.
    pub fn solver(&self, mut gram: DMatrix<f64>) -> Option<Solver<'_>> {
        gram += &self.penalty;
        let scale = DVector::from_iterator(
            gram.nrows(),
            gram.diagonal()
                .iter()
                .map(|d| if *d > 0.0 { d.sqrt().recip() } else { 0.0 }),
        );
        for column in 0..gram.ncols() {
            for row in column..gram.nrows() {
                gram[(row, column)] *= scale[row] * scale[column];
            }
            gram[(column, column)] += RIDGE;
        }
        Some(Solver {
            factor: Cholesky::new(gram)?,
            scale,
            pull: &self.pull,
        })
    }
}

/// The normal equations with the penalties, factored.
pub(super) struct Solver<'s> {
    factor: Cholesky,
    scale: DVector<f64>,
    pull: &'s DVector<f64>,
}

impl Solver<'_> {
    /// The unknowns for this right-hand side, including the pull of the penalties.
    pub fn solve(&self, right: DVector<f64>) -> DVector<f64> {
        self.solve_bare(right + self.pull)
    }

    /// As [`Solver::solve`], without the pull.
    pub fn solve_bare(&self, right: DVector<f64>) -> DVector<f64> {
        let mut x = right.component_mul(&self.scale);
        self.factor.solve(&mut x);
        x.component_mul(&self.scale)
    }
}
