//! Interference with the voltage of a channel.

use std::f64::consts::TAU;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use super::Active;
use crate::actuator::adc_code;

/// Interference with the voltage of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OnChannel {
    /// Multiplies it by `factor`, which is reached linearly over `ticks`; 0 for at once.
    Gain {
        /// 1 changes nothing, −1 reverses the sign.
        factor: f64,
        /// Ticks until it is reached.
        ticks: f64,
    },
    /// Adds this voltage.
    Offset(f64),
    /// Sets it to 0 V for `samples`, first at once and then at random, on average every `every` samples.
    DropOuts {
        /// Mean distance from one to the next, samples.
        every: f64,
        /// Length of each, samples.
        samples: u32,
    },
    /// An open input: replaces the signal by white noise of this RMS, V.
    Open(f64),
    /// Freezes it, with noise uniform over ± this, V.
    Frozen(f64),
    /// Adds noise uniform over ±`volts` for `samples` out of every `every`.
    Bursts {
        /// Largest voltage added.
        volts: f64,
        /// Distance from the beginning of one to that of the next, samples.
        every: u64,
        /// Length of each, samples.
        samples: u64,
    },
    /// Adds a sine.
    Hum {
        /// Its amplitude, V.
        volts: f64,
        /// Its frequency, Hz.
        frequency: f64,
    },
    /// A data bit of the converter is stuck.
    StuckBit {
        /// 0 for the least significant, up to 15.
        bit: u32,
        /// Its level.
        high: bool,
    },
    /// Sets one sample in `every` to 0 V.
    ZeroOneIn(u64),
    /// Keeps one sample in `every`, and sets the others to 0 V.
    GoodOneIn(u64),
    /// Clamps one sample in `every` to ±`volts`.
    ClampedOneIn {
        /// Largest voltage of such a sample.
        volts: f64,
        /// Distance from one to the next, samples.
        every: u64,
    },
    /// Adds this voltage to one sample.
    Spike(f64),
}

/// V at the converter's full scale, and codes per full scale.
const FULL_SCALE: f64 = 10.24;
const CODES: f64 = 32768.0;

impl OnChannel {
    /// Voltage that arrives for `volts` at `time` s.
    pub(super) fn act(
        self,
        volts: f64,
        time: f64,
        active: &mut Active,
        random: &mut ChaCha8Rng,
    ) -> f64 {
        let tick = active.ticks;
        match self {
            Self::Gain { factor, ticks } => {
                let part = if ticks > 0.0 {
                    (tick as f64 / ticks).min(1.0)
                } else {
                    1.0
                };
                volts * (1.0 + (factor - 1.0) * part)
            }
            Self::Offset(added) => volts + added,
            Self::DropOuts { every, samples } => {
                if active.left == 0 && (tick == 0 || random.random::<f64>() * every < 1.0) {
                    active.left = samples;
                }
                if active.left > 0 {
                    active.left -= 1;
                    0.0
                } else {
                    volts
                }
            }
            Self::Open(rms) => {
                let noise: f64 = StandardNormal.sample(random);
                rms * noise
            }
            Self::Frozen(dither) => {
                if tick == 0 {
                    active.held = volts;
                }
                active.held + dither * random.random_range(-1.0..=1.0)
            }
            Self::Bursts {
                volts: size,
                every,
                samples,
            } => {
                if tick % every < samples {
                    volts + size * random.random_range(-1.0..=1.0)
                } else {
                    volts
                }
            }
            Self::Hum {
                volts: size,
                frequency,
            } => volts + size * (TAU * frequency * time).sin(),
            Self::StuckBit { bit, high } => {
                let code = adc_code(volts);
                let mask = 1 << bit;
                let code = if high { code | mask } else { code & !mask };
                (f64::from(code) - CODES) / CODES * FULL_SCALE
            }
            Self::ZeroOneIn(every) if tick.is_multiple_of(every) => 0.0,
            Self::GoodOneIn(every) if !tick.is_multiple_of(every) => 0.0,
            Self::ClampedOneIn { volts: most, every } if tick.is_multiple_of(every) => {
                volts.clamp(-most, most)
            }
            Self::Spike(added) if tick == 0 => volts + added,
            Self::ZeroOneIn(_)
            | Self::GoodOneIn(_)
            | Self::ClampedOneIn { .. }
            | Self::Spike(_) => volts,
        }
    }
}
