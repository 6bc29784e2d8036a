//! A damper's law moved by a sine: the work of this firmware in a tick.

use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::effects::Motion;
use mesh_damper::error::ConfigError;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::tick_law::TickLaw as _;

use crate::motion::{CYCLES, RAMP_CYCLES, SINES};
use crate::mount::{self, DamperLaw};

/// Ticks per second.
pub const TICK_RATE: u32 = 10_000;

/// A cycle that ended.
#[derive(Clone, Copy)]
pub struct Ended {
    /// Index of the sine.
    pub sine: usize,
    pub cycle: Cycle,
}

/// Checksum of the bits of successive forces (FNV-1a of 32 bits). If one byte of two rows differs, the checksums differ. Two rows
/// with more differences have the same checksum by chance once in 2^32.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Checksum(pub u32);

impl Default for Checksum {
    fn default() -> Self {
        Self(0x811c_9dc5)
    }
}

impl Checksum {
    /// Adds a force.
    pub fn add(&mut self, force: f32) {
        for byte in force.to_le_bytes() {
            self.0 = (self.0 ^ u32::from(byte)).wrapping_mul(0x0100_0193);
        }
    }
}

/// Motion, law and cycles.
pub struct Excited {
    generator: SineGenerator<{ SINES.len() }>,
    law: &'static mut DamperLaw,
    accumulator: CycleAccumulator<1>,
    forces: Checksum,
    /// Sine of the previous tick; `None` in a ramp.
    sine: Option<usize>,
}

impl Excited {
    /// At rest. `law` is filled in place.
    ///
    /// # Errors
    /// The parameter of the motion or of the law that is out of range.
    pub fn new(law: &'static mut DamperLaw) -> Result<Self, ConfigError> {
        // ANCHOR: fill
        // The coefficients of effects are valid at one tick rate only.
        const { assert!(mount::TICK_RATE == TICK_RATE as f32) };
        mount::fill(law)?;
        // ANCHOR_END: fill
        let mut programme = Programme::new(TICK_RATE.into(), RAMP_CYCLES)?;
        for sine in SINES {
            programme = programme.with(Block::sine(sine.amplitude, sine.frequency, CYCLES)?)?;
        }
        Ok(Self {
            generator: SineGenerator::new(programme)?,
            law,
            accumulator: CycleAccumulator::new(),
            forces: Checksum::default(),
            sine: None,
        })
    }

    /// Checksum of all forces so far.
    pub fn forces(&self) -> Checksum {
        self.forces
    }

    /// Runs one tick. Returns the cycle that ended with this tick, if one ended outside the ramps. Returns `None` when the motion is
    /// over.
    pub fn tick(&mut self) -> Option<Option<Ended>> {
        // ANCHOR: tick
        let now = self.generator.tick();
        let force = self.law.force(&Motion {
            displacement: now.displacement,
            velocity: now.velocity,
            acceleration: now.acceleration,
            ..Motion::default()
        });
        // ANCHOR_END: tick
        self.forces.add(force);
        let ended = self
            .accumulator
            .update(now.displacement, [force], now.phase);
        // A cycle ends with the first tick of the next one. That tick may be in a ramp even if the cycle was not.
        let of_now = (!now.ramp && !now.done).then_some(now.block);
        let sine = core::mem::replace(&mut self.sine, of_now);
        if now.done && sine.is_none() {
            return None;
        }
        let ended = ended.zip(sine);
        Some(ended.map(|([cycle], sine)| Ended { sine, cycle }))
    }
}
