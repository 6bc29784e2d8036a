//! The fit of eq 13 and added effects by variable projection.
//!
//! For given exponents and shapes the force is linear in everything else: k1, k3 and c at each amplitude, and the
//! effects' sizes. So only exponents and shapes are searched (Levenberg–Marquardt), and every step of the search solves
//! the linear rest exactly (Golub and Pereyra 1973).

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Owned};

use super::rows::Rows;
use super::solution::Solution;
use super::term::{Shape, Term, TermValue};
use crate::model::{Family, LawNode};

/// Added to the diagonal of the scaled normal equations, so that a direction that the data do not show stays small.
const RIDGE: f64 = 1e-11;

/// A law and added terms, to be fitted to rows.
pub struct Problem<'r, 'a> {
    rows: &'r Rows<'a>,
    terms: Vec<Term>,
    shapes: Vec<Option<Shape>>,
    parameters: DVector<f64>,
    state: State,
}

/// What belongs to one set of searched parameters.
#[derive(Clone)]
struct State {
    residuals: DVector<f64>,
    linear: DVector<f64>,
}

impl<'r, 'a> Problem<'r, 'a> {
    /// Fits eq 13 and `terms` to `rows`.
    ///
    /// `start` is a solution without the last term, whose exponents and shapes the search starts from; the last term's
    /// shape starts from the best of its starting values.
    pub fn solve(rows: &'r Rows<'a>, terms: &[Term], start: Option<&Solution>) -> Solution {
        let shapes: Vec<Option<Shape>> = terms
            .iter()
            .map(|term| term.shape(rows.trajectories))
            .collect();
        let nodes = rows.nodes.len();
        let starts: Vec<DVector<f64>> = match start {
            None => [0.15, 0.35, 0.6]
                .iter()
                .map(|&alpha| {
                    let searched = terms
                        .iter()
                        .zip(&shapes)
                        .filter(|(term, _)| term.is_searched());
                    let first = std::iter::repeat_n(alpha, nodes);
                    DVector::from_vec(
                        first
                            .chain(searched.map(|(_, shape)| middle(shape)))
                            .collect(),
                    )
                })
                .collect(),
            Some(solution) => {
                // A term that `solution` lacks, if any, is the last.
                let fresh = shapes.get(solution.terms.len()).and_then(Option::as_ref);
                let ends: Vec<Option<f64>> = match fresh {
                    Some(shape) => shape.starts.iter().map(|x| Some(x.ln())).collect(),
                    None => vec![
                        terms
                            .get(solution.terms.len())
                            .filter(|t| t.is_searched())
                            .map(|_| 0.0),
                    ],
                };
                ends.into_iter()
                    .map(|end| {
                        DVector::from_vec(solution.search.iter().copied().chain(end).collect())
                    })
                    .collect()
            }
        };
        let problem = Self {
            rows,
            terms: terms.to_vec(),
            shapes,
            parameters: starts[0].clone(),
            state: State {
                residuals: DVector::zeros(0),
                linear: DVector::zeros(0),
            },
        };
        let mut rated: Vec<(f64, DVector<f64>)> = starts
            .into_iter()
            .map(|start| (problem.evaluate(&start).residuals.norm_squared(), start))
            .collect();
        rated.sort_by(|a, b| a.0.total_cmp(&b.0));
        // The two best starts: the best of a coarse grid may lead to the lesser of two minima.
        let solutions: Vec<Self> = rated
            .into_iter()
            .take(2)
            .map(|(_, start)| problem.search_from(start))
            .collect();
        solutions
            .iter()
            .min_by(|a, b| {
                let rate = |p: &Self| p.state.residuals.norm_squared();
                rate(a).total_cmp(&rate(b))
            })
            .map(Self::solution)
            .expect("there is at least one start")
    }

    fn search_from(&self, start: DVector<f64>) -> Self {
        let mut problem = Self {
            rows: self.rows,
            terms: self.terms.clone(),
            shapes: self.shapes.clone(),
            parameters: start,
            state: self.state.clone(),
        };
        problem.state = problem.evaluate(&problem.parameters);
        LevenbergMarquardt::new()
            .with_ftol(1e-9)
            .with_xtol(1e-7)
            .with_gtol(0.0)
            .with_patience(10)
            .minimize(problem)
            .0
    }

    /// Solves the linear part for the searched parameters `at`.
    fn evaluate(&self, at: &DVector<f64>) -> State {
        let rows = self.rows;
        let nodes = rows.nodes.len();
        let effects = self.effect_columns(at);
        let added = effects.len();
        let width = 3 * nodes + added;
        let law_columns = self.law_columns(at);

        let mut gram = DMatrix::<f64>::zeros(width, width);
        let mut right = DVector::<f64>::zeros(width);
        let mut row = vec![0.0; 3 + added];
        for (index, law) in law_columns.iter().enumerate() {
            let weight = rows.weight[index];
            for (slot, value) in row[..3].iter_mut().zip(law) {
                *slot = weight * value;
            }
            for (slot, column) in row[3..].iter_mut().zip(&effects) {
                *slot = weight * column[index];
            }
            let place = |i: usize| {
                if i < 3 {
                    3 * rows.node[index] + i
                } else {
                    3 * nodes + i - 3
                }
            };
            for i in 0..row.len() {
                let to = place(i);
                right[to] += row[i] * weight * rows.force[index];
                for j in 0..=i {
                    gram[(to, place(j))] += row[i] * row[j];
                }
            }
        }
        let linear = solve_normal(gram, &right, |i| i < 3 * nodes && i % 3 == 2);
        let residuals = DVector::from_iterator(
            rows.len(),
            law_columns.iter().enumerate().map(|(index, law)| {
                let node = 3 * rows.node[index];
                let mut force = 0.0;
                for (i, column) in law.iter().enumerate() {
                    force += linear[node + i] * column;
                }
                for (i, column) in effects.iter().enumerate() {
                    force += linear[3 * nodes + i] * column[index];
                }
                rows.weight[index] * (force - rows.force[index])
            }),
        );
        State { residuals, linear }
    }

    /// y, y³ and |v|^α·sgn v at every row, scaled by temperature where that is a term.
    fn law_columns(&self, at: &DVector<f64>) -> Vec<[f64; 3]> {
        let rows = self.rows;
        let scale = self
            .terms
            .iter()
            .position(|term| term.family == Family::Temperature)
            .and_then(|index| Some((at[self.slot(index)?], self.terms[index].reference)));
        (0..rows.len())
            .map(|index| {
                let alpha = at[rows.node[index]].clamp(0.0, 1.0);
                let factor = scale.map_or(1.0, |(beta, reference)| {
                    1.0 - beta * (rows.temperature[index] - reference)
                });
                rows.law_row(index, alpha, factor)
            })
            .collect()
    }

    /// The forces of the terms with size 1, at every row; temperature, which scales the law, has none.
    fn effect_columns(&self, at: &DVector<f64>) -> Vec<Vec<f64>> {
        self.terms
            .iter()
            .enumerate()
            .filter(|(_, term)| term.size_name().is_some())
            .map(|(index, term)| self.rows.unit_force(term, self.shape_value(index, at)))
            .collect()
    }

    /// Where the searched parameter of `term` stands among the parameters, if it has one.
    fn slot(&self, term: usize) -> Option<usize> {
        let before = self.terms[..term]
            .iter()
            .filter(|term| term.is_searched())
            .count();
        self.terms[term]
            .is_searched()
            .then_some(self.rows.nodes.len() + before)
    }

    /// The shape of `term`; 0 where it has none.
    fn shape_value(&self, term: usize, at: &DVector<f64>) -> f64 {
        match (&self.shapes[term], self.slot(term)) {
            (Some(shape), Some(slot)) => at[slot].exp().clamp(shape.low, shape.high),
            _ => 0.0,
        }
    }

    fn solution(&self) -> Solution {
        let nodes = self.rows.nodes.len();
        let linear = &self.state.linear;
        let law = (0..nodes)
            .map(|node| LawNode {
                amplitude: self.rows.nodes[node],
                k1: linear[3 * node],
                k3: linear[3 * node + 1],
                c: linear[3 * node + 2],
                alpha: self.parameters[node].clamp(0.0, 1.0),
            })
            .collect();
        let mut sizes = linear.iter().skip(3 * nodes);
        let terms = self
            .terms
            .iter()
            .enumerate()
            .map(|(index, &term)| {
                let size = match (term.size_name(), self.slot(index)) {
                    (None, Some(slot)) => self.parameters[slot],
                    _ => sizes.next().copied().unwrap_or(0.0),
                };
                TermValue {
                    term,
                    size,
                    shape: self.shape_value(index, &self.parameters),
                }
            })
            .collect();
        Solution {
            law,
            terms,
            search: self.parameters.iter().copied().collect(),
        }
    }
}

/// Where a searched parameter starts when nothing better is known: the middle of a shape's starts, β = 0.
fn middle(shape: &Option<Shape>) -> f64 {
    shape
        .as_ref()
        .map_or(0.0, |shape| shape.starts[shape.starts.len() / 2].ln())
}

/// Solves the normal equations, of which the lower triangle is given, with the unknowns that `not_negative` picks at 0
/// where they would be negative.
fn solve_normal(
    gram: DMatrix<f64>,
    right: &DVector<f64>,
    not_negative: impl Fn(usize) -> bool,
) -> DVector<f64> {
    let width = right.len();
    let scale: Vec<f64> = (0..width)
        .map(|i| {
            let norm = gram[(i, i)].sqrt();
            if norm > 0.0 { 1.0 / norm } else { 0.0 }
        })
        .collect();
    let mut active: Vec<usize> = (0..width).filter(|&i| scale[i] > 0.0).collect();
    loop {
        let count = active.len();
        let matrix = DMatrix::from_fn(count, count, |i, j| {
            let (a, b) = (active[i].max(active[j]), active[i].min(active[j]));
            gram[(a, b)] * scale[a] * scale[b] + if i == j { RIDGE } else { 0.0 }
        });
        let scaled = DVector::from_fn(count, |i, _| right[active[i]] * scale[active[i]]);
        let Some(factor) = Cholesky::new(matrix) else {
            return DVector::zeros(width);
        };
        let found = factor.solve(&scaled);
        let negative = (0..count).find(|&i| not_negative(active[i]) && found[i] < 0.0);
        match negative {
            Some(i) => {
                active.remove(i);
            }
            None => {
                let mut solution = DVector::zeros(width);
                for (i, &unknown) in active.iter().enumerate() {
                    solution[unknown] = found[i] * scale[unknown];
                }
                return solution;
            }
        }
    }
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Problem<'_, '_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, at: &DVector<f64>) {
        self.state = self.evaluate(at);
        self.parameters.copy_from(at);
    }

    fn params(&self) -> DVector<f64> {
        self.parameters.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.state.residuals.clone())
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(self.rows.len(), self.parameters.len());
        for index in 0..self.parameters.len() {
            let step = 1e-5;
            let mut ahead = self.parameters.clone();
            // Inwards at the end of an exponent's range, where the clamp would hide the slope.
            let signed = if index < self.rows.nodes.len() && ahead[index] + step > 1.0 {
                -step
            } else {
                step
            };
            ahead[index] += signed;
            let moved = self.evaluate(&ahead).residuals;
            jacobian.set_column(index, &((moved - &self.state.residuals) / signed));
        }
        Some(jacobian)
    }
}
