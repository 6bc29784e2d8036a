//! The image, for the commands that run on it.

use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use clap::ValueEnum;
use mesh_damper_link::image::Board;
use mesh_damper_link::lockstep::{self, Emulator, Image, Serial};
use mesh_damper_output::error::InputError;
use mesh_damper_output::terminal::tell;
use mesh_damper_sources::Sources;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Serialize, Serializer};

use super::board::Port;
use crate::commands::progress::Progress;

/// The place where the crate runs.
#[derive(Clone, Copy, Debug, PartialEq, JsonSchema, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum On {
    /// In this process
    Host,
    /// In the firmware image, in an emulator
    Image,
}

impl On {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Host => "host",
            Self::Image => "image",
        }
    }
}

/// The place where the crate runs, including a board.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// In this process.
    Host,
    /// In the firmware's image, in an emulator.
    Image,
    /// On a board, in lockstep over this serial port.
    Serial(Port),
}

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "host" => Ok(Self::Host),
            "image" => Ok(Self::Image),
            _ => text
                .parse()
                .map(Self::Serial)
                .map_err(|_| "give host, image or serial:PORT, such as serial:/dev/ttyACM0".into()),
        }
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Host => f.write_str("host"),
            Self::Image => f.write_str("image"),
            Self::Serial(port) => port.fmt(f),
        }
    }
}

impl JsonSchema for Place {
    fn schema_name() -> Cow<'static, str> {
        "Place".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({"type": "string", "description": "Where the crate ran: `host`, `image` or `serial:PORT`."})
    }
}

impl Serialize for Place {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The crate at the other end of a link.
pub enum Linked {
    /// In an emulator.
    Image(Box<Image<Emulator>>),
    /// At a serial port.
    Board(Box<Image<Serial>>),
}

impl Linked {
    /// The link that `place` needs; `None` for this process. The image's log goes to standard error with the time of ticks at
    /// `tick_rate` Hz; a board has its own log.
    ///
    /// # Errors
    /// No emulator, no board, or no answer from the board.
    pub fn at(place: &Place, log: LogLevel, tick_rate: f64) -> Result<Option<Self>, InputError> {
        Ok(match place {
            Place::Host => None,
            Place::Image => Some(Self::Image(start_image(log, tick_rate)?.into())),
            Place::Serial(port) => Some(Self::Board(Image::in_lockstep(port.path())?.into())),
        })
    }
}

/// The image's log messages to show.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum LogLevel {
    /// Trips only
    Error,
    /// Also what the image refuses
    Warn,
    /// Also starts, blocks, cycles and coefficient packs
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

/// Folder in which an installed command builds images, among its sources.
pub const IMAGES: &str = "target/mps2-an386";

/// Prints where an installed command builds `what`, and that the first build takes its time, if there is no folder `built` among
/// its sources.
pub fn say_where(sources: &Sources, what: &str, built: &str) {
    if !sources.is_repository() && !sources.root().join(built).exists() {
        tell(&format!(
            "note: {what} is built in {}; the first build takes a minute, and cargo downloads its dependencies",
            sources.root().display()
        ));
    }
}

/// Starts the firmware's image in the emulator, with its log on standard error and the time of ticks at `tick_rate` Hz.
pub fn start_image(log: LogLevel, tick_rate: f64) -> Result<Image<Emulator>, InputError> {
    let board = Board::Mps2An386;
    // A build that is not possible fails before the note about it.
    board.check()?;
    say_where(&Sources::find()?, "the firmware's image", IMAGES);
    let progress = Progress::of(1);
    progress.step("building the firmware's image");
    Image::start(
        board,
        Box::new(move |line| {
            if log.shows(line.level) {
                let time = f64::from(line.tick) / tick_rate;
                tell(&format!(
                    "image {time:10.4} s {:5} {}",
                    line.level.name(),
                    line.text
                ));
            }
        }),
    )
}
