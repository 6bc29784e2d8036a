//! The float that the law and its effects are written over.
//!
//! Identification on the host runs them in `f64`, the firmware in `f32`: the same lines, so that what is fitted is
//! what ships.

use crate::error::ConfigError;
use crate::limits;
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// `f32` or `f64`, with the few operations that the law and its effects need.
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

    /// The nearest value of this float; what is beyond its range becomes infinite.
    fn from_f64(value: f64) -> Self;
    /// The same value as `f64`, exactly.
    fn to_f64(self) -> f64;
    /// The nearest value of this float.
    fn from_i32(value: i32) -> Self;
    /// The integer towards 0; the nearest `i32` of what is beyond, 0 of NaN.
    fn to_i32(self) -> i32;
    /// 8192·log₂ of a positive number by straight lines between powers of two, rounded down: 4096ths of half octaves; some
    /// number of any other.
    fn half_octaves(self) -> i32;
    /// Magnitude.
    fn abs(self) -> Self;
    /// 1 of what is below 0 and of −0, else 0.
    fn sign_bit(self) -> usize;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// 2ˣ of an x of at most 0, 1 at 0; of one above 0, and of NaN, it is finite. `f32` takes the short form of
    /// [`crate::power`], within 2.1e-7 and x's own rounding.
    fn exp2_of_negative(self) -> Self;
    /// `|self|^exponent` for an exponent in 0…1: 0 at 0 for every exponent, 0 included.
    ///
    /// `f32` takes the short form of [`crate::power`], `f64` libm's or the host's.
    fn abs_pow(self, exponent: Self) -> Self;

    /// sin of `phase`, 2⁶⁴ to the cycle. `f32` takes that of [`crate::sine::sin_cos`], `f64` libm's or the host's.
    fn sine(phase: u64) -> Self;

    /// Clamped to `-limit..=limit`; NaN becomes 0.
    ///
    /// One comparison where it is within; `min` and `max` are calls on a Cortex-M.
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

/// `value` if it is finite and within `low..=high`, else the error that names `field`. Compared as `R`, to which the
/// bounds are rounded: a target without f64 need not emulate it.
#[inline(always)]
pub(crate) fn in_range<R: Real>(
    field: &'static str,
    value: R,
    low: f64,
    high: f64,
) -> Result<R, ConfigError> {
    compare(field, value, R::from_f64(low), R::from_f64(high))
}

/// `value` if it can be a stiffness, damping or force coefficient.
pub(crate) fn coefficient<R: Real>(field: &'static str, value: R) -> Result<R, ConfigError> {
    in_range(field, value, -limits::COEFFICIENT, limits::COEFFICIENT)
}

// Not inlined: there are many, and none is called every tick.
#[inline(never)]
fn compare<R: Real>(field: &'static str, value: R, low: R, high: R) -> Result<R, ConfigError> {
    if value >= low && value <= high && value.is_finite() {
        Ok(value)
    } else {
        Err(out_of_range(field, value, low, high))
    }
}

// Apart: what it saves on the stack is no matter of what is in range.
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

/// [`in_range`] of an `f32` in a `const`, where no trait's comparison can be called.
pub(crate) const fn within(
    field: &'static str,
    value: f32,
    low: f32,
    high: f32,
) -> Result<(), ConfigError> {
    if !value.is_finite() {
        Err(ConfigError::NonFinite(field))
    } else if value < low || value > high {
        Err(ConfigError::OutOfRange {
            field,
            value: value as f64,
            low: low as f64,
            high: high as f64,
        })
    } else {
        Ok(())
    }
}

/// √`x`, within 1e-7 of its own size: what a core without the square root of its own can do in a few instructions' code.
/// 0 for subnormals and below 0, infinity and NaN as they are.
pub(crate) fn square_root(x: f32) -> f32 {
    if x < f32::MIN_POSITIVE {
        return 0.0;
    }
    if !x.is_finite() {
        return x;
    }
    // Half of the exponent, and a line for the mantissa, within 3.5 %; Newton's steps square that and halve it.
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
        // The mantissa follows the exponent.
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
        // Positive floats compare as their bits do.
        let bits = self.to_bits();
        let magnitude = (bits & 0x7fff_ffff).min(limit.to_bits());
        f32::from_bits((bits & 0x8000_0000) | magnitude)
    }
}

#[cfg(feature = "std")]
mod host {
    /// In two thirds of the time of `powf`, by a rounding unit of the exponent: 1e-14 of a force.
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
        // From −½ cycle, for the digits near 0.
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
        // Every 997th float: both parities of the exponent, all of the mantissa.
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
