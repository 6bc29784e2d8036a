//! The law with stick-slip of one element: as a static type, or read from a pack.

use mesh_damper::effects::{AugmentedLaw, Effect, Motion, StickSlip};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::static_law::StaticLaw;
use mesh_damper::tick_law::TickLaw;

use super::Refused;
use super::tally::{Meter, Tally};
use super::tick::{FREQUENCY, TICK_RATE};

/// mm
const AMPLITUDE: f64 = 0.1;

// Both within reach of a load's offset.
#[repr(C)]
struct Beside<L> {
    motion: Motion<f32>,
    law: L,
}

extern "C" fn force<L: TickLaw>(beside: &mut Beside<L>, _: f32, _: f32) -> f32 {
    beside.law.force(&beside.motion)
}

/// Over the second and the third cycle of a sine; the first fills a pack's table.
fn count(meter: &mut impl Meter, name: &str, law: impl TickLaw) -> Result<(), ConfigError> {
    let block = Block::sine(AMPLITUDE, FREQUENCY, 2)?;
    let mut generator = SineGenerator::new(Programme::<1>::new(TICK_RATE, 1)?.with(block)?)?;
    let mut beside = Beside {
        motion: Motion::default(),
        law,
    };
    let mut tally = Tally::default();
    loop {
        let now = generator.tick();
        if now.cycle > 2 {
            break;
        }
        beside.motion.displacement = now.displacement;
        beside.motion.velocity = now.velocity;
        let result = meter.call(force, &mut beside, 0.0, 0.0);
        if now.cycle > 0 {
            tally.add(result);
        }
    }
    meter.report(name, "call", &tally);
    Ok(())
}

/// # Errors
/// None: every value is in its range.
pub fn run(meter: &mut impl Meter) -> Result<(), Refused> {
    let law = Law::new(1.2, 30.0, 0.1, 0.3)?;
    let effect = StickSlip::new(&[(1.2, 0.03)])?;
    let mut of_its_type = StaticLaw::<(StickSlip<f32>,)>::empty();
    of_its_type.set(law, (effect,));
    count(meter, "one_effect/static", of_its_type)?;
    let law = AugmentedLaw::<f32, 1>::new(law).with(Effect::StickSlip(effect))?;
    let from_pack = RunningLaw::new(FastLaw::new(law));
    count(meter, "one_effect/pack", from_pack)?;
    Ok(())
}
