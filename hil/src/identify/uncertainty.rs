//! How well the data determine each coefficient of a fit.

use nalgebra::{Cholesky, DMatrix};

use super::rows::Rows;
use super::solution::Solution;
use super::term::Term;
use crate::model::Family;

/// A normal variable is within this many deviations of its mean in 90 % of the cases.
const NINETY_PERCENT: f64 = 1.645;
/// Longest lag, in samples, over which residuals are taken as correlated.
const LONGEST_LAG: usize = 200;

/// Half widths of the 90 % intervals, in the units of what they belong to.
#[derive(Clone, Debug)]
pub struct Uncertainty {
    /// k1, k3, c and α of each node.
    pub law: Vec<[f64; 4]>,
    /// Size of each term, and the factor (≥ 1) by which its shape is uncertain either way.
    pub terms: Vec<(f64, f64)>,
}

impl Uncertainty {
    /// The intervals of `solution`, which was fitted to `rows`: s²·(JᵀJ)⁻¹, the residual variance s² raised by the
    /// residuals' integrated autocorrelation, because neighbouring samples do not err independently.
    pub fn of(rows: &Rows, solution: &Solution) -> Self {
        let nodes = solution.law.len();
        let columns = term_columns(rows, solution);
        let width = 4 * nodes + columns.len();
        let mut gram = DMatrix::<f64>::zeros(width, width);
        let mut row = vec![(0, 0.0); 4 + columns.len()];
        for index in 0..rows.len() {
            let node = rows.node[index];
            let coefficients = &solution.law[node];
            let [y, y3, damping] =
                rows.law_row(index, coefficients.alpha, solution.scale(rows, index));
            let slope = coefficients.c * damping * rows.log_speed[index];
            for (slot, value) in [y, y3, damping, slope].into_iter().enumerate() {
                row[slot] = (4 * node + slot, value);
            }
            for (slot, column) in columns.iter().enumerate() {
                row[4 + slot] = (4 * nodes + slot, column[index]);
            }
            let weight = rows.weight[index].powi(2);
            for &(i, a) in &row {
                for &(j, b) in &row {
                    gram[(i, j)] += weight * a * b;
                }
            }
        }
        let residuals = rows.residuals(solution);
        let freedom = (rows.len().saturating_sub(width)).max(1) as f64;
        let variance = residuals.iter().map(|r| r * r).sum::<f64>() / freedom
            * autocorrelation_time(&residuals);
        let deviation = deviations(&gram, variance);

        let law = (0..nodes)
            .map(|node| std::array::from_fn(|slot| NINETY_PERCENT * deviation[4 * node + slot]))
            .collect();
        let mut rest = deviation[4 * nodes..].iter().map(|d| NINETY_PERCENT * d);
        let terms = solution
            .terms
            .iter()
            .map(|value| {
                let size = rest.next().unwrap_or(f64::INFINITY);
                let shape = value
                    .term
                    .shape_name()
                    .and_then(|_| rest.next())
                    .unwrap_or(0.0);
                (size, shape.exp())
            })
            .collect();
        Self { law, terms }
    }
}

/// The derivatives of the force by each term's size, and by the logarithm of its shape.
fn term_columns(rows: &Rows, solution: &Solution) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for value in &solution.terms {
        let Term { family, reference } = value.term;
        if family == Family::Temperature {
            columns.push(
                (0..rows.len())
                    .map(|index| {
                        let node = &solution.law[rows.node[index]];
                        let [y, y3, damping] = rows.law_row(index, node.alpha, 1.0);
                        (reference - rows.temperature[index])
                            * (node.k1 * y + node.k3 * y3 + node.c * damping)
                    })
                    .collect(),
            );
            continue;
        }
        let unit = rows.unit_force(&value.term, value.shape);
        if value.term.shape_name().is_some() {
            let step = 1e-3_f64;
            let ahead = rows.unit_force(&value.term, value.shape * step.exp());
            let behind = rows.unit_force(&value.term, value.shape * (-step).exp());
            let slope = ahead
                .iter()
                .zip(&behind)
                .map(|(a, b)| value.size * (a - b) / (2.0 * step))
                .collect();
            columns.push(unit);
            columns.push(slope);
        } else {
            columns.push(unit);
        }
    }
    columns
}

/// Square roots of the diagonal of `variance`·`gram`⁻¹; infinite for what the data say nothing of.
fn deviations(gram: &DMatrix<f64>, variance: f64) -> Vec<f64> {
    let mut deviations = vec![f64::INFINITY; gram.nrows()];
    let seen: Vec<usize> = (0..gram.nrows()).filter(|&i| gram[(i, i)] > 0.0).collect();
    let scale = |i: usize| gram[(seen[i], seen[i])].sqrt();
    let scaled = DMatrix::from_fn(seen.len(), seen.len(), |i, j| {
        gram[(seen[i], seen[j])] / (scale(i) * scale(j))
    });
    if let Some(factor) = Cholesky::new(scaled) {
        let inverse = factor.inverse();
        for (i, &place) in seen.iter().enumerate() {
            deviations[place] = (variance * inverse[(i, i)]).sqrt() / scale(i);
        }
    }
    deviations
}

/// 1 + 2·Σ ρ(lag) up to the first lag without correlation: how many samples count as one.
fn autocorrelation_time(residuals: &[f64]) -> f64 {
    let power: f64 = residuals.iter().map(|r| r * r).sum();
    if power == 0.0 {
        return 1.0;
    }
    let correlation = |lag: usize| -> f64 {
        residuals
            .iter()
            .zip(&residuals[lag..])
            .map(|(a, b)| a * b)
            .sum::<f64>()
            / power
    };
    (1..LONGEST_LAG.min(residuals.len()))
        .map(correlation)
        .take_while(|&rho| rho > 0.02)
        .fold(1.0, |total, rho| total + 2.0 * rho)
}
