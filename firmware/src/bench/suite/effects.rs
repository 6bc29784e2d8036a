//! The cost of each added effect: the law as it runs on the target with none, with one, and with all of them; and the cost of the
//! residual table for every variable that it may have.

use core::fmt;

use mesh_damper::effects::description::{Cost, Description};
use mesh_damper::effects::residual_table::{CELLS, Memory, ResidualTableParts};
use mesh_damper::effects::{
    AugmentedLaw, CONTROLS, DESCRIPTIONS, Effect, Motion, ResidualTable, StickSlip,
};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;

use super::Refused;
use super::tally::{Meter, Tally};
use super::tick::{FREQUENCY, TICK_RATE};

/// Number of effects.
const EFFECTS: usize = DESCRIPTIONS.len();
/// mm
const AMPLITUDE: f32 = 0.1;
/// Largest speed of a correction's table, mm/s.
const SPEED: f32 = 8.0;
/// kN/mm and mm.
const ELEMENT: (f32, f32) = (0.9, 0.01);

// Both within reach of a load's offset.
#[repr(C)]
struct Beside {
    motion: Motion<f32>,
    law: RunningLaw<EFFECTS>,
}

extern "C" fn force(beside: &mut Beside, _: f32, _: f32) -> f32 {
    beside.law.force(&beside.motion)
}

type Augmented = AugmentedLaw<f32, EFFECTS>;

fn eq13<const N: usize>() -> AugmentedLaw<f32, N> {
    AugmentedLaw::new(PAPER.lookup(3.0, AMPLITUDE).law)
}

/// The mixed damping law of the paper with `effects`.
///
/// # Errors
/// More effects than `N`, or two of a kind.
pub fn law<const N: usize>(
    effects: impl IntoIterator<Item = Effect<f32>>,
) -> Result<AugmentedLaw<f32, N>, ConfigError> {
    let mut law = eq13();
    for effect in effects {
        law = law.with(effect)?;
    }
    Ok(law)
}

/// Over the second and the third cycle of a sine; the first fills the table.
fn count(
    meter: &mut impl Meter,
    name: impl fmt::Display,
    law: Augmented,
) -> Result<(), ConfigError> {
    let block = Block::sine(f64::from(AMPLITUDE), FREQUENCY, 2)?;
    let mut generator = SineGenerator::new(Programme::<1>::new(TICK_RATE, 1)?.with(block)?)?;
    let mut beside = Beside {
        law: RunningLaw::new(FastLaw::new(law)),
        motion: Motion::default(),
    };
    let mut tally = Tally::default();
    loop {
        let now = generator.tick();
        if now.cycle > 2 {
            break;
        }
        beside.motion = Motion {
            displacement: now.displacement,
            velocity: now.velocity,
            acceleration: now.acceleration,
            cycles: now.cycle as f32 + now.phase as f32 * (1.0 / (1u64 << 32) as f32),
            temperature: 20.0 + 30.0 * now.displacement,
            controls: [1.0 + now.displacement; CONTROLS],
        };
        let result = meter.call(force, &mut beside, 0.0, 0.0);
        if now.cycle > 0 {
            tally.add(result);
        }
    }
    meter.report(name, "call", &tally);
    Ok(())
}

fn one_element() -> Result<Effect<f32>, ConfigError> {
    StickSlip::new(&[ELEMENT]).map(Effect::StickSlip)
}

/// Every effect of the crate, with the typical parameters of its description, and the description.
///
/// # Errors
/// None: every value is in its range.
pub fn each() -> Result<[(&'static Description, Effect<f32>); EFFECTS], ConfigError> {
    let mut each = [(&DESCRIPTIONS[0], one_element()?); EFFECTS];
    for (place, description) in each.iter_mut().zip(DESCRIPTIONS) {
        let tick = 1.0 / TICK_RATE;
        let effect = Effect::from_parameters(description.number, description.typical, tick)?;
        *place = (description, effect);
    }
    Ok(each)
}

/// The memory of a correction, and the z of its first and of its last node.
pub type Remembered = (Memory<f32>, [f32; 2]);

/// Every variable that a correction may have in addition to the motion, with the name of its count. The counted cycles reach half
/// of the range of each.
fn memories() -> [(&'static str, Option<Remembered>); 10] {
    [
        ("correction/without_memory", None),
        (
            "correction/slip",
            Some((Memory::Slip { limit: 0.05 }, [-0.05, 0.05])),
        ),
        (
            "correction/lag",
            Some((Memory::Lag { time: 0.05 }, [-0.2, 0.2])),
        ),
        (
            "correction/travel",
            Some((Memory::Travel { time: 0.2 }, [0.0, 8.0])),
        ),
        ("correction/largest", Some((Memory::Largest, [0.0, 0.2]))),
        (
            "correction/age",
            Some((Memory::Age { time: 0.1 }, [0.0, 8.0])),
        ),
        (
            "correction/temperature",
            Some((Memory::Temperature, [14.0, 26.0])),
        ),
        ("correction/place", Some((Memory::Place, [0.0, 1.0]))),
        (
            "correction/sides",
            Some((
                Memory::Sides {
                    below: -0.1,
                    above: 0.1,
                },
                [0.0, 1.0],
            )),
        ),
        (
            "correction/frequency",
            Some((Memory::Frequency { time: 0.2 }, [0.0, 4.0])),
        ),
    ]
}

/// For a table that reaches as far as the motion and has no two equal neighbouring cells.
///
/// # Errors
/// None: every value is in its range.
pub fn correction(memory: Option<Remembered>) -> Result<ResidualTable<f32>, ConfigError> {
    // Against a falling displacement and with a rising one, so that a law with it is passive.
    let uneven = |cell: usize| (cell * 7919 % 1001) as i16;
    let cells: [i16; CELLS] = core::array::from_fn(|cell| match cell < CELLS / 2 {
        true => uneven(cell),
        false => -uneven(cell),
    });
    let parts = ResidualTableParts {
        reach: AMPLITUDE,
        speed: SPEED,
        unit: 1e-5,
        cells: &cells,
        memory,
    };
    ResidualTable::new(&parts, (1.0 / TICK_RATE) as f32)
}

/// # Errors
/// None: every value is in its range.
pub fn run(meter: &mut impl Meter) -> Result<(), Refused> {
    let each = each()?;
    count(meter, "effects/none", eq13())?;
    for (description, effect) in each {
        let name = format_args!("effects/{}", description.name);
        count(meter, name, law([effect])?)?;
    }
    let one = one_element()?;
    count(meter, "effects/stick_slip_1", law([one])?)?;
    let all = each.iter().map(|(_, effect)| *effect);
    // Stages are rare, too.
    let ordinary = each.iter().filter(|(of, _)| of.cost != Cost::Rare);
    let ordinary = ordinary.map(|(_, effect)| *effect);
    count(meter, "effects/all", law(ordinary.clone())?)?;
    count(meter, "effects/all_with_stages", law(all)?)?;
    let ordinary_one = ordinary.map(|effect| match effect {
        Effect::StickSlip(_) => one,
        other => other,
    });
    count(meter, "effects/all_stick_slip_1", law(ordinary_one)?)?;
    for (name, memory) in memories() {
        count(
            meter,
            name,
            eq13().with_residual_table(correction(memory)?)?,
        )?;
    }
    Ok(())
}
