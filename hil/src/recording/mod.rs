//! Recordings.
pub mod cycles;
mod harmonic;
pub mod motion;
pub mod trajectory;
