//! Whether the residual of a law changes on its own, independently of the motion.

use std::borrow::Borrow;

use mesh_damper_model::predict::predict;
use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::trajectory::Trajectory;

use crate::tolerance::held_to;

mesh_damper_recording::numbers! {
    /// When a force wanders.
    WanderPolicy {
        /// A force wanders if the mean residuals of the cycles of a block differ, in squares, by more than this many times what noise
        /// causes.
        more: f64 = 20.0, Tuned("the recordings of others");
    }
}

/// Whether the mean residual of `model` differs between the cycles of one block by more than noise explains. A cycle is used if
/// each of its samples `counts`, given the index of its trajectory and its own.
pub(super) fn wanders(
    trajectories: &[impl Borrow<Trajectory>],
    counts: impl Fn(usize, usize) -> bool,
    model: &Model,
) -> Result<bool, ModelError> {
    let (mut squares, mut expected) = (0.0, 0.0);
    for (which, trajectory) in trajectories.iter().enumerate() {
        let trajectory = trajectory.borrow();
        let predicted = predict(model, trajectory)?;
        for block in &trajectory.blocks {
            let cycles = block.cycles.iter().filter(|cycle| {
                let mut samples = (*cycle).clone();
                samples.all(|i| trajectory.is_comparable(i) && counts(which, i))
            });
            let means: Vec<f64> = cycles
                .map(|cycle| {
                    let left = cycle.clone().map(|i| trajectory.force[i] - predicted[i]);
                    let count = cycle.len() as f64;
                    let noise = cycle.clone().map(|i| held_to(trajectory, i));
                    expected += noise.sum::<f64>() / (count * count);
                    left.sum::<f64>() / count
                })
                .collect();
            let mean = means.iter().sum::<f64>() / means.len().max(1) as f64;
            squares += means.iter().map(|m| (m - mean).powi(2)).sum::<f64>();
        }
    }
    Ok(squares > WanderPolicy::in_use().more * expected)
}
