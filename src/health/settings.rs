//! What a monitor is set to.

use super::cause::Statistic;
use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::in_range;

/// What a monitor is set to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct HealthSettings {
    /// Smallest lasting change of stiffness, energy, mean force (of its amplitude) or residual (of the law's force) that is to
    /// be found, 0.01…0.5.
    pub size: f64,
    /// Cycles between false alarms of Gaussian noise, 1e2…1e9.
    pub false_alarm_cycles: f64,
    /// Cycles over which it learns, 8…1000.
    pub learning_cycles: u32,
    /// Cycles after a start within which a slow change is the run-in, 0…1e6.
    pub run_in_cycles: u32,
    /// Most by which temperature changes a specimen's force, part of it per °C, 0…0.1, beyond what the law says of it.
    pub temperature_slope: f64,
    /// Most by which stiffness or energy may change in the run-in, part of them, 0.01…1, beside what the temperature does. More is a fault:
    /// a mesh beds in by some 10 %, and what goes on losing force is breaking.
    pub run_in_size: f64,
    /// Most by which the law follows a slow change of k1, k3 and c, part of each, 0…0.5; 0 where it stays as it was given. It
    /// counts from where the law has found the specimen: for as many cycles as the run-in takes, after a start, another law,
    /// another block or [`crate::rig::RigController::clear_events`], it goes there by up to 0.1 % a cycle and half of each coefficient.
    /// A slow change of stiffness or energy by up to this is no fault. A law with a gap, a compliance or a delay stays,
    /// and so may any law with fewer than 27 ticks to the cycle.
    pub follow: f64,
}

impl Default for HealthSettings {
    /// 5 %, one false alarm in a million cycles, a mesh that loses up to 0.4 % of its force per °C and 15 % in its run-in, and a law
    /// that stays.
    fn default() -> Self {
        Self {
            size: 0.05,
            false_alarm_cycles: 1e6,
            learning_cycles: 16,
            run_in_cycles: 200,
            temperature_slope: 0.004,
            run_in_size: 0.15,
            follow: 0.0,
        }
    }
}

/// What [`HealthSettings`] come to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HealthConfig {
    pub(super) size: f32,
    /// Of one side of one statistic.
    pub(super) run_length: f32,
    pub(super) learning_cycles: u32,
    pub(super) run_in_cycles: u32,
    pub(super) temperature_slope: f32,
    pub(super) run_in_size: f32,
    pub(super) follow: f32,
}

impl HealthConfig {
    /// Whether the law follows slow changes.
    pub(crate) fn follows(&self) -> bool {
        self.follow > 0.0
    }
}

impl HealthSettings {
    /// Validated.
    ///
    /// # Errors
    /// A setting that is not finite or out of range.
    pub(crate) fn config(&self) -> Result<HealthConfig, ConfigError> {
        in_range("learning_cycles", f64::from(self.learning_cycles), 8.0, 1e3)?;
        in_range("run_in_cycles", f64::from(self.run_in_cycles), 0.0, 1e6)?;
        let cycles = in_range("false_alarm_cycles", self.false_alarm_cycles, 1e2, 1e9)?;
        Ok(HealthConfig {
            size: in_range("size", self.size, 0.01, 0.5)? as f32,
            // Both sides of each statistic that is watched.
            run_length: (cycles * 2.0 * Statistic::WATCHED as f64) as f32,
            learning_cycles: self.learning_cycles,
            run_in_cycles: self.run_in_cycles,
            temperature_slope: in_range("temperature_slope", self.temperature_slope, 0.0, 0.1)?
                as f32,
            run_in_size: in_range("run_in_size", self.run_in_size, 0.01, 1.0)? as f32,
            follow: in_range("follow", self.follow, 0.0, 0.5)? as f32,
        })
    }
}

impl Fields for HealthConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        writer.words([
            self.size.to_bits(),
            self.run_length.to_bits(),
            self.learning_cycles,
            self.run_in_cycles,
            self.temperature_slope.to_bits(),
            self.run_in_size.to_bits(),
            self.follow.to_bits(),
        ]);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [
            size,
            run_length,
            learning_cycles,
            run_in_cycles,
            temperature_slope,
            run_in_size,
            follow,
        ] = reader.words()?;
        let within = |bits, low, high| in_range("health", f32::from_bits(bits), low, high).ok();
        Some(Self {
            size: within(size, 0.01, 0.5)?,
            run_length: within(run_length, 1e2, 1e10)?,
            learning_cycles: (8..=1000)
                .contains(&learning_cycles)
                .then_some(learning_cycles)?,
            run_in_cycles: (0..=1_000_000)
                .contains(&run_in_cycles)
                .then_some(run_in_cycles)?,
            temperature_slope: within(temperature_slope, 0.0, 0.1)?,
            run_in_size: within(run_in_size, 0.01, 1.0)?,
            follow: within(follow, 0.0, 0.5)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn false_alarms_are_shared_out_among_both_sides_of_what_is_watched() {
        let settings = HealthSettings {
            false_alarm_cycles: 1e4,
            ..HealthSettings::default()
        };
        assert_eq!(settings.config().unwrap().run_length, 8e4);
    }
}
