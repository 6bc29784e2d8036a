//! The whole tick: generator, law, accumulator.

use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::effects::{AugmentedLaw, Motion};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;
use mesh_damper::tabulated::{RunningLaw, TabulatedLaw};

use super::suite::{Meter, Moments, When};

/// Ticks per second.
pub const TICK_RATE: f64 = 10_000.0;
/// Not a whole number of ticks to the cycle.
pub const FREQUENCY: f64 = 9.7;
/// Cycles at full amplitude.
pub const CYCLES: u32 = 4;
/// Densities, g/cm³, and amplitudes, mm, whose law and motion are run.
pub const DENSITIES: [f32; 3] = [2.0, 3.0, 4.0];
/// Amplitudes, mm.
pub const AMPLITUDES: [f32; 3] = [0.05, 0.15, 0.25];

/// What a tick works on.
struct Whole {
    generator: SineGenerator<1>,
    law: RunningLaw<1>,
    accumulator: CycleAccumulator,
    /// What the tick came to, beside the force.
    when: When,
    cycle: Option<Cycle>,
}

extern "C" fn whole(context: &mut Whole, _: f32, _: f32) -> f32 {
    let now = context.generator.tick();
    if now.cycle_end {
        context.law.boundary();
    }
    let force = context.law.force(&Motion {
        displacement: now.displacement,
        velocity: now.velocity,
        ..Motion::default()
    });
    context.cycle = context
        .accumulator
        .update(now.displacement, force, now.phase);
    context.when = When::of(now.done, now.ramp, now.cycle_end);
    force
}

/// A programme of one block, with a ramp of one cycle before and after it.
fn programme(amplitude: f32) -> Result<Programme<1>, ConfigError> {
    Programme::new(TICK_RATE, 1)?.with(Block::sine(f64::from(amplitude), FREQUENCY, CYCLES)?)
}

/// The laws that are run, with their amplitudes.
fn laws() -> impl Iterator<Item = (f32, Law<f32>)> {
    AMPLITUDES.into_iter().flat_map(|amplitude| {
        DENSITIES.map(|density| (amplitude, PAPER.lookup(density, amplitude).law))
    })
}

/// # Errors
/// None: every value is in its range.
pub fn run(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::new();
    for (amplitude, law) in laws() {
        let tabulated = TabulatedLaw::new(AugmentedLaw::new(law));
        let mut context = Whole {
            generator: SineGenerator::new(programme(amplitude)?)?,
            law: RunningLaw::new(tabulated.clone()),
            accumulator: CycleAccumulator::new(),
            when: When::Ramp,
            cycle: None,
        };
        let mut ends = 0;
        let mut since_swap = 0;
        while context.when != When::Done {
            let result = meter.call(whole, &mut context, 0.0, 0.0);
            let ended = context.when == When::CycleEnd;
            ends += u32::from(ended);
            // The table is being filled for the first time in the ramp; a swap comes into force at the third end.
            if ended && ends == 2 {
                context.law.swap(tabulated.clone());
            }
            since_swap = if ends < 3 {
                u32::MAX
            } else {
                since_swap.wrapping_add(1)
            };
            let when = match context.when {
                When::Steady if since_swap < 256 => When::Swap,
                when => when,
            };
            moments.add(when, result, context.cycle.as_ref());
        }
    }
    moments.report(meter, "tick/whole");
    Ok(())
}
