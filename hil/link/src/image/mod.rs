//! Images of the crate for microcontrollers: built, measured, and the emulator that runs them.

mod board;
mod build;
mod sections;

pub use board::Board;
pub use build::{FIRMWARE, Image, OWN_TIMER, SERIAL, build};
pub use sections::{Sections, sections};
