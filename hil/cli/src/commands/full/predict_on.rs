//! The force of a model by the firmware's image, in an emulator or on a board.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use mesh_damper_link::lockstep;
use mesh_damper_link::predict::{ImageError, predict_on};
use mesh_damper_model::{Model, ModelError};
use mesh_damper_output::error::InputError;
use mesh_damper_recording::trajectory::Trajectory;

use super::board::Port;
use super::image::start_image;

pub use super::image::LogLevel;

/// The place of an image.
#[derive(Clone, Debug, PartialEq)]
pub enum Link {
    /// In an emulator.
    Image,
    /// On a board.
    Serial(Port),
}

impl FromStr for Link {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "image" => Ok(Self::Image),
            _ => text.parse().map(Self::Serial),
        }
    }
}

impl Display for Link {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image => f.write_str("image"),
            Self::Serial(port) => port.fmt(f),
        }
    }
}

impl Link {
    /// The force of `model` over `trajectory`, kN, one value per tick.
    ///
    /// # Errors
    /// The image or the board does not answer, or the crate rejects the model, which `wrong` describes.
    pub fn predict(
        &self,
        log: LogLevel,
        model: &Model,
        trajectory: &Trajectory,
        wrong: impl Fn(ModelError) -> InputError,
    ) -> Result<Vec<f64>, InputError> {
        let predicted = match self {
            Self::Image => {
                // Ticks are not counted for a law alone.
                let mut image = start_image(log, 1.0)?;
                predict_on(&mut image, model, trajectory)
            }
            Self::Serial(port) => {
                let mut board = lockstep::Image::at(port.path())?;
                predict_on(&mut board, model, trajectory)
            }
        };
        predicted.map_err(|error| match error {
            ImageError::Model(error) => wrong(error),
            ImageError::Link(error) => error.into(),
        })
    }
}
