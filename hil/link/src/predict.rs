//! The force that an image gives for a recorded motion.

use mesh_damper::effects::Motion;
use mesh_damper_model::predict::motion_at;
use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::trajectory::Trajectory;

use crate::lockstep::{Image, LinkError, Wire};

/// Why an image made no prediction.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImageError {
    /// The model was rejected.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The link failed.
    #[error(transparent)]
    Link(#[from] LinkError),
}

/// [`mesh_damper_model::predict::predict_embedded`] on an image without a rig.
///
/// # Errors
/// A model that the crate rejects, or an error of the link.
pub fn predict_on<W: Wire>(
    image: &mut Image<W>,
    model: &Model,
    trajectory: &Trajectory,
) -> Result<Vec<f64>, ImageError> {
    let motions: Vec<Motion<f32>> = (0..trajectory.len())
        .map(|index| motion_at(trajectory, index))
        .collect();
    let mut forces = Vec::with_capacity(motions.len());
    image.rest()?;
    for same in trajectory.amplitude.chunk_by(|a, b| a == b) {
        image.send_pack(&model.pack(same[0], trajectory.tick)?)?;
        let from = forces.len();
        image.forces(&motions[from..from + same.len()], &mut forces)?;
    }
    Ok(trajectory.shown(forces.into_iter().map(f64::from).collect()))
}
