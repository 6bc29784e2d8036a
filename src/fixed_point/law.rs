//! Eq 13 of the paper, the mixed damping law, in integers.

use super::damping::Damping;
use super::scales::{HEADROOM, rounded};
use super::{Part, Scales, times};
use crate::error::ConfigError;
use crate::law;
use crate::limits;
use crate::real::in_range;

/// F = k1·y + k3·y³ + c·|v|^α·sgn v, in parts of full scale.
///
/// The error is within 3e-5 of full scale everywhere, relative to the law's own force for the same parts; its mean over a cycle is
/// much smaller.
#[derive(Clone, Debug, PartialEq)]
pub struct Law {
    /// k1·Y, plus half a unit of its results, 2³¹ per full scale.
    linear: i32,
    /// k3·Y³, 2³¹ per full scale.
    cubic: i32,
    damping: Damping,
}

impl Law {
    /// Converts `law` to `scales`. Computes some hundred powers in f64: not for the hot path.
    ///
    /// # Errors
    /// [`ConfigError::OutOfRange`] for `force` if the full scale of force is not above 1.001 times the law's largest force on the
    /// other two scales, |k1|·Y + |k3|·Y³ + c·V^α: see [`Scales::covering`].
    pub fn new(law: &law::Law<f64>, scales: &Scales) -> Result<Self, ConfigError> {
        let largest = scales.largest_force(law);
        in_range("force", scales.force(), HEADROOM * largest, limits::FORCE)?;
        let (y, f) = (scales.displacement(), scales.force());
        let cubic = law.k3() * y * y * y / f;
        // y² is rounded down to 2⁻¹⁶, by half of that on average; the stiffness is rounded to the nearest 2⁻¹⁶.
        let half = 1.0 / (1u32 << 17) as f64;
        let linear = law.k1() * y / f + half * cubic + half;
        Ok(Self {
            linear: rounded(linear, 31) as i32,
            cubic: rounded(cubic, 31) as i32,
            damping: Damping::new(law.damping_force(scales.velocity()) / f, law.alpha()),
        })
    }

    /// Force at displacement `y` and velocity `v`. At v = 0 the damping term is 0 for every α.
    #[inline(always)]
    pub fn force(&self, y: Part, v: Part) -> Part {
        Part::from_bits(self.elastic_force(y) + self.damping.force(v))
    }

    /// (k1 + k3·y²)·y, with y in two halves and the rest in 16 bits.
    #[inline(always)]
    fn elastic_force(&self, y: Part) -> i32 {
        let high = y.to_bits() >> 16;
        let low = y.to_bits() & 0xffff;
        // 2³⁰ per 1, plus ½ for the square of the low half, without which it could be negative; then 2¹⁶ per 1.
        let square = high * high + ((high * low) >> 15) + 1;
        let square = (square >> 14) as u32;
        let stiffness = (self.linear + times(self.cubic, square)) >> 15;
        high * stiffness + (((low >> 1) * stiffness) >> 15)
    }
}
