//! Whether one law predicts better than another, beyond what noise would give.

use std::ops::Range;

use super::split::{Role, Roles};
use crate::recording::trajectory::Trajectory;

/// Pieces that a period is cut into for comparing errors.
const PIECES_PER_PERIOD: f64 = 4.0;
/// The least part of the other's squared error that a better law has to save.
const LEAST_GAIN: f64 = 0.05;
/// How many deviations the gain per piece has to stand from zero.
const DEVIATIONS: f64 = 3.0;

/// Squared errors of one law on the samples of one role, summed over short pieces of time, as parts of the recording's
/// squared force there.
#[derive(Clone, Debug)]
pub struct Score {
    pieces: Vec<f64>,
    recordings: usize,
}

impl Score {
    /// Compares `predicted` (kN, per trajectory and sample) with the measured force on the samples of `role`.
    pub fn of(
        trajectories: &[Trajectory],
        roles: &Roles,
        role: Role,
        predicted: &[Vec<f64>],
    ) -> Self {
        let mut score = Self {
            pieces: Vec::new(),
            recordings: 0,
        };
        for (which, trajectory) in trajectories.iter().enumerate() {
            let first = score.pieces.len();
            let mut force_squared = 0.0;
            for piece in pieces(trajectory) {
                let mut error = None;
                for sample in piece.filter(|&sample| {
                    roles.of(which, sample) == role && trajectory.is_telling(sample)
                }) {
                    let force = trajectory.force[sample];
                    *error.get_or_insert(0.0) += (predicted[which][sample] - force).powi(2);
                    force_squared += force * force;
                }
                score.pieces.extend(error);
            }
            score.pieces[first..]
                .iter_mut()
                .for_each(|piece| *piece /= force_squared);
            score.recordings += usize::from(score.pieces.len() > first);
        }
        score
    }

    /// RMS error over RMS force; of several recordings the root of the mean square.
    pub fn nrmse(&self) -> f64 {
        (self.pieces.iter().sum::<f64>() / self.recordings as f64).sqrt()
    }

    /// Whether this law is better than `other` on the same samples: it saves a part of the squared error that matters,
    /// and does so piece after piece and not in a few by chance.
    ///
    /// What counts of a piece is its relative gain (a − b)/(a + b), which lies in −1…1, so that no piece can decide alone.
    pub fn beats(&self, other: &Self) -> bool {
        let saved = 1.0 - self.pieces.iter().sum::<f64>() / other.pieces.iter().sum::<f64>();
        let gains: Vec<f64> = other
            .pieces
            .iter()
            .zip(&self.pieces)
            .map(|(a, b)| (a - b) / (a + b).max(f64::MIN_POSITIVE))
            .collect();
        let count = gains.len() as f64;
        let mean = gains.iter().sum::<f64>() / count;
        let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0);
        saved > LEAST_GAIN && mean > DEVIATIONS * (variance / count).sqrt()
    }
}

/// Quarters of a period, block by block.
fn pieces(trajectory: &Trajectory) -> impl Iterator<Item = Range<usize>> + '_ {
    trajectory.blocks.iter().flat_map(|block| {
        let length = (1.0 / (block.frequency * trajectory.tick * PIECES_PER_PERIOD)) as usize;
        let end = block.samples.end;
        block
            .samples
            .clone()
            .step_by(length.max(4))
            .map(move |start| start..(start + length.max(4)).min(end))
    })
}
