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
}

/// By this part of a recording what was left is moved: it meets nothing like its own place, whatever the period of the motion.
/// Derived: the golden section, which is furthest from all ratios of small numbers.
const MOVED: f64 = 0.381_966;

impl MotionError {
    /// Of `motion`, which was estimated from `displacement` in mm, as `estimate` does it.
    pub(super) fn of(
        motion: &MotionEstimate,
        displacement: &[f64],
        estimate: impl FnOnce(&[f64]) -> MotionEstimate,
    ) -> Self {
        let count = displacement.len();
        let mut left: Vec<f64> = displacement
            .iter()
            .zip(&motion.displacement)
            .map(|(recorded, estimated)| recorded - estimated)
            .collect();
        left.rotate_left((MOVED * count as f64) as usize);
        // A short window leaves less than there was.
        let deviation = (left.iter().map(|x| x * x).sum::<f64>() / count as f64).sqrt();
        let scale = if deviation > 0.0 {
            (motion.noise / deviation).max(1.0)
        } else {
            0.0
        };
        let again: Vec<f64> = motion
            .displacement
            .iter()
            .zip(&left)
            .map(|(estimated, left)| estimated + scale * left)
            .collect();
        let again = estimate(&again);
        let off = |again: &[f64], estimated: &[f64]| {
            let each = again.iter().zip(estimated);
            each.map(|(again, estimated)| again - estimated).collect()
        };
        Self {
            displacement: off(&again.displacement, &motion.displacement),
            velocity: off(&again.velocity, &motion.velocity),
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
