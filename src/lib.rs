//! The elastic porous metal mesh damper at a fixed tick: its force law, what a cycle comes to, and the rig that tests it.
//!
//! No allocation, no unsafe code, `no_std`; f32 on the hot path. Constructors validate and name the field that is wrong;
//! what runs every tick cannot fail and is finite for every finite input. Configuration and state are two types.
//!
//! | for | use |
//! |---|---|
//! | the mixed damping law F = k1·y + k3·y³ + c·\|v\|^α·sgn v | [`law`], [`power`] |
//! | its coefficients over density and amplitude, the published ones included | [`table`] |
//! | the published loops by one law for every amplitude, for a motion that nobody declares | [`amplitude_independent`] |
//! | that law as it runs on the target, with a table for \|v\|^α: with the effects that a type names | [`static_law`] |
//! | the same read from a pack, with a swap at a cycle's end | [`fast_law`] |
//! | what firmware asks of either | [`tick_law`] |
//! | what the law lacks: offset, asymmetry, hardening, load friction, stops, gaps, stick-slip, viscosity, relaxation, inertia, drift, temperature, tones, series compliance, delay | [`effects`] |
//! | an excitation: sines, ramps and sweeps | [`sine`] |
//! | stiffness, energy and loss factor of each cycle | [`cycle`]; without a generator, [`crossing`] |
//! | the same without a floating-point unit: law, sine and cycles in integers | [`fixed_point`] |
//! | the law under an excitation, without a specimen, at the least cost a tick | [`simulation`] |
//! | velocity and acceleration from a measured displacement | [`observer`] |
//! | a law as bytes, loadable while running | [`pack`] |
//! | whether a law gives no more energy than it takes | [`passivity`] |
//! | whether a motion is one that a law was fitted on | [`operating_range`] |
//! | the fixed-tick controller of a rig, or of an emulated damper | [`rig`] |
//! | what has gone wrong with specimen, sensors and actuator of that rig | [`health`] |
//! | the link between a harness and the image of a rig | [`frame`], [`message`] |
//! | a 16-bit ADC and DAC on SPI | [`adc`], [`dac`], [`converter`] |
//!
//! Units are mm, s, kN, J = kN·mm and °C throughout. Effects are generic over [`real::Real`], so that identification in f64
//! and firmware in f32 run the same lines.
//!
//! # Example
//! A mesh of 3 g/cm³ shaken by 0.1 mm at 1 Hz, 10 000 ticks a second:
//!
//! ```
//! use mesh_damper::cycle::CycleAccumulator;
//! use mesh_damper::sine::{Block, Programme, SineGenerator};
//! use mesh_damper::table::PAPER;
//!
//! let law = PAPER.lookup(3.0, 0.1).law;
//! let programme = Programme::<1>::new(10_000.0, 1)?.with(Block::sine(0.1, 1.0, 3)?)?;
//! let mut generator = SineGenerator::new(programme)?;
//! let mut accumulator = CycleAccumulator::new();
//! let mut cycles = 0;
//! loop {
//!     let now = generator.tick();
//!     if now.done {
//!         break;
//!     }
//!     let force = law.force(now.displacement, now.velocity);
//!     // The first cycle is the ramp that leads up to the block.
//!     if let (Some([cycle]), 2..) = (accumulator.update(now.displacement, [force], now.phase), now.cycle) {
//!         assert!((cycle.stiffness - 1.6915).abs() < 1e-4);
//!         assert!((cycle.loss_factor - 0.6249).abs() < 1e-4);
//!         cycles += 1;
//!     }
//! }
//! assert_eq!(cycles, 3);
//! # Ok::<(), mesh_damper::error::ConfigError>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "std")]
extern crate std;

pub mod adc;
pub mod amplitude_independent;
pub mod converter;
pub mod crossing;
pub mod cycle;
pub mod dac;
pub mod effects;
pub mod error;
pub mod fast_law;
#[cfg(feature = "fixed-point")]
pub mod fixed_point;
pub mod frame;
pub mod health;
pub mod law;
pub mod limits;
pub mod message;
pub mod observer;
pub mod operating_range;
pub mod pack;
pub mod passivity;
pub mod power;
pub mod real;
pub mod rig;
pub mod simulation;
pub mod sine;
pub mod static_law;
mod sum;
pub mod table;
pub mod telemetry;
pub mod tick_law;

/// The README's example is compiled, so that it cannot rot.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// So are those of the other pages with Rust code.
#[cfg(doctest)]
#[doc = include_str!("../docs/firmware.md")]
struct Firmware;
#[cfg(doctest)]
#[doc = include_str!("../docs/export.md")]
struct Export;

/// Former names of what is in [`fast_law`].
#[deprecated(note = "use fast_law::{FastLaw, RunningLaw, Adaptation}")]
pub mod tabulated {
    pub use crate::fast_law::{Adaptation as Followed, FastLaw as TabulatedLaw, RunningLaw};
}

/// Former name of what is in [`simulation`].
#[deprecated(note = "use simulation::Simulation")]
pub mod virtual_test {
    pub use crate::simulation::Simulation as VirtualTest;
}

/// Former name of [`amplitude_independent`].
#[deprecated(note = "use amplitude_independent")]
pub mod amplitude_free {
    pub use crate::amplitude_independent::*;
}
