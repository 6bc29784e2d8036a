//! Tones in the residual of a law.

use mesh_damper_recording::spectrum::{place_of_line, powers};
use mesh_damper_recording::trajectory::Trajectory;

use super::split::Roles;
use crate::shape::ShapePolicy;

mesh_damper_recording::numbers! {
    /// Tones in a residual: which of its spectral lines may be a tone from outside, and which the motion makes.
    TonesPolicy {
        /// A search for a tone starts from at most this many of the strongest spectral lines.
        most: usize = 3, Tuned("the blind trial");
        /// Lines that the motion makes are known only if its displacement has at most this many spectral lines.
        most_of_motion: usize = 4, Convention("a modulated or beating sine has three; with more, the sums fill the band");
        /// The spectral lines of the displacement must hold at least this fraction of its power.
        hold: f64 = 0.95, Convention("the rest is starts, ends and noise");
        /// A spectral line of the displacement counts if its power exceeds this fraction of the strongest one's.
        least_of_motion: f64 = 1e-3, Convention("a thirtieth of its amplitude");
        /// The motion makes a line at each sum of up to this many frequencies of the displacement, with either sign.
        sums: usize = 4, Convention("a law of the third power makes sums of three, and a change that follows its power sums of four");
        /// A tone is one of the lines that the motion makes if it is off by less than this fraction of a line's width.
        off: f64 = 0.1, Derived("a line that stands out is located to a hundredth of its width, and a model's tone to less than a tenth");
    }
}

/// This many of the strongest spectral lines are examined for a tone; those that the motion makes are left out. Convention: the
/// motion makes about a dozen.
const MOST_SEEN: usize = 24;

/// The frequencies that a specimen produces from the motion.
#[derive(Clone, Debug)]
pub struct OfMotion {
    /// Hz, in order; empty if the motion has no lines.
    frequencies: Vec<f64>,
    /// How far a tone may be from one of them, Hz.
    off: f64,
}

impl OfMotion {
    /// From the longest of `trajectories`.
    pub fn of(trajectories: &[Trajectory]) -> Self {
        let longest = trajectories
            .iter()
            .max_by_key(|trajectory| trajectory.len());
        let Some(trajectory) = longest else {
            return Self {
                frequencies: Vec::new(),
                off: 0.0,
            };
        };
        let per_sample = few_lines(trajectory.motion.displacement.clone());
        let mut sums = vec![0.0];
        for _ in 0..TonesPolicy::in_use().sums {
            let more: Vec<f64> = sums
                .iter()
                .flat_map(|sum| per_sample.iter().flat_map(move |f| [sum + f, sum - f]))
                .collect();
            sums.extend(more);
            sums.sort_by(f64::total_cmp);
            sums.dedup();
        }
        Self {
            frequencies: sums.iter().map(|sum| sum / trajectory.tick).collect(),
            off: TonesPolicy::in_use().off / (trajectory.len() as f64 * trajectory.tick),
        }
    }

    /// Whether a tone of `frequency` in Hz is one of them: such a tone follows the motion and does not come from outside.
    pub fn holds(&self, frequency: f64) -> bool {
        let after = self
            .frequencies
            .partition_point(|&other| other < frequency - self.off);
        let next = self.frequencies.get(after);
        next.is_some_and(|next| *next <= frequency + self.off)
    }
}

/// The lines that contain nearly all of the power, cycles per sample; empty if there are more than a few.
fn few_lines(mut samples: Vec<f64>) -> Vec<f64> {
    let count = samples.len();
    let mean = samples.iter().sum::<f64>() / count.max(1) as f64;
    samples.iter_mut().for_each(|sample| *sample -= mean);
    let powers = powers(samples);
    let mut left = powers.clone();
    let total: f64 = powers.iter().sum();
    let (mut held, mut strongest) = (0.0, 0.0_f64);
    let mut lines = Vec::new();
    loop {
        let inner = 1..powers.len().saturating_sub(1);
        let Some(peak) = inner.max_by(|&a, &b| left[a].total_cmp(&left[b])) else {
            return Vec::new();
        };
        strongest = strongest.max(left[peak]);
        if left[peak] <= TonesPolicy::in_use().least_of_motion * strongest {
            break;
        }
        if lines.len() == TonesPolicy::in_use().most_of_motion {
            return Vec::new();
        }
        lines.push(place_of_line(&powers, peak) / count as f64);
        let around = peak.saturating_sub(LEAKS)..(peak + LEAKS + 1).min(powers.len());
        held += left[around.clone()].iter().sum::<f64>();
        left[around].fill(0.0);
    }
    if held >= TonesPolicy::in_use().hold * total {
        lines
    } else {
        Vec::new()
    }
}

/// Bins on each side of a line's peak that belong to it under the window of [`powers`].
const LEAKS: usize = 2;

/// The frequencies in Hz of the strongest lines, the strongest first, in the residual of `predicted` (kN, per trajectory and
/// sample) for the longest trajectory. It uses the open samples by `roles` and leaves out the frequencies `of_motion`.
pub fn tones(
    trajectories: &[Trajectory],
    roles: &Roles,
    predicted: &[Vec<f64>],
    of_motion: &OfMotion,
) -> Vec<f64> {
    let Some(longest) = (0..trajectories.len()).max_by_key(|&which| trajectories[which].len())
    else {
        return Vec::new();
    };
    let trajectory = &trajectories[longest];
    let left: Vec<f64> = (0..trajectory.len())
        .map(|index| {
            if trajectory.is_comparable(index) && roles.is_open(longest, index) {
                trajectory.force[index] - predicted[longest][index]
            } else {
                0.0
            }
        })
        .collect();
    let frequencies = lines(left).into_iter().map(|line| line / trajectory.tick);
    // No law can have a tone that the slowest recording does not show.
    let slowest = trajectories
        .iter()
        .fold(0.0_f64, |most, one| most.max(one.tick));
    let highest = ShapePolicy::in_use().highest_tone / slowest;
    let without =
        frequencies.filter(|frequency| *frequency <= highest && !of_motion.holds(*frequency));
    without.take(TonesPolicy::in_use().most).collect()
}

/// The strongest lines in cycles per sample.
fn lines(samples: Vec<f64>) -> Vec<f64> {
    let count = samples.len();
    let powers = powers(samples);
    let mut peaks: Vec<usize> = (2..powers.len().saturating_sub(2))
        .filter(|&k| powers[k] > powers[k - 1] && powers[k] >= powers[k + 1])
        .collect();
    peaks.sort_by(|&a, &b| powers[b].total_cmp(&powers[a]));
    peaks
        .into_iter()
        .take(MOST_SEEN)
        .map(|peak| place_of_line(&powers, peak) / count as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{few_lines, lines};

    /// A modulated sine has three lines, noise has none.
    #[test]
    fn lines_of_a_motion_are_few_or_none() {
        let count = 20_000;
        let turn = |frequency: f64, index: usize| std::f64::consts::TAU * frequency * index as f64;
        let modulated =
            |index| (1.0 + 0.5 * turn(2.03e-4, index).cos()) * turn(6.01e-3, index).sin();
        let mut found = few_lines((0..count).map(modulated).collect());
        found.sort_by(f64::total_cmp);
        assert_eq!(found.len(), 3, "{found:?}");
        for (found, expected) in found.iter().zip([5.807e-3, 6.01e-3, 6.213e-3]) {
            assert!(
                (found - expected).abs() * (count as f64) < 0.1,
                "{found} {expected}"
            );
        }
        let many = |index| (1..9).map(|n| turn(1.3e-3 * n as f64, index).sin()).sum();
        assert!(few_lines((0..count).map(many).collect()).is_empty());
    }

    /// Of two tones between bins the stronger comes first, each within a fiftieth of a bin.
    #[test]
    fn tones_between_bins_are_placed() {
        let count = 4000;
        let tone = |frequency: f64, index: usize| {
            (std::f64::consts::TAU * frequency * index as f64 + 0.4).sin()
        };
        for part in [0.0, 0.2, 0.5, 0.9] {
            let (strong, weak) = ((200.0 + part) / 4000.0, (731.0 - part) / 4000.0);
            let samples: Vec<f64> = (0..count)
                .map(|index| tone(strong, index) + 0.1 * tone(weak, index))
                .collect();
            let found = lines(samples);
            assert!(
                (found[0] - strong).abs() * 4000.0 < 0.02,
                "{found:?} {strong}"
            );
            assert!((found[1] - weak).abs() * 4000.0 < 0.1, "{found:?} {weak}");
        }
    }
}
