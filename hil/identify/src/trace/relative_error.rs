//! Errors relative to the force, with the share of the noise.

use std::ops::Range;

use mesh_damper_recording::extremes::quantile;
use mesh_damper_recording::trajectory::Trajectory;

use crate::beyond_noise::beyond_noise;
use crate::tolerance::expected;

/// Squared errors over the squared force.
#[derive(Clone, Copy, Debug)]
pub(super) struct RelativeError {
    /// The error of a law,
    pub error: f64,
    /// and that of a perfect law.
    pub noise: f64,
    /// What nine of ten errors do not exceed, squared as well.
    pub most: f64,
}

impl RelativeError {
    /// Of a law that cannot be run.
    pub const NONE: Self = Self {
        error: f64::INFINITY,
        noise: 0.0,
        most: f64::INFINITY,
    };

    /// Whether the law can be run.
    pub fn is_run(&self) -> bool {
        self.error.is_finite()
    }

    /// Over the samples that are `is_fair`, each with its `weight`; `None` if there are none.
    pub fn of(
        trajectory: &Trajectory,
        predicted: &[f64],
        samples: &Range<usize>,
        is_fair: impl Fn(usize) -> bool,
        weight: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let (mut error, mut noise, mut force) = (0.0, 0.0, 0.0);
        let mut squares = Vec::new();
        for i in samples.clone().filter(|&i| is_fair(i)) {
            let square = (predicted[i] - trajectory.force[i]).powi(2);
            error += weight(i) * square;
            squares.push(square);
            noise += expected(trajectory, i);
            force += trajectory.force[i].powi(2);
        }
        (force > 0.0).then(|| Self {
            error: error / force,
            noise: noise / force,
            most: quantile(&mut squares, 0.9) * squares.len() as f64 / force,
        })
    }

    /// Squares of both times `factor`.
    pub fn times(self, factor: f64) -> Self {
        Self {
            error: factor * self.error,
            noise: factor * self.noise,
            most: factor * self.most,
        }
    }

    /// The mean of their squares.
    pub fn mean(errors: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| errors.iter().map(of).sum::<f64>() / errors.len() as f64;
        Self {
            error: mean(|one| one.error),
            noise: mean(|one| one.noise),
            most: mean(|one| one.most),
        }
    }

    /// The geometric mean of their errors [beyond the noise](beyond_noise()), in which each counts equally. It is
    /// infinite for a law that cannot be run on one of the conditions.
    pub fn geometric_mean(errors: &[Self]) -> f64 {
        if !errors.iter().all(Self::is_run) {
            return f64::INFINITY;
        }
        let logs = errors.iter().map(|one| one.beyond_noise().ln());
        (logs.sum::<f64>() / errors.len() as f64).exp()
    }

    /// RMS error [beyond the noise](beyond_noise()).
    pub fn beyond_noise(&self) -> f64 {
        beyond_noise(self.error, self.noise)
    }
}
