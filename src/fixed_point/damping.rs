//! c·|v|^α with a table over one power of 8, which serves all of them.

use super::scales::rounded;
use super::{Part, times};

/// Segments of |v| = ⅛…1, in steps of 1/64; the last is for v = −1.
const SEGMENTS: usize = 57;
/// Index of the first segment in a table that would begin at 0.
const FIRST: u32 = 8;
/// Bits of |v| that give the position within a segment.
const WITHIN: u32 = 25;
/// ⅛ of full scale.
const EIGHTH: u32 = 1 << 28;
/// Powers of 8 below ⅛ of full scale, to the smallest |v|, 2⁻³¹.
const LEVELS: usize = 10;

/// A quadratic over the position x = 0…1 in a segment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Segment {
    /// Value at its beginning, 2³¹ per full scale.
    value: i32,
    /// 2²⁰ per full scale, as the next field.
    slope: i16,
    curvature: i16,
}

/// c·|v|^α·sgn v in parts of full scale, for a full scale c·V^α of up to 1.
///
/// |v|^α = 8^(−kα)·(8ᵏ·|v|)^α: |v| is shifted up until it is ⅛ or more, where a table of quadratics is within 4e-6 of
/// V^α, and the result is multiplied by 8^(−kα). The force thus keeps its relative accuracy next to a reversal, where the slope of
/// |v|^α is infinite, down to the resolution of the force.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Damping {
    segments: [Segment; SEGMENTS],
    /// 8^(−kα) for k = 1…, 2¹⁶ per 1.
    factors: [u32; LEVELS],
}

impl Damping {
    /// * `scale`: c·V^α divided by full scale, 0…1
    /// * `alpha`: 0…1
    pub(super) fn new(scale: f64, alpha: f64) -> Self {
        let mut segments = [Segment::default(); SEGMENTS];
        let step = 1.0 / 64.0;
        let mut from = FIRST as f64 * step;
        for segment in &mut segments {
            // The quadratic through the three Chebyshev nodes on 0…1.
            const NODE: f64 = 0.5 * 0.866_025_403_784_438_6;
            let at = |x: f64| scale * libm::pow(from + step * x, alpha);
            let (low, middle, high) = (at(0.5 - NODE), at(0.5), at(0.5 + NODE));
            let curvature = (low + high - 2.0 * middle) / (2.0 * NODE * NODE);
            let slope = (high - low) / (2.0 * NODE) - curvature;
            let value = middle - 0.5 * (slope + 0.5 * curvature);
            *segment = Segment {
                value: rounded(value, 31) as i32,
                slope: rounded(slope, 20) as i16,
                curvature: rounded(curvature, 20) as i16,
            };
            from += step;
        }
        let mut factors = [0; LEVELS];
        let mut level = 1.0;
        for factor in &mut factors {
            *factor = rounded(libm::exp2(-3.0 * level * alpha), 16) as u32;
            level += 1.0;
        }
        Self { segments, factors }
    }

    #[inline(always)]
    pub(super) fn force(&self, v: Part) -> i32 {
        let sign = v.to_bits() >> 31;
        let magnitude = v.to_bits().unsigned_abs();
        let force = if magnitude >= EIGHTH {
            self.upper(magnitude)
        } else {
            self.lower(magnitude)
        };
        (force ^ sign) - sign
    }

    /// For ⅛…1.
    #[inline(always)]
    fn upper(&self, magnitude: u32) -> i32 {
        let index = (magnitude >> WITHIN).wrapping_sub(FIRST) as usize;
        let Some(segment) = self.segments.get(index) else {
            return 0;
        };
        let x = ((magnitude << (32 - WITHIN)) >> 16) as i32;
        let slope = i32::from(segment.slope) + ((i32::from(segment.curvature) * x) >> 16);
        segment.value + ((slope * x) >> (16 + 20 - 31))
    }

    /// For less than ⅛; 0 at 0.
    #[cold]
    fn lower(&self, magnitude: u32) -> i32 {
        let mut magnitude = magnitude;
        for &factor in &self.factors {
            magnitude <<= 3;
            if magnitude >= EIGHTH {
                return times(self.upper(magnitude), factor);
            }
        }
        0
    }
}
