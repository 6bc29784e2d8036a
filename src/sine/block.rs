//! A block keeps one amplitude for whole cycles, at one frequency or in a sweep.

use super::{AMPLITUDE_MAX, AMPLITUDE_MIN, FREQUENCY_MIN, TICK_RATE_MAX};
use crate::error::ConfigError;
use crate::real::in_range;

/// One block of a programme: whole cycles at one amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Block {
    pub(super) amplitude: f64,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) cycles: u32,
}

/// A [`Block`] as read, before it is validated.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename = "Block")]
struct Unchecked {
    amplitude: f64,
    from: f64,
    to: f64,
    cycles: u32,
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for Block {
    type Error = ConfigError;

    fn try_from(read: Unchecked) -> Result<Self, ConfigError> {
        Self::sweep(read.amplitude, read.from, read.to, read.cycles)
    }
}

impl Block {
    /// A sine.
    ///
    /// * `amplitude`: mm, [`AMPLITUDE_MIN`]…[`AMPLITUDE_MAX`]
    /// * `frequency`: Hz, [`FREQUENCY_MIN`] to a quarter of the programme's tick rate
    /// * `cycles`: at full amplitude, at least 1
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn sine(amplitude: f64, frequency: f64, cycles: u32) -> Result<Self, ConfigError> {
        Self::new(
            amplitude,
            ("frequency", frequency),
            ("frequency", frequency),
            cycles,
        )
    }

    /// A logarithmic sweep up or down: the frequency changes by the same factor in equal times. Units and ranges as in
    /// [`Block::sine`].
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn sweep(amplitude: f64, from: f64, to: f64, cycles: u32) -> Result<Self, ConfigError> {
        Self::new(amplitude, ("from", from), ("to", to), cycles)
    }

    fn new(
        amplitude: f64,
        from: (&'static str, f64),
        to: (&'static str, f64),
        cycles: u32,
    ) -> Result<Self, ConfigError> {
        let frequency = |(field, value)| in_range(field, value, FREQUENCY_MIN, TICK_RATE_MAX / 4.0);
        in_range("cycles", f64::from(cycles), 1.0, f64::from(u32::MAX))?;
        Ok(Self {
            amplitude: in_range("amplitude", amplitude, AMPLITUDE_MIN, AMPLITUDE_MAX)?,
            from: frequency(from)?,
            to: frequency(to)?,
            cycles,
        })
    }

    /// Amplitude, mm.
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }
    /// Frequency at the start, Hz.
    pub fn from(&self) -> f64 {
        self.from
    }
    /// Frequency at the end, Hz: that at the start unless the block is a sweep.
    pub fn to(&self) -> f64 {
        self.to
    }
    /// Cycles at full amplitude.
    pub fn cycles(&self) -> u32 {
        self.cycles
    }
}
