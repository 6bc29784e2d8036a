//! The option for a control input that is constant for the whole recording.

use clap::Args;
use mesh_damper_model::Model;
use mesh_damper_output::error::InputError;
use mesh_damper_tables::control::ControlChannel;

use crate::commands::warn;

/// Control inputs of a damper.
#[derive(Args, Debug)]
pub struct Controls {
    /// Constant value of a control input, such as current_A=0.5; it replaces the column of that name
    #[arg(long = "control", value_name = "NAME=VALUE", value_parser = named, allow_hyphen_values = true)]
    given: Vec<(String, f64)>,
}

fn named(text: &str) -> Result<(String, f64), String> {
    let parts = text.split_once('=');
    let parsed = parts.and_then(|(name, value)| Some((name.to_owned(), value.parse().ok()?)));
    let is_finite = |(_, value): &(String, f64)| value.is_finite();
    parsed
        .filter(is_finite)
        .ok_or_else(|| "give a column's name and a number, such as current_A=0.5".to_owned())
}

impl Controls {
    /// The control inputs of `model` in their order, `count` samples each: the constant values given here, or the columns `known`
    /// of `file`.
    ///
    /// # Errors
    /// A control input that the model does not have, or one that the model has and that is neither given nor in the file.
    pub fn of(
        &self,
        model: &Model,
        (file, known): (&str, &[ControlChannel]),
        count: usize,
    ) -> Result<Vec<ControlChannel>, InputError> {
        let channels = model.held_controls((file, known), &self.given, count)?;
        for (channel, control) in channels.iter().zip(&model.controls) {
            if let Some(said) = control.beyond(&channel.values) {
                warn(&said);
            }
        }
        Ok(channels)
    }
}
