//! The image for the commands that run on it.

use clap::ValueEnum;
use mesh_damper_link::image::Board;
use mesh_damper_link::lockstep::{self, Emulator, Image};
use mesh_damper_recording::error::InputError;
use serde::Serialize;

use crate::commands::progress::Progress;

/// Where the crate runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum On {
    /// In this process
    Host,
    /// In the firmware's image, in an emulator
    Image,
}

/// Which of the image's log messages are shown.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum LogLevel {
    /// Where the rig stops
    Error,
    /// And what is refused
    Warn,
    /// And starts, blocks, cycles and coefficient packs
    Info,
}

impl LogLevel {
    fn shows(self, level: lockstep::LogLevel) -> bool {
        let least = match self {
            Self::Error => lockstep::LogLevel::Error,
            Self::Warn => lockstep::LogLevel::Warn,
            Self::Info => lockstep::LogLevel::Info,
        };
        level >= least
    }
}

/// The firmware's image in the emulator, its log on standard error with the time of ticks at `tick_rate` Hz.
pub fn start_image(log: LogLevel, tick_rate: f64) -> Result<Image<Emulator>, InputError> {
    let board = Board::Mps2An386;
    // Before anything is said of a build that cannot be.
    board.check()?;
    let progress = Progress::of(1);
    progress.step("building the firmware's image");
    Image::start(
        board,
        Box::new(move |line| {
            if log.shows(line.level) {
                let time = f64::from(line.tick) / tick_rate;
                eprintln!("image {time:10.4} s {:5} {}", line.level.name(), line.text);
            }
        }),
    )
}
