//! The fit of a law with a spring in series, with all parameters at once and with the crate's computation.
//!
//! While the spring's deflection is held fixed, all other parameters are fitted as if they did not change it. The result of that
//! fit is near the solution, but its derivatives are not those of the force. Here every derivative is a central difference of the
//! crate's force. A change of one node's coefficients affects only the rows of that node, except for a short time after a change of
//! amplitude, so one pair of runs serves all nodes.

use mesh_damper_model::predict::predict_in_half_steps;
use nalgebra::DVector;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

use super::basis::Basis;
use super::normal::Normal;
use super::solution::Solution;
use super::tangent::Tangent;

/// Coefficients of eq 13 at a node.
const LOCAL: usize = 4;
mesh_damper_recording::numbers! {
    /// The last steps of a fit, with the force as the crate computes it.
    ExactPolicy {
        /// In the last steps of a fit, the derivatives are computed at most this many times.
        tangents: usize = 2, Tuned("the blind trial");
        /// In the last steps of a fit, at most this many steps are made with the same derivatives.
        steps: usize = 3, Tuned("the blind trial");
        /// In the last steps of a fit, a step that does not reduce the error is halved at most this many times.
        halvings: usize = 3, Tuned("the blind trial");
        /// The last steps of a fit end when a step saves less than this fraction of the squared error.
        settled: f64 = 1e-4, Tuned("the blind trial");
    }
}

/// For a derivative by an exponent or a searched parameter (a logarithm, or a change of a force), the parameter is changed by this.
/// Convention: above rounding, below the curvature of the force.
const PARAMETER_STEP: f64 = 1e-3;

/// For a derivative by a linear coefficient, the coefficient is changed so that the force changes by this fraction of its RMS.
/// Convention: above rounding, below the curvature of the force.
const FORCE_CHANGE: f64 = 1e-3;

/// `solution` with all its parameters moved to the smallest error of the crate's force (Gauss–Newton); unchanged if the crate
/// refuses it.
pub(super) fn refined(basis: &Basis, solution: Solution) -> Solution {
    let Some(mut force) = force(basis, &solution) else {
        return solution;
    };
    let mut best = Solution {
        squares: squares(basis, &force),
        ..solution
    };
    for _ in 0..ExactPolicy::in_use().tangents {
        let Some(tangent) = tangent(basis, &best) else {
            return best;
        };
        let before = best.squares;
        for _ in 0..ExactPolicy::in_use().steps {
            let Some((tried, its_force)) = stepped(basis, &tangent, &best, &force) else {
                break;
            };
            let saved = best.squares - tried.squares;
            (best, force) = (tried, its_force);
            if saved < ExactPolicy::in_use().settled * best.squares {
                break;
            }
        }
        if before - best.squares < ExactPolicy::in_use().settled * best.squares {
            break;
        }
    }
    best
}

/// The crate's force in kN at every row; `None` if the crate refuses the law.
pub(super) fn force(basis: &Basis, solution: &Solution) -> Option<Vec<f64>> {
    let rows = basis.rows;
    let forces = solution.predicted_along(rows.trajectories, &rows.strides);
    Some(rows.pick(&forces.ok()?))
}

/// The error of that `force`, in kN, due to the length of the recording's steps: four thirds of the change with half the step,
/// because the error of a spring's deflection is proportional to the square of the step, as is what a turn exceeds the sample beside it by.
/// `None` as above.
pub(super) fn error_of_steps(
    basis: &Basis,
    solution: &Solution,
    force: &[f64],
) -> Option<Vec<f64>> {
    let model = solution.model();
    let trajectories = basis.rows.trajectories.iter();
    let halved = trajectories.map(|trajectory| predict_in_half_steps(&model, trajectory));
    let halved: Vec<Vec<f64>> = halved.collect::<Result<_, _>>().ok()?;
    let halved = basis.rows.pick(&halved);
    let both = force.iter().zip(&halved);
    let errors = both.map(|(force, halved)| (force - halved) * (4.0 / 3.0));
    Some(errors.collect())
}

/// The derivatives of that force; `None` as above.
pub(super) fn tangent(basis: &Basis, solution: &Solution) -> Option<Tangent> {
    let rows = basis.rows;
    let around = Basis::around(basis.clone(), solution);
    let columns = around.columns(&solution.search, None);
    let node = around.motion(&columns).node.clone();
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        (values.map(|value| value * value).sum::<f64>() / rows.len() as f64).sqrt()
    };
    let change = FORCE_CHANGE * rms(&mut rows.force.iter().copied());
    let over = |unit: f64| if unit > 0.0 { change / unit } else { 0.0 };
    let added = columns.added();
    let mut sizes = added.iter();
    let local: Vec<f64> = (0..3)
        .map(|slot| over(rms(&mut columns.law().iter().map(|row| row[slot]))))
        .chain([PARAMETER_STEP])
        .collect();
    let shared: Vec<f64> = (0..basis.terms.len())
        .flat_map(|term| {
            let of_sizes: Vec<f64> = sizes
                .by_ref()
                .take(added_by(basis, term))
                .map(|column| over(rms(&mut column.iter().copied())))
                .collect();
            let searched = basis.slot(term).map(|_| PARAMETER_STEP);
            of_sizes.into_iter().chain(searched).collect::<Vec<_>>()
        })
        .collect();

    let at = parameters(basis, solution);
    let nodes = rows.nodes.len();
    let difference = |places: Vec<usize>, step: f64| -> Option<Vec<f64>> {
        let beside = |step: f64| {
            let mut moved = at.clone();
            places.iter().for_each(|&place| moved[place] += step);
            let solution = at_parameters(basis, &moved);
            Some((parameters(basis, &solution), force(basis, &solution)?))
        };
        let ((ahead, above), (behind, below)) = (beside(step)?, beside(-step)?);
        // A parameter held at the end of its range has moved by less than a step.
        let slopes = (0..rows.len()).map(|index| {
            let place = places[node[index] % places.len()];
            let by = ahead[place] - behind[place];
            if by > 0.0 {
                (above[index] - below[index]) / by
            } else {
                0.0
            }
        });
        Some(slopes.collect())
    };
    let mut columns: Vec<Vec<f64>> = (0..LOCAL + shared.len())
        .into_par_iter()
        .map(|column| match column.checked_sub(LOCAL) {
            None => {
                let places = (0..nodes).map(|node| LOCAL * node + column);
                difference(places.collect(), local[column])
            }
            Some(place) => difference(vec![LOCAL * nodes + place], shared[place]),
        })
        .collect::<Option<_>>()?;
    let shared = columns.split_off(LOCAL);
    Some(Tangent {
        local: (0..rows.len())
            .map(|index| std::array::from_fn(|slot| columns[slot][index]))
            .collect(),
        shared,
        node,
    })
}

/// The best of a Gauss–Newton step and its halves, with its force, if it reduces the error.
fn stepped(
    basis: &Basis,
    tangent: &Tangent,
    from: &Solution,
    force: &[f64],
) -> Option<(Solution, Vec<f64>)> {
    let rows = basis.rows;
    let missing: Vec<f64> = rows.force.iter().zip(force).map(|(a, b)| a - b).collect();
    let shared: Vec<&[f64]> = tangent.shared.iter().map(Vec::as_slice).collect();
    let normal = Normal::assemble(rows, &missing, &tangent.node, &tangent.local, &shared);
    let (step, _) = normal.solve(|_| false)?;
    let at = DVector::from_vec(parameters(basis, from));
    (0..=ExactPolicy::in_use().halvings).find_map(|halving| {
        let tried = &at + &step * 0.5_f64.powi(halving as i32);
        let mut tried = at_parameters(basis, tried.as_slice());
        let force = self::force(basis, &tried)?;
        tried.squares = squares(basis, &force);
        (tried.squares < from.squares).then_some((tried, force))
    })
}

/// Sum of the squared weighted errors, kN².
fn squares(basis: &Basis, force: &[f64]) -> f64 {
    let rows = basis.rows;
    (0..rows.len())
        .map(|index| (rows.weight[index] * (force[index] - rows.force[index])).powi(2))
        .sum()
}

/// The number of sizes that a term has among the linear unknowns.
fn added_by(basis: &Basis, term: usize) -> usize {
    basis.terms[term].fitted_sizes()
}

/// All parameters in the order of a [`Tangent`]: k1, k3, c and α of every node, then the sizes and searched parameters of each
/// term.
fn parameters(basis: &Basis, solution: &Solution) -> Vec<f64> {
    let law = solution.law.iter();
    let law = law.flat_map(|node| [node.k1, node.k3, node.c, node.alpha]);
    let terms = solution.terms.iter().enumerate().flat_map(|(term, value)| {
        let sizes = value.sizes.iter().take(added_by(basis, term));
        sizes.chain(&solution.search[basis.slot(term)])
    });
    law.chain(terms.copied()).collect()
}

/// The solution for `parameters`, each limited to its range.
fn at_parameters(basis: &Basis, parameters: &[f64]) -> Solution {
    let nodes = basis.rows.nodes.len();
    let (law, terms) = parameters.split_at(LOCAL * nodes);
    let mut linear = Vec::new();
    let mut search = Vec::new();
    for node in law.chunks(LOCAL) {
        linear.extend([node[0], node[1], node[2].max(0.0)]);
        search.push(node[3].clamp(0.0, 1.0));
    }
    let mut rest = terms.iter().copied();
    for term in 0..basis.terms.len() {
        for size in rest.by_ref().take(added_by(basis, term)) {
            let positive = basis.is_positive(linear.len() - 3 * nodes);
            linear.push(if positive { size.max(0.0) } else { size });
        }
        search.extend(rest.by_ref().take(basis.slot(term).len()));
    }
    basis.solution(&search, &linear, f64::NAN)
}
