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
const OCTAVES: usize = 32;
/// Segments of an octave.
const SEGMENTS: usize = 8;
/// Exponent of the lowest octave.
const LOWEST_EXPONENT: i32 = -20;
/// Smallest tabulated |v|, mm/s.
const LOWEST: f64 = 1.0 / (1u32 << -LOWEST_EXPONENT) as f64;
/// Its bits.
const LOWEST_BITS: u32 = ((127 + LOWEST_EXPONENT) as u32) << 23;
/// Bits of a float that tell the place within a segment.
const WITHIN: u32 = 20;

/// c·|v|^α·sgn v for one c and α, within 2.5e-7 of its own size: 4 KiB of cubics, eight to the octave, for |v| from
/// 2⁻²⁰ (9.5e-7) to 2¹² (4096) mm/s.
///
/// The table holds c·|v|^α and the sign is carried over. c·|v|^(α−1), to be multiplied by v, would have the sign for
/// nothing, but on a segment it is further from a cubic by (4 − α)/α, 6 to 26 times for the α of the paper, and would miss
/// by 1e-6.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerTable {
    segments: [[f32; 4]; OCTAVES * SEGMENTS],
    slope: f32,
    c: f32,
    alpha: f32,
}

impl PowerTable {
    /// * `c`: kN·(s/mm)^α, 0…1e9
    /// * `alpha`: 0…1
    ///
    /// Takes some thousand powers in f64: not for the hot path.
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(c: f64, alpha: f64) -> Result<Self, ConfigError> {
        let c = in_range("c", c, 0.0, limits::COEFFICIENT)?;
        let alpha = in_range("alpha", alpha, 0.0, 1.0)?;
        // An octave is the one below times 2^α: the cubics of |v| = 1…2 serve them all.
        let mut octave = [[0.0; 4]; SEGMENTS];
        for (segment, cubic) in octave.iter_mut().enumerate() {
            let half = 0.5 / SEGMENTS as f64;
            let centre = 1.0 + half * (2 * segment + 1) as f64;
            *cubic = chebyshev_cubic(|x| libm::pow(centre + half * x, alpha));
        }
        let mut segments = [[0.0; 4]; OCTAVES * SEGMENTS];
        for (index, cubics) in segments.chunks_exact_mut(SEGMENTS).enumerate() {
            let scale = c * libm::exp2(alpha * f64::from(LOWEST_EXPONENT + index as i32));
            for (to, from) in cubics.iter_mut().zip(&octave) {
                *to = from.map(|coefficient| (scale * coefficient) as f32);
            }
        }
        Ok(Self {
            segments,
            slope: (c * libm::pow(LOWEST, alpha - 1.0)) as f32,
            c: c as f32,
            alpha: alpha as f32,
        })
    }

    /// c·|v|^α·sgn v in kN for `v` mm/s.
    ///
    /// Below 2⁻²⁰ mm/s it is linear through 0, Coulomb friction (α = 0) included; above 4096 mm/s it is
    /// `c` times [`abs_pow`] of up to 1e6 mm/s ([`crate::limits::VELOCITY`]), which larger magnitudes, infinity and
    /// NaN count as. It is always finite.
    #[inline(always)]
    pub fn damping_force(&self, v: f32) -> f32 {
        let magnitude = v.to_bits() & 0x7fff_ffff;
        let sign = v.to_bits() ^ magnitude;
        let index = (magnitude.wrapping_sub(LOWEST_BITS) >> WITHIN) as usize;
        let Some([a0, a1, a2, a3]) = self.segments.get(index) else {
            return self.outside(magnitude, sign);
        };
        // −1…1 across the segment.
        let place = (magnitude & ((1 << WITHIN) - 1)) as i32 - (1 << (WITHIN - 1));
        let x = place as f32 * (1.0 / (1u32 << (WITHIN - 1)) as f32);
        let force = a0 + x * (a1 + x * (a2 + x * a3));
        f32::from_bits(force.to_bits() | sign)
    }

    #[cold]
    fn outside(&self, magnitude: u32, sign: u32) -> f32 {
        let limit = limits::VELOCITY as f32;
        let force = if magnitude < LOWEST_BITS {
            self.slope * f32::from_bits(magnitude)
        } else if magnitude < limit.to_bits() {
            self.c * abs_pow(f32::from_bits(magnitude), self.alpha)
        } else {
            self.c * abs_pow(limit, self.alpha)
        };
        f32::from_bits(force.to_bits() | sign)
    }
}

/// The cubic through `f` at Chebyshev's four nodes on −1…1, lowest power first.
fn chebyshev_cubic(f: impl Fn(f64) -> f64) -> [f64; 4] {
    // cos π/8 and cos 3π/8.
    const NODES: [f64; 2] = [0.923_879_532_511_286_7, 0.382_683_432_365_089_8];
    let mut a = [0.0; 4];
    for x in [NODES[0], NODES[1], -NODES[1], -NODES[0]] {
        let value = 0.5 * f(x);
        let square = x * x;
        let polynomials = [0.5, x, 2.0 * square - 1.0, x * (4.0 * square - 3.0)];
        for (a, t) in a.iter_mut().zip(polynomials) {
            *a += value * t;
        }
    }
    let [a0, a1, a2, a3] = a;
    [a0 - a2, a1 - 3.0 * a3, 2.0 * a2, 4.0 * a3]
}
