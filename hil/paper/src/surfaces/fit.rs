//! The surfaces closest to the loops of Tables 6–9.
//!
//! The fit minimises the sum of the fourth powers of the cells' NRMSE: every cell counts by its relative error, and one large error
//! more than several small ones. A coefficient that a loop hardly shows, such as k3 at a small amplitude, is kept close to the
//! table's by a small weight on the squared relative errors of the coefficients. The method is Gauss–Newton, with every cell
//! weighted by its present squared error. Each step is least squares, with the steps of ln P and ln D from polynomial to polynomial
//! not below 0.

use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables::{self, AMPLITUDES, DENSITIES};
use nalgebra::{DMatrix, DVector};

use super::{OMEGA, SAMPLES, SurfaceShape, Surfaces, basis, logistic};
use crate::amplitude_independent::Sine;
use crate::nonnegative;

/// As many as the tables have densities.
const HATS: usize = DENSITIES.len();
/// Weight of the squared logarithm of a coefficient over the table's, relative to the errors of the loops.
const COEFFICIENTS: f64 = 1e-5;
/// Ridge penalty of an unknown, so that every step's equations are definite if a cell is left out.
const RIDGE: f64 = 1e-10;
/// Smallest squared error as the weight of a cell, so that none is dropped.
const LEAST_WEIGHT: f64 = 1e-4;
/// Steps, of which a few dozen are needed.
const MOST_STEPS: usize = 200;

/// One cell: the functions there and its loop.
struct Cell {
    hats: [f64; HATS],
    polynomials: Vec<f64>,
    /// sin and cos of the samples, and the force over its norm.
    samples: Vec<(f64, f64, f64)>,
    norm: f64,
    amplitude: f64,
    law: Coefficients,
}

/// Fits surfaces of `degree` over the logarithm of the amplitude to all cells, or to all except the one in the row and column
/// `left_out`.
///
/// # Panics
/// Never: the ridge keeps every step's equations definite.
pub fn fit(degree: usize, left_out: Option<(usize, usize)>) -> Surfaces {
    let cells: Vec<Cell> = (0..25)
        .map(|cell| (cell / 5, cell % 5))
        .filter(|&cell| Some(cell) != left_out)
        .map(|(row, column)| Cell::new(row, column, degree))
        .collect();
    let unknowns = Unknowns { degree };
    let mut at = unknowns.start();
    let mut cost = cost_of(&cells, &unknowns, &at);
    for _ in 0..MOST_STEPS {
        let (gram, right) = equations(&cells, &unknowns, &at);
        let target = nonnegative::solve(&gram, &right, unknowns.free())
            .expect("the ridge keeps the equations definite");
        let step = target - &at;
        let mut part = 1.0;
        let mut next = &at + &step;
        let mut next_cost = cost_of(&cells, &unknowns, &next);
        while next_cost > cost && part > 1e-6 {
            part *= 0.5;
            next = &at + part * &step;
            next_cost = cost_of(&cells, &unknowns, &next);
        }
        if next_cost >= cost * (1.0 - 1e-12) {
            break;
        }
        (at, cost) = (next, next_cost);
    }
    unknowns.surfaces(&at)
}

impl Cell {
    fn new(row: usize, column: usize, degree: usize) -> Self {
        let amplitude = AMPLITUDES[row];
        let sine = Sine::new(amplitude, 1.0, SAMPLES);
        let law = tables::cell(row, column);
        let force = sine.force(&law);
        let norm = force.iter().map(|f| f * f).sum::<f64>().sqrt();
        let motion = sine.displacement.iter().zip(&sine.velocity).zip(&force);
        Self {
            hats: basis::hats(DENSITIES[column]),
            polynomials: basis::polynomials(amplitude, degree),
            samples: motion
                .map(|((y, v), f)| (y / amplitude, v / (OMEGA * amplitude), f / norm))
                .collect(),
            norm,
            amplitude,
            law,
        }
    }

    /// Logarithms of k1, k3, c and α over the table's, and their slopes with respect to ln P, logit s, ln D and logit α.
    fn coefficients(&self, shape: &SurfaceShape) -> [(f64, [f64; 4]); 4] {
        let found = shape.coefficients(self.amplitude);
        let (s, alpha) = (shape.cubic_share, shape.exponent);
        let speed = (OMEGA * self.amplitude).ln();
        [
            ((found.k1 / self.law.k1).ln(), [1.0, -s, 0.0, 0.0]),
            ((found.k3 / self.law.k3).ln(), [1.0, 1.0 - s, 0.0, 0.0]),
            (
                (found.c / self.law.c).ln(),
                [0.0, 0.0, 1.0, -speed * alpha * (1.0 - alpha)],
            ),
            (
                (found.alpha / self.law.alpha).ln(),
                [0.0, 0.0, 0.0, 1.0 - alpha],
            ),
        ]
    }

    /// Error of each sample over the norm of the loop, and its slopes with respect to ln P, logit s, ln D and logit α.
    fn residuals<'a>(
        &'a self,
        shape: &'a SurfaceShape,
    ) -> impl Iterator<Item = (f64, [f64; 4])> + 'a {
        let SurfaceShape {
            elastic,
            cubic_share: s,
            damping,
            exponent: alpha,
        } = *shape;
        let (elastic, damping) = (elastic / self.norm, damping / self.norm);
        self.samples.iter().map(move |&(sin, cos, force)| {
            let cube = sin.powi(3);
            let spring = elastic * ((1.0 - s) * sin + s * cube);
            let friction = damping * cos.abs().powf(alpha) * cos.signum();
            let slopes = [
                spring,
                elastic * (cube - sin) * s * (1.0 - s),
                friction,
                friction * cos.abs().ln() * alpha * (1.0 - alpha),
            ];
            (spring + friction - force, slopes)
        })
    }
}

/// The place of each b among the unknowns: the first of ln P and ln D and all of the logits, which may have any sign, then the
/// steps of ln P and ln D.
struct Unknowns {
    degree: usize,
}

impl Unknowns {
    fn free(&self) -> usize {
        HATS * (2 + 2 * (self.degree + 1))
    }

    fn count(&self) -> usize {
        HATS * 4 * (self.degree + 1)
    }

    /// Place of the first of ln P (0) or ln D (1) for a hat.
    fn first(which: usize, hat: usize) -> usize {
        which * HATS + hat
    }

    /// Place of logit s (0) or logit α (1).
    fn logit(&self, which: usize, hat: usize, polynomial: usize) -> usize {
        2 * HATS + (which * HATS + hat) * (self.degree + 1) + polynomial
    }

    /// Place of the step of ln P (0) or ln D (1) to `polynomial`, from 1 on.
    fn step(&self, which: usize, hat: usize, polynomial: usize) -> usize {
        self.free() + (which * HATS + hat) * self.degree + polynomial - 1
    }

    /// Forces that rise by a factor of 4 from the smallest amplitude to the largest, and shares of a third.
    fn start(&self) -> DVector<f64> {
        let mut at = DVector::from_element(self.count(), 4.0_f64.ln() / self.degree.max(1) as f64);
        for hat in 0..HATS {
            at[Self::first(0, hat)] = -2.0;
            at[Self::first(1, hat)] = -3.0;
            for polynomial in 0..=self.degree {
                for which in 0..2 {
                    at[self.logit(which, hat, polynomial)] = -0.7;
                }
            }
        }
        at
    }

    fn surfaces(&self, at: &DVector<f64>) -> Surfaces {
        let rising = |which| -> Vec<Vec<f64>> {
            let row = |hat| {
                let mut sum = at[Self::first(which, hat)];
                let steps = (1..=self.degree).map(|polynomial| {
                    sum += at[self.step(which, hat, polynomial)];
                    sum
                });
                let first = at[Self::first(which, hat)];
                std::iter::once(first)
                    .chain(steps.collect::<Vec<_>>())
                    .collect()
            };
            (0..HATS).map(row).collect()
        };
        let any = |which| -> Vec<Vec<f64>> {
            let row = |hat| {
                (0..=self.degree)
                    .map(|polynomial| at[self.logit(which, hat, polynomial)])
                    .collect()
            };
            (0..HATS).map(row).collect()
        };
        Surfaces {
            degree: self.degree,
            elastic: rising(0),
            cubic_share: any(0),
            damping: rising(1),
            exponent: any(1),
        }
    }

    /// The slopes of ln P, logit s, ln D and logit α in a cell with respect to its unknowns: place, slope.
    fn slopes(&self, cell: &Cell) -> [Vec<(usize, f64)>; 4] {
        let mut slopes = [const { Vec::new() }; 4];
        for (hat, &n) in cell.hats.iter().enumerate() {
            for which in 0..2 {
                let rising = &mut slopes[2 * which];
                rising.push((Self::first(which, hat), n));
                for polynomial in 1..=self.degree {
                    // A step raises every later coefficient.
                    let later: f64 = cell.polynomials[polynomial..].iter().sum();
                    rising.push((self.step(which, hat, polynomial), n * later));
                }
                for (polynomial, b) in cell.polynomials.iter().enumerate() {
                    slopes[2 * which + 1].push((self.logit(which, hat, polynomial), n * b));
                }
            }
        }
        slopes
    }

    fn shape(&self, slopes: &[Vec<(usize, f64)>; 4], at: &DVector<f64>) -> SurfaceShape {
        let value = |which: usize| -> f64 {
            let parts = slopes[which].iter();
            parts.map(|&(place, slope)| slope * at[place]).sum()
        };
        SurfaceShape {
            elastic: value(0).exp(),
            cubic_share: logistic(value(1)),
            damping: value(2).exp(),
            exponent: logistic(value(3)),
        }
    }
}

/// Σ NRMSE⁴, the coefficients' part and the ridge.
fn cost_of(cells: &[Cell], unknowns: &Unknowns, at: &DVector<f64>) -> f64 {
    let errors = cells.iter().map(|cell| {
        let shape = unknowns.shape(&unknowns.slopes(cell), at);
        let squared: f64 = cell.residuals(&shape).map(|(error, _)| error * error).sum();
        let off = cell
            .coefficients(&shape)
            .iter()
            .map(|(error, _)| error * error)
            .sum::<f64>();
        squared * squared + COEFFICIENTS * off
    });
    errors.sum::<f64>() + RIDGE * at.norm_squared()
}

/// The equations of the least squares step around `at`, whose solution is the unknowns themselves.
fn equations(
    cells: &[Cell],
    unknowns: &Unknowns,
    at: &DVector<f64>,
) -> (DMatrix<f64>, DVector<f64>) {
    let count = unknowns.count();
    let mut gram = DMatrix::identity(count, count) * RIDGE;
    let mut right = DVector::zeros(count);
    for cell in cells {
        let slopes = unknowns.slopes(cell);
        let shape = unknowns.shape(&slopes, at);
        let mut products = [[0.0; 4]; 4];
        let mut errors = [0.0; 4];
        let mut squared = 0.0;
        for (error, by) in cell.residuals(&shape) {
            squared += error * error;
            for i in 0..4 {
                errors[i] += by[i] * error;
                for j in 0..4 {
                    products[i][j] += by[i] * by[j];
                }
            }
        }
        let weight = 2.0 * (squared + LEAST_WEIGHT);
        errors.iter_mut().for_each(|error| *error *= weight);
        products
            .iter_mut()
            .flatten()
            .for_each(|product| *product *= weight);
        for (error, by) in cell.coefficients(&shape) {
            for i in 0..4 {
                errors[i] += COEFFICIENTS * by[i] * error;
                for j in 0..4 {
                    products[i][j] += COEFFICIENTS * by[i] * by[j];
                }
            }
        }
        for i in 0..4 {
            for &(place, slope) in &slopes[i] {
                right[place] -= slope * errors[i];
                for j in 0..4 {
                    for &(other, by) in &slopes[j] {
                        gram[(place, other)] += slope * by * products[i][j];
                    }
                }
            }
        }
    }
    // From the step to the unknowns themselves; the ridge draws them to 0.
    let ridge = RIDGE * at;
    right += &gram * at - ridge;
    (gram, right)
}
