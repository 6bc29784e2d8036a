//! The whole tick in integers, for a core without a floating-point unit.

use mesh_damper::error::ConfigError;
use mesh_damper::fixed_point::{
    Cycle, CycleAccumulator, Law, RawCycle, Scales, Sine, SineGenerator,
};
use mesh_damper::law;

use super::tally::{Meter, Moments, Tally, When};
use super::tick::{CYCLES, FREQUENCY, TICK_RATE, laws};

/// Full scales of displacement and velocity over the amplitudes.
const SCALE: f64 = 1.1;

/// The state of a tick.
pub struct Whole {
    generator: SineGenerator,
    law: Law,
    accumulator: CycleAccumulator,
    /// The moment of the last tick, in addition to its force.
    pub when: When,
    /// The cycle that ended with it.
    pub cycle: Option<RawCycle>,
    /// Its units.
    pub scales: Scales,
    converted: Cycle,
}

impl Whole {
    /// A sine of `amplitude` mm with a ramp of one cycle before and after it.
    ///
    /// # Errors
    /// None for a published law and its amplitude.
    pub fn new(amplitude: f32, law: &law::Law<f32>) -> Result<Self, ConfigError> {
        let law = law.cast::<f64>();
        let amplitude = f64::from(amplitude);
        let speed = core::f64::consts::TAU * FREQUENCY * amplitude;
        let scales = Scales::covering(&law, SCALE * amplitude, SCALE * speed)?;
        let sine = Sine {
            amplitude,
            frequency: FREQUENCY,
            cycles: CYCLES,
            ramp_cycles: 1,
        };
        Ok(Self {
            generator: SineGenerator::new(sine, TICK_RATE, &scales)?,
            law: Law::new(&law, &scales)?,
            accumulator: CycleAccumulator::new(),
            when: When::Ramp,
            cycle: None,
            scales,
            converted: Cycle::default(),
        })
    }

    /// The force's bits, so that the count contains no conversion to a float.
    #[inline(always)]
    pub fn tick(&mut self) -> f32 {
        let Some(now) = self.generator.tick() else {
            self.when = When::Done;
            return 0.0;
        };
        let force = self.law.force(now.displacement, now.velocity);
        self.cycle = self
            .accumulator
            .update(now.displacement, force, now.cycle_end);
        self.when = When::of(false, now.ramp, now.cycle_end);
        f32::from_bits(force.to_bits() as u32)
    }
}

extern "C" fn tick(whole: &mut Whole, _: f32, _: f32) -> f32 {
    whole.tick()
}

/// The results of a cycle in their units, computed outside the tick.
extern "C" fn convert(whole: &mut Whole, _: f32, _: f32) -> f32 {
    if let Some(cycle) = whole.cycle {
        whole.converted = cycle.over(&whole.scales);
    }
    whole.converted.loss_factor
}

/// # Errors
/// None: every value is in its range.
#[inline(never)]
pub fn run(meter: &mut impl Meter) -> Result<(), ConfigError> {
    let mut moments = Moments::default();
    let mut conversion = Tally::default();
    for (amplitude, law) in laws() {
        let mut whole = Whole::new(amplitude, &law)?;
        while whole.when != When::Done {
            let result = meter.call(tick, &mut whole, 0.0, 0.0);
            moments.add(whole.when, result, None);
            if whole.cycle.is_some() {
                conversion.add(meter.call(convert, &mut whole, 0.0, 0.0));
            }
        }
    }
    moments.report(meter, "fixed/tick");
    meter.report("fixed/cycle", "call", &conversion);
    Ok(())
}
