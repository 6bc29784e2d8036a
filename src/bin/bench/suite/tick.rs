//! The whole tick (generator, law, accumulator) of the crate, alone and in blocks, and of [`super::naive`].

use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::effects::{AugmentedLaw, Motion};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::power::ROWS;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;
use mesh_damper::tabulated::{RunningLaw, TabulatedLaw};

use super::naive::{self, Naive};
use super::tally::{Meter, Moments, When};

/// Ticks per second.
pub const TICK_RATE: f64 = 10_000.0;
/// Hz: no whole number of ticks to the cycle.
pub const FREQUENCY: f64 = 9.7;
/// Cycles at full amplitude.
pub(super) const CYCLES: u32 = 4;
/// Ticks that the naive tick is run for, which has no ramps and no end.
pub const NAIVE_TICKS: u32 = 2200;
/// Ticks to the block.
pub const BLOCK: usize = 64;

/// The published laws, each with its amplitude in mm: row by row of the paper's tables.
pub fn laws() -> impl Iterator<Item = (f32, Law<f32>)> {
    PAPER.amplitudes().flat_map(|amplitude| {
        PAPER
            .densities()
            .map(move |density| (amplitude, PAPER.lookup(density, amplitude).law))
    })
}

/// What a tick works on.
pub struct Whole {
    generator: SineGenerator<1>,
    law: RunningLaw<1>,
    accumulator: CycleAccumulator,
    /// What the last tick came to, beside its force.
    pub when: When,
    /// The cycle that ended with it.
    pub cycle: Option<Cycle>,
    /// Of the last block.
    forces: [f32; BLOCK],
}

impl Whole {
    /// A sine of `amplitude` mm with a ramp of one cycle before and after it.
    ///
    /// # Errors
    /// None for a published law and its amplitude.
    pub fn new(amplitude: f32, law: Law<f32>) -> Result<Self, ConfigError> {
        let block = Block::sine(f64::from(amplitude), FREQUENCY, CYCLES)?;
        Ok(Self {
            generator: SineGenerator::new(Programme::new(TICK_RATE, 1)?.with(block)?)?,
            law: RunningLaw::new(TabulatedLaw::new(AugmentedLaw::new(law))),
            accumulator: CycleAccumulator::new(),
            when: When::Ramp,
            cycle: None,
            forces: [0.0; BLOCK],
        })
    }

    /// Force in kN.
    #[inline(always)]
    pub fn tick(&mut self) -> f32 {
        let now = self.generator.tick();
        if now.cycle_end {
            self.law.boundary();
        }
        let force = self.law.force(&Motion {
            displacement: now.displacement,
            velocity: now.velocity,
            ..Motion::default()
        });
        self.cycle = self.accumulator.update(now.displacement, force, now.phase);
        self.when = When::of(now.done, now.ramp, now.cycle_end);
        force
    }
}

extern "C" fn tick(whole: &mut Whole, _: f32, _: f32) -> f32 {
    whole.tick()
}

extern "C" fn block(whole: &mut Whole, _: f32, _: f32) -> f32 {
    let mut forces = whole.forces;
    let mut when = When::Steady;
    for force in &mut forces {
        *force = whole.tick();
        when = when.or(whole.when);
    }
    whole.forces = forces;
    whole.when = when;
    0.0
}

/// Alone, with a swap of coefficients at the third end of a cycle.
fn alone(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::new();
    for (amplitude, law) in laws() {
        let mut whole = Whole::new(amplitude, law)?;
        let other = TabulatedLaw::new(AugmentedLaw::new(law));
        let mut ends = 0;
        let mut since_swap = ROWS;
        while whole.when != When::Done {
            let result = meter.call(tick, &mut whole, 0.0, 0.0);
            let ended = whole.when == When::CycleEnd;
            ends += u32::from(ended);
            since_swap = if ended && ends == 3 {
                0
            } else {
                since_swap + 1
            };
            if ended && ends == 2 {
                whole.law.swap(other.clone());
            }
            let when = match whole.when {
                When::Steady if since_swap < ROWS => When::Swap,
                when => when,
            };
            moments.add(when, result, whole.cycle.as_ref());
        }
    }
    moments.report(meter, "tick/whole");
    Ok(())
}

/// Alone, without a swap: there is no room for a third law in the 16 KiB of a small core.
///
/// # Errors
/// None: every value is in its range.
#[inline(never)]
pub fn small(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::new();
    for (amplitude, law) in laws() {
        let mut whole = Whole::new(amplitude, law)?;
        while whole.when != When::Done {
            let result = meter.call(tick, &mut whole, 0.0, 0.0);
            moments.add(whole.when, result, whole.cycle.as_ref());
        }
    }
    moments.report(meter, "tick/whole");
    Ok(())
}

fn blocks(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::new();
    for (amplitude, law) in laws() {
        let mut whole = Whole::new(amplitude, law)?;
        while whole.when != When::Done {
            let result = meter.call(block, &mut whole, 0.0, 0.0);
            moments.add(whole.when, result, None);
        }
    }
    moments.report(meter, "tick/block");
    Ok(())
}

/// On libm.
#[inline(never)]
pub fn naive(meter: &mut impl Meter) {
    let mut moments = Moments::new();
    for (amplitude, law) in laws() {
        let mut naive = Naive::new(&law, amplitude, FREQUENCY, TICK_RATE);
        for _ in 0..NAIVE_TICKS {
            let result = meter.call(naive::TICK, &mut naive, 0.0, 0.0);
            moments.add(naive.when(), result, naive.cycle.as_ref());
        }
    }
    moments.report(meter, "tick/naive");
}

/// # Errors
/// None: every value is in its range.
pub fn run(meter: &mut impl Meter) -> Result<(), ConfigError> {
    alone(meter)?;
    blocks(meter)?;
    naive(meter);
    Ok(())
}
