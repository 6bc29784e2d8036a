//! Interference with temperature, output and clock.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use super::Active;

/// Interference with the temperature for the controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OnTemperature {
    /// It reads this, °C, finite or not.
    Reads(f32),
    /// It reads this many degrees more.
    Added(f32),
    /// Adds noise uniform over ± this many degrees.
    Noise(f32),
}

impl OnTemperature {
    pub(super) fn act(self, temperature: f32, random: &mut ChaCha8Rng) -> f32 {
        match self {
            Self::Reads(value) => value,
            Self::Added(more) => temperature + more,
            Self::Noise(size) => temperature + size * random.random_range(-1.0..=1.0),
        }
    }
}

/// Interference between the controller and the servo amplifier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OnOutput {
    /// The DAC has lost its supply: 0 V.
    BrownOut,
    /// The DAC accepts no new value.
    Holds,
    /// The DAC puts out this part of the voltage.
    Gain(f64),
    /// The enable line stays at this level at the servo.
    Enable(bool),
}

impl OnOutput {
    pub(super) fn act(self, (volts, enabled): (f64, bool), active: &mut Active) -> (f64, bool) {
        match self {
            Self::BrownOut => (0.0, enabled),
            Self::Holds => {
                if active.ticks == 0 {
                    active.held = volts;
                }
                (active.held, enabled)
            }
            Self::Gain(part) => (part * volts, enabled),
            Self::Enable(level) => (volts, level),
        }
    }
}

/// Interference with the timer that calls the controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnClock {
    /// Half of the ticks are missing.
    HalfRate,
    /// This many ticks are missing, once.
    Stall(u32),
    /// One tick is missing after every this many.
    Loses(u64),
}

impl OnClock {
    /// Number of ticks missing after the one with this number.
    pub(super) fn missed(self, tick: u64) -> u32 {
        match self {
            Self::HalfRate => 1,
            Self::Stall(ticks) if tick == 0 => ticks,
            Self::Stall(_) => 0,
            Self::Loses(every) => u32::from((tick + 1).is_multiple_of(every)),
        }
    }
}
