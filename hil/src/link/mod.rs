//! The crate in a loop with the simulated rig, in this process, tick by tick.
//!
//! Every quantity passes between the two as it would on a bench: volts into the simulated ADC, bytes over the simulated
//! bus, bytes into the simulated DAC, volts out of it, a level on the enable line.

mod bench;
mod emulation;
mod expected;
pub mod image;
mod journal;
mod plant;
mod run;

pub use bench::{Bench, RigSetup, SetupError};
pub use emulation::{Emulation, EmulatorBench, EmulatorSetup};
pub use journal::Journal;
pub use plant::Plant;
pub use run::{Controlled, RigRun, Samples, Watch, run_rig, run_rig_on};

/// Tick rate of the crate unless told otherwise, Hz.
pub const TICK_RATE: f64 = 10_000.0;
