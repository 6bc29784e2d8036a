//! What a trace ends in, as a model file.

use mesh_damper_model::file::{FittedRange, ModelFile};
use mesh_damper_recording::motion::MotionEstimate;

use super::{Role, Trace};

impl Trace {
    /// The contents of `model.json`: the model with the range of motion that it was fitted on.
    pub fn model_file(&self) -> ModelFile {
        let fitted = |channel: fn(&MotionEstimate) -> &Vec<f64>| {
            self.recordings.iter().flat_map(move |traced| {
                let values = channel(&traced.trajectory.motion);
                values
                    .iter()
                    .zip(&traced.roles)
                    .filter(|(_, role)| **role != Role::HeldOut)
                    .map(|(value, _)| value)
            })
        };
        let still = FittedRange {
            displacement: [0.0; 2],
            velocity: [0.0; 2],
        };
        let range = FittedRange::of(
            fitted(|motion| &motion.displacement),
            fitted(|motion| &motion.velocity),
        );
        ModelFile::new(self.model.clone(), range.unwrap_or(still))
    }
}
