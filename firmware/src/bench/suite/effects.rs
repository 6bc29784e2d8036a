//! What each added effect costs: the law as it runs on the target with none, with one, and with all of them; and what the
//! correction without a name does, over all that it may be over.

use mesh_damper::effects::correction::{CELLS, CorrectionParts, Memory};
use mesh_damper::effects::{
    Asymmetry, AugmentedLaw, BoucWen, Compliance, Correction, Delay, Drift, Effect, Gap, Hardening,
    Inertia, LoadFriction, Motion, Offset, Periodic, Relaxation, StickSlip, Stop, Temperature,
    Viscous,
};
use mesh_damper::error::ConfigError;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;
use mesh_damper::tabulated::{RunningLaw, TabulatedLaw};

use super::Refused;
use super::tally::{Meter, Tally};
use super::tick::{FREQUENCY, TICK_RATE};

/// Effects that there are.
const EFFECTS: usize = 16;
/// Of these, the first so many are ordinary; stages and what is rare come last.
const ORDINARY: usize = 10;
/// mm
const AMPLITUDE: f32 = 0.1;
/// Largest speed of a correction's table, mm/s.
const SPEED: f32 = 8.0;
/// Elements, kN/mm and mm.
const ELEMENTS: [(f32, f32); 6] = [
    (0.9, 0.01),
    (0.8, 0.02),
    (0.7, 0.03),
    (0.6, 0.045),
    (0.5, 0.06),
    (0.4, 0.09),
];

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

fn eq13() -> Augmented {
    AugmentedLaw::new(PAPER.lookup(3.0, AMPLITUDE).law)
}

fn law(effects: &[Effect<f32>]) -> Result<Augmented, ConfigError> {
    let mut law = eq13();
    for effect in effects {
        law = law.with(*effect)?;
    }
    Ok(law)
}

/// Over the second and the third cycle of a sine; the first fills the table.
fn count(meter: &mut impl Meter, name: &str, law: Augmented) -> Result<(), ConfigError> {
    let block = Block::sine(f64::from(AMPLITUDE), FREQUENCY, 2)?;
    let mut generator = SineGenerator::new(Programme::<1>::new(TICK_RATE, 1)?.with(block)?)?;
    let mut beside = Beside {
        law: RunningLaw::new(TabulatedLaw::new(law)),
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
            ..Motion::default()
        };
        let result = meter.call(force, &mut beside, 0.0, 0.0);
        if now.cycle > 0 {
            tally.add(result);
        }
    }
    meter.report(name, "call", &tally);
    Ok(())
}

fn stick_slip(elements: &[(f32, f32)]) -> Result<Effect<f32>, ConfigError> {
    StickSlip::new(elements).map(Effect::StickSlip)
}

/// Every effect with the name that it is counted under.
///
/// # Errors
/// None: every value is in its range.
pub fn each() -> Result<[(&'static str, Effect<f32>); EFFECTS], ConfigError> {
    Ok([
        ("effects/offset", Effect::Offset(Offset::new(0.05)?)),
        ("effects/asymmetry", Effect::Asymmetry(Asymmetry::new(2.0)?)),
        (
            "effects/hardening",
            Effect::Hardening(Hardening::new(90.0)?),
        ),
        ("effects/stick_slip", stick_slip(&ELEMENTS)?),
        ("effects/viscous", Effect::Viscous(Viscous::new(0.005)?)),
        (
            "effects/relaxation",
            Effect::Relaxation(Relaxation::new(&[(0.8, 0.05)], (1.0 / TICK_RATE) as f32)?),
        ),
        ("effects/inertia", Effect::Inertia(Inertia::new(0.5)?)),
        ("effects/drift", Effect::Drift(Drift::new(0.2, 30.0)?)),
        (
            "effects/temperature",
            Effect::Temperature(Temperature::new(0.002, 20.0)?),
        ),
        (
            "effects/load_friction",
            Effect::LoadFriction(LoadFriction::new(4.0)?),
        ),
        (
            "effects/stop",
            Effect::Stop(Stop::new(&[(2.0, 0.06), (3.0, -0.08)])?),
        ),
        (
            "effects/bouc_wen",
            Effect::BoucWen(BoucWen::new(0.9, 0.02, 1.5)?),
        ),
        (
            "effects/periodic",
            Effect::Periodic(Periodic::new(&[(0.02, 50.0, 0.3)], 1.0 / TICK_RATE)?),
        ),
        ("effects/gap", Effect::Gap(Gap::new(0.01, false)?)),
        (
            "effects/compliance",
            Effect::Compliance(Compliance::new(20.0, (1.0 / TICK_RATE) as f32)?),
        ),
        (
            "effects/delay",
            Effect::Delay(Delay::new(0.0012, (1.0 / TICK_RATE) as f32)?),
        ),
    ])
}

/// What a correction remembers, and the z of its first and of its last node.
type Remembered = (Memory<f32>, [f32; 2]);

/// Everything that a correction may be over beside the motion, with the name that it is counted under. Half of the range of
/// each is reached in the cycles that are counted.
fn memories() -> [(&'static str, Option<Remembered>); 13] {
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
            "correction/cycles",
            Some((Memory::Cycles { cycles: 0.5 }, [0.0, 4.0])),
        ),
        (
            "correction/level",
            Some((Memory::Level { time: 0.2 }, [0.0, 0.2])),
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
        (
            "correction/acceleration",
            Some((Memory::Acceleration, [-800.0, 800.0])),
        ),
    ]
}

/// Of a table that reaches as far as the motion and has no two cells alike side by side.
fn correction(memory: Option<Remembered>) -> Result<Correction<f32>, ConfigError> {
    let uneven = |cell: usize| (cell * 7919 % 2003) as i16 - 1001;
    let cells: [i16; CELLS] = core::array::from_fn(uneven);
    let parts = CorrectionParts {
        reach: AMPLITUDE,
        speed: SPEED,
        unit: 1e-5,
        cells: &cells,
        memory,
    };
    Correction::new(&parts, (1.0 / TICK_RATE) as f32)
}

/// # Errors
/// None: every value is in its range.
pub fn run(meter: &mut impl Meter) -> Result<(), Refused> {
    let each = each()?;
    let [one, ..] = ELEMENTS;
    count(meter, "effects/none", eq13())?;
    for (name, effect) in each {
        count(meter, name, law(&[effect])?)?;
    }
    count(meter, "effects/stick_slip_1", law(&[stick_slip(&[one])?])?)?;
    let all = each.map(|(_, effect)| effect);
    let (ordinary, _) = all.split_at(ORDINARY);
    count(meter, "effects/all", law(ordinary)?)?;
    count(meter, "effects/all_with_stages", law(&all)?)?;
    let one = stick_slip(&[one])?;
    let all_one = all.map(|effect| match effect {
        Effect::StickSlip(_) => one,
        other => other,
    });
    let (ordinary_one, _) = all_one.split_at(ORDINARY);
    count(meter, "effects/all_stick_slip_1", law(ordinary_one)?)?;
    for (name, memory) in memories() {
        count(meter, name, eq13().with_correction(correction(memory)?)?)?;
    }
    Ok(())
}
