//! Inputs and outputs of the crate, written and read in a format for people and in one for firmware.

use core::fmt::Debug;

use mesh_damper::adc::AdcError;
use mesh_damper::converter::{Sample, Scale};
use mesh_damper::cycle::Cycle;
use mesh_damper::dac::DacError;
use mesh_damper::effects::delay::DelayState;
use mesh_damper::effects::{AugmentedLaw, AugmentedState, CONTROLS, DESCRIPTIONS, Effect, Motion};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::Adaptation;
use mesh_damper::health::{Channel, Event, HealthCause, HealthSettings, Statistic};
use mesh_damper::law::Law;
use mesh_damper::message::{Outcome, Refusal, Sensors, Statistics};
use mesh_damper::observer::Estimate;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::pack::{Expectation, Identity, PackError, PackInfo, Stamp};
use mesh_damper::rig::{
    ClearRefused, Command, CycleReport, DamperEmulationSettings, Knot, Reading, RigSettings,
    SpiActuatorError, StartRefused, State, StreamSettings, Telemetry, TripCause, Wiring,
};
use mesh_damper::sine::{Block, Excitation};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Unchanged to the last bit in both formats, floats included.
fn survives<T: Serialize + DeserializeOwned + PartialEq + Debug>(value: T) {
    let text = serde_json::to_string(&value).unwrap();
    assert_eq!(
        serde_json::from_str::<T>(&text).unwrap(),
        value,
        "as {text}"
    );
    let bytes = postcard::to_stdvec(&value).unwrap();
    assert_eq!(
        postcard::from_bytes::<T>(&bytes).unwrap(),
        value,
        "as {bytes:?}"
    );
}

fn telemetry() -> Telemetry {
    let cycle = Cycle {
        force_max: 0.3,
        energy: 1e-30,
        ..Cycle::default()
    };
    Telemetry {
        tick: u64::MAX,
        displacement: 0.1,
        velocity: -0.7,
        measured_force: f32::MIN_POSITIVE,
        controls: [0.1, -0.3, f32::MIN_POSITIVE, f32::MAX],
        model_force: f32::MAX,
        command: 0.2,
        block: 3,
        cycle: 7,
        phase: u32::MAX,
        ramp: true,
        state: State::Faulted(TripCause::ForceLost),
        report: Some(CycleReport {
            block: 3,
            cycle: 6,
            ramp: false,
            measured: cycle,
            model: cycle,
            nrmse: 0.012,
            followed: Adaptation {
                k1: 0.1,
                k3: -0.05,
                c: 0.0,
            },
        }),
        event: Some(Event {
            cause: HealthCause::SensorClipped(Channel::Force),
            or: None,
            statistic: Statistic::Response,
            value: 1.5,
            limit: 1.0,
            cycle: 6,
        }),
    }
}

/// Each cause as the crate wrote it at commit 3f3244e2: its number, as JSON, and in postcard's bytes. Causes since then are not there.
#[test]
fn causes_that_an_earlier_version_wrote_are_read() {
    for line in include_str!("causes.txt").lines() {
        let parts: Vec<&str> = line.split(' ').collect();
        let [number, json, bytes] = parts[..] else {
            panic!("{line}")
        };
        let pairs = bytes.as_bytes().chunks(2);
        let bytes: Vec<u8> = pairs
            .map(|pair| u8::from_str_radix(str::from_utf8(pair).unwrap(), 16).unwrap())
            .collect();
        let cause: HealthCause = serde_json::from_str(json).unwrap();
        assert_eq!(cause.number().to_string(), number);
        assert_eq!(postcard::from_bytes::<HealthCause>(&bytes).unwrap(), cause);
        assert_eq!(serde_json::to_string(&cause).unwrap(), json);
        assert_eq!(postcard::to_stdvec(&cause).unwrap(), bytes);
    }
}

#[test]
fn what_goes_in_and_comes_out_survives_a_format() {
    survives(telemetry());
    survives(Outcome {
        code: 0x8001,
        enabled: true,
        telemetry: telemetry(),
    });
    let sample = Sample {
        value: -0.3,
        code: 0x1234,
    };
    survives(Reading {
        displacement: sample,
        force: sample,
        controls: [0.1; CONTROLS],
    });
    survives(Command {
        value: 0.1,
        enabled: true,
    });
    survives(Motion::<f32> {
        temperature: 20.1,
        controls: [0.1; CONTROLS],
        ..Motion::default()
    });
    survives(Sensors {
        displacement: 1,
        force: 2,
        temperature: 20.0,
        controls: [0.1; CONTROLS],
        clock: 3,
        tripped: true,
    });
    survives(Statistics {
        stack: 1,
        log_lost: 2,
    });
    survives(Estimate {
        displacement: 0.1,
        velocity: 0.2,
        acceleration: 0.3,
    });
    survives(Excitation::default());
    survives(Knot {
        displacement: 0.1,
        velocity: 0.2,
    });
    survives(RigSettings::default());
    survives(HealthSettings::default());
    survives(DamperEmulationSettings::default());
    survives(StreamSettings::default());
    // A full scale whose step and inverse are rounded separately.
    for full_scale in [0.1, 1.1, -10.24, 5.0 / 3.0] {
        let scale = Scale::new(full_scale, 0.07).unwrap();
        survives(Wiring {
            displacement: scale,
            force: scale,
            command: scale,
        });
    }
    survives(Block::sweep(0.1, 2.0, 20.0, 7).unwrap());
    let identity = Identity([1, 2, 3, 4, 5, 6, 7, 255]);
    survives(Expectation {
        identity: Some(identity),
        newer_than: Some(3),
        ..Expectation::at(1e4)
    });
    survives(PackInfo {
        stamp: Stamp {
            tick_rate: 1e4,
            revision: 7,
            identity,
        },
        operating_range: Some(OperatingRange::new([-0.2, 0.25], [-6.3, 6.3]).unwrap()),
        density: Some(3.1),
        amplitude: None,
        ..PackInfo::at(1e4).named("Größe 4").unwrap()
    });
    survives(StartRefused::Faulted(TripCause::LinkLost));
    survives(ClearRefused::Moving);
    survives(AdcError::<u8>::Register {
        address: 5,
        expected: 5,
        found: 0,
    });
    survives(DacError::<u8>::Control { read: 3 });
    survives(SpiActuatorError::<u8, ()>::Dac(1));
}

#[test]
fn settings_have_their_names_and_defaults() {
    let settings: RigSettings =
        serde_json::from_str(r#"{"force_limit": 2.5, "health": {"follow": 0.1}}"#).unwrap();
    let expected = RigSettings {
        force_limit: 2.5,
        health: HealthSettings {
            follow: 0.1,
            ..HealthSettings::default()
        },
        ..RigSettings::default()
    };
    assert_eq!(settings, expected);
    let refused = serde_json::from_str::<RigSettings>(r#"{"force_limits": 2.5}"#).unwrap_err();
    let said = refused.to_string();
    assert!(said.contains("unknown field `force_limits`"), "{said}");
    // A value that was read is validated where it is used, like a value in code.
    let wrong: RigSettings = serde_json::from_str(r#"{"force_limit": -1}"#).unwrap();
    let Err(ConfigError::OutOfRange { field, .. }) = wrong.at(1e4) else {
        panic!("no force is negative");
    };
    assert_eq!(field, "force_limit");
}

/// A value that a constructor refuses is also refused when it is read.
#[test]
fn what_cannot_be_is_not_read() {
    fn refused<T: DeserializeOwned + Debug>(text: &str, what: &str) {
        let said = serde_json::from_str::<T>(text).unwrap_err().to_string();
        assert!(said.contains(what), "{said}");
    }
    refused::<OperatingRange<f32>>(
        r#"{"displacement": [0.2, -0.2], "velocity": [-6.3, 6.3]}"#,
        "displacement",
    );
    refused::<Block>(
        r#"{"amplitude": -0.1, "from": 5, "to": 5, "cycles": 3}"#,
        "amplitude",
    );
    refused::<Scale>(r#"{"zero": 0, "step": 0, "inverse_step": 1}"#, "full_scale");
    refused::<Scale>(
        r#"{"zero": 0, "step": 0.5, "inverse_step": 2.00001}"#,
        "inverse_step",
    );
    refused::<Expectation>(r#"{"tick_rates": 1}"#, "unknown field `tick_rates`");
    let named = |name: &str| {
        let mut info = serde_json::to_value(PackInfo::at(1e4)).unwrap();
        info["name"] = name.into();
        info.to_string()
    };
    refused::<PackInfo>(&named(&"x".repeat(33)), "at most 32 bytes");
    assert!(serde_json::from_str::<PackInfo>(&named(&"x".repeat(32))).is_ok());
}

#[test]
fn a_refusal_can_be_written() {
    let refused = PackError::TickRate {
        expected: 1e4,
        found: None,
    };
    assert_eq!(
        serde_json::to_string(&refused).unwrap(),
        r#"{"TickRate":{"expected":10000.0,"found":null}}"#
    );
    assert_eq!(
        serde_json::to_string(&Refusal::Field("k1")).unwrap(),
        r#"{"Field":"k1"}"#
    );
    let refused = ConfigError::Full {
        field: "blocks",
        capacity: 4,
    };
    assert_eq!(
        serde_json::to_string(&refused).unwrap(),
        r#"{"Full":{"field":"blocks","capacity":4}}"#
    );
}

/// The state of a law with every effect: a law that continues from the state that was read gives the same forces to the last bit.
#[test]
fn the_state_of_a_law_survives() {
    let tick = 1e-4;
    for description in DESCRIPTIONS {
        let parameters = description.typical;
        let effect = Effect::from_parameters(description.number, parameters, tick).unwrap();
        let law = Law::new(8.0, 180.0, 0.3, 0.3).unwrap();
        let law = AugmentedLaw::<f64, 1>::new(law).with(effect).unwrap();
        let motion = |index: u32| {
            let (sin, cos) = (f64::from(index) * 0.01).sin_cos();
            Motion {
                displacement: 0.1 * sin,
                velocity: 10.0 * cos,
                acceleration: -1e3 * sin,
                cycles: f64::from(index) * 1e-3,
                temperature: 30.0,
                controls: [0.5; CONTROLS],
            }
        };
        let mut state = law.at_rest();
        for index in 0..700 {
            law.force(&mut state, &motion(index));
        }
        let bytes = postcard::to_stdvec(&state).unwrap();
        let mut read: AugmentedState<f64> = postcard::from_bytes(&bytes).unwrap();
        let text = serde_json::to_string(&state).unwrap();
        let mut told: AugmentedState<f64> = serde_json::from_str(&text).unwrap();
        for index in 700..1400 {
            let force = law.force(&mut state, &motion(index)).to_bits();
            for other in [&mut read, &mut told] {
                let after = law.force(other, &motion(index)).to_bits();
                assert_eq!(after, force, "{} at {index}", description.name);
            }
        }
    }
    let short = r#"{"forces":[0.0,1.0],"next":0,"filled":0}"#;
    let refused = serde_json::from_str::<DelayState<f64>>(short).unwrap_err();
    assert!(
        refused.to_string().contains("expected 256 forces"),
        "{refused}"
    );
}
