//! Results of the loops of Tables 6–9: stiffness, loss factor, energy and inflections.

use mesh_damper_reference::dynamic_test;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES, cell};
use serde::Serialize;

use crate::amplitude_independent::Sine;

/// Samples of a cycle; the error of the largest force is below (π/N)²/2 of it.
const SAMPLES: usize = 4000;

/// The frequency of the paper's test, Hz.
pub const FREQUENCY: f64 = 1.0;

/// Results of one loop from eqs 3–7.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Dynamics {
    /// Dynamic stiffness K, kN/mm.
    pub stiffness: f64,
    /// Dynamic loss factor η_d.
    pub loss_factor: f64,
    /// Dissipated energy ΔW, J.
    pub dissipated: f64,
}

/// One cell of Tables 6–9.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Cell {
    /// Density, g/cm³.
    pub density: f64,
    /// Amplitude, mm.
    pub amplitude: f64,
    /// The coefficients, as printed.
    pub coefficients: Coefficients,
    /// Results of the cell's loop at 1 Hz.
    pub dynamics: Dynamics,
    /// Number of sign changes of the curvature on a branch of the loop; 0 for an ellipse.
    pub inflections: usize,
}

/// Every cell: rows are amplitudes, columns densities.
pub fn cells() -> [[Cell; 5]; 5] {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let coefficients = cell(row, column);
            let amplitude = AMPLITUDES[row];
            Cell {
                density: DENSITIES[column],
                amplitude,
                coefficients,
                dynamics: dynamics(&coefficients, amplitude, FREQUENCY),
                inflections: inflections(&coefficients, amplitude),
            }
        })
    })
}

/// Eqs 3–7 on the loop of `law` at `amplitude` mm and `frequency` Hz.
pub fn dynamics(law: &Coefficients, amplitude: f64, frequency: f64) -> Dynamics {
    let sine = Sine::new(amplitude, frequency, SAMPLES);
    dynamics_of(&sine.displacement, &sine.force(law))
}

/// Eqs 3–7 on the samples of one cycle, mm and kN.
///
/// # Panics
/// Without motion.
pub fn dynamics_of(displacement: &[f64], force: &[f64]) -> Dynamics {
    let result = dynamic_test::characterize(displacement, force).expect("a cycle with motion");
    Dynamics {
        stiffness: result.stiffness,
        loss_factor: result.loss_factor,
        dissipated: result.dissipated,
    }
}

/// Changes of sign of the curvature along the branch of rising displacement. With x = y/A it is
/// F″·A² = 6·k3·A³·x − c·(ωA)^α·α·(1 − x²)^(α/2 − 2)·(1 + (1 − α)·x²).
pub fn inflections(law: &Coefficients, amplitude: f64) -> usize {
    let speed = std::f64::consts::TAU * FREQUENCY * amplitude;
    let friction = law.c * speed.powf(law.alpha) * law.alpha;
    let curvature = |x: f64| {
        let rest: f64 = 1.0 - x * x;
        6.0 * law.k3 * amplitude.powi(3) * x
            - friction * rest.powf(0.5 * law.alpha - 2.0) * (1.0 + (1.0 - law.alpha) * x * x)
    };
    let steps = 4000;
    let signs: Vec<bool> = (1..steps)
        .map(|i| curvature(2.0 * f64::from(i) / f64::from(steps) - 1.0) > 0.0)
        .collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared to second differences of the force itself.
    #[test]
    fn the_curvature_is_the_forces() {
        let count = |law: &Coefficients| inflections(law, 0.2);
        let ellipse = Coefficients::new(1.0, 0.0, 0.1, 1.0);
        assert_eq!(count(&ellipse), 0);
        let law = cell(3, 1);
        let branch = |x: f64| {
            let speed = std::f64::consts::TAU * 0.2 * (1.0 - x * x).sqrt();
            law.force(0.2 * x, speed)
        };
        let step = 1e-4;
        let signs: Vec<bool> = (1..9_900)
            .map(|i| {
                let x = f64::from(i) * 2e-4 - 0.99;
                branch(x + step) - 2.0 * branch(x) + branch(x - step) > 0.0
            })
            .collect();
        let changes = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        assert_eq!((changes, count(&law)), (2, 2));
    }
}
