//! The whole tick (generator, law, accumulator) of the crate, alone and in blocks, and of [`super::naive`].

use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::effects::{AugmentedLaw, Motion};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::simulation::Simulation;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;

use super::naive::{self, Naive};
use super::tally::{Meter, Moments, Tally, When};

/// Ticks per second.
pub const TICK_RATE: f64 = 10_000.0;
/// Hz: a cycle is no whole number of ticks.
pub const FREQUENCY: f64 = 9.7;
/// Cycles at full amplitude.
pub const CYCLES: u32 = 4;
/// Ticks of the naive tick, which has no ramps and no end.
pub const NAIVE_TICKS: u32 = 2200;
/// Ticks per block.
pub const BLOCK: usize = 64;

/// The published laws, each with its amplitude in mm: row by row of the paper's tables.
pub fn laws() -> impl Iterator<Item = (f32, Law<f32>)> {
    PAPER.amplitudes().flat_map(|amplitude| {
        PAPER
            .densities()
            .map(move |density| (amplitude, PAPER.lookup(density, amplitude).law))
    })
}

/// A sine of `amplitude` mm with a ramp of one cycle before and after it.
fn programme(amplitude: f32) -> Result<Programme<1>, ConfigError> {
    let block = Block::sine(f64::from(amplitude), FREQUENCY, CYCLES)?;
    Programme::new(TICK_RATE, 1)?.with(block)
}

/// `law` under a sine of `amplitude` mm.
///
/// # Errors
/// None for a published law and its amplitude.
pub fn simulation(amplitude: f32, law: Law<f32>) -> Result<Simulation<1>, ConfigError> {
    let law = FastLaw::new(AugmentedLaw::new(law));
    Simulation::new(programme(amplitude)?, law)
}

/// The state of a tick.
pub struct Whole<'a> {
    test: &'a mut Simulation<1>,
    /// The moment of the last tick, in addition to its force.
    pub when: When,
    /// The results of a completed cycle that became available with it.
    pub cycle: Option<Cycle>,
}

impl<'a> Whole<'a> {
    /// Before the first tick of `test`.
    pub fn new(test: &'a mut Simulation<1>) -> Self {
        Self {
            test,
            when: When::Ramp,
            cycle: None,
        }
    }

    /// Calls `ticks`, and records the moment and the results.
    pub fn told<R>(&mut self, ticks: impl FnOnce(&mut Self) -> R) -> R {
        let test = &self.test;
        let (cycle, ramp, results) = (test.cycle(), test.ramp(), test.results().0);
        let result = ticks(self);
        let test = &self.test;
        self.when = match (test.done(), ramp || test.ramp(), test.filling()) {
            (true, ..) => When::Done,
            (_, true, _) => When::Ramp,
            (.., true) => When::Swap,
            _ if test.cycle() != cycle => When::CycleEnd,
            _ => When::Steady,
        };
        let (now, cycle) = test.results();
        self.cycle = (now != results).then_some(*cycle);
        result
    }
}

/// Force in kN at the next tick, the other arguments unused.
pub extern "C" fn tick(whole: &mut Whole<'_>, _: f32, _: f32) -> f32 {
    whole.test.tick()
}

/// The state of a block of ticks.
struct BlockOfTicks<'a, 'p> {
    whole: &'a mut Whole<'p>,
    forces: &'a mut [f32; BLOCK],
}

extern "C" fn block(block: &mut BlockOfTicks<'_, '_>, _: f32, _: f32) -> f32 {
    block.whole.test.block(block.forces);
    0.0
}

/// Fewest ticks of [`alone`] at full amplitude before the swap: two cycles, after that of the ramp.
const COMPARED: usize = 2000;

/// Alone, with a swap of coefficients at the third end of a cycle.
///
/// The same tick is at the same place of the same cycle under every law. So differences between its counts depend on the data.
fn alone(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::default();
    let mut extremes = [(u32::MAX, 0); COMPARED];
    for (amplitude, law) in laws() {
        let mut steady = 0;
        let mut test = simulation(amplitude, law)?;
        let mut whole = Whole::new(&mut test);
        let other = FastLaw::new(AugmentedLaw::new(law));
        let mut ends = 0;
        while whole.when != When::Done {
            let result = whole.told(|whole| meter.call(tick, whole, 0.0, 0.0));
            ends += u32::from(whole.when == When::CycleEnd);
            if whole.when == When::CycleEnd && ends == 2 {
                whole.test.swap_law(other.clone());
            }
            if !matches!(whole.when, When::Ramp | When::Done) {
                if let Some((least, most)) = extremes.get_mut(steady) {
                    *least = result.0.min(*least);
                    *most = result.0.max(*most);
                }
                steady += 1;
            }
            moments.add(whole.when, result, whole.cycle.as_ref());
        }
    }
    moments.report(meter, "tick/whole");
    let mut spread = Tally::default();
    for (least, most) in extremes {
        spread.add((most.saturating_sub(least), 0.0));
    }
    meter.report("tick/whole", "spread", &spread);
    Ok(())
}

/// Alone, without a swap: the 32 KiB of a small core have no room for a third law.
///
/// # Errors
/// None: every value is in its range.
#[inline(never)]
pub fn small(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::default();
    for (amplitude, law) in laws() {
        // Not moved out of its result: there is no room for a copy either.
        let mut built = simulation(amplitude, law);
        let mut whole = Whole::new(built.as_mut().map_err(|error| *error)?);
        while whole.when != When::Done {
            let result = whole.told(|whole| meter.call(tick, whole, 0.0, 0.0));
            moments.add(whole.when, result, whole.cycle.as_ref());
        }
    }
    moments.report(meter, "tick/whole");
    Ok(())
}

/// The same from the crate's parts, which work for any motion and any force.
struct Parts {
    generator: SineGenerator<1>,
    law: RunningLaw<0>,
    accumulator: CycleAccumulator<1>,
    when: When,
    cycle: Option<Cycle>,
}

extern "C" fn tick_of_parts(parts: &mut Parts, _: f32, _: f32) -> f32 {
    let now = parts.generator.tick();
    let force = parts.law.force(&Motion {
        displacement: now.displacement,
        velocity: now.velocity,
        ..Motion::default()
    });
    parts.cycle = parts
        .accumulator
        .update(now.displacement, [force], now.phase)
        .map(|[cycle]| cycle);
    parts.when = When::of(now.done, now.ramp, now.cycle_end);
    force
}

fn parts(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::default();
    for (amplitude, law) in laws() {
        let mut parts = Parts {
            generator: SineGenerator::new(programme(amplitude)?)?,
            law: RunningLaw::new(FastLaw::new(AugmentedLaw::new(law))),
            accumulator: CycleAccumulator::new(),
            when: When::Ramp,
            cycle: None,
        };
        while parts.when != When::Done {
            let result = meter.call(tick_of_parts, &mut parts, 0.0, 0.0);
            moments.add(parts.when, result, parts.cycle.as_ref());
        }
    }
    moments.report(meter, "tick/parts");
    Ok(())
}

fn blocks(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::default();
    let mut forces = [0.0; BLOCK];
    for (amplitude, law) in laws() {
        let mut test = simulation(amplitude, law)?;
        let mut whole = Whole::new(&mut test);
        while whole.when != When::Done {
            let forces = &mut forces;
            let result = whole
                .told(|whole| meter.call(block, &mut BlockOfTicks { whole, forces }, 0.0, 0.0));
            moments.add(whole.when, result, None);
        }
    }
    moments.report(meter, "tick/block");
    Ok(())
}

/// With libm.
#[inline(never)]
pub fn naive(meter: &mut impl Meter) {
    let mut moments = Moments::default();
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
    parts(meter)?;
    naive(meter);
    Ok(())
}
