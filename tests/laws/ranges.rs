//! Every constructor accepts exactly the range that it documents for each number, and reports the number that it refuses.

use mesh_damper::amplitude_independent;
use mesh_damper::converter::Scale;
use mesh_damper::crossing::{CrossingAccumulator, CrossingDetector};
use mesh_damper::effects::description::Parameter;
use mesh_damper::effects::residual_table::{CELLS, Memory, ResidualTableParts};
use mesh_damper::effects::{
    AugmentedLaw, Compliance, ControlInput, DESCRIPTIONS, Delay, Effect, Periodic, Relaxation,
    ResidualTable, StickSlip, Yielding,
};
use mesh_damper::error::ConfigError;
use mesh_damper::health::HealthSettings;
use mesh_damper::law::Law;
use mesh_damper::observer::ObserverConfig;
use mesh_damper::power::PowerSeed;
use mesh_damper::rig::{DamperEmulationSettings, RigSettings};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::{EmulatorBench, EmulatorSetup, SetupError};
use proptest::prelude::*;

/// One number of a constructor.
struct Number {
    field: &'static str,
    low: f64,
    high: f64,
    /// The constructor with this value for the number, and with valid values for all others.
    give: Box<dyn Fn(f64) -> Result<(), ConfigError>>,
}

macro_rules! number {
    ($field:expr, $low:expr, $high:expr, |$x:ident| $constructed:expr) => {
        Number {
            field: $field,
            low: $low,
            high: $high,
            give: Box::new(|$x| $constructed.map(|_| ())),
        }
    };
}

fn controlled(tick: f64) -> Result<ControlInput<f64>, ConfigError> {
    let branch = Yielding::new(1.0, 0.1, 1.0, 0.0, 1e-3)?;
    ControlInput::new(3, branch, 0.1)?.with_lag(1.0, tick)
}

/// Parameters whose values do not fill their range: an index, and a gap on either side of 0.
const HOLED: [&str; 2] = ["input", "gap"];
/// Ticks in s: one of a rig, and those at which a range that depends on the tick has its ends.
const TICKS: [f64; 4] = [1e-4, 1e-7, 1e-6, 1e3];

/// Every parameter of every effect, with the typical values for the others.
fn parameters() -> impl Iterator<Item = Number> {
    DESCRIPTIONS.iter().flat_map(|effect| {
        let places = 0..effect.typical.len();
        let of = move |place| (place, effect.parameters[place % effect.parameters.len()]);
        let full = |(_, parameter): &(usize, Parameter)| !HOLED.contains(&parameter.name);
        places
            .map(of)
            .filter(full)
            .map(move |(place, parameter)| Number {
                field: parameter.name,
                // A quotient of a corner in ticks and a tick is rounded.
                low: match parameter.name {
                    "corner" => parameter.range[0].next_up(),
                    _ => parameter.range[0],
                },
                high: parameter.range[1],
                give: Box::new(move |x| {
                    let mut all = effect.typical.to_vec();
                    all[place] = x;
                    let made = |tick| Effect::<f64>::from_parameters(effect.number, &all, tick);
                    let [first, ..] = TICKS;
                    let made = TICKS
                        .into_iter()
                        .map(made)
                        .find(Result::is_ok)
                        .unwrap_or_else(|| made(first));
                    made.map(|_| ())
                }),
            })
    })
}

/// Sets the field to `x`.
macro_rules! setting {
    ($field:ident, $low:expr, $high:expr) => {
        number!(stringify!($field), $low, $high, |x| RigSettings {
            $field: x,
            ..RigSettings::default()
        }
        .at(1e4))
    };
}

/// The same for the monitor.
macro_rules! health {
    ($field:ident, $low:expr, $high:expr) => {
        number!(stringify!($field), $low, $high, |x| RigSettings {
            health: HealthSettings {
                $field: x,
                ..HealthSettings::default()
            },
            ..RigSettings::default()
        }
        .at(1e4))
    };
}

/// The same for the damper emulation; `$named` if the refusal reports another name for its part.
macro_rules! emulator {
    ($field:ident, $named:expr, $low:expr, $high:expr) => {
        number!($named, $low, $high, |x| emulator(DamperEmulationSettings {
            $field: x,
            ..DamperEmulationSettings::default()
        }))
    };
}

fn emulator(settings: DamperEmulationSettings) -> Result<(), ConfigError> {
    let law = AugmentedLaw::<_, 1>::new(Law::new(1.0, 0.0, 0.0, 0.5)?);
    let bench = EmulatorBench::new(EmulatorSetup {
        settings,
        ..EmulatorSetup::new(law)
    });
    match bench {
        Ok(_) => Ok(()),
        Err(SetupError::Config(error)) => Err(error),
        Err(other) => panic!("{other}"),
    }
}

fn correction(
    reach: f64,
    speed: f64,
    unit: f64,
    memory: Memory<f64>,
    range: [f64; 2],
    tick: f64,
) -> Result<ResidualTable<f64>, ConfigError> {
    let parts = ResidualTableParts {
        reach,
        speed,
        unit,
        cells: &[1; CELLS],
        memory: Some((memory, range)),
    };
    ResidualTable::new(&parts, tick)
}

const LAG: Memory<f64> = Memory::Lag { time: 0.1 };
const RANGE: [f64; 2] = [-0.1, 0.1];

fn numbers() -> Vec<Number> {
    vec![
        number!("k1", -1e9, 1e9, |x| Law::new(x, 1.0, 1.0, 0.5)),
        number!("k3", -1e9, 1e9, |x| Law::new(1.0, x, 1.0, 0.5)),
        number!("c", 0.0, 1e9, |x| Law::new(1.0, 1.0, x, 0.5)),
        number!("alpha", 0.0, 1.0, |x| Law::new(1.0, 1.0, 1.0, x)),
        number!("c", 0.0, 1e9, |x| PowerSeed::new(x, 0.5)),
        number!("alpha", 0.0, 1.0, |x| PowerSeed::new(1.0, x)),
        number!("density", 2.0, 4.0, |x| amplitude_independent::law(
            x as f32
        )),
        number!("tick", 1e-7, 1e3, |x| Yielding::new(1.0, 0.1, 1.0, 0.1, x)),
        number!("tick", 1e-7, 1e3, |x| controlled(x)),
        number!("tick", 1e-7, 1e3, |x| Compliance::new(1.0, x)),
        number!("tick", 1e-7, 1e3, |x| Delay::new(0.0, x)),
        number!("tick", 1e-6, 1e3, |x| Periodic::new(&[(1.0, 1e-6, 0.0)], x)),
        number!("tick", 1e-7, 1e3, |x| Relaxation::new(&[(1.0, 0.1)], x)),
        number!("reach", 1e-9, 1e4, |x| correction(
            x, 1.0, 1.0, LAG, RANGE, 1e-4
        )),
        number!("speed", 1e-9, 1e6, |x| correction(
            1.0, x, 1.0, LAG, RANGE, 1e-4
        )),
        number!("unit", 0.0, 1e9, |x| correction(
            1.0, 1.0, x, LAG, RANGE, 1e-4
        )),
        number!("tick", 1e-7, 1e3, |x| correction(
            1.0, 1.0, 1.0, LAG, RANGE, x
        )),
        number!("time", 1e-6, 1e6, |x| {
            correction(1.0, 1.0, 1.0, Memory::Lag { time: x }, RANGE, 1e-4)
        }),
        number!("below", -1e4, 1e4, |below| {
            let sides = Memory::Sides { below, above: 1e4 };
            correction(1.0, 1.0, 1.0, sides, RANGE, 1e-4)
        }),
        number!("above", -1e4, 1e4, |above| {
            let sides = Memory::Sides { below: -1e4, above };
            correction(1.0, 1.0, 1.0, sides, RANGE, 1e-4)
        }),
        number!("zero", -1e6, 1e6, |x| Scale::new(1.0, x)),
        number!("tick_rate", 1.0, 1e6, |x| ObserverConfig::new(x, 0.1, 0.7)),
        number!("bandwidth", 1e-3, 1e3, |x| ObserverConfig::new(1e4, x, 0.7)),
        number!("damping", 0.3, 3.0, |x| ObserverConfig::new(1e4, 20.0, x)),
        number!("hysteresis", 1e-9, 1e4, |x| CrossingDetector::new(x as f32)),
        number!("hysteresis", 1e-9, 1e4, |x| CrossingAccumulator::new(
            x as f32
        )),
        number!("amplitude", 1e-6, 1e4, |x| Block::sine(x, 1.0, 1)),
        number!("frequency", 1e-6, 2.5e5, |x| Block::sine(0.1, x, 1)),
        number!("from", 1e-6, 2.5e5, |x| Block::sweep(0.1, x, 1.0, 1)),
        number!("to", 1e-6, 2.5e5, |x| Block::sweep(0.1, 1.0, x, 1)),
        number!("tick_rate", 1.0, 1e6, |x| Programme::<1>::new(x, 1)),
        emulator!(displacement_limit, "displacement_limit", 1e-6, 1e4),
        emulator!(force_limit, "force_limit", 1e-6, 1e9),
        emulator!(observer_bandwidth, "bandwidth", 1e-3, 1e3),
        emulator!(observer_damping, "damping", 0.3, 3.0),
        emulator!(hysteresis, "hysteresis", 1e-9, 1e4),
        health!(size, 0.01, 0.5),
        health!(false_alarm_cycles, 1e2, 1e9),
        health!(temperature_slope, 0.0, 0.1),
        health!(follow, 0.0, 0.5),
        setting!(displacement_limit, 1e-6, 1e4),
        setting!(force_limit, 1e-6, 1e9),
        setting!(tracking_limit, 1e-6, 1e4),
        setting!(correction_gain, 0.0, 1.0),
        setting!(lead, 0.0, f64::from(0.1_f32)),
        setting!(glide, 1e-4, 10.0),
        setting!(feedback, 0.0, 100.0),
    ]
}

/// All numbers.
fn all() -> impl Iterator<Item = Number> {
    let all = numbers().into_iter().chain(parameters());
    #[cfg(feature = "fixed-point")]
    let all = all.chain(integers::numbers());
    all
}

#[cfg(feature = "fixed-point")]
mod integers {
    use mesh_damper::fixed_point::{Scales, Sine, SineGenerator};

    use super::{ConfigError, Number};

    /// In integers, with a full scale for any speed.
    fn generator(amplitude: f64, frequency: f64, tick_rate: f64) -> Result<(), ConfigError> {
        let sine = Sine {
            amplitude,
            frequency,
            cycles: 1,
            ramp_cycles: 1,
        };
        SineGenerator::new(sine, tick_rate, &Scales::new(1.0, 1e6, 1.0)?).map(|_| ())
    }

    pub fn numbers() -> Vec<Number> {
        vec![
            number!("displacement", 1e-9, 1e4, |x| Scales::new(x, 1.0, 1.0)),
            number!("velocity", 1e-9, 1e6, |x| Scales::new(1.0, x, 1.0)),
            number!("force", 1e-9, 1e12, |x| Scales::new(1.0, 1.0, x)),
            number!("amplitude", 0.0, 65_535.0 / 65_536.0, |x| {
                generator(x, 1.0, 1e4)
            }),
            number!("frequency", 1e-6, 2500.0, |x| generator(0.1, x, 1e4)),
            number!("tick_rate", 1.0, 1e6, |x| generator(0.1, 0.1, x)),
        ]
    }
}

/// In f32 the ends are the nearest floats, so a value less than one float beyond them is accepted.
fn check(number: &Number, x: f64) -> Result<(), TestCaseError> {
    let given = (number.give)(x);
    let expected = if !x.is_finite() {
        Err(ConfigError::NonFinite(number.field))
    } else if x < number.low || x > number.high {
        match given {
            Err(ConfigError::OutOfRange { field, .. }) => {
                prop_assert_eq!(field, number.field);
                return Ok(());
            }
            other => other.and(Err(ConfigError::NonFinite("out of range"))),
        }
    } else {
        Ok(())
    };
    prop_assert_eq!(&given, &expected, "{} = {:e}", number.field, x);
    Ok(())
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        -2.0..2.0,
        (-12.0..14.0).prop_map(|e| 10f64.powf(e)),
        (-12.0..14.0).prop_map(|e| -10f64.powf(e)),
        Just(f64::NAN),
        Just(f64::INFINITY),
        Just(f64::NEG_INFINITY),
        Just(-0.0),
    ]
}

#[test]
fn the_ends_belong_to_the_range_and_what_lies_beyond_does_not() {
    for number in all() {
        for end in [number.low, number.high] {
            check(&number, end).unwrap();
            for factor in [1.0 - 1e-6, 1.0 + 1e-6] {
                check(&number, end * factor).unwrap();
            }
        }
        for middle in [
            0.5 * (number.low + number.high),
            number.low - 1e-6,
            number.high + 1e-3,
        ] {
            check(&number, middle).unwrap();
        }
    }
}

proptest! {
    #[test]
    fn what_is_taken_is_what_lies_in_the_range(x in any_number(), part in 0.0..1.0f64) {
        for number in all() {
            // Closer to an end than the spacing of its floats, f32 rounds.
            if x.is_finite() && [number.low, number.high].iter().any(|end| (x - end).abs() <= 1e-7 * end.abs()) {
                continue;
            }
            check(&number, x)?;
            check(&number, number.low + part * (number.high - number.low))?;
        }
    }
}

#[test]
fn counts_of_none_or_too_many_are_refused() {
    let out_of_range = |error, name| {
        assert!(
            matches!(error, ConfigError::OutOfRange { field, .. } if field == name),
            "{error:?}"
        );
    };
    out_of_range(Block::sine(0.1, 1.0, 0).unwrap_err(), "cycles");
    out_of_range(Block::sweep(0.1, 1.0, 2.0, 0).unwrap_err(), "cycles");
    out_of_range(Programme::<1>::new(1e4, 0).unwrap_err(), "ramp_cycles");
    for (trip_ticks, fits) in [(0, false), (1, true), (1_000_000, true), (1_000_001, false)] {
        let settings = RigSettings {
            trip_ticks,
            ..RigSettings::default()
        };
        assert_eq!(settings.at(1e4).is_ok(), fits, "{trip_ticks}");
    }
    for (stop_ticks, fits) in [
        (0, false),
        (1, true),
        (10_000_000, true),
        (10_000_001, false),
    ] {
        let settings = RigSettings {
            stop_ticks,
            ..RigSettings::default()
        };
        assert_eq!(settings.at(1e4).is_ok(), fits, "{stop_ticks}");
    }
    for (cycles, learns, runs_in) in [
        (0, false, true),
        (7, false, true),
        (8, true, true),
        (1000, true, true),
        (1001, false, true),
        (1_000_000, false, true),
        (1_000_001, false, false),
    ] {
        let at = |health| RigSettings {
            health,
            ..RigSettings::default()
        };
        let learning = HealthSettings {
            learning_cycles: cycles,
            ..HealthSettings::default()
        };
        let running_in = HealthSettings {
            run_in_cycles: cycles,
            ..HealthSettings::default()
        };
        assert_eq!(at(learning).at(1e4).is_ok(), learns, "{cycles}");
        assert_eq!(at(running_in).at(1e4).is_ok(), runs_in, "{cycles}");
    }
    let element = (1.0, 0.1);
    assert_eq!(
        StickSlip::new(&[] as &[(f64, f64)]),
        Err(ConfigError::Empty("elements"))
    );
    assert!(StickSlip::new(&[element; 6]).is_ok());
    let full = StickSlip::new(&[element; 7]).unwrap_err();
    assert!(
        matches!(
            full,
            ConfigError::Full {
                field: "elements",
                capacity: 6
            }
        ),
        "{full:?}"
    );
}

/// What a tick rules out is refused by name too: the list of ranges holds at the ticks that allow the most.
#[test]
fn a_range_that_depends_on_the_tick_ends_with_it() {
    for (name, value) in [
        ("delay", 0.02551),
        ("force_filter", 0.9),
        ("periodic", 5000.0),
    ] {
        let effect = DESCRIPTIONS.iter().find(|each| each.name == name).unwrap();
        let place = usize::from(name == "periodic");
        let mut parameters = effect.typical.to_vec();
        parameters[place] = value;
        let refused = Effect::<f32>::from_parameters(effect.number, &parameters, 1e-4);
        let named = effect.parameters[place].name;
        assert!(
            matches!(refused, Err(ConfigError::OutOfRange { field, .. }) if field == named),
            "{refused:?}"
        );
    }
}
