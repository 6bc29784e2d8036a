//! How well the data determine each coefficient of a fit.

use mesh_damper_model::predict::NINETY_PERCENT;
use nalgebra::{Cholesky, DMatrix, DVector};

use super::basis::Basis;
use super::exact;
use super::rows::{Purpose, Rows};
use super::shape::Extent;
use super::solution::Solution;
use super::tangent::Tangent;
use super::term::{Term, TermValue};

mesh_damper_recording::numbers! {
    /// The intervals of fitted parameters.
    UncertaintyPolicy {
        /// A fit reduces the residual of each sample, most where a sample determines a parameter almost alone. For the intervals, a
        /// residual is assumed to keep at least this fraction of its error.
        least_kept: f64 = 0.1, Tuned("hil/trials/tests/trials/intervals.rs");
        /// Residuals are taken as correlated up to the first lag with a correlation of at most this.
        uncorrelated: f64 = 0.02, Tuned("hil/trials/tests/trials/intervals.rs");
        /// A parameter has no bound if its interval extends by more than this factor to either side.
        bounded: f64 = 10.0, Convention("within a decade to either side not even the order of magnitude is known");
    }
}

/// Residuals are taken as correlated over a lag of at most this many samples. Convention: a cycle of 5 Hz at 1 kHz.
const LONGEST_LAG: usize = 200;

/// Half widths of the 90 % intervals, in the units of the parameters.
#[derive(Clone, Debug)]
pub struct Uncertainty {
    /// k1, k3, c and α of each node.
    pub law: Vec<[f64; 4]>,
    /// For each term.
    pub terms: Vec<TermUncertainty>,
}

/// Half widths of the 90 % intervals of one term.
#[derive(Clone, Debug, PartialEq)]
pub struct TermUncertainty {
    /// For each size.
    pub sizes: Vec<f64>,
    /// The factor (≥ 1) of each shape's uncertainty in either direction.
    pub shapes: Vec<f64>,
}

impl TermUncertainty {
    /// Whether every size is finite and every shape is known to a factor of [`UncertaintyPolicy::bounded`].
    pub fn is_bounded(&self) -> bool {
        let shapes = self.shapes.iter();
        self.sizes.iter().all(|half| half.is_finite())
            && shapes
                .into_iter()
                .all(|&factor| factor <= UncertaintyPolicy::in_use().bounded)
    }

    /// The elements of `value` as [`TermValue::elements`] gives them, each parameter with its smallest and its largest value.
    pub fn elements(&self, value: &TermValue) -> Vec<Vec<(&'static str, Interval)>> {
        let elements = value.elements();
        let [low, high] = [-1.0, 1.0].map(|end| self.shifted(value, end));
        elements
            .into_iter()
            .map(|(size, parameters)| {
                let bounds = low[size].iter().zip(&high[size]);
                parameters
                    .into_iter()
                    .zip(bounds)
                    .map(|((name, value), (&a, &b))| {
                        let interval = Interval {
                            value,
                            low: a.min(b),
                            high: a.max(b),
                        };
                        (name, interval)
                    })
                    .collect()
            })
            .collect()
    }

    /// The parameters of each size's element at one end of their intervals.
    fn shifted(&self, value: &TermValue, end: f64) -> Vec<Vec<f64>> {
        let shapes = value.shapes.iter().zip(&self.shapes);
        let shapes: Vec<f64> = shapes
            .map(|(shape, factor)| shape * factor.powf(end))
            .collect();
        if let (true, [a, b], [of_a, of_b]) = (
            value.term.form.follows_clock,
            &value.sizes[..],
            &self.sizes[..],
        ) {
            // For √(a² + b²) and its angle, from the independent errors of a and b.
            let size = a.hypot(*b).max(f64::MIN_POSITIVE);
            let amplitude = size + end * (a * of_a).hypot(b * of_b) / size;
            let phase = b.atan2(*a) + end * (b * of_a).hypot(a * of_b) / (size * size);
            return vec![vec![amplitude, shapes[0], phase]];
        }
        let sizes = value.sizes.iter().zip(&self.sizes);
        let at_end = TermValue {
            term: value.term,
            // Above 0, so that no element is lost.
            sizes: sizes
                .map(|(size, half)| match value.term.form.elements_may_miss {
                    true => (size + end * half).max(f64::MIN_POSITIVE),
                    false => size + end * half,
                })
                .collect(),
            shapes,
        };
        at_end
            .elements()
            .into_iter()
            .map(|(_, parameters)| parameters.into_iter().map(|(_, value)| value).collect())
            .collect()
    }
}

impl Uncertainty {
    /// Widens the intervals of `solution` by its difference from `moved`: the same terms fitted along a motion that is off by one
    /// draw of its error. The residuals show the random part of that error, not its bias.
    pub fn widen(&mut self, solution: &Solution, moved: &Solution) {
        for ((halves, node), other) in self.law.iter_mut().zip(&solution.law).zip(&moved.law) {
            let differs = [
                node.k1 - other.k1,
                node.k3 - other.k3,
                node.c - other.c,
                node.alpha - other.alpha,
            ];
            for (half, differs) in halves.iter_mut().zip(differs) {
                *half = half.hypot(differs);
            }
        }
        let terms = self.terms.iter_mut().zip(&solution.terms);
        for ((uncertainty, term), other) in terms.zip(&moved.terms) {
            let sizes = term.sizes.iter().zip(&other.sizes);
            for (half, (size, other)) in uncertainty.sizes.iter_mut().zip(sizes) {
                *half = half.hypot(size - other);
            }
            let shapes = term.shapes.iter().zip(&other.shapes);
            for (factor, (shape, other)) in uncertainty.shapes.iter_mut().zip(shapes) {
                *factor = factor.ln().hypot((shape / other).ln()).exp();
            }
        }
    }
}

/// A parameter and its 90 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The fitted value.
    pub value: f64,
    /// Smallest.
    pub low: f64,
    /// Largest.
    pub high: f64,
}

impl Uncertainty {
    /// The intervals of `solution`, which was fitted to `rows`.
    ///
    /// With H = (JᵀJ)⁻¹ their variances are on the diagonal of H·(Σ jᵢjᵢᵀ·(rᵢ/(1 − hᵢ))²)·H, hᵢ = jᵢᵀHjᵢ (HC3, MacKinnon and White
    /// 1985). Where the force is steepest, at reversals, an error of the motion makes the residuals large. There the data are less
    /// precise than a common residual variance would suggest. The variances are raised by the residuals' integrated
    /// autocorrelation, because errors of neighbouring samples are not independent. The force has an error e from the length of the
    /// recording's steps, such as that of a slider whose motion turns between two samples: |H·Σ jᵢeᵢ| is added to 1.645 deviations.
    pub fn of(rows: &Rows, extent: &Extent, solution: &Solution) -> Self {
        let basis = Basis::new(rows, extent, &solution.terms()).around(solution);
        let columns = basis.columns(&solution.search, None);
        let as_run = exact::force(&basis, solution);
        let as_run = as_run.and_then(|force| {
            let of_steps = match rows.purpose {
                Purpose::Result => exact::error_of_steps(&basis, solution, &force)?,
                // The intervals of folds are compared with each other, and this error is nearly the same in all.
                _ => vec![0.0; rows.len()],
            };
            Some((force, of_steps))
        });
        // Behind a spring in series, whose deflection they change, the derivatives are those of the force as it is run.
        let in_series = |term: &Term| term.form.gives_way;
        let is_exact = as_run.is_some() && basis.terms.iter().any(in_series);
        let exact = is_exact.then(|| exact::tangent(&basis, solution)).flatten();
        let is_exact = exact.is_some();
        let tangent = exact.unwrap_or_else(|| Tangent::of(&basis, &columns, solution));
        let (force, of_steps) = match as_run {
            Some(as_run) if is_exact => as_run,
            as_run => {
                let of_steps = as_run.map_or_else(|| vec![0.0; rows.len()], |(_, steps)| steps);
                (basis.force(&columns, &solution.linear()), of_steps)
            }
        };
        let nodes = solution.law.len();
        let width = 4 * nodes + tangent.shared.len();
        let fill = |index: usize, row: &mut [(usize, f64)]| {
            let weight = rows.weight[index];
            for (slot, &value) in tangent.local[index].iter().enumerate() {
                row[slot] = (4 * tangent.node[index] + slot, weight * value);
            }
            for (slot, column) in tangent.shared.iter().enumerate() {
                row[4 + slot] = (4 * nodes + slot, weight * column[index]);
            }
        };
        let mut row = vec![(0, 0.0); 4 + tangent.shared.len()];
        let mut gram = DMatrix::<f64>::zeros(width, width);
        let mut pull = DVector::<f64>::zeros(width);
        for (index, error) in of_steps.iter().enumerate() {
            fill(index, &mut row);
            add_square(&mut gram, &row, 1.0);
            for &(place, value) in &row {
                pull[place] += value * rows.weight[index] * error;
            }
        }
        let inverse = inverse(&gram);
        let offsets = &inverse * pull;
        let residuals: Vec<f64> = (0..rows.len())
            .map(|index| rows.weight[index] * (force[index] - rows.force[index]))
            .collect();
        let mut spread = DMatrix::<f64>::zeros(width, width);
        for (index, residual) in residuals.iter().enumerate() {
            fill(index, &mut row);
            let leverage: f64 = row
                .iter()
                .flat_map(|&(i, a)| row.iter().map(move |&(j, b)| (i, j, a * b)))
                .map(|(i, j, product)| inverse[(i, j)] * product)
                .sum();
            let kept = (1.0 - leverage).max(UncertaintyPolicy::in_use().least_kept);
            add_square(&mut spread, &row, (residual / kept).powi(2));
        }
        let covariance = &inverse * spread * &inverse * autocorrelation_time(&residuals);
        let deviations = (0..width).map(|i| {
            if inverse[(i, i)] > 0.0 {
                covariance[(i, i)].max(0.0).sqrt()
            } else {
                f64::INFINITY
            }
        });
        let half: Vec<f64> = deviations
            .zip(offsets.iter())
            .map(|(deviation, offset)| NINETY_PERCENT * deviation + offset.abs())
            .collect();

        let law = (0..nodes)
            .map(|node| std::array::from_fn(|slot| half[4 * node + slot]))
            .collect();
        let mut rest = half[4 * nodes..].iter().copied();
        let terms = solution
            .terms
            .iter()
            .map(|value| TermUncertainty {
                sizes: match value.term.held {
                    Some(_) => vec![0.0; value.sizes.len()],
                    None => rest.by_ref().take(value.sizes.len()).collect(),
                },
                shapes: rest
                    .by_ref()
                    .take(value.shapes.len())
                    .map(f64::exp)
                    .collect(),
            })
            .collect();
        Self { law, terms }
    }
}

/// Adds `factor`·jjᵀ for a row j given as its (place, value) pairs.
fn add_square(matrix: &mut DMatrix<f64>, row: &[(usize, f64)], factor: f64) {
    for &(i, a) in row {
        for &(j, b) in row {
            matrix[(i, j)] += factor * a * b;
        }
    }
}

/// `gram`⁻¹, with zeros where the data determine nothing.
fn inverse(gram: &DMatrix<f64>) -> DMatrix<f64> {
    let mut whole = DMatrix::zeros(gram.nrows(), gram.ncols());
    let seen: Vec<usize> = (0..gram.nrows()).filter(|&i| gram[(i, i)] > 0.0).collect();
    let scale: Vec<f64> = seen.iter().map(|&i| gram[(i, i)].sqrt()).collect();
    let scaled = DMatrix::from_fn(seen.len(), seen.len(), |i, j| {
        gram[(seen[i], seen[j])] / (scale[i] * scale[j])
    });
    if let Some(factor) = Cholesky::new(scaled) {
        let inverse = factor.inverse();
        for (i, &row) in seen.iter().enumerate() {
            for (j, &column) in seen.iter().enumerate() {
                whole[(row, column)] = inverse[(i, j)] / (scale[i] * scale[j]);
            }
        }
    }
    whole
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
        .take_while(|&rho| rho > UncertaintyPolicy::in_use().uncorrelated)
        .fold(1.0, |total, rho| total + 2.0 * rho)
}
