//! |v|^α for the hot path: a short form for any α, and a table for one that stays.
//!
//! Both work on the float's bits, v = 2ᵉ·m, and call nothing.

use crate::error::ConfigError;
use crate::limits;
use crate::real::in_range;

/// √½'s bits: where the mantissa's range m = √½…√2 begins.
const SQRT_HALF: u32 = 0x3f35_04f3;
/// 2⁻¹²⁶'s bits: the smallest magnitude that is not treated as 0.
const SMALLEST: u32 = 0x0080_0000;
/// 2¹²⁷'s bits: the largest magnitude that is not treated as smaller.
const LARGEST: u32 = 0x7f00_0000;
/// Added to a small float and taken off again it leaves the nearest integer, and its last bits are that integer's.
const ROUND: f32 = 12_582_912.0;

/// First coefficient of q below.
#[expect(clippy::approx_constant, reason = "the fit's, which is not ln 2")]
const FIRST: f32 = 0.693_147;

/// `|v|^alpha` for an `alpha` of 0…1, within 3e-7 of its own size for |v| from 2⁻¹²⁶ to 2¹²⁷.
///
/// At v = 0 it is 0 for every α above 0, and 1 for α = 0. Subnormal magnitudes count as 0; those above 2¹²⁷ ≈ 1.7e38,
/// infinity and NaN as 2¹²⁷, so that the result is always finite.
///
/// 2^(α·(e + log₂ m)): α is cut into 16 bits and a rest, so that α·e less its integer part is exact and an exponent of
/// −126 costs no digits of the fraction.
#[inline(always)]
pub fn abs_pow(v: f32, alpha: f32) -> f32 {
    let bits = v.to_bits() & 0x7fff_ffff;
    if bits < SMALLEST {
        return if alpha == 0.0 { 1.0 } else { 0.0 };
    }
    let bits = if bits > LARGEST { LARGEST } else { bits };
    let above = bits.wrapping_sub(SQRT_HALF) as i32;
    let exponent = (above >> 23) as f32;
    let mantissa = f32::from_bits((above as u32 & 0x007f_ffff).wrapping_add(SQRT_HALF));

    // log₂ m = 2/ln 2·atanh s with s = (m − 1)/(m + 1): minimax in s² for the smallest relative error, 1.2e-7.
    let s = (mantissa - 1.0) / (mantissa + 1.0);
    let z = s * s;
    let logarithm = s * (2.885_390_5 + z * (0.961_588_3 + z * 0.595_780_7));

    let upper = f32::from_bits(alpha.to_bits() & 0xffff_ff00);
    let whole = upper * exponent;
    let rest = (alpha - upper) * exponent + alpha * logarithm;
    let rounded = (whole + rest) + ROUND;
    let fraction = (whole - (rounded - ROUND)) + rest;

    // 2^r for r = −½…½ = 1 + r·q(r): q minimax for the smallest relative error of the power, 9.1e-8; exact at r = 0.
    let q = 0.009_671_513 + fraction * 0.001_326_473;
    let q = FIRST + fraction * (0.240_222_42 + fraction * (0.055_507_336 + fraction * q));
    let power = 1.0 + fraction * q;
    // The integer part goes into the exponent.
    f32::from_bits(power.to_bits().wrapping_add(rounded.to_bits() << 23))
}

/// Octaves that a [`PowerTable`] covers.
pub const OCTAVES: usize = 32;
/// Segments of an octave.
pub const SEGMENTS: usize = 8;
/// Rows of a [`PowerTable`].
pub const ROWS: usize = OCTAVES * SEGMENTS;
/// Exponent of the lowest octave.
const LOWEST_EXPONENT: i32 = -20;
/// Bits of a float that tell the place within a segment.
const WITHIN: u32 = 20;
/// Segments of all floats below the lowest octave.
const BELOW: i32 = (127 + LOWEST_EXPONENT) << (23 - WITHIN);

/// One segment of c·|v|^α·sgn v. With t the segment's lower edge, signed as v, and x = v − t,
///
/// F = t·(b0 + b2·x²) + x·(a1 + a3·x²),
///
/// in the order b0, a1, b2, a3. It is the cubic in x, odd in v: the sign is carried for nothing.
pub type Segment = [f32; 4];

/// What a [`PowerTable`] is filled from, 256 bytes for one c and α.
///
/// An octave is the one below times 2^α, so that the segments of |v| = 1…2 serve them all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerSeed {
    octave: [Segment; SEGMENTS],
    scale: [f32; OCTAVES],
}

impl PowerSeed {
    /// Of no damping.
    pub(crate) const EMPTY: Self = Self {
        octave: [[0.0; 4]; SEGMENTS],
        scale: [0.0; OCTAVES],
    };

    /// * `c`: kN·(s/mm)^α, 0…1e9
    /// * `alpha`: 0…1
    ///
    /// Takes 64 powers in f64: not for the hot path.
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(c: f64, alpha: f64) -> Result<Self, ConfigError> {
        Ok(Self::from_valid(
            in_range("c", c, 0.0, limits::COEFFICIENT)?,
            in_range("alpha", alpha, 0.0, 1.0)?,
        ))
    }

    /// From what is known to be in range.
    pub(crate) fn from_valid(c: f64, alpha: f64) -> Self {
        let mut octave = [[0.0; 4]; SEGMENTS];
        for (index, segment) in octave.iter_mut().enumerate() {
            let width = 1.0 / SEGMENTS as f64;
            let edge = 1.0 + width * index as f64;
            let [a0, a1, a2, a3] = chebyshev_cubic(width, |x| libm::pow(edge + x, alpha));
            *segment = [a0 / edge, a1, a2 / edge, a3].map(|value| value as f32);
        }
        let mut scale = [0.0; OCTAVES];
        for (exponent, scale) in (LOWEST_EXPONENT..).zip(&mut scale) {
            *scale = (c * libm::exp2((alpha - 1.0) * f64::from(exponent))) as f32;
        }
        Self { octave, scale }
    }

    /// From what [`PowerSeed::octave`] and [`PowerSeed::scale`] gave.
    ///
    /// # Errors
    /// `octave` or `scale` not finite, or beyond what any c and α in their ranges give.
    pub fn from_parts(
        octave: [Segment; SEGMENTS],
        scale: [f32; OCTAVES],
    ) -> Result<Self, ConfigError> {
        for value in octave.as_flattened() {
            in_range("octave", *value, -2.0, 2.0)?;
        }
        for value in scale {
            let most = limits::COEFFICIENT * (1u32 << -LOWEST_EXPONENT) as f64;
            in_range("scale", value, 0.0, 1.001 * most)?;
        }
        Ok(Self { octave, scale })
    }

    /// The segments of |v|^α over |v| = 1…2.
    pub fn octave(&self) -> &[Segment; SEGMENTS] {
        &self.octave
    }

    /// c·2^(e·(α − 1)) for the octaves from 2ᵉ, e = −20…11: what makes [`PowerSeed::octave`] theirs.
    pub fn scale(&self) -> &[f32; OCTAVES] {
        &self.scale
    }

    /// Row `row` of the table; whole turns of [`ROWS`] fall off.
    #[inline(always)]
    fn row(&self, row: usize) -> Segment {
        let row = row % ROWS;
        // Below and above what is tabulated the law is linear: below, to the edge of the first segment.
        let linear = row == 0 || row == ROWS - 1;
        let segment = if row == 0 { 1 } else { row };
        let octave = segment / SEGMENTS;
        let scale = self.scale[octave];
        let [b0, a1, b2, a3] = self.octave[segment % SEGMENTS].map(|value| scale * value);
        if linear {
            return [b0, b0, 0.0, 0.0];
        }
        // 2^(−2e), for x².
        let square = f32::from_bits(((127 - 2 * LOWEST_EXPONENT) as u32 - 2 * octave as u32) << 23);
        [b0, a1, square * b2, square * a3]
    }
}

/// c·|v|^α·sgn v for one c and α, within 5e-7 of its own size: 4 KiB of cubics, eight to the octave, for |v| from
/// 1.07e-6 (1.125·2⁻²⁰) to 3840 mm/s. Below and above it is linear, c·|v|^α of the edge times v over the edge.
///
/// The cubics are of c·|v|^α. Those of c·|v|^(α−1), to be multiplied by v, would have the sign for nothing too, but on a
/// segment it is further from a cubic by (4 − α)/α, 6 to 26 times for the α of the paper, and would miss by 1e-6.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerTable {
    rows: [Segment; ROWS],
}

impl PowerTable {
    /// Filled from `seed`.
    pub fn new(seed: &PowerSeed) -> Self {
        let mut new = Self::empty();
        for row in 0..ROWS {
            new.fill_row(seed, row);
        }
        new
    }

    /// 0 for every velocity, until rows are filled.
    pub const fn empty() -> Self {
        Self {
            rows: [[0.0; 4]; ROWS],
        }
    }

    /// Row `row` for the c and α of `seed`, a handful of multiplications; whole turns of [`ROWS`] fall off.
    #[inline(always)]
    pub fn fill_row(&mut self, seed: &PowerSeed, row: usize) {
        self.rows[row % ROWS] = seed.row(row);
    }

    /// The row that serves `v` mm/s.
    #[inline(always)]
    pub fn row_of(v: f32) -> usize {
        let segment = ((v.to_bits() << 1) >> (WITHIN + 1)) as i32 - BELOW;
        segment.clamp(0, ROWS as i32 - 1) as usize % ROWS
    }

    /// c·|v|^α·sgn v in kN for `v` mm/s within ±[`limits::VELOCITY`]; beyond, and for NaN, it may be infinite or NaN.
    ///
    /// 0 at v = 0 for every α, Coulomb friction (α = 0) included.
    #[inline(always)]
    pub fn damping_force(&self, v: f32) -> f32 {
        let [b0, a1, b2, a3] = self.rows[Self::row_of(v)];
        let t = f32::from_bits(v.to_bits() & !((1 << WITHIN) - 1));
        let x = v - t;
        let square = x * x;
        t * (b0 + b2 * square) + x * (a1 + a3 * square)
    }
}

/// The cubic through `f` at Chebyshev's four nodes on 0…`width`, lowest power first.
fn chebyshev_cubic(width: f64, f: impl Fn(f64) -> f64) -> [f64; 4] {
    // cos π/8 and cos 3π/8.
    const NODES: [f64; 2] = [0.923_879_532_511_286_7, 0.382_683_432_365_089_8];
    let half = 0.5 * width;
    let mut a = [0.0; 4];
    for x in [NODES[0], NODES[1], -NODES[1], -NODES[0]] {
        let value = 0.5 * f(half + half * x);
        let square = x * x;
        let polynomials = [0.5, x, 2.0 * square - 1.0, x * (4.0 * square - 3.0)];
        for (a, t) in a.iter_mut().zip(polynomials) {
            *a += value * t;
        }
    }
    // In x from the middle in halves of the width, and then from the beginning.
    let [a0, a1, a2, a3] = [a[0] - a[2], a[1] - 3.0 * a[3], 2.0 * a[2], 4.0 * a[3]];
    [
        a0 - a1 + a2 - a3,
        (a1 - 2.0 * a2 + 3.0 * a3) / half,
        (a2 - 3.0 * a3) / (half * half),
        a3 / (half * half * half),
    ]
}
