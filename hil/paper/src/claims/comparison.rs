//! Section 4.7: law and finite elements on the loops of Tables 6–9, over density at 0.1 mm and over amplitude at 2.0 g/cm³ (Figures
//! 14–18).
//!
//! The recorded loops are not published; the loops of the tables take their place. On those, the tables' own coefficients have no
//! error. So the law is taken from eqs 16–20, as printed and with eq 18 corrected, and from the surfaces of this crate.

use mesh_damper_reference::comparison::{beside_ellipse, nrmse, relative_error};
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::surfaces::{self, Equation18};
use mesh_damper_reference::tables::{AMPLITUDES, DENSITIES, cell};
use rayon::prelude::*;
use serde::Serialize;

use super::cells::{Cell, Dynamics, FREQUENCY, dynamics_of};
use super::trends::TENTH;
use crate::amplitude_independent::Sine;
use crate::finite_element::ForceLoop;
use crate::surfaces::Surfaces;

/// Smallest measured force of a sample in eq 21, as fractions of the loop's largest. The paper states none.
pub const GUARDS: [f64; 4] = [0.0, 0.05, 0.1, 0.2];
/// The one of [`GUARDS`] by which claims are judged.
pub const JUDGED: usize = 1;

/// Samples of a cycle for comparisons of the law alone.
const SAMPLES: usize = 1000;

/// The difference between a simulated loop and the loop of the tables.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compared {
    /// NRMSE: RMS of the error over the RMS of the force.
    pub nrmse: f64,
    /// σ of eq 21 at each of [`GUARDS`].
    pub sigma: [f64; 4],
    /// Stiffness and loss factor of the simulated loop.
    pub dynamics: Dynamics,
    /// RMS of the difference between the simulated loop and its nearest ellipse, over the RMS of the loop.
    pub beside_ellipse: f64,
}

/// One density and amplitude.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Condition {
    /// Density, g/cm³.
    pub density: f64,
    /// Amplitude, mm.
    pub amplitude: f64,
    /// Results of the loop from the tables.
    pub measured: Dynamics,
    /// RMS of the part of the tables' loop that an ellipse does not explain, over the RMS of the loop.
    pub measured_beside_ellipse: f64,
    /// Eq 20 as printed, compared with the tables' loop.
    pub printed: Compared,
    /// Eq 20 with eq 18 corrected, compared with the tables' loop.
    pub corrected: Compared,
    /// The crate's surfaces, compared with the tables' loop.
    pub surfaces: Compared,
    /// The finite elements, compared with the tables' loop, or the reason why there is no comparison.
    pub finite_elements: Result<Compared, String>,
    /// The loop of the finite elements; null if there is none.
    #[serde(skip)]
    pub finite_element_loop: Option<ForceLoop>,
}

/// Law and finite elements on the paper's conditions.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// Conditions at 0.1 mm, by density.
    pub by_density: Vec<Condition>,
    /// Conditions at 2.0 g/cm³, by amplitude.
    pub by_amplitude: Vec<Condition>,
    /// The guards of [`Compared::sigma`].
    pub guards: [f64; 4],
}

/// Compares; `finite_elements` returns the steady loop at a density in g/cm³ and an amplitude in mm, 1 Hz.
pub fn compare(
    cells: &[[Cell; 5]; 5],
    own: &Surfaces,
    finite_elements: impl Fn(f64, f64) -> Result<ForceLoop, String> + Sync,
) -> Comparison {
    let by_density = (0..5).map(|column| (TENTH, column));
    let by_amplitude = (0..5).filter(|&row| row != TENTH).map(|row| (row, 0));
    let places: Vec<(usize, usize)> = by_density.chain(by_amplitude).collect();
    let mut conditions: Vec<Condition> = places
        .into_par_iter()
        .map(|(row, column)| {
            let simulated = finite_elements(DENSITIES[column], AMPLITUDES[row]);
            Condition::new(&cells[row][column], (row, column), own, simulated)
        })
        .collect();
    let mut by_amplitude = conditions.split_off(5);
    by_amplitude.insert(TENTH, conditions[0].clone());
    Comparison {
        by_density: conditions,
        by_amplitude,
        guards: GUARDS,
    }
}

impl Condition {
    fn new(
        of_cell: &Cell,
        (row, column): (usize, usize),
        own: &Surfaces,
        simulated: Result<ForceLoop, String>,
    ) -> Self {
        let (density, amplitude) = (of_cell.density, of_cell.amplitude);
        let law = cell(row, column);
        let by = |coefficients: Coefficients| {
            let sine = Sine::new(amplitude, FREQUENCY, SAMPLES);
            let force = sine.force(&coefficients);
            compared(&force, &sine.force(&law), &sine.displacement)
        };
        let (finite_elements, finite_element_loop) = match simulated {
            Ok(one) => (Ok(compared_on_its_samples(&one, &law)), Some(one)),
            Err(error) => (Err(error), None),
        };
        let sine = Sine::new(amplitude, FREQUENCY, SAMPLES);
        Self {
            density,
            amplitude,
            measured: of_cell.dynamics,
            measured_beside_ellipse: beside_ellipse(&sine.force(&law)),
            printed: by(surfaces::coefficients(
                density,
                amplitude,
                Equation18::Printed,
            )),
            corrected: by(surfaces::coefficients(
                density,
                amplitude,
                Equation18::Corrected,
            )),
            surfaces: by(own.coefficients(density, amplitude)),
            finite_elements,
            finite_element_loop,
        }
    }
}

/// A simulated loop compared to that of `law`, on its own samples.
pub fn compared_on_its_samples(simulated: &ForceLoop, law: &Coefficients) -> Compared {
    let motion = simulated.displacement.iter().zip(&simulated.velocity);
    let measured: Vec<f64> = motion.map(|(&y, &v)| law.force(y, v)).collect();
    compared(&simulated.force, &measured, &simulated.displacement)
}

fn compared(force: &[f64], measured: &[f64], displacement: &[f64]) -> Compared {
    Compared {
        nrmse: nrmse(force, measured).expect("a loop with force"),
        sigma: GUARDS.map(|guard| {
            relative_error(force, measured, guard)
                .expect("the largest force is kept")
                .sigma
        }),
        dynamics: dynamics_of(displacement, force),
        beside_ellipse: beside_ellipse(force),
    }
}
