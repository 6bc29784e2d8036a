//! Screens effects: the possible gain of each when added to a fitted law, before any of them is fitted.
//!
//! The force is linearised at the fitted law. The gain of a candidate comes from the component of its force, outside all
//! derivatives of the law, along the residual (the score test of Rao 1948). It costs a few passes over the rows for each start. So
//! a grid of starts can be screened, and only the best are fitted.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::basis::{Basis, Columns};
use super::families::{Entry, Form, Moment};
use super::normal::{Factor, Normal};
use super::rows::Rows;
use super::shape::Extent;
use super::solution::Solution;
use super::tangent::Tangent;
use super::term::Term;

/// A fitted law, linearised.
pub struct Screen<'s, 'r, 'a> {
    extent: &'s Extent,
    solution: &'s Solution,
    basis: Basis<'r, 'a>,
    columns: Columns,
    tangent: Tangent,
    /// The force at every row without that of the terms with a held size, kN.
    to_explain: Vec<f64>,
    normal: Normal,
    /// `None` if the equations are singular: no statement is possible then.
    factor: Option<Factor>,
}

/// A start for the fit of a candidate.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// The candidate's shapes.
    pub shapes: Vec<f64>,
    /// The part of the squared error that it could save, to first order.
    pub gain: f64,
}

impl<'s, 'r, 'a> Screen<'s, 'r, 'a> {
    /// At `solution`, which was fitted to `rows`.
    pub fn at(rows: &'r Rows<'a>, extent: &'s Extent, solution: &'s Solution) -> Self {
        let basis = Basis::new(rows, extent, &solution.terms()).around(solution);
        let columns = basis.columns(&solution.search, None);
        let tangent = Tangent::of(&basis, &columns, solution);
        let to_explain = basis.to_explain(&columns).into_owned();
        let (normal, factor) = normal_of(rows, &to_explain, &tangent);
        Self {
            extent,
            solution,
            basis,
            columns,
            tangent,
            to_explain,
            normal,
            factor,
        }
    }

    /// The starts of `term`, the best first; a term without shapes has one.
    pub fn starts(&self, term: Term) -> Vec<Start> {
        let moved = (term.form.entry == Entry::Moves).then(|| {
            let terms: Vec<Term> = self.solution.terms().into_iter().chain([term]).collect();
            Basis::new(self.basis.rows, self.extent, &terms).around(self.solution)
        });
        let mut starts: Vec<Start> = grid(self.extent, term.form)
            .into_iter()
            .map(|shapes| Start {
                gain: self.gain(term, moved.as_ref(), &shapes),
                shapes,
            })
            .collect();
        starts.sort_by(|a, b| b.gain.total_cmp(&a.gain));
        starts
    }

    /// The squared error that a force, in kN at every row and of any size, saves in addition to the law's, to first order.
    pub fn saving(&self, force: &[f64]) -> f64 {
        let factor = self.factor.as_ref();
        factor.map_or(0.0, |factor| self.saved_by(factor, &[force], false))
    }

    /// The size that a force, in kN at every row with size 1, has in addition to the law's, to first order, and its deviation; none if the law
    /// has that force.
    pub fn size_of(&self, force: &[f64]) -> Option<(f64, f64)> {
        let factor = self.factor.as_ref()?;
        let (along, sizes) = self.beside(factor, &[force])?;
        let variance = factor.left(&self.normal) / self.basis.rows.len() as f64;
        let gram = along[0] / sizes[0];
        (gram > 0.0).then(|| (sizes[0], (variance / gram).sqrt()))
    }

    /// `moved` has the term if that moves the motion.
    fn gain(&self, term: Term, moved: Option<&Basis>, shapes: &[f64]) -> f64 {
        let Some(factor) = &self.factor else {
            return 0.0;
        };
        let left = factor.left(&self.normal);
        let saved = match term.form.entry {
            Entry::Moves => {
                let moved = moved.and_then(|basis| self.left_when_moved(basis, shapes));
                left - moved.unwrap_or(left)
            }
            Entry::Scales(count) => {
                let columns: Vec<Vec<f64>> = (0..count)
                    .map(|size| {
                        let mut sizes = vec![0.0; count];
                        sizes[size] = 1.0;
                        self.scaled_by(term, &sizes, shapes)
                    })
                    .collect();
                let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
                self.saved_by(factor, &columns, false)
            }
            Entry::Adds(_) => {
                let forces = self.basis.unit_forces(term.form, shapes, &self.columns);
                let forces: Vec<&[f64]> = forces.iter().map(|force| force.as_slice()).collect();
                self.saved_by(factor, &forces, term.form.size_is_positive)
            }
        };
        (saved / left).max(0.0)
    }

    /// The force that a term which scales the law adds at every row, kN.
    fn scaled_by(&self, term: Term, sizes: &[f64], shapes: &[f64]) -> Vec<f64> {
        let motion = &self.basis.rows.motion;
        let scaled = |index: usize| {
            let node = &self.solution.law[self.tangent.node[index]];
            let [y, y3, damping, _] = self.tangent.local[index];
            let moment = Moment {
                displacement: motion.displacement[index],
                direction: motion.direction[index],
                cycles: motion.cycles[index],
                temperature: motion.temperature[index],
                reference: term.reference,
            };
            let [of_elastic, of_damping] = (term.form.gains)(sizes, shapes, &moment);
            of_elastic * (node.k1 * y + node.k3 * y3) + of_damping * (node.c * damping)
        };
        (0..self.basis.rows.len()).map(scaled).collect()
    }

    /// The squared error that columns save in addition to the law's.
    fn saved_by(&self, factor: &Factor, columns: &[&[f64]], positive: bool) -> f64 {
        let Some((force, sizes)) = self.beside(factor, columns) else {
            return 0.0;
        };
        match force.as_slice() {
            [only] if positive && *only <= 0.0 => 0.0,
            _ => force.dot(&sizes),
        }
    }

    /// The force along each column beside the law, and the sizes that the columns have then; none if they are not independent.
    fn beside(&self, factor: &Factor, columns: &[&[f64]]) -> Option<(DVector<f64>, DVector<f64>)> {
        let products: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| self.products_with_base(column))
            .collect();
        let inner = |a: &[f64], b: &[f64]| -> f64 {
            let weights = self.basis.rows.weight.iter();
            weights
                .zip(a.iter().zip(b))
                .map(|(w, (a, b))| w * w * a * b)
                .sum()
        };
        let count = columns.len();
        let force = DVector::from_fn(count, |i, _| {
            let with_force = inner(columns[i], &self.to_explain);
            factor.force_beside(&self.normal, &products[i], with_force)
        });
        let gram = DMatrix::from_fn(count, count, |i, j| {
            let product = inner(columns[i], columns[j]);
            // A column that the law nearly contains can save nothing above rounding.
            let least = if i == j { 1e-9 * product } else { 0.0 };
            factor.beside(&products[i], &products[j], product) + least
        });
        let sizes = Cholesky::new(gram)?.solve(&force);
        Some((force, sizes))
    }

    fn products_with_base(&self, column: &[f64]) -> Vec<f64> {
        let local = 4 * self.basis.rows.nodes.len();
        let mut products = vec![0.0; local + self.tangent.shared.len()];
        for (index, value) in column.iter().enumerate() {
            let weighted = self.basis.rows.weight[index].powi(2) * value;
            let first = 4 * self.tangent.node[index];
            for (slot, own) in self.tangent.local[index].iter().enumerate() {
                products[first + slot] += weighted * own;
            }
            for (slot, shared) in self.tangent.shared.iter().enumerate() {
                products[local + slot] += weighted * shared[index];
            }
        }
        products
    }

    /// The squared error of the law when the motion is changed, by the last term of `basis`.
    fn left_when_moved(&self, basis: &Basis, shapes: &[f64]) -> Option<f64> {
        let known = self.solution.search.iter().copied();
        let at: Vec<f64> = known.chain(shapes.iter().map(|shape| shape.ln())).collect();
        let columns = basis.columns(&at, None);
        let tangent = self.tangent.moved(basis, &columns, self.solution);
        let to_explain = basis.to_explain(&columns);
        let (normal, factor) = normal_of(self.basis.rows, &to_explain, &tangent);
        Some(factor?.left(&normal))
    }
}

fn normal_of(rows: &Rows, to_explain: &[f64], tangent: &Tangent) -> (Normal, Option<Factor>) {
    let shared: Vec<&[f64]> = tangent.shared.iter().map(Vec::as_slice).collect();
    let normal = Normal::assemble(rows, to_explain, &tangent.node, &tangent.local, &shared);
    let factor = Factor::of_all(&normal);
    (normal, factor)
}

/// Every combination of the starts of a form's shapes.
fn grid(extent: &Extent, form: Form) -> Vec<Vec<f64>> {
    (form.shapes)(extent)
        .iter()
        .fold(vec![Vec::new()], |grid, shape| {
            grid.iter()
                .flat_map(|point| {
                    shape.starts.iter().map(move |&start| {
                        let mut point = point.clone();
                        point.push(start);
                        point
                    })
                })
                .collect()
        })
}
