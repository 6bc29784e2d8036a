//! What a drift over the cycles is told by from what only differs from block to block: it goes on within them.
//!
//! Where the blocks of a test come in order of their frequency, whatever depends on frequency looks like a drift that stands
//! still in every block.

use super::score::Jury;
use crate::identify::solution::Solution;
use crate::identify::term::Form;
use crate::recording::trajectory::Trajectory;

/// Whether a stiffness of its own for every block predicts better than the drift of `solution` beside such stiffnesses.
/// `predicted` is the force of `solution` on every trajectory, kN.
pub(super) fn stands_still_within_blocks(
    trajectories: &[Trajectory],
    fitted: &Jury,
    solution: &Solution,
    predicted: &[Vec<f64>],
) -> bool {
    let drifts: Vec<usize> = (0..solution.terms.len())
        .filter(|&index| solution.terms[index].term.form == Form::Drift)
        .collect();
    let [drift] = drifts[..] else { return false };
    let drift = &solution.terms[drift];
    let (Some(&stiffness), Some(&lasting)) = (drift.sizes.first(), drift.shapes.first()) else {
        return false;
    };
    let (mut drifting, mut still) = (Vec::new(), Vec::new());
    for (which, (trajectory, predicted)) in trajectories.iter().zip(predicted).enumerate() {
        let without: Vec<f64> = (0..trajectory.len())
            .map(|i| {
                let settled = 1.0 - (-trajectory.cycles[i] / lasting).exp();
                predicted[i] - stiffness * settled * trajectory.motion.displacement[i]
            })
            .collect();
        drifting.push(with_stiffness_by_block(
            trajectory, fitted, which, predicted,
        ));
        still.push(with_stiffness_by_block(trajectory, fitted, which, &without));
    }
    fitted.score(&still).nrmse() < fitted.score(&drifting).nrmse()
}

/// `force` and, in each block, the spring that it lacks there on the samples of `fitted`.
fn with_stiffness_by_block(
    trajectory: &Trajectory,
    fitted: &Jury,
    which: usize,
    force: &[f64],
) -> Vec<f64> {
    let y = &trajectory.motion.displacement;
    let mut with = force.to_vec();
    for block in &trajectory.blocks {
        let (mut lacks, mut squares) = (0.0, 0.0);
        for i in fitted.samples(which).filter(|i| block.samples.contains(i)) {
            lacks += y[i] * (trajectory.force[i] - force[i]);
            squares += y[i] * y[i];
        }
        if squares > 0.0 {
            for i in block.samples.clone() {
                with[i] += lacks / squares * y[i];
            }
        }
    }
    with
}
