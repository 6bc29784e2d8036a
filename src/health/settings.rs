//! Settings of a health monitor.

use super::event::Statistic;
use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::in_range;

/// Settings of a health monitor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct HealthSettings {
    /// Smallest lasting change to be detected in stiffness, energy, mean force (as a part of its amplitude) or residual (as a part
    /// of the law's force), 0.01…0.5.
    pub size: f64,
    /// Cycles between false alarms by Gaussian noise, 1e2…1e9.
    pub false_alarm_cycles: f64,
    /// Cycles over which the monitor learns, 8…1000.
    pub learning_cycles: u32,
    /// Cycles after a start within which a slow change is the run-in, 0…1e6.
    pub run_in_cycles: u32,
    /// Largest effect of the temperature on a specimen's force, in addition to that in the law, as a part of the force per °C,
    /// 0…0.1.
    pub temperature_slope: f64,
    /// Largest relative change of stiffness or energy in the run-in, 0.01…1, in addition to that by the temperature. A larger
    /// change is a fault: a mesh beds in by some 10 %, and one that keeps losing force is breaking.
    pub run_in_size: f64,
    /// Largest adaptation of k1, k3 and c to slow changes, as a part of each, 0…0.5; 0 switches adaptation off. It counts from the
    /// specimen's initial condition. The adaptation first finds that condition, after a start, another law, another block or
    /// [`crate::rig::RigController::clear_events`]: for as many cycles as the run-in takes, each coefficient changes by up to 0.1 %
    /// per cycle and by up to half of its value. A slow change of stiffness or energy by up to this setting is no fault. A law with
    /// a gap, a compliance or a delay is not adapted, and any law may stay unadapted with fewer than 27 ticks per cycle.
    pub follow: f64,
}

impl Default for HealthSettings {
    /// 5 %, one false alarm in a million cycles, a mesh that loses up to 0.4 % of its force per °C and 15 % in its run-in, and no
    /// adaptation.
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

/// [`HealthSettings`] in the units of the monitor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HealthConfig {
    pub(super) size: f32,
    /// Run length for one side of one statistic.
    pub(super) run_length: f32,
    pub(super) learning_cycles: u32,
    pub(super) run_in_cycles: u32,
    pub(super) temperature_slope: f32,
    pub(super) run_in_size: f32,
    pub(super) follow: f32,
}

impl HealthConfig {
    /// Whether adaptation is on.
    pub(crate) fn follows(&self) -> bool {
        self.follow > 0.0
    }
}

impl HealthSettings {
    /// Validates and converts the settings.
    ///
    /// # Errors
    /// A setting that is not finite or out of range.
    pub(crate) fn config(&self) -> Result<HealthConfig, ConfigError> {
        in_range("learning_cycles", f64::from(self.learning_cycles), 8.0, 1e3)?;
        in_range("run_in_cycles", f64::from(self.run_in_cycles), 0.0, 1e6)?;
        let cycles = in_range("false_alarm_cycles", self.false_alarm_cycles, 1e2, 1e9)?;
        Ok(HealthConfig {
            size: in_range("size", self.size, 0.01, 0.5)? as f32,
            // Both sides of each watched statistic.
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
    fn false_alarms_are_shared_among_both_sides_of_all_watched_statistics() {
        let settings = HealthSettings {
            false_alarm_cycles: 1e4,
            ..HealthSettings::default()
        };
        assert_eq!(settings.config().unwrap().run_length, 8e4);
    }
}
