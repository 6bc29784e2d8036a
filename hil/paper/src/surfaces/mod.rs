//! The coefficients of eq 13 as surfaces over density and amplitude, in place of eqs 16–19.
//!
//! k1 and k3 compensate each other within a loop, and so do c and α. So a small error of the loop may require a large error of a
//! coefficient. The fit therefore uses quantities that a loop of amplitude A mm at 1 Hz shows:
//!
//! - P = k1·A + k3·A³, the elastic force at the amplitude, kN;
//! - s = k3·A³/P, the share of the cubic in it, 0…1;
//! - D = c·(2π·1 Hz·A)^α, the damping force at the largest speed, kN;
//! - α, 0…1.
//!
//! ln P, ln D, logit s and logit α are each Σ bᵢⱼ·Nᵢ(ρ)·Bⱼ(a): hat functions N on the densities of the tables, Bernstein
//! polynomials B over a = ln(A/0.05 mm)/ln 5. The following holds for this form with any coefficients b:
//!
//! - k1, k3 and c are above 0 and α is within 0…1, because exponential and logistic function are;
//! - at every density P and D do not fall when the amplitude rises: N and B are nonnegative, each sums to 1, and the bᵢⱼ of ln P
//!   and ln D do not fall with j. A mesh that is pressed further does not push back less;
//! - between two densities of the tables P, s, D and α are between their values. A smoother form over density overshoots, because
//!   the tables rise and fall from each density to the next. For the same reason the stiffness is not forced to rise with density:
//!   the tables' own stiffness does not from 0.15 mm on.

mod basis;
mod fit;

use std::f64::consts::TAU;

use mesh_damper_reference::comparison::nrmse;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables::{self, AMPLITUDES, DENSITIES};
use serde::Serialize;

use crate::amplitude_independent::Sine;
pub use fit::fit;

/// Degree over the logarithm of amplitude: the smallest that leaves no cell of the tables above an NRMSE of 0.15.
pub const DEGREE: usize = 2;

/// Samples of a cycle for the comparison of loops.
const SAMPLES: usize = 200;

/// ω of the paper's test, rad/s.
const OMEGA: f64 = TAU;

/// Coefficients of the crate's surfaces.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Surfaces {
    /// Degree of the polynomials over the logarithm of the amplitude.
    pub degree: usize,
    /// Coefficients b of ln P with P in kN, by density of the tables and, within it, by polynomial.
    pub elastic: Vec<Vec<f64>>,
    /// Coefficients b of logit s.
    pub cubic_share: Vec<Vec<f64>>,
    /// Coefficients b of ln D with D in kN.
    pub damping: Vec<Vec<f64>>,
    /// Coefficients b of logit α.
    pub exponent: Vec<Vec<f64>>,
}

/// The quantities that a loop shows, see the module.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SurfaceShape {
    elastic: f64,
    cubic_share: f64,
    damping: f64,
    exponent: f64,
}

impl Surfaces {
    /// Eq 13 at `density` g/cm³, 2…4, and `amplitude` mm, 0.05…0.25; beyond, that of the nearest edge.
    pub fn coefficients(&self, density: f64, amplitude: f64) -> Coefficients {
        let amplitude = amplitude.clamp(AMPLITUDES[0], AMPLITUDES[4]);
        self.shape(density, amplitude).coefficients(amplitude)
    }

    fn shape(&self, density: f64, amplitude: f64) -> SurfaceShape {
        let hats = basis::hats(density);
        let polynomials = basis::polynomials(amplitude, self.degree);
        let at = |b: &[Vec<f64>]| -> f64 {
            let row = |b: &[f64]| -> f64 { b.iter().zip(&polynomials).map(|(b, p)| b * p).sum() };
            b.iter().zip(hats).map(|(b, n)| n * row(b)).sum()
        };
        SurfaceShape {
            elastic: at(&self.elastic).exp(),
            cubic_share: logistic(at(&self.cubic_share)),
            damping: at(&self.damping).exp(),
            exponent: logistic(at(&self.exponent)),
        }
    }
}

impl SurfaceShape {
    fn coefficients(&self, amplitude: f64) -> Coefficients {
        Coefficients {
            k1: self.elastic * (1.0 - self.cubic_share) / amplitude,
            k3: self.elastic * self.cubic_share / amplitude.powi(3),
            c: self.damping / (OMEGA * amplitude).powf(self.exponent),
            alpha: self.exponent,
        }
    }
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

/// NRMSE of the loop of `law` at a density in g/cm³ and an amplitude in mm, 1 Hz, in each cell of Tables 6–9: rows are amplitudes,
/// columns densities.
pub fn loop_errors(law: impl Fn(f64, f64) -> Coefficients) -> [[f64; 5]; 5] {
    let mut errors = [[0.0; 5]; 5];
    for (row, &amplitude) in AMPLITUDES.iter().enumerate() {
        for (column, &density) in DENSITIES.iter().enumerate() {
            errors[row][column] = loop_error(&law(density, amplitude), row, column);
        }
    }
    errors
}

/// NRMSE of the loop of `law` in row `row` and column `column` of the tables.
pub fn loop_error(law: &Coefficients, row: usize, column: usize) -> f64 {
    let sine = Sine::new(AMPLITUDES[row], 1.0, SAMPLES);
    let measured = sine.force(&tables::cell(row, column));
    nrmse(&sine.force(law), &measured).expect("no cell is without force")
}

/// By cell, the error of surfaces of `degree` that were fitted to all other cells: their accuracy between cells.
pub fn left_out_errors(degree: usize) -> [[f64; 5]; 5] {
    use rayon::prelude::*;
    let errors: Vec<f64> = (0..25_usize)
        .into_par_iter()
        .map(|cell| {
            let (row, column) = (cell / 5, cell % 5);
            let surfaces = fit(degree, Some((row, column)));
            let law = surfaces.coefficients(DENSITIES[column], AMPLITUDES[row]);
            loop_error(&law, row, column)
        })
        .collect();
    std::array::from_fn(|row| std::array::from_fn(|column| errors[5 * row + column]))
}

/// Mean and largest value of a table.
pub fn mean_and_largest(errors: &[[f64; 5]; 5]) -> (f64, f64) {
    let all = || errors.iter().flatten();
    (
        all().sum::<f64>() / 25.0,
        all().fold(0.0, |largest, &error| largest.max(error)),
    )
}
