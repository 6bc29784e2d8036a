//! The whole tick (generator, law, accumulator) of the crate, alone and in blocks, and of [`super::naive`].

use mesh_damper::cycle::Cycle;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme};
use mesh_damper::table::PAPER;
use mesh_damper::tabulated::TabulatedLaw;
use mesh_damper::virtual_test::VirtualTest;

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
    test: VirtualTest<1>,
    /// What the last tick came to, beside its force.
    pub when: When,
    /// The results that were complete with it, of a cycle that had ended.
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
        let programme = Programme::new(TICK_RATE, 1)?.with(block)?;
        let law = TabulatedLaw::new(AugmentedLaw::new(law));
        Ok(Self {
            test: VirtualTest::new(programme, law)?,
            when: When::Ramp,
            cycle: None,
            forces: [0.0; BLOCK],
        })
    }

    /// Does `ticks`, and looks what they came to.
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
pub extern "C" fn tick(whole: &mut Whole, _: f32, _: f32) -> f32 {
    whole.test.tick()
}

extern "C" fn block(whole: &mut Whole, _: f32, _: f32) -> f32 {
    whole.test.block(&mut whole.forces);
    0.0
}

/// Alone, with a swap of coefficients at the third end of a cycle.
fn alone(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::new();
    for (amplitude, law) in laws() {
        let mut whole = Whole::new(amplitude, law)?;
        let other = TabulatedLaw::new(AugmentedLaw::new(law));
        let mut ends = 0;
        while whole.when != When::Done {
            let result = whole.told(|whole| meter.call(tick, whole, 0.0, 0.0));
            ends += u32::from(whole.when == When::CycleEnd);
            if whole.when == When::CycleEnd && ends == 2 {
                whole.test.swap_law(other.clone());
            }
            moments.add(whole.when, result, whole.cycle.as_ref());
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
            let result = whole.told(|whole| meter.call(tick, whole, 0.0, 0.0));
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
            let result = whole.told(|whole| meter.call(block, whole, 0.0, 0.0));
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
