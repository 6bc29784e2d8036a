//! The error of a trajectory's motion, and what it means for the force.

use super::Trajectory;
use crate::motion_error::MotionError;

/// The variance that a law leaves is computed in at most this many turns, until it changes by less than this part. Convention: a
/// weight needs no more digits.
const MOST_TURNS: usize = 30;
const SETTLED: f64 = 0.01;

impl Trajectory {
    /// Carries the error of the motion into the tolerance for a law's force. `force` is roughly the law's force, kN, at a
    /// displacement in mm, a velocity in mm/s and an acceleration in mm/s².
    pub fn carry_motion_error(&mut self, force: impl Fn(f64, f64, f64) -> f64) {
        let deviations = |error: &[f64]| -> Vec<f64> {
            let variances = self.variance_of(error).into_iter();
            variances.map(f64::sqrt).collect()
        };
        let of_displacement = deviations(&self.motion_error.displacement);
        let of_velocity = deviations(&self.motion_error.velocity);
        let of_acceleration = deviations(&self.motion_error.acceleration);
        let carried = |index: usize| {
            let motion = &self.motion;
            let (y, v) = (motion.displacement[index], motion.velocity[index]);
            let a = motion.acceleration[index];
            let (dy, dv) = (of_displacement[index], of_velocity[index]);
            let here = force(y, v, a);
            let off = |y: f64, v: f64, a: f64| (force(y, v, a) - here).powi(2);
            off(y + dy, v, a)
                + 0.5 * (off(y, v + dv, a) + off(y, v - dv, a))
                + off(y, v, a + of_acceleration[index])
        };
        self.carried = (0..self.len()).map(carried).collect();
    }

    /// Variance of the force that a law leaves in addition to the [tolerance](Self::tolerance) on the samples that `counts` picks, kN²: the
    /// one that is most likely. `predicted` is the law's force at every sample, kN. It is 0 without samples.
    pub fn left_beyond_tolerance(&self, predicted: &[f64], counts: impl Fn(usize) -> bool) -> f64 {
        let (squares, tolerances): (Vec<f64>, Vec<f64>) = (0..self.len())
            .filter(|&index| counts(index) && self.is_telling(index))
            .map(|index| {
                let error = predicted[index] - self.force[index];
                (error.powi(2), self.tolerance(index))
            })
            .unzip();
        let mut left = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
        for _ in 0..MOST_TURNS {
            let (mut sum, mut weights) = (0.0, 0.0);
            for (square, tolerance) in squares.iter().zip(&tolerances) {
                let weight = (tolerance + left).powi(-2);
                sum += weight * (square - tolerance);
                weights += weight;
            }
            let next = (sum / weights).max(0.0);
            if !next.is_finite() || (next - left).abs() <= SETTLED * left {
                break;
            }
            left = next;
        }
        left
    }

    /// This trajectory with another motion that is equally likely: the estimate plus one draw of its error.
    #[must_use]
    pub fn as_it_may_be(&self) -> Self {
        // Without the error, which takes a quarter of the memory.
        let mut other = self.motion_alone();
        other
            .motion
            .velocity_deviation
            .clone_from(&self.motion.velocity_deviation);
        other.motion.rests.clone_from(&self.motion.rests);
        other.motion.kinks.clone_from(&self.motion.kinks);
        other.force.clone_from(&self.force);
        other.carried.clone_from(&self.carried);
        other.unexplained = self.unexplained;
        other.measured.clone_from(&self.measured);
        other.unsettled.clone_from(&self.unsettled);
        other.blocks.clone_from(&self.blocks);
        let error = &self.motion_error;
        for (channel, error) in [
            (&mut other.motion.displacement, &error.displacement),
            (&mut other.motion.velocity, &error.velocity),
            (&mut other.motion.acceleration, &error.acceleration),
        ] {
            channel
                .iter_mut()
                .zip(error)
                .for_each(|(value, error)| *value += error);
        }
        other
    }

    /// Variance at every sample of a quantity that changes by `off` when the motion is [off by one draw](Self::as_it_may_be) of its
    /// error.
    pub fn variance_of(&self, off: &[f64]) -> Vec<f64> {
        MotionError::variance(off, |index| self.is_telling(index))
    }

    /// Variance of the residual of a perfect law at a sample, kN²: the noise of the force, and the error of the motion if it was
    /// [carried](Trajectory::carry_motion_error) into the force.
    pub fn tolerance(&self, index: usize) -> f64 {
        let carried = self.carried.get(index).copied().unwrap_or_default();
        self.force_noise.powi(2) + carried
    }
}
