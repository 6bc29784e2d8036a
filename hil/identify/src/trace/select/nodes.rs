//! Eq 13 has coefficients at the amplitudes of the blocks: these nodes, and the error between them.

use mesh_damper_model::ModelError;
use mesh_damper_model::predict::predict;
use mesh_damper_recording::cycles::{FoundBlock, levels, same_amplitude};
use mesh_damper_recording::trajectory::Trajectory;

use super::super::split::{Role, Roles};
use crate::base_law::BaseLaw;
use crate::problem::Problem;
use crate::rows::Rows;
use crate::rows::SEARCH_ROWS;
use crate::shape::Extent;
use crate::solution::Solution;

/// How well a law with coefficients at the amplitudes `nodes` predicts an amplitude that it was not fitted to. Each inner node in
/// turn is left out; returns the root of the summed squared error there, kN. Samples that `roles` hold out are not used.
pub fn error_between(
    trajectories: &[Trajectory],
    roles: &Roles,
    nodes: &[f64],
    left_out: &[f64],
    (found, law): (&Solution, BaseLaw),
) -> Result<f64, ModelError> {
    let extent = Extent::of(trajectories);
    let mut error = 0.0;
    for &amplitude in left_out {
        let is_left_out = |which: usize, sample: usize| {
            let trajectory: &Trajectory = &trajectories[which];
            same_amplitude(trajectory.amplitude[sample], amplitude)
        };
        let others = nodes
            .iter()
            .copied()
            .filter(|&node| node != amplitude)
            .collect();
        let rows = Rows::gather(trajectories, law, others, SEARCH_ROWS, |which, sample| {
            roles.is_open(which, sample) && !is_left_out(which, sample)
        });
        let model = Problem::new(&rows, &extent, &found.terms())
            .solve_near(found)
            .model();
        for (which, trajectory) in trajectories.iter().enumerate() {
            let predicted = predict(&model, trajectory)?;
            error += (0..trajectory.len())
                .filter(|&sample| roles.is_open(which, sample) && is_left_out(which, sample))
                .map(|sample| (predicted[sample] - trajectory.force[sample]).powi(2))
                .sum::<f64>();
        }
    }
    Ok(error.sqrt())
}

/// The levels of amplitude in mm of the fitted blocks.
pub fn amplitude_nodes(trajectories: &[Trajectory], roles: &Roles) -> Vec<f64> {
    let is_fitted = |which: usize, block: &FoundBlock| {
        let mut samples = block.samples.clone();
        samples.any(|sample| roles.of(which, sample) == Role::Fit)
    };
    let each = trajectories.iter().enumerate();
    levels(each.flat_map(|(which, trajectory)| {
        let fitted = trajectory
            .blocks
            .iter()
            .filter(move |block| is_fitted(which, block));
        fitted.map(|block| block.amplitude)
    }))
}
