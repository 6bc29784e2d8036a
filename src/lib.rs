//! The elastic porous metal mesh damper at a fixed tick: its force law, the stiffness and energy of each cycle, and the rig that
//! tests it.
//!
//! `no_std`, without allocation and without unsafe code; the hot path is in f32. Constructors validate their arguments and name the
//! field that is wrong. Functions that run on every tick cannot fail, and return a finite value for every finite input.
//! Configuration and state are two types.
//!
//! | for | use |
//! |---|---|
//! | the mixed damping law F = k1·y + k3·y³ + c·\|v\|^α·sgn v | [`law`], [`power`] |
//! | its coefficients tabulated over density and amplitude, with the published tables | [`table`] |
//! | one law for every amplitude, fitted to the published loops, for a motion of unknown amplitude | [`amplitude_independent`] |
//! | the mixed damping law as it runs on the target, with a table for \|v\|^α, and with effects that a type names | [`static_law`] |
//! | the same, read from a pack and swapped at a cycle's end | [`fast_law`] |
//! | the interface of both for a firmware | [`tick_law`] |
//! | effects to add to that law, such as hardening, stick-slip, relaxation, stops and series compliance | [`effects`] |
//! | an excitation: sines, ramps and sweeps | [`sine`] |
//! | stiffness, energy and loss factor of each cycle | [`cycle`]; without a generator, [`crossing`] |
//! | law, sine and cycles in integers, for a core without a floating-point unit | [`fixed_point`] |
//! | the law under an excitation, without a specimen, at the lowest cost per tick | [`simulation`] |
//! | velocity and acceleration from a measured displacement | [`observer`] |
//! | a law as bytes, loaded while the rig runs | [`pack`] |
//! | whether a law is passive: whether it gives out no more energy than it absorbs | [`passivity`] |
//! | whether a motion lies in the operating range of a law | [`operating_range`] |
//! | the fixed-tick controller of a rig or of a damper emulation | [`rig`] |
//! | faults of the specimen, the sensors and the actuator of that rig | [`health`] |
//! | the link between a harness and the image of a rig | [`frame`], [`message`] |
//! | a 16-bit ADC and DAC on SPI | [`adc`], [`dac`], [`converter`] |
//!
//! Units are mm, s, kN, J = kN·mm and °C throughout. Effects are generic over [`real::Real`], so that identification in f64 and
//! firmware in f32 run the same code.
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
//!     // The first cycle is the ramp before the block.
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
mod forms;
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

/// Compiles the README's example, so that it stays correct.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Compiles the Rust code of the other pages.
#[cfg(doctest)]
#[doc = include_str!("../docs/firmware.md")]
struct Firmware;
#[cfg(doctest)]
#[doc = include_str!("../docs/export.md")]
struct Export;
#[cfg(doctest)]
#[doc = include_str!("../docs/monitor.md")]
struct Monitor;
