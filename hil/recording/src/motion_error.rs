//! The possible error of an estimated motion, from an estimate of a known motion with an equally noisy displacement.
//!
//! The error of an estimate has two parts: remaining noise, and motion that was smoothed away. For a cubic in a window the first
//! has a formula; the second depends on the motion without noise. So the estimated motion is taken as the true one, the residual of
//! the recorded displacement is added to it at other positions, and the estimate is repeated (a bootstrap of residuals, Efron
//! 1979). This works for any kind of estimate: windows, sines, rests and kinks.

use super::motion::MotionEstimate;

crate::numbers! {
    /// How far a motion may be off.
    MotionErrorPolicy {
        /// The force error that comes from the motion's error is averaged, as a variance, over this many samples to each side.
        about: usize = 16, Convention("the mean of 33 squares gives a variance to within a quarter");
    }
}

/// A possible error of an estimated motion: one draw of it for every sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionError {
    /// Displacement, mm
    pub displacement: Vec<f64>,
    /// Velocity, mm/s
    pub velocity: Vec<f64>,
    /// Acceleration, mm/s²
    pub acceleration: Vec<f64>,
}

/// Part of a recording by which the residual is shifted, so that it meets no similar position, whatever the period of the motion.
/// Derived: the golden section, which is furthest from all ratios of small numbers.
const MOVED: f64 = 0.381_966;

/// The step between the positions of `count` samples that are scattered: about that part of a recording, without a common divisor
/// with its length, so that each sample gets its own position.
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

/// A displacement as noisy as the recorded one about the motion that was `estimated` from it, mm, with noise of the deviation
/// `noise`, mm, because the residual of an estimate may be smaller than the noise.
///
/// The residual is shifted unchanged. `is_banded` marks samples where the estimate knows the band of the motion. There the residual
/// has no noise in that band; it is scattered, which makes it white again.
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
    /// The error of `motion`, which was estimated from `displacement` in mm by `estimate`; `is_banded` marks samples where that
    /// knows the band of the motion.
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

    /// Variance of a quantity whose error is `off` in one draw at each sample.
    ///
    /// One draw is no variance, but the mean square of the informative samples about it nearly is. Samples near a standstill, where
    /// the force of |v|^α may have a much larger error, are not informative: they count only for themselves.
    pub(super) fn variance(off: &[f64], is_telling: impl Fn(usize) -> bool) -> Vec<f64> {
        let count = off.len();
        let telling: Vec<bool> = (0..count).map(is_telling).collect();
        // For the informative samples before each.
        let mut sums = vec![(0.0, 0.0)];
        let (mut sum, mut counted) = (0.0, 0.0);
        for (off, telling) in off.iter().zip(&telling) {
            if *telling {
                sum += off * off;
                counted += 1.0;
            }
            sums.push((sum, counted));
        }
        let about = MotionErrorPolicy::in_use().about;
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
