//! What goes into the crate and comes out of it, written and read by a format that people read and one that firmware uses.

use core::fmt::Debug;

use mesh_damper::adc::AdcError;
use mesh_damper::converter::Sample;
use mesh_damper::cycle::Cycle;
use mesh_damper::dac::DacError;
use mesh_damper::effects::{CONTROLS, Motion};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::Adaptation;
use mesh_damper::health::{Channel, Event, HealthCause, HealthSettings, Statistic};
use mesh_damper::message::{Outcome, Sensors, Statistics};
use mesh_damper::observer::Estimate;
use mesh_damper::rig::{
    ClearRefused, Command, CycleReport, DamperEmulationSettings, Knot, Reading, RigSettings,
    SpiActuatorError, StartRefused, State, StreamSettings, Telemetry, TripCause,
};
use mesh_damper::sine::Excitation;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The same to the last bit through either, floats included.
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
            statistic: Statistic::Response,
            value: 1.5,
            limit: 1.0,
            cycle: 6,
        }),
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
    // What is read is validated where it is used, as what is written in code.
    let wrong: RigSettings = serde_json::from_str(r#"{"force_limit": -1}"#).unwrap();
    let Err(ConfigError::OutOfRange { field, .. }) = wrong.at(1e4) else {
        panic!("no force is negative");
    };
    assert_eq!(field, "force_limit");
}

#[test]
fn a_refusal_can_be_written() {
    let refused = ConfigError::Full {
        field: "blocks",
        capacity: 4,
    };
    assert_eq!(
        serde_json::to_string(&refused).unwrap(),
        r#"{"Full":{"field":"blocks","capacity":4}}"#
    );
}
