//! Dynamic stiffness of equal cycles by eq 3, without the bias of noise.
//!
//! Eq 3 is the distance between the extremes of the force over that of the displacement. The largest of noisy samples is too large, and
//! the more samples, the more so. Here each cycle is fitted by its first harmonics. The phases of the extremes come from the mean of
//! the other cycles, and the values at these phases from the cycle itself, whose noise did not choose them.

use std::f64::consts::TAU;

use nalgebra::{Cholesky, DMatrix, DVector};

/// A cycle is fitted by at most this many harmonics. Convention: the force of friction, whose curvature jumps at reversals, has less
/// than a thousandth beyond them.
const MOST: usize = 15;
/// A cycle has at least this many samples for each harmonic. Derived: two coefficients, and a sample to tell the noise.
const SAMPLES: usize = 3;
/// Phases at which extremes are searched for. Convention: the largest force is then off by less than (π·15/1440)²/2, a thousandth of
/// the 15th harmonic.
const PHASES: usize = 1440;
/// Half of a 90 % interval of a normal variable, in deviations.
const NINETY_PERCENT: f64 = 1.645;

/// The dynamic stiffness of equal cycles.
pub struct Stiffness {
    /// Of each cycle, kN/mm.
    pub each: Vec<f64>,
    /// The 90 % interval of their mean, kN/mm.
    pub interval: [f64; 2],
}

/// The stiffness of the cycles between these `spans`, in samples of `displacement` in mm and `force` in kN.
pub fn stiffnesses(displacement: &[f64], force: &[f64], spans: &[[f64; 2]]) -> Stiffness {
    let shortest = spans.iter().map(|[from, to]| to - from);
    let shortest = shortest.fold(f64::INFINITY, f64::min) as usize;
    let order = (shortest / SAMPLES).clamp(1, MOST);
    let [(travel, _), (forces, variance)] =
        [displacement, force].map(|values| distances(values, spans, order));
    let each: Vec<f64> = forces.iter().zip(&travel).map(|(f, x)| f / x).collect();
    let count = each.len() as f64;
    let mean = each.iter().sum::<f64>() / count;
    let from_noise = variance / (travel.iter().sum::<f64>() / count).powi(2);
    // More than the noise: cycles of a specimen that settles or drifts differ.
    let scatter = each.iter().map(|one| (one - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    let half = NINETY_PERCENT * (from_noise.max(scatter) / count).sqrt();
    Stiffness {
        each,
        interval: [mean - half, mean + half],
    }
}

/// The distance between the extremes of each cycle, and the variance of one of them due to noise.
fn distances(values: &[f64], spans: &[[f64; 2]], order: usize) -> (Vec<f64>, f64) {
    let series: Vec<Series> = spans
        .iter()
        .map(|&span| Series::of(values, span, order))
        .collect();
    let count = series.len();
    let terms = 2 * order + 1;
    let sum = series
        .iter()
        .fold(DVector::zeros(terms), |sum: DVector<f64>, one| {
            sum + &one.terms
        });
    let phases = (0..PHASES).map(|i| basis(TAU * i as f64 / PHASES as f64, order).transpose());
    let at = DMatrix::from_rows(&phases.collect::<Vec<_>>());
    let mut variance = 0.0;
    let each = series.iter().map(|one| {
        let others = match count {
            1 => one.terms.clone(),
            _ => (&sum - &one.terms) / (count - 1) as f64,
        };
        let shape = &at * others;
        let between = (at.row(shape.imax()) - at.row(shape.imin())).transpose();
        variance += 2.0 * one.variance * between.norm_squared() / one.samples / count as f64;
        between.dot(&one.terms)
    });
    let each = each.collect();
    (each, variance)
}

/// The harmonics of a cycle.
struct Series {
    /// The mean, then cosine and sine of each harmonic.
    terms: DVector<f64>,
    /// Of the noise of a sample.
    variance: f64,
    samples: f64,
}

impl Series {
    /// Of the samples in `span`, by least squares: they need not fill a cycle exactly.
    fn of(values: &[f64], [from, to]: [f64; 2], order: usize) -> Self {
        let count = 2 * order + 1;
        let mut gram = DMatrix::<f64>::zeros(count, count);
        let mut right = DVector::<f64>::zeros(count);
        let samples = from.ceil().max(0.0) as usize..(to.ceil() as usize).min(values.len());
        let row = |index: usize| basis(TAU * (index as f64 - from) / (to - from), order);
        for index in samples.clone() {
            let row = row(index);
            gram.syger(1.0, &row, &row, 1.0);
            right.axpy(values[index], &row, 1.0);
        }
        // The rows of a cycle are independent: it has three samples for each harmonic.
        let terms = Cholesky::new(gram)
            .map_or_else(|| DVector::zeros(count), |factor| factor.solve(&right));
        let left = samples
            .clone()
            .map(|index| (values[index] - row(index).dot(&terms)).powi(2));
        let free = samples.len().saturating_sub(count).max(1);
        Self {
            variance: left.sum::<f64>() / free as f64,
            samples: samples.len() as f64,
            terms,
        }
    }
}

/// The terms of a series at a phase: the mean, then cosine and sine of each harmonic.
fn basis(phase: f64, order: usize) -> DVector<f64> {
    let (sin, cos) = phase.sin_cos();
    let mut terms = DVector::from_element(2 * order + 1, 1.0);
    let (mut s, mut c) = (0.0, 1.0);
    for harmonic in 0..order {
        (s, c) = (s * cos + c * sin, c * cos - s * sin);
        terms[2 * harmonic + 1] = c;
        terms[2 * harmonic + 2] = s;
    }
    terms
}
