//! A damper in integers: motion, law and cycle results, in parts of full scales.

use mesh_damper::error::ConfigError;
use mesh_damper::fixed_point::{Cycle, CycleAccumulator, Law, Part, Scales, Sine, SineGenerator};
use mesh_damper::law;
use mesh_damper::table::PAPER;

/// Ticks per second.
pub const TICK_RATE: f64 = 10_000.0;
/// The motion: mm, Hz, cycles.
pub const SINE: Sine = Sine {
    amplitude: 0.1,
    frequency: 5.0,
    cycles: 4,
    ramp_cycles: 1,
};
/// Density of the mesh, g/cm³.
const DENSITY: f32 = 3.0;
/// Full scales over the largest displacement and velocity: a ramp overshoots the velocity a little.
const MARGIN: f64 = 1.1;

/// The law in numbers, before its conversion to integers.
pub fn published() -> law::Law<f64> {
    PAPER.lookup(DENSITY, SINE.amplitude as f32).law.cast()
}

/// The damper, moved by a sine.
pub struct Damper {
    generator: SineGenerator,
    law: Law,
    accumulator: CycleAccumulator,
    scales: Scales,
}

impl Damper {
    /// At rest. The conversion computes in f64, in software: for a minute part of a second, and never on a tick.
    ///
    /// # Errors
    /// A constant above that is out of range.
    pub fn new() -> Result<Self, ConfigError> {
        let law = published();
        let speed = core::f64::consts::TAU * SINE.frequency * SINE.amplitude;
        let scales = Scales::covering(&law, MARGIN * SINE.amplitude, MARGIN * speed)?;
        Ok(Self {
            generator: SineGenerator::new(SINE, TICK_RATE, &scales)?,
            law: Law::new(&law, &scales)?,
            accumulator: CycleAccumulator::new(),
            scales,
        })
    }

    /// The next tick: the force, as a part of its full scale, and the cycle that ended. `None` when the motion is over.
    ///
    /// With sensors in place of the sine, displacement and velocity are their codes as parts of the full scales.
    pub fn tick(&mut self) -> Option<(Part, Option<Cycle>)> {
        let now = self.generator.tick()?;
        let force = self.law.force(now.displacement, now.velocity);
        let ended = self
            .accumulator
            .update(now.displacement, force, now.cycle_end);
        Some((force, ended.map(|cycle| cycle.over(&self.scales))))
    }
}

/// Adds the code that a modulator or a DAC of 16 bits would take to a checksum of all of them.
pub fn added(sum: u32, force: Part) -> u32 {
    sum.rotate_left(1) ^ (force.to_bits() >> 16) as u32
}
