//! How far an estimated motion may be off: the estimate of a motion that is known, from a displacement as noisy.
//!
//! An estimate errs by what is left of the noise and by what was smoothed away of the motion. Of a cubic in a window the former
//! has a formula; the latter depends on what the motion would be without noise. So the motion that was estimated is taken for
//! the truth, what it left of the recorded displacement is added at other places, and all is estimated again (a bootstrap of
//! residuals, Efron 1979). That holds for whatever an estimate is made of: windows, sines, rests and kinks.

use super::motion::MotionEstimate;
use crate::policy::policy;

crate::numbers! {
    /// How far a motion may be off.
    MotionErrorPolicy {
        /// Samples to either side that tell how large the force is that the motion's error leaves.
        about: usize = 16, Convention("33 squares give a variance to a quarter");
    }
}

/// An error that an estimated motion may have: one draw of it for every sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionError {
    /// mm
    pub displacement: Vec<f64>,
    /// mm/s
    pub velocity: Vec<f64>,
    /// mm/s²
    pub acceleration: Vec<f64>,
}

/// By this part of a recording what was left is moved: it meets nothing like its own place, whatever the period of the motion.
/// Derived: the golden section, which is furthest from all ratios of small numbers.
const MOVED: f64 = 0.381_966;

/// The step between the places of `count` samples that are scattered: about that part of a recording, without a divisor in common
/// with its length, so that each sample has a place of its own.
fn stride(count: usize) -> usize {
    let divisor = |mut a: usize, mut b: usize| {
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    let least = ((MOVED * count as f64) as usize).max(1);
    (least..)
        .find(|&stride| divisor(stride, count) == 1)
        .unwrap_or(1)
}

/// A displacement as noisy as the recorded one about the motion that was `estimated` from it, mm, whose `noise` has this deviation, mm: an
/// estimate may leave less than there was.
///
/// What was left is moved as it is. `is_banded` tells where the estimate knows the band of the motion: there it leaves nothing of the
/// noise in that band, and what was left is scattered, which makes it white again.
pub(super) fn as_noisy(
    estimated: &[f64],
    displacement: &[f64],
    noise: f64,
    is_banded: impl Fn(usize) -> bool,
) -> Vec<f64> {
    let count = displacement.len();
    let (shift, stride) = ((MOVED * count as f64) as usize, stride(count));
    let left = |index: usize| {
        let from = if is_banded(index) {
            (index as u128 * stride as u128 % count as u128) as usize
        } else {
            (index + shift) % count
        };
        displacement[from] - estimated[from]
    };
    let left: Vec<f64> = (0..count).map(left).collect();
    let deviation = (left.iter().map(|x| x * x).sum::<f64>() / left.len() as f64).sqrt();
    let scale = if deviation > 0.0 {
        (noise / deviation).max(1.0)
    } else {
        0.0
    };
    let pairs = estimated.iter().zip(&left);
    pairs
        .map(|(estimated, left)| estimated + scale * left)
        .collect()
}

impl MotionError {
    /// Of `motion`, which was estimated from `displacement` in mm, as `estimate` does it; `is_banded` tells where that knows
    /// the band of the motion.
    pub(super) fn of(
        motion: &MotionEstimate,
        displacement: &[f64],
        is_banded: impl Fn(usize) -> bool,
        estimate: impl FnOnce(&[f64]) -> MotionEstimate,
    ) -> Self {
        let again = as_noisy(&motion.displacement, displacement, motion.noise, is_banded);
        let again = estimate(&again);
        let off = |again: &[f64], estimated: &[f64]| {
            let each = again.iter().zip(estimated);
            each.map(|(again, estimated)| again - estimated).collect()
        };
        Self {
            displacement: off(&again.displacement, &motion.displacement),
            velocity: off(&again.velocity, &motion.velocity),
            acceleration: off(&again.acceleration, &motion.acceleration),
        }
    }

    /// Variance of what is `off` by one draw at each sample.
    ///
    /// One draw is no variance, but the mean square of those samples about it that are telling is about one. Others are near a
    /// standstill, where the force of |v|^α may be off by much more: they count for themselves alone.
    pub(super) fn variance(off: &[f64], is_telling: impl Fn(usize) -> bool) -> Vec<f64> {
        let count = off.len();
        let telling: Vec<bool> = (0..count).map(is_telling).collect();
        // Of the telling samples before each.
        let mut sums = vec![(0.0, 0.0)];
        let (mut sum, mut told) = (0.0, 0.0);
        for (off, telling) in off.iter().zip(&telling) {
            if *telling {
                sum += off * off;
                told += 1.0;
            }
            sums.push((sum, told));
        }
        let about = policy().motion_error.about;
        let variance = |index: usize| {
            if !telling[index] {
                return off[index].powi(2);
            }
            let from = sums[index.saturating_sub(about)];
            let to = sums[(index + about + 1).min(count)];
            (to.0 - from.0).max(0.0) / (to.1 - from.1)
        };
        (0..count).map(variance).collect()
    }
}
