//! Excitation, law and cycles: all of the crate that this firmware runs.

use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;

/// Ticks a second.
pub const TICK_RATE: u32 = 10_000;

/// Density of the mesh, g/cm³.
const DENSITY: f32 = 3.0;
/// Amplitude of its motion, mm.
const AMPLITUDE: f32 = 0.1;
/// Frequency of its motion, Hz.
const FREQUENCY: f64 = 1.0;
/// Cycles from one rest to the next, without the ramps that lead from it and to it.
const CYCLES: u32 = 60;
/// Cycles of such a ramp.
const RAMP_CYCLES: u32 = 1;

/// The mixed damping law under a sine that begins again when it has ended.
pub struct Simulation {
    generator: SineGenerator<1>,
    law: Law<f32>,
    accumulator: CycleAccumulator<1>,
    /// The last tick was in a ramp.
    ramp: bool,
}

impl Simulation {
    /// At rest.
    ///
    /// # Errors
    /// The constant above that is out of range.
    pub fn new() -> Result<Self, ConfigError> {
        let programme = Programme::new(TICK_RATE.into(), RAMP_CYCLES)?.with(Block::sine(
            AMPLITUDE.into(),
            FREQUENCY,
            CYCLES,
        )?)?;
        Ok(Self {
            generator: SineGenerator::new(programme)?,
            law: PAPER.lookup(DENSITY, AMPLITUDE).law,
            accumulator: CycleAccumulator::new(),
            ramp: true,
        })
    }

    /// One tick: the force in kN, and the results of the cycle that ended with it. Cycles of a ramp have none.
    pub fn tick(&mut self) -> (f32, Option<Cycle>) {
        let now = self.generator.tick();
        let force = self.law.force(now.displacement, now.velocity);
        let ended = self
            .accumulator
            .update(now.displacement, [force], now.phase);
        // A cycle ends with the first tick of the next one, which may be in a ramp when the cycle was not.
        let ramp = core::mem::replace(&mut self.ramp, now.ramp || now.done);
        if now.done {
            self.generator.restart();
        }
        (force, ended.filter(|_| !ramp).map(|[cycle]| cycle))
    }
}
