//! Weighted normal equations for columns of two kinds: some belong to one of the law's nodes each, the others to all.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::rows::Rows;

/// Added to the diagonal of the scaled equations, so that a direction that the data do not determine stays small.
const RIDGE: f64 = 1e-11;

/// Normal equations. The unknowns are `LOCAL` for each node in turn, then those of the shared columns.
pub(super) struct Normal {
    /// The lower triangle.
    gram: DMatrix<f64>,
    right: DVector<f64>,
    /// Weighted sum of the squared force.
    power: f64,
}

impl Normal {
    /// For the `force` in kN at `rows`; `local` columns belong to the node that `node` gives for each row.
    pub fn assemble<const LOCAL: usize>(
        rows: &Rows,
        force: &[f64],
        node: &[usize],
        local: &[[f64; LOCAL]],
        shared: &[&[f64]],
    ) -> Self {
        let first_shared = LOCAL * rows.nodes.len();
        let width = first_shared + shared.len();
        let mut normal = Self {
            gram: DMatrix::zeros(width, width),
            right: DVector::zeros(width),
            power: 0.0,
        };
        let count = LOCAL + shared.len();
        let (mut row, mut right) = (vec![0.0; count], vec![0.0; count]);
        let mut gram = vec![0.0; count * count];
        let mut index = 0;
        // Rows of one node follow each other, so their sums are looked up once.
        for same in node.chunk_by(|a, b| a == b) {
            right.fill(0.0);
            gram.fill(0.0);
            for _ in same {
                let weight = rows.weight[index];
                for (slot, value) in row.iter_mut().zip(&local[index]) {
                    *slot = weight * value;
                }
                for (slot, column) in row[LOCAL..].iter_mut().zip(shared) {
                    *slot = weight * column[index];
                }
                let force = weight * force[index];
                normal.power += force * force;
                for (i, (a, line)) in row.iter().zip(gram.chunks_exact_mut(count)).enumerate() {
                    right[i] += a * force;
                    for (sum, b) in line.iter_mut().zip(&row[..=i]) {
                        *sum += a * b;
                    }
                }
                index += 1;
            }
            let first = LOCAL * same[0];
            let place = |i: usize| {
                if i < LOCAL {
                    first + i
                } else {
                    first_shared + i - LOCAL
                }
            };
            for (i, line) in gram.chunks_exact(count).enumerate() {
                normal.right[place(i)] += right[i];
                for (j, sum) in line[..=i].iter().enumerate() {
                    normal.gram[(place(i), place(j))] += sum;
                }
            }
        }
        normal
    }

    /// The solution, with the unknowns that `not_negative` picks set to 0 where they would be negative, and the factored equations
    /// of the others. `None` if the equations are singular.
    pub fn solve(&self, not_negative: impl Fn(usize) -> bool) -> Option<(DVector<f64>, Factor)> {
        let mut active: Vec<usize> = (0..self.right.len()).collect();
        loop {
            let factor = Factor::of(self, active)?;
            let found = factor.solution(self);
            let negative = factor
                .active
                .iter()
                .position(|&i| not_negative(i) && found[i] < 0.0);
            let Some(place) = negative else {
                return Some((found, factor));
            };
            active = factor.active;
            active.remove(place);
        }
    }
}

/// Factored normal equations: they give the components of other columns that these columns do not span.
pub(super) struct Factor {
    cholesky: Cholesky<f64, Dyn>,
    scale: Vec<f64>,
    active: Vec<usize>,
}

impl Factor {
    /// Of the unknowns `among`, those with a nonzero column.
    fn of(normal: &Normal, among: Vec<usize>) -> Option<Self> {
        let active: Vec<usize> = among
            .into_iter()
            .filter(|&i| normal.gram[(i, i)] > 0.0)
            .collect();
        let scale: Vec<f64> = active
            .iter()
            .map(|&i| normal.gram[(i, i)].sqrt().recip())
            .collect();
        let matrix = DMatrix::from_fn(active.len(), active.len(), |i, j| {
            let (a, b) = (active[i].max(active[j]), active[i].min(active[j]));
            normal.gram[(a, b)] * scale[i] * scale[j] + if i == j { RIDGE } else { 0.0 }
        });
        Some(Self {
            cholesky: Cholesky::new(matrix)?,
            scale,
            active,
        })
    }

    /// Of all unknowns.
    pub fn of_all(normal: &Normal) -> Option<Self> {
        Self::of(normal, (0..normal.right.len()).collect())
    }

    fn solution(&self, normal: &Normal) -> DVector<f64> {
        DVector::from_vec(self.nearest(normal.right.as_slice()))
    }

    fn solve_scaled(&self, right: &[f64]) -> DVector<f64> {
        let scaled = DVector::from_fn(self.active.len(), |i, _| {
            right[self.active[i]] * self.scale[i]
        });
        self.cholesky.solve(&scaled)
    }

    /// The coefficients with which these columns come closest to a column that has the `products` with them.
    pub fn nearest(&self, products: &[f64]) -> Vec<f64> {
        let mut coefficients = vec![0.0; products.len()];
        let scaled = self.solve_scaled(products);
        for ((&i, scale), value) in self.active.iter().zip(&self.scale).zip(&scaled) {
            coefficients[i] = value * scale;
        }
        coefficients
    }

    /// The component of a·b outside these columns. `a` and `b` are the products of two other columns with these, and `product` is
    /// a·b.
    pub fn beside(&self, a: &[f64], b: &[f64], product: f64) -> f64 {
        let b = self.solve_scaled(b);
        let taken: f64 = self
            .active
            .iter()
            .zip(&self.scale)
            .zip(&b)
            .map(|((&i, scale), b)| a[i] * scale * b)
            .sum();
        product - taken
    }

    /// The remaining squared force, kN² weighted.
    pub fn left(&self, normal: &Normal) -> f64 {
        let right = normal.right.as_slice();
        self.beside(right, right, normal.power)
    }

    /// The component of a column's product with the force that lies outside these columns.
    pub fn force_beside(&self, normal: &Normal, products: &[f64], with_force: f64) -> f64 {
        self.beside(products, normal.right.as_slice(), with_force)
    }
}
