//! Distinguishes changes over time from differences between blocks: a change over time also appears between the cycles of one
//! block.
//!
//! If the blocks of a test are in order of their frequency, everything that depends on frequency looks like a drift, but one that
//! stands still in every block.

use mesh_damper_recording::cycles::FoundBlock;
use mesh_damper_recording::trajectory::Trajectory;

use crate::tolerance::held_to;

/// Phases at which cycles are compared.
const PHASES: usize = 16;

/// Whether `changing` predicts changes from cycle to cycle within blocks at least as well as `still`, on the samples that
/// `counts(trajectory, sample)` picks. Both are forces on every trajectory, kN. It also holds if no block has two cycles.
pub(super) fn is_seen_within_blocks(
    trajectories: &[Trajectory],
    counts: impl Fn(usize, usize) -> bool,
    changing: &[Vec<f64>],
    still: &[Vec<f64>],
) -> bool {
    let left = |predicted: &[Vec<f64>]| -> f64 {
        let each = trajectories.iter().zip(predicted).enumerate();
        each.map(|(which, (trajectory, predicted))| {
            left_of_changes(trajectory, |sample| counts(which, sample), predicted)
        })
        .sum()
    };
    left(changing) <= left(still)
}

/// The residual of `predicted` on `trajectory` without the part that is common to all cycles of a block: squares over those of the
/// noise.
fn left_of_changes(
    trajectory: &Trajectory,
    counts: impl Fn(usize) -> bool,
    predicted: &[f64],
) -> f64 {
    let left = |sample: usize| {
        (trajectory.force[sample] - predicted[sample]) / held_to(trajectory, sample).sqrt()
    };
    let several = |block: &&FoundBlock| block.cycles.len() > 1;
    let mut squares = 0.0;
    for block in trajectory.blocks.iter().filter(several) {
        let mut at_phases: [Vec<f64>; PHASES] = Default::default();
        for cycle in &block.cycles {
            for (phase, at_phase) in at_phases.iter_mut().enumerate() {
                let place = cycle.start as f64 + (phase * cycle.len()) as f64 / PHASES as f64;
                let (before, part) = (place as usize, place.fract());
                let after = (before + 1).min(cycle.end - 1);
                if counts(before) && counts(after) {
                    at_phase.push((1.0 - part) * left(before) + part * left(after));
                }
            }
        }
        for at_phase in &at_phases {
            let mean = at_phase.iter().sum::<f64>() / at_phase.len() as f64;
            squares += at_phase
                .iter()
                .map(|left| (left - mean).powi(2))
                .sum::<f64>();
        }
    }
    squares
}
