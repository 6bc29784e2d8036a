//! The coefficients as functions of density and amplitude, eqs 16–20.
//!
//! Density ρ in g/cm³, 2…4, amplitude A in mm, 0.05…0.25.

use super::law::Coefficients;

/// Which reading of eq 18.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Equation18 {
    /// As printed; gives a negative damping over the whole grid.
    Printed,
    /// With the last three coefficients on A²ρ, Aρ², ρ³ instead of A³, A²ρ, Aρ²: the order of a fit of degree 2 in A
    /// and 3 in ρ. Negative at 2.0 g/cm³, 0.05 mm even so.
    Corrected,
}

/// Eq 16, k1 in kN/mm. 18 to 40 times below Table 6 at 2.0 g/cm³.
pub fn k1(density: f64, amplitude: f64) -> f64 {
    3.137e-5 * amplitude.powf(0.05217) * density.powf(9.108)
}

/// Eq 17, k3 in kN/mm³. R² = 0.78 against Table 7.
pub fn k3(density: f64, amplitude: f64) -> f64 {
    let (r, a) = (density, amplitude);
    -836.7 - 367.4 * a + 975.6 * r - 183.1 * a * a - 327.3 * a * r - 314.7 * r * r
        + 2760.0 * a * a * a
        + 1299.0 * a * a * r
        - 69.43 * a * r * r
        + 36.29 * r * r * r
}

/// Eq 18, c in kN·(s/mm)^α.
pub fn c(density: f64, amplitude: f64, reading: Equation18) -> f64 {
    let (r, a) = (density, amplitude);
    let last = match reading {
        Equation18::Printed => [a * a * a, a * a * r, a * r * r],
        Equation18::Corrected => [a * a * r, a * r * r, r * r * r],
    };
    -6.705 + 9.596 * a + 6.924 * r + 0.7754 * a * a - 7.209 * a * r - 2.286 * r * r
        + 0.1469 * last[0]
        + 1.297 * last[1]
        + 0.2459 * last[2]
}

/// Eq 19, α. R² = 0.85 against Table 9.
pub fn alpha(density: f64, amplitude: f64) -> f64 {
    let (r, a) = (density, amplitude);
    -0.8135 + 0.6189 * a + 1.188 * r - 0.7935 * a * r - 0.3195 * r * r
        + 0.1205 * a * r * r
        + 0.02337 * r * r * r
}

/// The coefficients that eq 20 puts into eq 13.
///
/// Of its exponent only the last three terms are printed; the whole of eq 19 is meant.
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
