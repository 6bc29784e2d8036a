//! The simulated rig: a servo-hydraulic actuator, its sensors, and the converters and the line that connect them to the crate. It
//! is written in f64 and shares no code with the crate except the bus traits of both.

mod ad5761;
mod ads8688;
mod enable;
mod sensor;
mod servo;

pub use ad5761::{DacPins, SimulatedAd5761, dac_volts};
pub use ads8688::{AdcPins, SimulatedAds8688, adc_code};
pub use enable::{SimulatedEnable, SimulatedInput, enable_line};
pub use sensor::{Sensor, SensorConfig, SensorFault};
pub use servo::{Servo, ServoConfig, ServoFault};

/// An invalid field in a simulated part's configuration.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{field} = {value}: must be {must_be}")]
pub struct InvalidField {
    /// The field's name.
    pub field: &'static str,
    /// The value given.
    pub value: f64,
    /// The condition on the value.
    pub must_be: &'static str,
}

fn check(
    field: &'static str,
    value: f64,
    must_be: &'static str,
    holds: bool,
) -> Result<(), InvalidField> {
    // NaN fails every comparison, infinity passes some.
    if holds && value.is_finite() {
        Ok(())
    } else {
        Err(InvalidField {
            field,
            value,
            must_be,
        })
    }
}

fn positive(field: &'static str, value: f64) -> Result<(), InvalidField> {
    check(field, value, "positive", value > 0.0)
}

fn not_negative(field: &'static str, value: f64) -> Result<(), InvalidField> {
    check(field, value, "0 or more", value >= 0.0)
}
