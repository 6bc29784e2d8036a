//! The force of each law on the loop that was held out.

use mesh_damper::effects::Motion;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper_model::{Model, ModelError};
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::surfaces::{self, Equation18};
use mesh_damper_reference::tables::{DENSITIES, cell};

use super::loops::{FITTED, HELD_OUT, Sine, amplitude};

/// Ticks per second of the rig.
const TICK_RATE: f64 = 1e4;

/// One cycle of a sine at the rig's ticks.
pub fn ticks_of(amplitude: f64, frequency: f64) -> Sine {
    Sine::new(
        amplitude,
        frequency,
        (TICK_RATE / frequency).round() as usize,
    )
}

/// The force in kN of the firmware's computation, in f32, on the closed loop under `sine`: in the second cycle.
///
/// # Errors
/// A model that the crate refuses.
pub fn embedded_force(model: &Model, sine: &Sine) -> Result<Vec<f64>, ModelError> {
    let law = model.augmented::<f32>(0.0, 1.0 / TICK_RATE)?;
    let mut running = RunningLaw::new(FastLaw::new(law));
    let mut cycle = || -> Vec<f64> {
        let samples = sine.displacement.iter().zip(&sine.velocity);
        samples
            .map(|(&y, &v)| {
                let motion = Motion::at(y as f32, v as f32);
                f64::from(running.force(&motion))
            })
            .collect()
    };
    cycle();
    Ok(cycle())
}

/// The fitted rows on either side of the held-out one, and its place between them, 0…1.
fn beside_held_out() -> (usize, usize, f64) {
    let held_out = amplitude(HELD_OUT);
    let above = FITTED.iter().position(|&row| amplitude(row) > held_out);
    let above = above.expect("an amplitude above the held-out one is fitted");
    let (low, high) = (FITTED[above - 1], FITTED[above]);
    let part = (held_out - amplitude(low)) / (amplitude(high) - amplitude(low));
    (low, high, part)
}

/// The force in kN at the held-out amplitude, interpolated at the same phase between the loops on either side.
pub fn loop_between(density: usize, frequency: f64) -> Vec<f64> {
    let (low, high, part) = beside_held_out();
    let held_out = amplitude(HELD_OUT);
    let force = |row| ticks_of(amplitude(row), frequency).force_of_cell(row, density);
    let between = force(low).into_iter().zip(force(high));
    between
        .map(|(a, b)| held_out * ((1.0 - part) * a / amplitude(low) + part * b / amplitude(high)))
        .collect()
}

/// Coefficients at the held-out amplitude, interpolated between the tables' cells on either side: the result of the tables if the
/// cell itself is not known.
pub fn interpolated(density: usize) -> Coefficients {
    let (low, high, part) = beside_held_out();
    let (low, high) = (cell(low, density), cell(high, density));
    let between = |of: fn(&Coefficients) -> f64| of(&low) + part * (of(&high) - of(&low));
    Coefficients {
        k1: between(|law| law.k1),
        k3: between(|law| law.k3),
        c: between(|law| law.c),
        alpha: between(|law| law.alpha),
    }
}

/// Coefficients from eqs 16–19 at the held-out amplitude, with eq 18 corrected.
pub fn of_surfaces(density: usize) -> Coefficients {
    surfaces::coefficients(
        DENSITIES[density],
        amplitude(HELD_OUT),
        Equation18::Corrected,
    )
}
