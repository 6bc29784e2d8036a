//! |v|^α for the hot path: a direct form for any α, and a table for a fixed α.
//!
//! Both work on the bits of the float, v = 2ᵉ·m, and call no function. Integers that represent fractions are named by their unit:
//! Q23 counts 2⁻²³.

use crate::error::ConfigError;
use crate::law::Law;
use crate::limits;
use crate::real::{in_range, within};

/// Bits of ¾, where the mantissa's range m = ¾…1½ begins.
const MANTISSA_LOW: u32 = 0x3f40_0000;
/// Bits of 1.
const ONE: u32 = 0x3f80_0000;
/// Bits of 2⁻¹²⁶, the smallest magnitude that is not treated as 0.
const SMALLEST: u32 = 0x0080_0000;
/// The bits of a float that are its mantissa, which are also those of a Q23 that are its fraction.
const FRACTION: u32 = 0x007f_ffff;

/// `|v|^alpha` for an `alpha` of 0…1, with a relative error within 4e-7 for |v| from 2⁻¹²⁶ to 2¹²⁷.
///
/// At v = 0 it is 0 for every α, 0 included. Subnormal magnitudes count as 0. For magnitudes above 2¹²⁷ ≈ 1.7e38, infinity and NaN
/// it is finite and at least the value at 2¹²⁷.
///
/// 2^(α·(e + log₂ m)), with the exponent in integers, so that an e of −126 costs no digits of the fraction.
#[inline(always)]
pub const fn abs_pow(v: f32, alpha: f32) -> f32 {
    let bits = v.to_bits() & 0x7fff_ffff;
    let exponent = bits.wrapping_sub(MANTISSA_LOW) & !FRACTION;
    let mantissa = f32::from_bits(bits.wrapping_sub(exponent));

    // log₂ m = 2/ln 2·atanh s with s = (m − 1)/(m + 1): minimax in s² for the smallest error, 8.9e-8. In Q24, with the sign
    // inverted twice to save one constant.
    let s = (1.0 - mantissa) / (1.0 + mantissa);
    let z = s * s;
    let logarithm = s * (-48_408_864.0 + z * (-16_126_021.0 + z * -10_186_557.0));
    let exponent = exponent as i32;
    let logarithm = (logarithm as i32).saturating_add(exponent.saturating_add(exponent));

    // α as a Q31, so that the upper half of the product is a Q23. A value of 1 becomes 1 − 2⁻³¹.
    let alpha = (alpha * (1u32 << 31) as f32) as i32;
    let power = ((alpha as i64 * logarithm as i64) >> 32) as i32;
    let scale = if bits < SMALLEST {
        0
    } else {
        exponent_bits(power)
    };
    exp2_of_fraction(power) * f32::from_bits(scale)
}

/// 2^`x` for an `x` of at most 0, with an error within 2.1e-7 plus the effect of x·2⁻²⁴; 0 below −127. Finite for an x above 0, and
/// 1 for NaN.
#[inline(always)]
pub(crate) fn exp2_of_negative(x: f32) -> f32 {
    let exponent = (x * (FRACTION + 1) as f32) as i32;
    // Below −127 the bits would be those of a negative number.
    let scale = (exponent_bits(exponent) as i32).max(0) as u32;
    exp2_of_fraction(exponent) * f32::from_bits(scale)
}

/// Bits of 2ⁿ for the integer part n of a Q23.
#[inline(always)]
const fn exponent_bits(exponent: i32) -> u32 {
    (exponent as u32 & !FRACTION).wrapping_add(ONE)
}

/// 2^(r + 2⁻²⁴) for the fraction r = 0…1 of a Q23. The 2⁻²⁴ are the mean that rounding down removed.
///
/// 1 + r·q(r), r in units of 2⁻²³: minimax for the smallest relative error, 7.8e-8.
#[inline(always)]
const fn exp2_of_fraction(exponent: i32) -> f32 {
    let fraction = (exponent as u32 & FRACTION) as f32;
    let q = 1.817_702_2e-30 + fraction * 4.509_714e-38;
    let q = 3.412_853_2e-15 + fraction * (9.455_48e-23 + fraction * q);
    1.0 + fraction * (8.263_02e-8 + fraction * q)
}

/// Octaves that a [`PowerTable`] covers.
pub const OCTAVES: usize = 32;
/// Segments of an octave.
pub const SEGMENTS: usize = 8;
/// Rows of a [`PowerTable`].
pub const ROWS: usize = OCTAVES * SEGMENTS;
/// Exponent of the lowest octave.
const LOWEST_EXPONENT: i32 = -21;
/// Bits of a float that give the position within a segment.
const WITHIN: u32 = 20;
/// Bits of the lowest octave's smallest float.
const LOWEST_BITS: u32 = ((127 + LOWEST_EXPONENT) as u32) << 23;

/// Largest magnitude of a number in [`PowerSeed::octave`]: for any α in 0…1 the numbers are below it. It also bounds the rounding
/// of a segment's sum, to 1e-5.
const OCTAVE_MOST: f32 = 2.0;
/// Scales that are checked together: as much work as one segment.
const TOGETHER: usize = 4;
/// Parts of a seed that are read and checked one by one: a segment, or [`TOGETHER`] scales.
const PARTS: usize = SEGMENTS + OCTAVES / TOGETHER;
/// Relative difference of a seed from the power that [`abs_pow`] gives. Derived: the 4e-7 of the seed's segments and of `abs_pow`,
/// 3e-7 for the rounding of the sum, and twice that as a margin for the powers of another host.
const AGREEMENT: f32 = 2e-6;

/// One segment of c·|v|^α·sgn v. With t the segment's lower edge, signed as v,
///
/// F = t·(p0 + |v|·(p1 + |v|·(p2 + |v|·p3))),
///
/// in this order. It is c·|v|^α as a cubic in |v|, and t gives the sign.
pub type Segment = [f32; 4];

/// The seed from which a [`PowerTable`] is filled, 264 bytes for one c and α.
///
/// Each octave is the one below times 2^α, so that the segments of |v| = 1…2 serve all of them. Every seed agrees with its c and α:
/// its numbers are computed from them, or compared with them where they come from a host.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerSeed {
    c: f32,
    alpha: f32,
    octave: [Segment; SEGMENTS],
    scale: [f32; OCTAVES],
}

impl PowerSeed {
    /// Seed without damping.
    pub(crate) const EMPTY: Self = Self {
        c: 0.0,
        alpha: 0.0,
        octave: [[0.0; 4]; SEGMENTS],
        scale: [0.0; OCTAVES],
    };

    /// * `c`: kN·(s/mm)^α, 0…1e9
    /// * `alpha`: 0…1
    ///
    /// Computes 64 powers in f64: not for the hot path.
    ///
    /// # Errors
    /// The field that is not finite or out of range.
    pub fn new(c: f64, alpha: f64) -> Result<Self, ConfigError> {
        Ok(Self::from_valid(
            in_range("c", c, 0.0, limits::COEFFICIENT)?,
            in_range("alpha", alpha, 0.0, 1.0)?,
        ))
    }

    /// From values that are known to be in range.
    pub(crate) fn from_valid(c: f64, alpha: f64) -> Self {
        let mut octave = [[0.0; 4]; SEGMENTS];
        for (index, segment) in octave.iter_mut().enumerate() {
            let half = 0.5 / SEGMENTS as f64;
            let centre = 1.0 + half * (2 * index + 1) as f64;
            let edge = centre - half;
            *segment = chebyshev_cubic(centre, half, |x| libm::pow(x, alpha))
                .map(|coefficient| (coefficient / edge) as f32);
        }
        let mut scale = [0.0; OCTAVES];
        for (exponent, scale) in (LOWEST_EXPONENT..).zip(&mut scale) {
            *scale = (c * libm::exp2((alpha - 1.0) * f64::from(exponent))) as f32;
        }
        Self {
            c: c as f32,
            alpha: alpha as f32,
            octave,
            scale,
        }
    }

    /// From the numbers of [`PowerSeed::octave`] and [`PowerSeed::scale`], computed on a host for this `c` and `alpha`. For firmware
    /// that knows its law, which then links no power in f64. In a `const` the compiler compares them.
    ///
    /// # Errors
    /// `c` or `alpha` out of range, as for [`PowerSeed::new`]; a number that is not finite, or not that of `c` and `alpha`.
    pub const fn from_parts(
        c: f32,
        alpha: f32,
        octave: [Segment; SEGMENTS],
        scale: [f32; OCTAVES],
    ) -> Result<Self, ConfigError> {
        if let Err(error) = within("c", c, 0.0, limits::COEFFICIENT as f32) {
            return Err(error);
        }
        if let Err(error) = within("alpha", alpha, 0.0, 1.0) {
            return Err(error);
        }
        let new = Self {
            c,
            alpha,
            octave,
            scale,
        };
        let mut part = 0;
        while part < PARTS {
            if let Err(error) = new.check_part(part) {
                return Err(error);
            }
            part += 1;
        }
        Ok(new)
    }

    /// Begins a seed of `law` whose numbers are read.
    pub(crate) fn begin(&mut self, law: &Law<f32>) {
        self.c = law.c();
        self.alpha = law.alpha();
    }

    /// Reads the numbers of a part, those of [`PowerSeed::octave`] before those of [`PowerSeed::scale`], each by `next`, and compares
    /// them with c and α. Returns whether this was the last part.
    ///
    /// # Errors
    /// The error of `next`; a number that is not that of c and α.
    #[inline(never)]
    pub(crate) fn read_part<E: From<ConfigError>>(
        &mut self,
        part: usize,
        mut next: impl FnMut() -> Result<f32, E>,
    ) -> Result<bool, E> {
        let numbers = match part.checked_sub(SEGMENTS) {
            None => self.octave.get_mut(part).map(<[f32; 4]>::as_mut_slice),
            Some(group) => self.scale.chunks_exact_mut(TOGETHER).nth(group),
        };
        for number in numbers.unwrap_or_default() {
            *number = next()?;
        }
        self.check_part(part)?;
        Ok(part + 1 >= PARTS)
    }

    /// Compares a part with c and α.
    ///
    /// # Errors
    /// A number that is not finite or does not agree.
    const fn check_part(&self, part: usize) -> Result<(), ConfigError> {
        if part < SEGMENTS {
            return self.check_segment(part);
        }
        let first = TOGETHER * (part - SEGMENTS);
        let mut place = first;
        while place < first + TOGETHER {
            if let Err(error) = self.check_scale(place) {
                return Err(error);
            }
            place += 1;
        }
        Ok(())
    }

    /// Compares a segment with |v|^α at both of its ends and at its thirds. A cubic that agrees at four points agrees between them,
    /// within 1.7 times as much.
    const fn check_segment(&self, index: usize) -> Result<(), ConfigError> {
        let [p0, p1, p2, p3] = self.octave[index % SEGMENTS];
        let mut place = 0;
        while place < 4 {
            let number = self.octave[index % SEGMENTS][place];
            if let Err(error) = within("octave", number, -OCTAVE_MOST, OCTAVE_MOST) {
                return Err(error);
            }
            place += 1;
        }
        let edge = 1.0 + index as f32 * (1.0 / SEGMENTS as f32);
        let mut third = 0;
        while third < 4 {
            let v = edge + third as f32 * (1.0 / (3 * SEGMENTS) as f32);
            let found = edge * (p0 + v * (p1 + v * (p2 + v * p3)));
            if let Err(error) = agrees("octave", found, abs_pow(v, self.alpha)) {
                return Err(error);
            }
            third += 1;
        }
        Ok(())
    }

    /// Compares a scale with c·2^(e·(α − 1)), as c·(2ᵉ)^α/2ᵉ: the powers of two are exact.
    const fn check_scale(&self, place: usize) -> Result<(), ConfigError> {
        let exponent = (place as i32 + LOWEST_EXPONENT) << 23;
        let [octave, unit] = [
            f32::from_bits((ONE as i32 + exponent) as u32),
            f32::from_bits((ONE as i32 - exponent) as u32),
        ];
        let expected = self.c * abs_pow(octave, self.alpha) * unit;
        agrees("scale", self.scale[place % OCTAVES], expected)
    }

    /// c, kN·(s/mm)^α.
    pub fn c(&self) -> f32 {
        self.c
    }

    /// α
    pub fn alpha(&self) -> f32 {
        self.alpha
    }

    /// The segments of |v|^α over |v| = 1…2.
    pub fn octave(&self) -> &[Segment; SEGMENTS] {
        &self.octave
    }

    /// c·2^(e·(α − 1)) for the octaves from 2ᵉ, e = −21…10: the factor from [`PowerSeed::octave`] to each octave.
    pub fn scale(&self) -> &[f32; OCTAVES] {
        &self.scale
    }

    /// c·|v|^α·sgn v for `v` mm/s, bit for bit as a table filled from this seed gives it, without a table. Not for every tick.
    #[inline(never)]
    pub(crate) fn damping_force(&self, v: f32) -> f32 {
        let (t, quotient) = edge_and_quotient(&self.row(PowerTable::row_of(v)), v);
        t * quotient
    }

    /// Row `row` of the table, modulo [`ROWS`].
    #[inline(always)]
    fn row(&self, row: usize) -> Segment {
        let row = row % ROWS;
        // Below the table the lower edge of its first segment serves, above it the edge of its last.
        let segment = row.max(1);
        let octave = segment / SEGMENTS;
        let scale = self.scale[octave];
        let [p0, p1, p2, p3] = self.octave[segment % SEGMENTS].map(|value| scale * value);
        // 2⁻ᵉ: the octave's coefficients are for |v|/2ᵉ.
        let unit = f32::from_bits(((127 - LOWEST_EXPONENT) as u32 - octave as u32) << 23);
        if (1..ROWS - 1).contains(&row) {
            let square = unit * unit;
            [p0, unit * p1, square * p2, square * (unit * p3)]
        } else {
            let edge = 1.0 + (segment % SEGMENTS) as f32 * (1.0 / SEGMENTS as f32);
            [p0 + edge * (p1 + edge * (p2 + edge * p3)), 0.0, 0.0, 0.0]
        }
    }
}

/// Checks that `found` is `expected`, a number of at least 0, within [`AGREEMENT`].
///
/// # Errors
/// It is not finite, or does not agree.
const fn agrees(field: &'static str, found: f32, expected: f32) -> Result<(), ConfigError> {
    // Beside the relative part, the rounding of a number below the smallest normal one.
    let most = AGREEMENT * expected + f32::MIN_POSITIVE;
    within(field, found, expected - most, expected + most)
}

/// c·|v|^α·sgn v for one c and α, with a relative error within 4e-7: 4 KiB of cubics, eight per octave, for |v| from 5.4e-7
/// (1.125·2⁻²¹) to 1920 mm/s. Outside that range it is proportional to v in steps of an eighth of an octave: t·p0, where p0 is
/// c·|v|^α at the edge divided by the edge.
///
/// The cubics approximate c·|v|^α. Cubics of c·|v|^(α−1), to be multiplied by v, would give the sign at no cost too. But on a
/// segment that function is further from a cubic by (4 − α)/α, 6 to 26 times for the α of the paper, and the error would be 1e-6.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerTable {
    rows: [Segment; ROWS],
}

impl PowerTable {
    /// A table filled from `seed`.
    pub fn new(seed: &PowerSeed) -> Self {
        let mut new = Self::empty();
        new.fill(seed);
        new
    }

    /// Fills all rows for the c and α of `seed`, in place.
    pub fn fill(&mut self, seed: &PowerSeed) {
        for row in 0..ROWS {
            self.fill_row(seed, row);
        }
    }

    /// A table that gives 0 for every velocity until rows are filled.
    pub const fn empty() -> Self {
        Self {
            rows: [[0.0; 4]; ROWS],
        }
    }

    /// Fills row `row`, modulo [`ROWS`], for the c and α of `seed`: a handful of multiplications.
    #[inline(always)]
    pub fn fill_row(&mut self, seed: &PowerSeed, row: usize) {
        self.rows[row % ROWS] = seed.row(row);
    }

    /// The row that serves `v` mm/s within ±[`limits::VELOCITY`].
    #[inline(always)]
    pub fn row_of(v: f32) -> usize {
        // The sign is shifted out, and a value below the table becomes negative.
        let above = (v.to_bits() << 1).wrapping_sub(LOWEST_BITS << 1) as i32;
        (above >> (WITHIN + 1)).clamp(0, ROWS as i32 - 1) as usize % ROWS
    }

    /// c·|v|^α·sgn v in kN for `v` mm/s within ±[`limits::VELOCITY`]; beyond it, and for NaN, the result may be infinite or NaN.
    ///
    /// 0 at v = 0 for every α, Coulomb friction (α = 0) included.
    #[inline(always)]
    pub fn damping_force(&self, v: f32) -> f32 {
        let (t, quotient) = edge_and_quotient(&self.rows[Self::row_of(v)], v);
        t * quotient
    }

    /// Sum of `elastic` kN and [`PowerTable::damping_force`].
    #[inline(always)]
    pub(crate) fn add_damping_force(&self, elastic: f32, v: f32) -> f32 {
        let (t, quotient) = edge_and_quotient(&self.rows[Self::row_of(v)], v);
        elastic + t * quotient
    }
}

/// t of [`Segment`] and its factor.
#[inline(always)]
fn edge_and_quotient([p0, p1, p2, p3]: &Segment, v: f32) -> (f32, f32) {
    let t = f32::from_bits(v.to_bits() & !((1 << WITHIN) - 1));
    let magnitude = v.abs();
    (t, p0 + magnitude * (p1 + magnitude * (p2 + magnitude * p3)))
}

/// The cubic through `f` at the four Chebyshev nodes within `half` of `centre`, lowest power first.
fn chebyshev_cubic(centre: f64, half: f64, f: impl Fn(f64) -> f64) -> [f64; 4] {
    // cos π/8 and cos 3π/8.
    const NODES: [f64; 2] = [0.923_879_532_511_286_7, 0.382_683_432_365_089_8];
    let mut a = [0.0; 4];
    for x in [NODES[0], NODES[1], -NODES[1], -NODES[0]] {
        let value = 0.5 * f(centre + half * x);
        let square = x * x;
        let polynomials = [0.5, x, 2.0 * square - 1.0, x * (4.0 * square - 3.0)];
        for (a, t) in a.iter_mut().zip(polynomials) {
            *a += value * t;
        }
    }
    // From Chebyshev polynomials to powers of the distance from the centre, and from there to powers of the argument.
    let [t0, t1, t2, t3] = a;
    let [d0, d1, d2, d3] = [
        t0 - t2,
        (t1 - 3.0 * t3) / half,
        2.0 * t2 / (half * half),
        4.0 * t3 / (half * half * half),
    ];
    [
        d0 - centre * (d1 - centre * (d2 - centre * d3)),
        d1 - centre * (2.0 * d2 - 3.0 * centre * d3),
        d2 - 3.0 * centre * d3,
        d3,
    ]
}

#[cfg(test)]
mod tests {
    use super::exp2_of_negative;

    /// Rounding down takes 4.1e-8, the polynomial 7.8e-8, and two roundings of a float the same again.
    #[test]
    fn two_to_the_negative_is_that_of_f64() {
        for step in 0..=125 * 512u16 {
            let x = -f32::from(step) / 512.0 - 1e-3 * f32::from(step % 7);
            let exact = libm::exp2(f64::from(x));
            let error = (f64::from(exp2_of_negative(x)) - exact).abs();
            assert!(error <= 2.5e-7 * exact, "{error} of {exact} at {x}");
        }
        for below in [-127.01, -1e3, -1e30, f32::NEG_INFINITY] {
            assert_eq!(exp2_of_negative(below), 0.0);
        }
        for above in [1.0, 127.0, 1e30, f32::INFINITY] {
            assert!(exp2_of_negative(above).is_finite());
        }
        assert!((exp2_of_negative(f32::NAN) - 1.0).abs() <= 2.5e-7);
    }
}
