//! The float type over which the law and its effects are generic.
//!
//! Identification on the host runs them in `f64`, the firmware in `f32`. Both run the same code, so the fitted law is the law that
//! ships.

use crate::error::ConfigError;
use crate::limits;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// `f32` or `f64`, with the operations that the law and its effects need.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + 'static
{
    /// 0
    const ZERO: Self;
    /// 1
    const ONE: Self;

    /// The nearest value of this float; a value beyond its range becomes infinite.
    fn from_f64(value: f64) -> Self;
    /// The same value as `f64`, exactly.
    fn to_f64(self) -> f64;
    /// The nearest value of this float.
    fn from_i32(value: i32) -> Self;
    /// The integer towards 0; a value beyond `i32` gives the nearest `i32`, NaN gives 0.
    fn to_i32(self) -> i32;
    /// 8192·log₂ of a positive number, linear between powers of two and rounded down, which is 4096 per half octave. Unspecified
    /// for any other number.
    fn half_octaves(self) -> i32;
    /// Magnitude.
    fn abs(self) -> Self;
    /// 1 for a negative number and for −0, else 0.
    fn sign_bit(self) -> usize;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// 2ˣ for an x of at most 0, and 1 at 0. Finite for an x above 0 and for NaN. `f32` uses the short form in [`crate::power`],
    /// with an error within 2.1e-7 plus x's own rounding.
    fn exp2_of_negative(self) -> Self;
    /// `|self|^exponent` for an exponent in 0…1: 0 at 0 for every exponent, 0 included.
    ///
    /// `f32` uses the short form in [`crate::power`], `f64` that of libm or of the host.
    fn abs_pow(self, exponent: Self) -> Self;

    /// sin of `phase`, 2⁶⁴ per cycle. `f32` uses [`crate::sine::sin_cos`], `f64` that of libm or of the host.
    fn sine(phase: u64) -> Self;

    /// Clamped to `-limit..=limit`; NaN becomes 0.
    ///
    /// One comparison for a value within the limit; `min` and `max` are function calls on a Cortex-M.
    #[inline(always)]
    fn clamped(self, limit: Self) -> Self {
        if self.abs() <= limit {
            self
        } else if self > Self::ZERO {
            limit
        } else if self < Self::ZERO {
            -limit
        } else {
            Self::ZERO
        }
    }

    /// Clipped to `-limit..=limit` for a `limit` above 0, without a branch. NaN may become either end.
    fn clipped(self, limit: Self) -> Self;
}

/// Returns `value` if it is finite and within `low..=high`, else the error that names `field`. The comparison is in `R`, to which
/// the bounds are rounded, so that a target without f64 need not emulate it.
#[inline(always)]
pub(crate) fn in_range<R: Real>(
    field: &'static str,
    value: R,
    low: f64,
    high: f64,
) -> Result<R, ConfigError> {
    compare(field, value, R::from_f64(low), R::from_f64(high))
}

/// Returns `value` if it is 0…`high` and may be divided by: −0, which would give the other infinity, is out of range.
pub(crate) fn divisor<R: Real>(field: &'static str, value: R, high: f64) -> Result<R, ConfigError> {
    if value.sign_bit() == 1 {
        return Err(out_of_range(field, value, R::ZERO, R::from_f64(high)));
    }
    in_range(field, value, 0.0, high)
}

/// Returns `value` if it is a valid stiffness, damping or force coefficient.
pub(crate) fn coefficient<R: Real>(field: &'static str, value: R) -> Result<R, ConfigError> {
    in_range(field, value, -limits::COEFFICIENT, limits::COEFFICIENT)
}

/// [`in_range`] for bounds that are computed.
///
/// # Errors
/// As there.
// Not inlined, because there are many calls, and none on every tick.
#[inline(never)]
pub(crate) fn compare<R: Real>(
    field: &'static str,
    value: R,
    low: R,
    high: R,
) -> Result<R, ConfigError> {
    if value >= low && value <= high && value.is_finite() {
        Ok(value)
    } else {
        Err(out_of_range(field, value, low, high))
    }
}

// A separate function, so that a value in range does not pay for its stack.
#[cold]
#[inline(never)]
fn out_of_range<R: Real>(field: &'static str, value: R, low: R, high: R) -> ConfigError {
    if !value.is_finite() {
        return ConfigError::NonFinite(field);
    }
    ConfigError::OutOfRange {
        field,
        value: value.to_f64(),
        low: low.to_f64(),
        high: high.to_f64(),
    }
}

/// [`in_range`] for an `f32` in a `const`, where a trait's comparison cannot be called.
#[inline(never)]
pub(crate) const fn within(
    field: &'static str,
    value: f32,
    low: f32,
    high: f32,
) -> Result<(), ConfigError> {
    if value >= low && value <= high && value.is_finite() {
        Ok(())
    } else if value.is_finite() {
        Err(ConfigError::OutOfRange {
            field,
            value: value as f64,
            low: low as f64,
            high: high as f64,
        })
    } else {
        Err(ConfigError::NonFinite(field))
    }
}

/// √`x`, with a relative error within 1e-7: little code for a core without a square-root instruction. 0 for subnormal and negative
/// numbers; infinity and NaN stay as they are.
pub(crate) fn square_root(x: f32) -> f32 {
    if x < f32::MIN_POSITIVE {
        return 0.0;
    }
    if !x.is_finite() {
        return x;
    }
    // Half of the exponent, and a line for the mantissa, with an error within 3.5 %; each Newton step halves the square of the
    // error.
    let mut root = f32::from_bits((x.to_bits() >> 1) + 0x1fbd_1df5);
    for _ in 0..3 {
        root = 0.5 * (root + x / root);
    }
    root
}

impl Real for f32 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn from_i32(value: i32) -> Self {
        value as f32
    }
    #[inline(always)]
    fn to_i32(self) -> i32 {
        self as i32
    }
    #[inline(always)]
    fn half_octaves(self) -> i32 {
        // In the bits the mantissa follows the exponent.
        (self.to_bits() as i32).wrapping_sub(127 << 23) >> 10
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32::abs(self)
    }
    #[inline(always)]
    fn sign_bit(self) -> usize {
        (self.to_bits() >> 31) as usize
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }
    #[inline(always)]
    fn exp2_of_negative(self) -> Self {
        crate::power::exp2_of_negative(self)
    }
    #[inline(always)]
    fn abs_pow(self, exponent: Self) -> Self {
        crate::power::abs_pow(self, exponent)
    }
    #[inline(always)]
    fn sine(phase: u64) -> Self {
        crate::sine::sin_cos(phase).0
    }
    #[inline(always)]
    fn clipped(self, limit: Self) -> Self {
        // Positive floats compare like their bits.
        let bits = self.to_bits();
        let magnitude = (bits & 0x7fff_ffff).min(limit.to_bits());
        f32::from_bits((bits & 0x8000_0000) | magnitude)
    }
}

#[cfg(feature = "std")]
mod host {
    /// Takes two thirds of the time of `powf`, at the cost of one rounding of the exponent: 1e-14 of a force.
    pub fn pow(base: f64, exponent: f64) -> f64 {
        (exponent * base.ln()).exp()
    }

    pub fn exp2(x: f64) -> f64 {
        x.exp2()
    }

    pub fn sin(x: f64) -> f64 {
        x.sin()
    }
}

#[cfg(not(feature = "std"))]
use libm as host;

impl Real for f64 {
    const ZERO: Self = 0.0;
    const ONE: Self = 1.0;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn from_i32(value: i32) -> Self {
        f64::from(value)
    }
    #[inline(always)]
    fn to_i32(self) -> i32 {
        self as i32
    }
    #[inline(always)]
    fn half_octaves(self) -> i32 {
        ((self.to_bits() as i64).wrapping_sub(1023 << 52) >> 39) as i32
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn sign_bit(self) -> usize {
        (self.to_bits() >> 63) as usize
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
    fn exp2_of_negative(self) -> Self {
        host::exp2(self.min(0.0))
    }
    fn abs_pow(self, exponent: Self) -> Self {
        if self == 0.0 {
            0.0
        } else {
            host::pow(self.abs(), exponent)
        }
    }
    fn sine(phase: u64) -> Self {
        // From −½ cycle on, for accuracy near 0.
        host::sin(phase.cast_signed() as f64 * (core::f64::consts::TAU / (1u128 << 64) as f64))
    }
    #[inline(always)]
    fn clipped(self, limit: Self) -> Self {
        self.abs().min(limit).copysign(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_root_is_that_of_f64_to_the_last_digit_or_so() {
        let mut worst = 0.0f64;
        // Every 997th float: both parities of the exponent, and all of the mantissa's range.
        for bits in (f32::MIN_POSITIVE.to_bits()..f32::INFINITY.to_bits()).step_by(997) {
            let x = f32::from_bits(bits);
            let exact = libm::sqrt(f64::from(x));
            worst = worst.max(((f64::from(square_root(x)) - exact) / exact).abs());
        }
        assert!(worst < 1e-7, "{worst}");
        assert_eq!(square_root(1.0), 1.0);
        assert_eq!(square_root(f32::INFINITY), f32::INFINITY);
        assert!(square_root(f32::NAN).is_nan());
        for none in [0.0, -0.0, 1e-40, -1.0, f32::NEG_INFINITY] {
            assert_eq!(square_root(none), 0.0);
        }
    }
}
