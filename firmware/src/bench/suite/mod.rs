//! The counted regions and their inputs.
//!
//! The image counts them. The harness runs the same lines on the host, to determine the errors of the results against f64. The
//! checksums show that both ran the same computation.

pub mod effects;
pub mod fixed_point;
pub mod naive;
pub mod one_effect;
pub mod pack;
pub mod power;
pub mod rig;
pub mod tally;
pub mod tick;

use mesh_damper::error::ConfigError;

use tally::Meter;

/// A measurement could not be set up.
#[derive(Debug)]
pub struct Refused;

impl From<ConfigError> for Refused {
    fn from(_: ConfigError) -> Self {
        Self
    }
}

/// All regions for a core with a floating-point unit.
///
/// # Errors
/// A value out of its range, or a rig that stopped.
pub fn cortex_m4f(meter: &mut impl Meter) -> Result<(), Refused> {
    power::run(meter)?;
    tick::run(meter)?;
    effects::run(meter)?;
    one_effect::run(meter)?;
    pack::run(meter)?;
    rig::run(meter)
}

/// The whole tick for a core without one: in integers, and in floats that are computed in software.
///
/// # Errors
/// A value out of its range.
pub fn cortex_m0(meter: &mut impl Meter) -> Result<(), Refused> {
    fixed_point::run(meter)?;
    tick::small(meter)?;
    tick::naive(meter);
    Ok(())
}
