//! The reason why a model is not exported, with the option or the file concerned.

use mesh_damper_model::ModelError;
use mesh_damper_model::export::ExportError;
use mesh_damper_model::file::model_error;
use mesh_damper_output::error::{InputError, Place};

use super::Request;

impl Request {
    /// `error` with the option or the file concerned.
    pub(crate) fn refused(&self, error: &ExportError) -> InputError {
        let model = self.model.display().to_string();
        match error {
            ExportError::Setting(setting) => {
                let said = setting.to_string();
                let field = said.split(' ').next().unwrap_or_default();
                InputError::new(
                    format!("--{}", field.replace('_', "-")),
                    said.clone(),
                    "give a value within that",
                )
            }
            ExportError::NoAmplitude => InputError::new(
                "--amplitude",
                format!("the law of {model} has the same coefficients at every amplitude"),
                "leave --amplitude out",
            ),
            ExportError::Model(error @ ModelError::Refused { .. }) => {
                let mut refused = model_error(&model, error);
                refused.remedy = format!(
                    "give a --tick-rate other than {}, correct the field, or trace the recordings again",
                    self.tick_rate
                );
                refused
            }
            ExportError::Model(error) => model_error(&model, error),
            ExportError::Active(active) => InputError::new(
                model,
                format!("the law is active: {active}"),
                "correct it, or give --allow-active to export the law as it is",
            )
            .at(Place::Field(format!("{}.{}", active.effect, active.field))),
            ExportError::ResidualTable => InputError::new(
                model,
                "a Rust module cannot hold a residual table",
                "export it with --format pack or c, which firmware reads at run time",
            )
            .at(Place::Field("correction".into())),
        }
    }
}
