//! The energy balance of a response.

use serde::Serialize;

use super::Moment;
use super::specimen::{PER_KILOGRAM, Specimen};
use crate::ModelError;

/// The energies of a response, J: `input` = `kinetic` + `elastic` + `dissipated` + `residual`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EnergyBalance {
    /// Work of the force on the mass and of the base on the damper, J.
    pub input: f64,
    /// Increase of the kinetic energy of all moving masses, J.
    pub kinetic: f64,
    /// Increase of the energy stored in the springs of the law, of stops and of a compliance, with the coefficients at the end, J.
    pub elastic: f64,
    /// The rest of the work on the damper, J. It includes the energy that friction and relaxation springs store at the end.
    pub dissipated: f64,
    /// Energy error of the time steps, J.
    pub residual: f64,
}

/// Sums up the work while the mass moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    start: Moment,
    last: Moment,
    input: f64,
    damper: f64,
}

impl Work {
    pub fn from(start: Moment) -> Self {
        Self {
            start,
            last: start,
            input: 0.0,
            damper: 0.0,
        }
    }

    /// Adds one step of `step` s to `now`.
    pub fn add(&mut self, now: Moment, step: f64) {
        self.input += 0.5 * step * (self.last.input_power + now.input_power);
        self.damper += 0.5 * step * (self.last.damper_power + now.damper_power);
        self.last = now;
    }

    /// The balance, with the coefficients at `amplitudes` mm for the start and the end.
    ///
    /// # Errors
    /// A model that the crate refuses.
    pub fn balance(
        &self,
        specimen: &Specimen,
        amplitudes: [f64; 2],
    ) -> Result<EnergyBalance, ModelError> {
        let of_mass =
            |at: &Moment| 0.5 * PER_KILOGRAM * specimen.moving_mass() * at.velocity * at.velocity;
        let of_springs = |at: &Moment, amplitude: f64| {
            specimen.elastic_energy(at.relative_displacement, at.damper, amplitude)
        };
        let kinetic = of_mass(&self.last) - of_mass(&self.start);
        let elastic =
            of_springs(&self.last, amplitudes[1])? - of_springs(&self.start, amplitudes[0])?;
        Ok(EnergyBalance {
            input: self.input,
            kinetic,
            elastic,
            dissipated: self.damper - elastic,
            residual: self.input - kinetic - self.damper,
        })
    }
}
