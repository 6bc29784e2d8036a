//! The temperature given to the law: the measured one, as far as it is plausible for a specimen.
//!
//! T ← T + clamp(shown − T, ±rate·h) per tick. A shown value that is not a number, or is implausible for the specimen and its
//! chamber, does not change T: an open thermocouple shows the end of its range. The rate is limited because a specimen warms
//! slowly. At rest T is the shown value.

use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::{Real as _, in_range};

/// Temperature until one is set, °C.
const USUAL: f32 = 20.0;
/// Range of the settings, °C.
const COLDEST: f64 = -273.0;
const HOTTEST: f64 = 2000.0;
/// Distance of a shown value from T at which it changed faster than a specimen warms, °C.
const FAR: f32 = 5.0;

/// Plausible range and rate of change of a temperature, validated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TemperatureConfig {
    /// Limits, °C.
    coldest: f32,
    hottest: f32,
    /// Largest change per tick, °C.
    step: f32,
}

impl TemperatureConfig {
    /// * `range`: coldest and hottest, °C
    /// * `rate`: °C/s
    pub(super) fn new(tick_rate: f64, range: [f64; 2], rate: f64) -> Result<Self, ConfigError> {
        let [coldest, hottest] = range;
        in_range("temperature_range", coldest, COLDEST, HOTTEST)?;
        in_range("temperature_range", hottest, coldest, HOTTEST)?;
        Ok(Self {
            coldest: coldest as f32,
            hottest: hottest as f32,
            step: (in_range("temperature_rate", rate, 1e-3, 1e3)? / tick_rate) as f32,
        })
    }
}

impl Fields for TemperatureConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        writer.words([self.coldest, self.hottest, self.step].map(f32::to_bits));
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [coldest, hottest, step] = reader.words()?.map(f32::from_bits);
        in_range("temperature_range", coldest, COLDEST, HOTTEST).ok()?;
        in_range("temperature_range", hottest, f64::from(coldest), HOTTEST).ok()?;
        in_range("temperature_rate", step, 1e-9, 1e3).ok()?;
        Some(Self {
            coldest,
            hottest,
            step,
        })
    }
}

/// The temperature given to the law.
#[derive(Clone, Copy, Debug)]
pub(super) struct Temperature {
    /// Last plausible value shown, and T.
    shown: f32,
    taken: f32,
    /// Implausible value shown, until it is reported.
    implausible: Option<f32>,
    /// It has been reported, and no shown value has been plausible since.
    reported: bool,
}

impl Default for Temperature {
    fn default() -> Self {
        Self {
            shown: USUAL,
            taken: USUAL,
            implausible: None,
            reported: false,
        }
    }
}

impl Temperature {
    /// Takes the measured temperature, °C. `moving`: T must not jump.
    pub(super) fn show(&mut self, config: &TemperatureConfig, shown: f32, moving: bool) {
        // NaN is in no range.
        let can_be = shown >= config.coldest && shown <= config.hottest;
        if can_be {
            self.shown = shown;
        }
        if can_be && !moving {
            self.taken = shown;
        }
        let implausible = !can_be || (shown - self.taken).abs() > FAR;
        if implausible && !self.reported {
            self.implausible = Some(shown);
        }
        self.reported = implausible;
    }

    /// Advances by one tick; returns T.
    #[inline(always)]
    pub(super) fn tick(&mut self, config: &TemperatureConfig) -> f32 {
        if self.shown != self.taken {
            self.go(config);
        }
        self.taken
    }

    #[inline(never)]
    fn go(&mut self, config: &TemperatureConfig) {
        self.taken += (self.shown - self.taken).clamped(config.step);
    }

    /// T, °C.
    pub(super) fn taken(&self) -> f32 {
        self.taken
    }

    /// An implausible value shown, once.
    #[inline(always)]
    pub(super) fn take_implausible(&mut self) -> Option<f32> {
        self.implausible.take()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config() -> TemperatureConfig {
        TemperatureConfig::new(100.0, [-40.0, 120.0], 2.0).unwrap()
    }

    fn after(temperature: &mut Temperature, shown: f32, ticks: u32) -> f32 {
        for _ in 0..ticks {
            temperature.show(&config(), shown, true);
            temperature.tick(&config());
        }
        temperature.taken()
    }

    /// 1372 °C is the end of the range of a type K thermocouple.
    #[test]
    fn an_implausible_temperature_changes_nothing_and_is_reported_once() {
        for shown in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1372.0, -80.0] {
            let mut temperature = Temperature::default();
            temperature.show(&config(), 30.0, false);
            assert_eq!(after(&mut temperature, shown, 10_000), 30.0);
            let implausible = temperature.take_implausible().unwrap();
            assert_eq!(implausible.to_bits(), shown.to_bits());
            after(&mut temperature, shown, 10);
            assert!(temperature.take_implausible().is_none());
            // Repaired, and broken once more.
            assert_eq!(after(&mut temperature, 30.0, 1), 30.0);
            after(&mut temperature, shown, 1);
            assert!(temperature.take_implausible().is_some());
        }
    }

    #[test]
    fn a_jump_is_followed_at_the_rate_of_a_specimen_and_reported() {
        let mut temperature = Temperature::default();
        assert!((after(&mut temperature, 50.0, 250) - 25.0).abs() < 1e-3);
        assert_eq!(temperature.take_implausible(), Some(50.0));
        assert!((after(&mut temperature, 50.0, 1250) - 50.0).abs() < 1e-3);
        assert!(temperature.take_implausible().is_none());
        // At the largest rate.
        let mut temperature = Temperature::default();
        for tick in 0..3000u16 {
            let shown = 20.0 + 0.02 * f32::from(tick);
            assert!((after(&mut temperature, shown, 1) - shown).abs() < 0.03);
        }
        assert!(temperature.take_implausible().is_none());
    }

    #[test]
    fn at_rest_it_is_the_shown_one() {
        let mut temperature = Temperature::default();
        temperature.show(&config(), 80.0, false);
        assert_eq!(temperature.taken(), 80.0);
        assert!(temperature.take_implausible().is_none());
    }
}
