//! Tones in what a law leaves of the force.

use mesh_damper_recording::spectrum::{place_of_line, powers};
use mesh_damper_recording::trajectory::Trajectory;

use super::split::Roles;
use crate::policy::policy;

mesh_damper_recording::numbers! {
    /// Tones in a residual.
    TonesPolicy {
        /// A search for a tone starts from this many of the strongest lines.
        most: usize = 3, Tuned("the blind trial");
    }
}

/// The frequencies in Hz of the strongest lines in what `predicted` (kN, per trajectory and sample) leaves of the force of
/// the longest trajectory, the strongest first; of the samples that are open, by `roles`.
pub fn tones(trajectories: &[Trajectory], roles: &Roles, predicted: &[Vec<f64>]) -> Vec<f64> {
    let Some(longest) = (0..trajectories.len()).max_by_key(|&which| trajectories[which].len())
    else {
        return Vec::new();
    };
    let trajectory = &trajectories[longest];
    let left: Vec<f64> = (0..trajectory.len())
        .map(|index| {
            if trajectory.measured[index] && roles.is_open(longest, index) {
                trajectory.force[index] - predicted[longest][index]
            } else {
                0.0
            }
        })
        .collect();
    lines(left)
        .into_iter()
        .map(|line| line / trajectory.tick)
        .collect()
}

/// The strongest lines in cycles per sample.
fn lines(samples: Vec<f64>) -> Vec<f64> {
    let count = samples.len();
    let powers = powers(samples);
    let mut peaks: Vec<usize> = (2..powers.len().saturating_sub(2))
        .filter(|&k| powers[k] > powers[k - 1] && powers[k] >= powers[k + 1])
        .collect();
    peaks.sort_by(|&a, &b| powers[b].total_cmp(&powers[a]));
    let strongest = peaks.into_iter().take(policy().tones.most);
    strongest
        .map(|peak| place_of_line(&powers, peak) / count as f64)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::lines;

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
