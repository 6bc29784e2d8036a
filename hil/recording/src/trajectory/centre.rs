//! Whether a recorded displacement has its zero where the law needs it.

use nalgebra::{SMatrix, SVector};

use crate::cycles::Cycles;
use crate::extremes::least_and_largest;
use crate::noise::noise_deviation;
use crate::rig::DisplacementZero;
use crate::trajectory::TrajectoryPolicy;

/// The displacement midway between the smallest and the largest, mm.
pub(super) fn middle(displacement: &[f64]) -> f64 {
    let (low, high) = least_and_largest(displacement);
    0.5 * (low + high)
}

/// Where the displacement of a recording is counted from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zero {
    /// The recorded zero.
    Recorded,
    /// The displacement midway between the smallest and the largest.
    Middle,
    /// The mean displacement.
    Mean,
    /// The displacement at the start.
    Start,
}

impl Zero {
    /// As the channels show it: the middle of the motion if the recorded zero was left in, otherwise the recorded zero.
    pub(super) fn seen_in(displacement: &[f64], force: &[f64]) -> Self {
        match is_off(displacement, force) {
            true => Self::Middle,
            false => Self::Recorded,
        }
    }

    /// The recorded displacement there, mm.
    pub(super) fn of(self, displacement: &[f64]) -> f64 {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        match self {
            Self::Recorded => 0.0,
            Self::Middle => middle(displacement),
            Self::Mean => mean(displacement),
            Self::Start => {
                // The rest with which a recording starts, as far as it is within the noise.
                let band =
                    TrajectoryPolicy::in_use().crossing_noises * noise_deviation(displacement);
                let rest = displacement
                    .iter()
                    .take_while(|y| (*y - displacement[0]).abs() <= band);
                mean(&displacement[..rest.count()])
            }
        }
    }
}

impl From<DisplacementZero> for Zero {
    fn from(stated: DisplacementZero) -> Self {
        match stated {
            DisplacementZero::Mean => Self::Mean,
            DisplacementZero::Start => Self::Start,
            DisplacementZero::None => Self::Recorded,
        }
    }
}

/// Whether the middle of the motion is a zero that was left in. It is if it lies more than half an amplitude from 0, or if the
/// specimen does not feel it.
fn is_off(displacement: &[f64], force: &[f64]) -> bool {
    let (low, high) = least_and_largest(displacement);
    let middle = middle(displacement);
    let largest = 0.5 * (high - low);
    // A motion that is not about its middle says nothing about a zero, nor does a motion without similar cycles.
    let mean = displacement.iter().sum::<f64>() / displacement.len() as f64;
    let is_about = (mean - middle).abs() < TrajectoryPolicy::in_use().about * middle.abs()
        && has_like_cycles(displacement);
    middle.abs() > TrajectoryPolicy::in_use().far * largest
        || middle.abs() > TrajectoryPolicy::in_use().off * largest
            && is_about
            && !feels_it(displacement, force, middle, largest)
}

/// Whether most samples belong to cycles that resemble a neighbour.
fn has_like_cycles(displacement: &[f64]) -> bool {
    let cycles = Cycles::of(displacement, 1.0);
    let alike = cycles.blocks.iter().filter(|block| block.cycles.len() > 1);
    2 * alike.map(|block| block.samples.len()).sum::<usize>() > displacement.len()
}

/// Whether the force at displacement `middle` exceeds [`TrajectoryPolicy::felt`](super::TrajectoryPolicy::felt) of the force of a spring with the stiffness that
/// the channels show there, by a cubic through the force. A specimen that is stiffer on one side has no such middle.
fn feels_it(displacement: &[f64], force: &[f64], middle: f64, largest: f64) -> bool {
    let mut gram = SMatrix::<f64, 4, 4>::zeros();
    let mut right = SVector::<f64, 4>::zeros();
    for (y, force) in displacement.iter().zip(force) {
        let u = (y - middle) / largest;
        let row = SVector::from([1.0, u, u * u, u.powi(3)]);
        gram += row * row.transpose();
        right += row * *force;
    }
    let Some(factor) = gram.cholesky() else {
        return true;
    };
    let cubic = factor.solve(&right);
    let (at_middle, slope) = (cubic[0], cubic[1]);
    (at_middle / (slope * middle / largest)).abs() > TrajectoryPolicy::in_use().felt
}
