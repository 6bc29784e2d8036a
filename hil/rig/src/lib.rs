//! The crate in a loop with the simulated rig, in this process, tick by tick.
//!
//! Every quantity passes between the two as on a real bench: volts into the simulated ADC, bytes over the simulated bus, bytes into
//! the simulated DAC, volts out of it, a level on the enable line.
//!
//! Simulated parts use f64 and seeded noise: the same seed gives the same run.
//!
//! | module | for |
//! |---|---|
//! | the root | [`run_rig`]: a whole programme, recorded; [`Bench`]: the same tick by tick; [`EmulatorBench`]: the crate as a damper |
//! | [`specimen`] | the specimen: eq 13, and effects that the law does not contain |
//! | [`drive`] | any motion for the rig to follow, and its demands on the rig |
//! | [`actuator`] | actuator, sensors, converters and enable line |
//! | [`signals`] | interference with the signals between these parts and the controller |
//! | [`campaign`] | faults and attacks injected into these parts, and the findings of the rig's monitor |
//!
//! A controller that runs elsewhere takes part as a [`Controlled`].
//!
//! ```
//! use mesh_damper::effects::AugmentedLaw;
//! use mesh_damper::law::Law;
//! use mesh_damper::sine::{Block, Programme};
//! use mesh_damper_rig::specimen::Specimen;
//! use mesh_damper_rig::{RigSetup, TICK_RATE, run_rig};
//!
//! let specimen = Specimen::of_density(3.0, 0.1);
//! let law: AugmentedLaw<f32, 1> = AugmentedLaw::new(Law::new(1.05, 10.5, 0.11, 0.4)?);
//! let programme = Programme::<1>::new(TICK_RATE, 1)?.with(Block::sine(0.1, 5.0, 4)?)?;
//! let run = run_rig(RigSetup::new(specimen, law, programme, 1), |_| {})?;
//! assert_eq!(run.steady_cycles(0).count(), 4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod actuator;
mod bench;
pub mod campaign;
pub mod check;
pub mod drive;
mod emulation;
mod expected;
mod journal;
mod plant;
mod run;
#[cfg(feature = "schema")]
mod schema;
pub mod signals;
pub mod specimen;

pub use bench::{Bench, RigSetup, SetupError};
pub use emulation::{Emulation, EmulatorBench, EmulatorSetup};
pub use journal::Journal;
pub use plant::{Passed, Plant};
pub use run::{Controlled, Plan, RigRun, Samples, Watch, run_controlled, run_rig};

/// Default tick rate of the crate, Hz.
pub const TICK_RATE: f64 = 10_000.0;
