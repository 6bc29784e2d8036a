//! The coefficients as functions of density and amplitude, eqs 16–20.
//!
//! Density ρ in g/cm³, 2…4, amplitude A in mm, 0.05…0.25.

use super::law::Coefficients;

/// The reading of eq 18.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equation18 {
    /// As printed; gives a negative damping over the whole grid.
    Printed,
    /// With the last three coefficients on A²ρ, Aρ², ρ³ instead of A³, A²ρ, Aρ²: the order of a fit of degree 2 in A and 3 in ρ.
    /// Still negative at 2.0 g/cm³, 0.05 mm.
    Corrected,
}

/// Eq 16, k1 in kN/mm. 18 to 40 times below Table 6 at 2.0 g/cm³.
pub fn k1(density: f64, amplitude: f64) -> f64 {
    3.137e-5 * amplitude.powf(0.05217) * density.powf(9.108)
}

/// The coefficients of eq 17, in the order of [`terms_17`].
pub const EQUATION_17: [f64; 10] = [
    -836.7, -367.4, 975.6, -183.1, -327.3, -314.7, 2760.0, 1299.0, -69.43, 36.29,
];

/// 1, A, ρ, A², Aρ, ρ², A³, A²ρ, Aρ², ρ³.
pub fn terms_17(density: f64, amplitude: f64) -> [f64; 10] {
    let (r, a) = (density, amplitude);
    [
        1.0,
        a,
        r,
        a * a,
        a * r,
        r * r,
        a * a * a,
        a * a * r,
        a * r * r,
        r * r * r,
    ]
}

/// Eq 17, k3 in kN/mm³. R² = 0.78 against Table 7.
pub fn k3(density: f64, amplitude: f64) -> f64 {
    sum(&EQUATION_17, &terms_17(density, amplitude))
}

/// The coefficients of eq 18, in the order of [`terms_18`].
pub const EQUATION_18: [f64; 9] = [
    -6.705, 9.596, 6.924, 0.7754, -7.209, -2.286, 0.1469, 1.297, 0.2459,
];

/// 1, A, ρ, A², Aρ, ρ², and the last three terms of the reading.
pub fn terms_18(density: f64, amplitude: f64, reading: Equation18) -> [f64; 9] {
    let (r, a) = (density, amplitude);
    let [x, y, z] = match reading {
        Equation18::Printed => [a * a * a, a * a * r, a * r * r],
        Equation18::Corrected => [a * a * r, a * r * r, r * r * r],
    };
    [1.0, a, r, a * a, a * r, r * r, x, y, z]
}

/// Eq 18, c in kN·(s/mm)^α.
pub fn c(density: f64, amplitude: f64, reading: Equation18) -> f64 {
    sum(&EQUATION_18, &terms_18(density, amplitude, reading))
}

/// The coefficients of eq 19, in the order of [`terms_19`].
pub const EQUATION_19: [f64; 7] = [-0.8135, 0.6189, 1.188, -0.7935, -0.3195, 0.1205, 0.02337];

/// 1, A, ρ, Aρ, ρ², Aρ², ρ³.
pub fn terms_19(density: f64, amplitude: f64) -> [f64; 7] {
    let (r, a) = (density, amplitude);
    [1.0, a, r, a * r, r * r, a * r * r, r * r * r]
}

/// Eq 19, α. R² = 0.85 against Table 9.
pub fn alpha(density: f64, amplitude: f64) -> f64 {
    sum(&EQUATION_19, &terms_19(density, amplitude))
}

fn sum(coefficients: &[f64], terms: &[f64]) -> f64 {
    coefficients.iter().zip(terms).map(|(b, x)| b * x).sum()
}

/// The coefficients that eq 20 inserts into eq 13.
///
/// Only the last three terms of its exponent are printed; the whole of eq 19 is meant.
pub fn coefficients(density: f64, amplitude: f64, reading: Equation18) -> Coefficients {
    Coefficients {
        k1: k1(density, amplitude),
        k3: k3(density, amplitude),
        c: c(density, amplitude, reading),
        alpha: alpha(density, amplitude),
    }
}

/// Eq 20: force in kN at displacement `y` mm and velocity `v` mm/s.
pub fn force(density: f64, amplitude: f64, reading: Equation18, y: f64, v: f64) -> f64 {
    coefficients(density, amplitude, reading).force(y, v)
}
