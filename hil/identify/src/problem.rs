//! The fit of eq 13 and added effects by variable projection.
//!
//! For given exponents and shapes the force is linear in all other parameters: k1, k3 and c at each amplitude, and the sizes of the
//! effects. So the search (Levenberg–Marquardt) covers only exponents and shapes, and each of its steps solves the linear part
//! exactly (Golub and Pereyra 1973).

use std::cell::RefCell;
use std::collections::HashMap;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use mesh_damper_model::LawNode;
use nalgebra::{DMatrix, DVector, Dyn, Owned};
use rayon::prelude::*;

use super::basis::{Basis, Columns};
use super::exact;
use super::families::Form;
use super::normal::{Factor, Normal};
use super::rows::{Purpose, Rows};
use super::shape::Extent;
use super::solution::Solution;
use super::term::Term;

mesh_damper_recording::numbers! {
    /// The fit of the law and of effects.
    ProblemPolicy {
        /// Starting values of the law's exponent α for a fit without a known solution. The middle one is also used for an amplitude without
        /// a known neighbour.
        exponents: [f64; 3] = [0.15, 0.35, 0.6], Tuned("the blind trial");
        /// The deflection of a spring in series is computed this many times before all parameters are fitted together.
        series_rounds: usize = 4, Tuned("the blind trial");
        /// A fit ends after this many evaluations, multiplied by the number of its parameters plus one.
        patience: usize = 8, Tuned("the blind trial");
    }
}

/// A fit for this purpose ends when a step changes its parameters by less than this fraction, or saves less than this fraction of the
/// squared error. Convention: in a search less than any gain that counts; in turn a third of a deviation of a parameter, as its
/// rows determine it; in the result less than any interval.
const fn enough(purpose: Purpose) -> [f64; 2] {
    match purpose {
        Purpose::Search => [1e-3, 1e-4],
        Purpose::InTurn => [1e-4, 1e-5],
        Purpose::Result => [1e-5, 1e-7],
    }
}

/// A search keeps derivatives until a shape changes by this fraction. Convention: a step of a fit is then wrong by about as much of itself,
/// and the next one makes up for it.
const NEAR: f64 = 0.02;

/// Eq 13 and terms, to be fitted to rows.
pub struct Problem<'r, 'a> {
    rows: &'r Rows<'a>,
    extent: &'r Extent,
    terms: Vec<Term>,
}

impl<'r, 'a> Problem<'r, 'a> {
    /// Eq 13 and `terms` on `rows`; their shapes are searched within `extent`.
    pub fn new(rows: &'r Rows<'a>, extent: &'r Extent, terms: &[Term]) -> Self {
        Self {
            rows,
            extent,
            terms: terms.to_vec(),
        }
    }

    /// The fit without a start.
    pub fn solve(&self) -> Solution {
        let ends: Vec<f64> = self
            .terms
            .iter()
            .flat_map(|term| {
                let shapes = (term.form.shapes)(self.extent);
                let middle = |starts: &[f64]| starts.get(starts.len() / 2).copied();
                let shapes = shapes
                    .iter()
                    .map(|shape| middle(&shape.starts).unwrap_or(shape.low));
                searched(term.form, shapes)
            })
            .collect();
        let starts = ProblemPolicy::in_use().exponents.map(|alpha| {
            let alphas = std::iter::repeat_n(alpha, self.rows.nodes.len());
            alphas.chain(ends.iter().copied()).collect::<Vec<f64>>()
        });
        starts
            .into_par_iter()
            .map(|start| self.minimized(self.basis(), start))
            .min_by(|a, b| a.squares.total_cmp(&b.squares))
            .expect("there is at least one start")
    }

    /// The fit from `start`, a solution with these terms or with all but the last, whose shapes then are `shapes`.
    pub fn solve_from(&self, start: &Solution, shapes: &[f64]) -> Solution {
        self.solve_from_best(start, std::iter::once(shapes))
            .expect("there is one start")
    }

    /// The best of the fits from `start` with each of these shapes of the last term.
    pub fn solve_from_best<'s>(
        &self,
        start: &Solution,
        shapes: impl Iterator<Item = &'s [f64]>,
    ) -> Option<Solution> {
        let fits = shapes.map(|shapes| self.solve_in_rounds(start, shapes));
        let best = fits.min_by(|a, b| a.squares.total_cmp(&b.squares))?;
        Some(match self.gives_way() {
            true => exact::refined(&self.basis(), best),
            false => best,
        })
    }

    /// With a spring in series, whose deflection each round takes from the round before.
    fn solve_in_rounds(&self, start: &Solution, shapes: &[f64]) -> Solution {
        let at = self.start(start, shapes);
        let mut solution = self.minimized(self.basis().around(start), at);
        if self.gives_way() {
            for _ in 1..ProblemPolicy::in_use().series_rounds {
                let at = solution.search.clone();
                solution = self.minimized(self.basis().around(&solution), at);
            }
        }
        solution
    }

    fn gives_way(&self) -> bool {
        self.terms.iter().any(|term| term.form.gives_way)
    }

    /// The fit from `known`, a solution with these terms, possibly with nodes at other amplitudes.
    pub fn solve_near(&self, known: &Solution) -> Solution {
        let distance = |node: &LawNode, amplitude: f64| (node.amplitude - amplitude).abs();
        let alphas = self.rows.nodes.iter().map(|&amplitude| {
            let nearest = known
                .law
                .iter()
                .min_by(|a, b| distance(a, amplitude).total_cmp(&distance(b, amplitude)));
            nearest.map_or(ProblemPolicy::in_use().exponents[1], |node| node.alpha)
        });
        let rest = &known.search[known.law.len()..];
        let start = Solution {
            search: alphas.chain(rest.iter().copied()).collect(),
            ..known.clone()
        };
        self.solve_from(&start, &[])
    }

    /// The linear part alone, at the exponents of `start` and these `shapes` of the last term.
    pub fn solve_at(&self, start: &Solution, shapes: &[f64]) -> Solution {
        let basis = self.basis().around(start);
        let search = Search::new(&basis, DVector::from_vec(self.start(start, shapes)));
        search.solution()
    }

    fn basis(&self) -> Basis<'r, 'a> {
        Basis::new(self.rows, self.extent, &self.terms)
    }

    /// The searched parameters of `start`, and those of the last term if `start` lacks it.
    fn start(&self, start: &Solution, shapes: &[f64]) -> Vec<f64> {
        let fresh = self.terms.len() > start.terms.len();
        let last = self.terms.last().filter(|_| fresh);
        let end = last.map_or(Vec::new(), |term| {
            searched(term.form, shapes.iter().copied())
        });
        start.search.iter().copied().chain(end).collect()
    }

    fn minimized(&self, basis: Basis<'r, 'a>, start: Vec<f64>) -> Solution {
        let search = Search::new(&basis, DVector::from_vec(start));
        let [changed, saved] = enough(self.rows.purpose);
        LevenbergMarquardt::new()
            .with_ftol(saved)
            .with_xtol(changed)
            .with_gtol(0.0)
            .with_patience(ProblemPolicy::in_use().patience)
            .minimize(search)
            .0
            .solution()
    }
}

/// The searched parameters of a form with these shapes: the sizes that scale eq 13, starting from 0, and the shapes.
fn searched(form: Form, shapes: impl Iterator<Item = f64>) -> Vec<f64> {
    let sizes = std::iter::repeat_n(0.0, form.scales());
    sizes.chain(shapes.map(f64::ln)).collect()
}

/// A search over exponents and shapes.
struct Search<'b, 'r, 'a> {
    basis: &'b Basis<'r, 'a>,
    at: DVector<f64>,
    columns: Columns,
    projected: Projected,
    /// Of each searched parameter that has some.
    slopes: RefCell<HashMap<usize, Slopes>>,
}

/// The derivatives of a term's forces with size 1, and where they were computed.
type Slopes = (Vec<f64>, Vec<Vec<f64>>);

/// The linear part, solved.
struct Projected {
    /// k1, k3 and c of every node, then the sizes.
    linear: DVector<f64>,
    /// The weighted residual at every row.
    residuals: DVector<f64>,
    /// `None` if the columns are zero.
    factor: Option<Factor>,
}

impl<'b, 'r, 'a> Search<'b, 'r, 'a> {
    fn new(basis: &'b Basis<'r, 'a>, at: DVector<f64>) -> Self {
        let columns = basis.columns(at.as_slice(), None);
        Self {
            basis,
            at,
            projected: project(basis, &columns),
            columns,
            slopes: RefCell::default(),
        }
    }

    /// The derivative of the force by a searched parameter. In a search of effects, those of terms that moved little since are not computed
    /// again: each takes a run of the term.
    fn slope(&self, slot: usize) -> Vec<f64> {
        let linear = self.projected.linear.as_slice();
        let at = self.at.as_slice();
        let fresh = || self.basis.slope(&self.columns, linear, slot);
        if self.basis.rows.purpose != Purpose::Search {
            return fresh();
        }
        let mut known = self.slopes.borrow_mut();
        let is_near = |(there, _): &&Slopes| self.basis.is_near(slot, [at, there.as_slice()], NEAR);
        if let Some((_, units)) = known.get(&slot).filter(is_near) {
            return self.basis.slope_of(units, linear, slot);
        }
        let Some(units) = self.basis.unit_slopes(&self.columns, slot) else {
            return fresh();
        };
        let slope = self.basis.slope_of(&units, linear, slot);
        known.insert(slot, (at.to_vec(), units));
        slope
    }

    fn solution(&self) -> Solution {
        let linear = self.projected.linear.as_slice();
        let squares = self.projected.residuals.norm_squared();
        self.basis.solution(self.at.as_slice(), linear, squares)
    }
}

fn project(basis: &Basis, columns: &Columns) -> Projected {
    let rows = basis.rows;
    let nodes = rows.nodes.len();
    let added = columns.added();
    let normal = Normal::assemble(
        rows,
        &basis.to_explain(columns),
        &basis.motion(columns).node,
        columns.law(),
        &added,
    );
    let solved = normal.solve(|i| match i.checked_sub(3 * nodes) {
        None => i % 3 == 2,
        Some(size) => basis.is_positive(size),
    });
    let (linear, factor) = match solved {
        Some((linear, factor)) => (linear, Some(factor)),
        None => (DVector::zeros(3 * nodes + added.len()), None),
    };
    let force = basis.force(columns, linear.as_slice());
    let residuals = (0..rows.len()).map(|i| rows.weight[i] * (force[i] - rows.force[i]));
    Projected {
        residuals: DVector::from_iterator(rows.len(), residuals),
        linear,
        factor,
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Search<'_, '_, '_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, at: &DVector<f64>) {
        self.columns = self.basis.columns(at.as_slice(), Some(&self.columns));
        self.projected = project(self.basis, &self.columns);
        self.at.copy_from(at);
    }

    fn params(&self) -> DVector<f64> {
        self.at.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.projected.residuals.clone())
    }

    /// The derivatives of the force with the linear part held, minus the components that the linear part would absorb (Kaufman
    /// 1975).
    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let rows = self.basis.rows;
        let linear = self.projected.linear.as_slice();
        let factor = self.projected.factor.as_ref()?;
        let node = &self.basis.motion(&self.columns).node;
        let (law, added) = (self.columns.law(), self.columns.added());
        let first_size = 3 * rows.nodes.len();
        let mut jacobian = DMatrix::zeros(rows.len(), self.at.len());
        for (slot, mut column) in jacobian.column_iter_mut().enumerate() {
            let slope = self.slope(slot);
            let mut products = vec![0.0; linear.len()];
            for (index, slope) in slope.iter().enumerate() {
                let weighted = rows.weight[index].powi(2) * slope;
                for (i, own) in law[index].iter().enumerate() {
                    products[3 * node[index] + i] += weighted * own;
                }
                for (i, own) in added.iter().enumerate() {
                    products[first_size + i] += weighted * own[index];
                }
            }
            let taken = self.basis.force(&self.columns, &factor.nearest(&products));
            for (index, value) in column.iter_mut().enumerate() {
                *value = rows.weight[index] * (slope[index] - taken[index]);
            }
        }
        Some(jacobian)
    }
}
