//! Whether one law predicts better than another, beyond the influence of noise.

use std::ops::Range;

use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::Stride;

use super::split::{Role, Roles};
use crate::tolerance::{certainty_beside, expected_beside};

mesh_damper_recording::numbers! {
    /// Whether one law predicts better than another.
    ScorePolicy {
        /// Laws are compared piece by piece; a period is cut into this many pieces.
        pieces_per_period: f64 = 4.0, Derived("a quarter of a period is loading or unloading on one side");
        /// A piece of a period has at least this many samples.
        shortest_piece: usize = 4, Convention("fewer are noise");
        /// A law is better than another only if its squared error is smaller by more than this fraction.
        least_gain: f64 = 0.05, Tuned("the blind trial");
        /// A law that passes `least_gain` is better than another if it saves more than this fraction of the squared error even without the
        /// piece of a period in which it saves most. It then need not be better in most pieces.
        large_gain: f64 = 0.2, Tuned("the blind trial");
        /// A law that passes `least_gain` is better than another if its mean relative gain over all pieces of the periods exceeds this many
        /// of its standard errors.
        deviations: f64 = 3.0, Tuned("the blind trial");
    }
}

/// The samples of one role on which laws are compared, in short pieces of time.
#[derive(Clone)]
pub struct ValidationSamples<'a> {
    trajectories: &'a [Trajectory],
    /// Trajectory and samples of each piece, each sample with the number of those that it stands for.
    pieces: Vec<(usize, Vec<(usize, f64)>)>,
    /// Of each trajectory, the sum of the squared force there, kN².
    power: Vec<f64>,
    /// What the law that samples are weighted for leaves of each trajectory, kN².
    left: Vec<f64>,
}

impl<'a> ValidationSamples<'a> {
    /// The samples of `role` that are [telling](Trajectory::is_telling), of those that the `strides` over each trajectory visit.
    pub fn of(
        trajectories: &'a [Trajectory],
        strides: &[Vec<Stride>],
        roles: &Roles,
        role: Role,
    ) -> Self {
        let mut found = Self {
            trajectories,
            pieces: Vec::new(),
            power: Vec::new(),
            left: trajectories.iter().map(|one| one.unexplained).collect(),
        };
        for (which, trajectory) in trajectories.iter().enumerate() {
            let mut power = 0.0;
            let visited = strides[which].iter().flat_map(Stride::counted);
            let visited = visited.map(|(sample, count)| (sample, count as f64));
            let mut visited = visited.peekable();
            for piece in pieces(trajectory) {
                let is_within = |(sample, _): &(usize, f64)| *sample < piece.end;
                let within = std::iter::from_fn(|| visited.next_if(is_within));
                let counts = |&(sample, _): &(usize, f64)| {
                    sample >= piece.start
                        && roles.of(which, sample) == role
                        && trajectory.is_telling(sample)
                };
                let samples: Vec<(usize, f64)> = within.filter(counts).collect();
                power += samples
                    .iter()
                    .map(|&(sample, count)| count * trajectory.force[sample].powi(2))
                    .sum::<f64>();
                if !samples.is_empty() {
                    found.pieces.push((which, samples));
                }
            }
            found.power.push(power);
        }
        found
    }

    /// The same samples weighted for a law that leaves another variance of each trajectory, kN².
    #[must_use]
    pub fn beside(&self, left: Vec<f64>) -> Self {
        Self {
            left,
            ..self.clone()
        }
    }

    /// The error of a perfect law there, with each sample weighted by its [`certainty`](crate::tolerance::certainty); for several
    /// recordings, the root of the mean square.
    pub fn noise(&self) -> f64 {
        let pieces = self.pieces.iter();
        let squares: f64 = pieces
            .map(|(which, samples)| {
                let trajectory = &self.trajectories[*which];
                let left = self.left[*which];
                let expected = |&(sample, count): &(usize, f64)| {
                    count * expected_beside(left, trajectory, sample)
                };
                samples.iter().map(expected).sum::<f64>() / self.power[*which]
            })
            .sum();
        (squares / self.recordings() as f64).sqrt()
    }

    fn recordings(&self) -> usize {
        self.power.iter().filter(|&&power| power > 0.0).count()
    }

    /// Compares the force that is `predicted` on each trajectory, kN at every sample visited, with the measured force. Each sample is
    /// weighted by its [`certainty`](crate::tolerance::certainty).
    pub fn score(&self, predicted: &[Vec<f64>]) -> Score {
        let mut pieces = Vec::with_capacity(self.pieces.len());
        // The pieces of one trajectory follow each other.
        for of_one in self.pieces.chunk_by(|a, b| a.0 == b.0) {
            let which = of_one[0].0;
            let trajectory = &self.trajectories[which];
            let predicted = &predicted[which];
            pieces.extend(of_one.iter().map(|(_, samples)| {
                let error = |&(sample, count): &(usize, f64)| {
                    let error = predicted[sample] - trajectory.force[sample];
                    let certainty = certainty_beside(self.left[which], trajectory, sample);
                    count * certainty * error * error
                };
                samples.iter().map(error).sum::<f64>() / self.power[which]
            }));
        }
        Score {
            pieces,
            recordings: self.recordings(),
        }
    }
}

/// Squared errors of one law, summed over short pieces of time, as fractions of the recording's squared force.
#[derive(Clone, Debug)]
pub struct Score {
    pieces: Vec<f64>,
    recordings: usize,
}

impl Score {
    /// RMS error, weighted by certainty, over RMS force; for several recordings, the root of the mean square.
    pub fn nrmse(&self) -> f64 {
        (self.pieces.iter().sum::<f64>() / self.recordings as f64).sqrt()
    }

    /// Whether this law is better than `other` on the same samples. It has to reduce the squared error by a relevant part, and
    /// consistently over the pieces instead of by chance in a few.
    ///
    /// A contact acts in a few pieces only. So a law also wins if it reduces the error by a large part without the piece in which it gains
    /// most.
    pub fn beats(&self, other: &Self) -> bool {
        let pieces = other.pieces.iter().zip(&self.pieces);
        let saved: Vec<f64> = pieces.map(|(a, b)| a - b).collect();
        let before: f64 = other.pieces.iter().sum();
        let all: f64 = saved.iter().sum();
        if all <= ScorePolicy::in_use().least_gain * before {
            return false;
        }
        let most = saved.iter().copied().fold(0.0, f64::max);
        all - most > ScorePolicy::in_use().large_gain * before || self.gains_throughout(other)
    }

    /// Whether this law is better than `other` piece by piece, by however little: beyond chance, and not by a few pieces.
    ///
    /// A piece counts with its relative gain (a − b)/(a + b), which lies in −1…1, so no piece can decide alone.
    pub fn gains_throughout(&self, other: &Self) -> bool {
        let pieces = other.pieces.iter().zip(&self.pieces);
        let gains: Vec<f64> = pieces
            .map(|(a, b)| (a - b) / (a + b).max(f64::MIN_POSITIVE))
            .collect();
        let count = gains.len() as f64;
        let mean = gains.iter().sum::<f64>() / count;
        let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (count - 1.0);
        mean > ScorePolicy::in_use().deviations * (variance / count).sqrt()
    }
}

/// Quarters of a period, block by block.
fn pieces(trajectory: &Trajectory) -> impl Iterator<Item = Range<usize>> + '_ {
    trajectory.blocks.iter().flat_map(|block| {
        let length = (1.0
            / (block.frequency * trajectory.tick * ScorePolicy::in_use().pieces_per_period))
            as usize;
        let end = block.samples.end;
        let length = length.max(ScorePolicy::in_use().shortest_piece);
        block
            .samples
            .clone()
            .step_by(length)
            .map(move |start| start..(start + length).min(end))
    })
}

#[cfg(test)]
mod tests {
    use mesh_damper_recording::trajectory::strides::strides;

    use super::*;

    #[test]
    fn a_score_along_strides_is_that_of_every_sample() {
        let displacement: Vec<f64> = (0..40_000)
            .map(|n| (f64::from(n) / if n < 30_000 { 500.0 } else { 15.0 }).sin())
            .collect();
        // Only the slow part has more than is predicted.
        let more = |n: usize| if n < 30_000 { 0.2 } else { 0.0 };
        let force = displacement.iter().enumerate();
        let force: Vec<f64> = force.map(|(n, y)| y + more(n) * y.powi(3)).collect();
        let predicted = [displacement.clone()];
        let trajectory = Trajectory::new("two", 1e-3, &displacement, force, None, None);
        let trajectories = [trajectory];
        let mut roles = Roles::all_fit(&trajectories);
        roles.keep_apart(&trajectories, Role::Validation);
        let few = strides(&trajectories, 100, |_, _| true);
        let each = [Stride::each(40_000)];
        let [few, each] = [&few[..], &each].map(|strides| {
            let samples = ValidationSamples::of(&trajectories, strides, &roles, Role::Validation);
            let count: usize = samples
                .pieces
                .iter()
                .map(|(_, samples)| samples.len())
                .sum();
            let score = samples.score(&predicted);
            (count, score.pieces.len(), score.nrmse(), samples.noise())
        });
        // A piece of few samples, cut by a role, may have none.
        assert!(few.0 < each.0 / 2 && few.1 + 2 > each.1, "{few:?} {each:?}");
        assert!((few.2 / each.2 - 1.0).abs() < 0.01, "{few:?} {each:?}");
        assert!((few.3 / each.3 - 1.0).abs() < 0.01, "{few:?} {each:?}");
    }
}
