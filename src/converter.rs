//! 16-bit offset-binary converter codes and the quantities they represent.

use crate::error::ConfigError;
use crate::frame::{Fields, Reader, Writer};
use crate::real::in_range;

/// Code of zero volts.
pub const MIDSCALE: u16 = 0x8000;

/// Largest full scale and largest zero, in the channel's unit.
pub const SCALE_LIMIT: f64 = 1e6;

/// value = full_scale·(code − 32768)/32768 − zero.
///
/// The unit is the channel's own: mm, kN.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Unchecked"))]
pub struct Scale {
    zero: f32,
    step: f32,
    inverse_step: f32,
}

/// A [`Scale`] as read, before it is validated.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(rename = "Scale")]
struct Unchecked {
    zero: f32,
    step: f32,
    inverse_step: f32,
}

#[cfg(feature = "serde")]
impl TryFrom<Unchecked> for Scale {
    type Error = ConfigError;

    fn try_from(read: Unchecked) -> Result<Self, ConfigError> {
        let full_scale = f64::from(read.step) * f64::from(MIDSCALE);
        let scale = Self::new(full_scale, f64::from(read.zero))?;
        // The full scale was rounded to the step's f32, so the two inverses differ by up to three roundings, 1.8e-7.
        let inverse = f64::from(scale.inverse_step);
        let ends = [inverse * (1.0 - 2e-7), inverse * (1.0 + 2e-7)];
        let [low, high] = if inverse > 0.0 {
            ends
        } else {
            [ends[1], ends[0]]
        };
        in_range("inverse_step", f64::from(read.inverse_step), low, high)?;
        Ok(Self {
            inverse_step: read.inverse_step,
            ..scale
        })
    }
}

impl Fields for Scale {
    fn write(&self, writer: &mut Writer<'_>) {
        let floats = [self.full_scale(), self.zero, self.step, self.inverse_step];
        writer.words(floats.map(f32::to_bits));
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        // The full scale follows from the step.
        let [_, zero, step, inverse_step] = reader.words()?.map(f32::from_bits);
        let midscale = f64::from(MIDSCALE);
        let most = SCALE_LIMIT / midscale;
        in_range("full_scale", step.abs(), 1e-6 / midscale, most).ok()?;
        in_range("zero", zero, -SCALE_LIMIT, SCALE_LIMIT).ok()?;
        // Each of the two numbers was rounded, and so is their product.
        in_range("inverse_step", step * inverse_step, 1.0 - 3e-7, 1.0 + 3e-7).ok()?;
        Some(Self {
            zero,
            step,
            inverse_step,
        })
    }
}

impl Scale {
    /// * `full_scale`: the quantity at the converter's positive full scale, ±1e-6…±1e6. Negative where the sensor or
    ///   the amplifier inverts.
    /// * `zero`: reading of the channel when the quantity is 0, −1e6…1e6
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(full_scale: f64, zero: f64) -> Result<Self, ConfigError> {
        let full_scale = in_range("full_scale", full_scale, -SCALE_LIMIT, SCALE_LIMIT)?;
        in_range("full_scale", full_scale.abs(), 1e-6, SCALE_LIMIT)?;
        let zero = in_range("zero", zero, -SCALE_LIMIT, SCALE_LIMIT)?;
        Ok(Self {
            zero: zero as f32,
            step: (full_scale / f64::from(MIDSCALE)) as f32,
            inverse_step: (f64::from(MIDSCALE) / full_scale) as f32,
        })
    }

    /// The quantity at the converter's positive full scale.
    pub fn full_scale(&self) -> f32 {
        // A power of two, so nothing is rounded.
        self.step * f32::from(MIDSCALE)
    }

    /// The quantity that one code step represents.
    pub fn step(&self) -> f32 {
        self.step
    }

    /// Quantities of the first and the last code, the smaller one first.
    pub(crate) fn ends(&self) -> [f32; 2] {
        let [first, last] = [0, u16::MAX].map(|code| self.decode(code).value);
        if first < last {
            [first, last]
        } else {
            [last, first]
        }
    }

    /// Quantity that an ADC's code represents.
    #[inline(always)]
    pub fn decode(&self, code: u16) -> Sample {
        let count = i32::from(code) - i32::from(MIDSCALE);
        Sample {
            value: count as f32 * self.step - self.zero,
            code,
        }
    }

    /// Quantity that a code of an ADC of `BITS` bits represents, 1…16, offset binary over the same range. The sample holds the code
    /// scaled to 16 bits. The last code stays distinct, so that [`Sample::clipped`] detects either end.
    #[inline(always)]
    pub fn decode_narrow<const BITS: u32>(&self, code: u16) -> Sample {
        const { assert!(BITS >= 1 && BITS <= 16, "an ADC has 1 to 16 bits") };
        self.decode_bits(BITS, code)
    }

    /// [`Self::decode_narrow`] for an ADC whose bits are known only when the firmware runs: 1…16; any other number counts as 16.
    #[inline(always)]
    pub fn decode_bits(&self, bits: u32, code: u16) -> Sample {
        let shift = match bits {
            1..=16 => 16 - bits,
            _ => 0,
        };
        let last = u16::MAX >> shift;
        let sample = self.decode(code.min(last) << shift);
        Sample {
            code: if code >= last { u16::MAX } else { sample.code },
            ..sample
        }
    }

    /// The nearest code to write to a DAC. Beyond the range it is the end of the range; NaN gives [`MIDSCALE`].
    #[inline(always)]
    pub fn encode(&self, value: f32) -> Code {
        // The centre of code 0's step is at 0.5, so truncation rounds to the nearest code.
        let position = (value + self.zero) * self.inverse_step + (f32::from(MIDSCALE) + 0.5);
        if position >= 0.0 {
            // A cast saturates, also for infinity.
            let nearest = position as u32;
            Code {
                code: u16::try_from(nearest).unwrap_or(u16::MAX),
                clipped: nearest > u32::from(u16::MAX),
            }
        } else {
            let code = if position.is_nan() { MIDSCALE } else { 0 };
            Code {
                code,
                clipped: true,
            }
        }
    }
}

/// One channel's reading.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sample {
    /// In the channel's unit.
    pub value: f32,
    /// Offset binary.
    pub code: u16,
}

impl Default for Sample {
    /// 0 V, of a channel whose zero is 0.
    fn default() -> Self {
        Self {
            value: 0.0,
            code: MIDSCALE,
        }
    }
}

impl Sample {
    /// The code is the first or the last one, so the quantity may lie beyond the range.
    #[inline(always)]
    pub fn clipped(&self) -> bool {
        // One comparison covers both.
        self.code.wrapping_add(1) <= 1
    }
}

/// A code for a DAC.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Code {
    /// Offset binary.
    pub code: u16,
    /// The requested quantity lies beyond the range, or is NaN.
    pub clipped: bool,
}
