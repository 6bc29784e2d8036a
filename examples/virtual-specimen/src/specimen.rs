//! The specimen that is not there: a published mesh under a sine, a part of whose wires breaks on the way.

use mesh_damper::cycle::Cycle;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::simulation::Simulation;
use mesh_damper::sine::{Block, Programme};
use mesh_damper::table::PAPER;

/// Ticks per second.
pub const TICK_RATE: u32 = 10_000;
/// Density of the mesh, g/cm³.
pub const DENSITY: f32 = 3.0;
/// Amplitude of the motion, mm.
pub const AMPLITUDE: f64 = 0.1;
/// Frequency of the motion, Hz.
pub const FREQUENCY: f64 = 5.0;
/// Cycles at full amplitude, after a ramp of one cycle and before another.
pub const CYCLES: u32 = 8;
/// Cycles, that of the ramp included, after which wires break.
pub const WHOLE: u32 = 5;
/// Part of the force that is left then.
pub const LEFT: f32 = 0.9;

/// The law of the whole specimen.
pub fn law() -> Law<f32> {
    PAPER.lookup(DENSITY, AMPLITUDE as f32).law
}

/// A tick of the specimen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// mm.
    pub displacement: f32,
    /// kN.
    pub force: f32,
    /// Results of a cycle, once they are complete: some hundred ticks after its end.
    pub cycle: Option<Cycle>,
}

/// The specimen with its motion.
pub struct Specimen {
    simulation: Simulation<1>,
    broken: Option<FastLaw<0>>,
    /// Number of cycles whose results were given.
    given: u32,
}

impl Specimen {
    /// At rest.
    ///
    /// # Errors
    /// A constant above that is out of range.
    pub fn new() -> Result<Self, ConfigError> {
        let whole = law();
        let [k1, k3, c] = [whole.k1(), whole.k3(), whole.c()].map(|each| LEFT * each);
        let broken = Law::new(k1, k3, c, whole.alpha())?;
        let motion = Block::sine(AMPLITUDE, FREQUENCY, CYCLES)?;
        let programme = Programme::new(TICK_RATE.into(), 1)?.with(motion)?;
        let fast = |law| FastLaw::new(AugmentedLaw::new(law));
        Ok(Self {
            simulation: Simulation::new(programme, fast(whole))?,
            broken: Some(fast(broken)),
            given: 0,
        })
    }

    /// The next tick; `None` when the motion is over.
    pub fn tick(&mut self) -> Option<Sample> {
        // The law takes over at the end of the cycle.
        if self.simulation.cycle() + 1 == WHOLE
            && let Some(broken) = self.broken.take()
        {
            self.simulation.swap_law(broken);
        }
        let force = self.simulation.tick();
        if self.simulation.done() {
            return None;
        }
        let (complete, cycle) = self.simulation.results();
        let is_new = complete != self.given;
        self.given = complete;
        Some(Sample {
            displacement: self.simulation.displacement(),
            force,
            cycle: is_new.then_some(*cycle),
        })
    }
}
