//! Checks of a model file beyond the types of its fields.

use mesh_damper::effects::CONTROLS;
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper_output::error::{InputError, Place};

use super::ModelFile;
use crate::{AddedEffect, ModelError};

/// The tick with which effects are built to check their parameters, s: that of the rig.
const CHECKED_TICK: f64 = 1e-4;

impl ModelFile {
    /// Whether the model can be built, and every number is in its range; errors call the file `name`.
    pub(super) fn check(&self, name: &str) -> Result<(), InputError> {
        let refused = |field: String, problem: String| {
            Err(InputError::new(
                name,
                problem,
                "correct the field, or trace the recordings again",
            )
            .at(Place::Field(field)))
        };
        for (index, node) in self.law.iter().enumerate() {
            if !(0.0..=mesh_damper::limits::DISPLACEMENT).contains(&node.amplitude) {
                return refused(
                    format!("law[{index}].amplitude"),
                    format!(
                        "{} is outside 0…{}",
                        node.amplitude,
                        mesh_damper::limits::DISPLACEMENT
                    ),
                );
            }
            if let Err(error) = Law::new(node.k1, node.k3, node.c, node.alpha) {
                return refused(
                    format!("law[{index}]{}", field_of(&error)),
                    error.to_string(),
                );
            }
        }
        for (field, [low, high]) in [
            ("displacement", self.fitted_range.displacement),
            ("velocity", self.fitted_range.velocity),
        ] {
            // An infinite value would be written as null, which cannot be read back; a firmware takes the value as f32.
            if !((low as f32).is_finite() && (high as f32).is_finite() && low <= high) {
                return refused(
                    format!("fitted_range.{field}"),
                    format!("{low} to {high} is not a finite range"),
                );
            }
        }
        let [low, high] = self.displacement_zero;
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return refused(
                "displacement_zero".into(),
                format!("{low} to {high} is not a finite range"),
            );
        }
        if let Some(elsewhere) = self.elsewhere
            && !(0.0..f64::INFINITY).contains(&elsewhere.most)
        {
            return refused(
                "elsewhere.most".into(),
                format!("{} is no fraction of a force", elsewhere.most),
            );
        }
        if self.controls.len() > CONTROLS {
            return refused(
                "controls".into(),
                format!(
                    "{} control inputs are given, at most {CONTROLS} are possible",
                    self.controls.len()
                ),
            );
        }
        for (index, control) in self.controls.iter().enumerate() {
            let others = &self.controls[..index];
            if control.name.is_empty() {
                return refused(
                    format!("controls[{index}].name"),
                    "the name is empty".into(),
                );
            }
            if others.iter().any(|each| each.name == control.name) {
                return refused(
                    format!("controls[{index}].name"),
                    format!("the name {:?} is used twice", control.name),
                );
            }
            let [low, high] = control.range;
            if !(low.is_finite() && high.is_finite() && low <= high) {
                return refused(
                    format!("controls[{index}].range"),
                    format!("{low} to {high} is not a finite range"),
                );
            }
        }
        let unnamed = |effect: &AddedEffect| {
            let place = effect.parameters.get("input").copied();
            let is_controlled = effect.family.depends_on_control();
            is_controlled && place.unwrap_or_default() >= self.controls.len() as f64
        };
        if let Some(index) = self.effects.iter().position(unnamed) {
            return refused(
                format!("effects[{index}]"),
                "depends on a control input that `controls` does not name".into(),
            );
        }
        let amplitude = self.law.first().map_or(0.0, |node| node.amplitude);
        let model = self.model();
        model
            .augmented::<f64>(amplitude, CHECKED_TICK)
            .map_err(|error| model_error(name, &error))?;
        model
            .augmented::<f32>(amplitude, CHECKED_TICK)
            .map_err(|error| model_error(name, &error))?;
        Ok(())
    }
}

/// The error of a model that cannot be built, with the file of the model.
pub fn model_error(file: &str, error: &ModelError) -> InputError {
    let (field, problem) = match error {
        ModelError::Refused { place, error } => (place.clone(), error.to_string()),
        ModelError::Parameters { place, problem } => (place.clone(), problem.clone()),
        ModelError::Nodes(problem) => ("law".into(), (*problem).to_owned()),
        ModelError::Pack(error) => ("effects".into(), error.to_string()),
    };
    InputError::new(
        file,
        problem,
        "correct the field, or trace the recordings again",
    )
    .at(Place::Field(field))
}

/// `.k1` if the error names k1.
fn field_of(error: &ConfigError) -> String {
    match error {
        ConfigError::NonFinite(field) | ConfigError::OutOfRange { field, .. } => {
            format!(".{field}")
        }
        _ => String::new(),
    }
}
