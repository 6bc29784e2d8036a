//! Law, generator and accumulator in integers, for a core without a floating-point unit.
//!
//! Quantities are parts of a full scale that the configuration chooses ([`Scales`]), as `fixed`'s [`Part`]. A value thus cannot
//! leave the range −1…1 for which all arithmetic is designed. Conversions saturate values beyond it, and nothing wraps. A tick has
//! no division, and its only multiplication is the 32 × 32 → 32 bits of a Cortex-M0, with factors whose product fits. Constructors
//! compute the tables in f64.
//!
//! A mesh of 3 g/cm³ shaken by 0.1 mm at 1 Hz, 10 000 ticks a second:
//!
//! ```
//! use mesh_damper::fixed_point::{CycleAccumulator, Law, Scales, Sine, SineGenerator};
//! use mesh_damper::table::PAPER;
//!
//! let published = PAPER.lookup(3.0, 0.1).law.cast::<f64>();
//! let scales = Scales::covering(&published, 0.12, 0.8)?;
//! let law = Law::new(&published, &scales)?;
//! let sine = Sine { amplitude: 0.1, frequency: 1.0, cycles: 3, ramp_cycles: 1 };
//! let mut generator = SineGenerator::new(sine, 10_000.0, &scales)?;
//! let mut accumulator = CycleAccumulator::new();
//! let mut cycles = 0;
//! while let Some(now) = generator.tick() {
//!     let force = law.force(now.displacement, now.velocity);
//!     // The first cycle is the ramp.
//!     if let (Some(cycle), 2..) = (accumulator.update(now.displacement, force, now.cycle_end), now.cycle) {
//!         let cycle = cycle.over(&scales);
//!         assert!((cycle.stiffness - 1.6915).abs() < 1e-4);
//!         assert!((cycle.loss_factor - 0.6249).abs() < 1e-4);
//!         cycles += 1;
//!     }
//! }
//! assert_eq!(cycles, 3);
//! # Ok::<(), mesh_damper::error::ConfigError>(())
//! ```

mod accumulator;
mod damping;
mod generator;
mod law;
mod scales;
mod sine;

pub use accumulator::{Cycle, CycleAccumulator, RawCycle};
pub use generator::{Excitation, RAMP_CYCLES_MAX, Sine, SineGenerator};
pub use law::Law;
pub use scales::{SCALE_MIN, Scales};

/// A part of a full scale, −1…1.
pub type Part = fixed::types::I1F31;

/// `a`·`b`/2¹⁶ for `b` of 0…2¹⁶, rounded down, with an error below 1: two products of 16 bits by 17.
#[inline(always)]
fn times(a: i32, b: u32) -> i32 {
    let high = (a >> 16) * b as i32;
    let low = ((a as u32 & 0xffff) * b) >> 16;
    high + low as i32
}
