//! A dead actuator and a stuck, lost or open sensor stop the rig in time, with their event.

use mesh_damper::health::{Channel, HealthCause};
use mesh_damper::rig::{State, TripCause};
use mesh_damper_rig::Bench;
use mesh_damper_rig::actuator::{SensorFault, ServoFault};

use super::{setup, started, stops};

#[test]
fn a_dead_actuator_is_a_tracking_fault() {
    let mut setup = setup(3.0, &[(0.2, 1.0, 5)]);
    setup.settings.tracking_limit = 0.1;
    let mut bench = started(setup);
    // After 1.25 cycles, at the crest.
    for _ in 0..12_500 {
        assert_eq!(bench.tick().state, State::Running);
    }
    bench.plant.servo.fault = ServoFault::Dead;
    let ticks = stops(&mut bench, 5000, TripCause::TrackingLimit);
    // cos φ has fallen by half at a sixth of a cycle, 1667 ticks; and 10 ticks to trip.
    assert!((1667..1800).contains(&ticks), "{ticks}");
}

#[test]
fn a_stuck_sensor_is_lost_before_it_is_far_off() {
    for force in [false, true] {
        let mut bench = started(setup(3.0, &[(0.2, 1.0, 5)]));
        // After 1.25 cycles, at the crest of both.
        for _ in 0..12_500 {
            assert_eq!(bench.tick().state, State::Running);
        }
        let (sensor, fault) = if force {
            (&mut bench.plant.force_sensor, TripCause::ForceLost)
        } else {
            (
                &mut bench.plant.displacement_sensor,
                TripCause::DisplacementLost,
            )
        };
        sensor.fault = SensorFault::Stuck;
        let ticks = stops(&mut bench, 5000, fault);
        // cos φ has fallen by 0.3 after 1266 ticks. The force changes earlier: at its crest the friction reverses.
        let expected = if force { 10..1266 } else { 1260..1290 };
        assert!(expected.contains(&ticks), "{ticks}");
    }
}

/// Its event is reported once, until events are cleared.
#[test]
fn a_sensor_that_is_lost_again_stops_the_rig_again() {
    let mut bench = Bench::new(setup(3.0, &[(0.2, 1.0, 5)])).unwrap();
    for reported in [true, false] {
        bench.plant.force_sensor.fault = SensorFault::None;
        bench.rig.start().unwrap();
        for _ in 0..12_500 {
            assert_eq!(bench.tick().state, State::Running);
        }
        bench.plant.force_sensor.fault = SensorFault::DroppedOut;
        let mut events = 0;
        while bench.rig.state() == State::Running {
            events += usize::from(bench.tick().event.is_some());
        }
        assert_eq!(bench.rig.state(), State::Faulted(TripCause::ForceLost));
        assert_eq!(
            (events, bench.rig.events().len()),
            (usize::from(reported), 1)
        );
        for _ in 0..5000 {
            bench.tick();
        }
        bench.rig.clear().unwrap();
    }
}

/// In the tick that detects it.
#[test]
fn an_event_is_reported_at_once() {
    let mut bench = started(setup(3.0, &[(0.1, 2.0, 12)]));
    let mut reported = Vec::new();
    for tick in 0..55_000 {
        if tick == 30_000 {
            bench.plant.servo.fault = ServoFault::Lagging(100);
        }
        let before = bench.rig.events().len();
        let event = bench.tick().event;
        assert_eq!(event.as_slice(), &bench.rig.events()[before..]);
        reported.extend(event.map(|event| event.cause));
    }
    assert_eq!(reported, [HealthCause::ActuatorLagging]);
}

#[test]
fn an_actuator_dead_from_the_start_is_noticed_in_the_ramp_or_after_a_cycle() {
    // A ramp and a cycle of 5000 ticks each; the tick that ends the cycle is the first of the next one. A ramp of one cycle is too
    // short for a decision, unless its amplitude is large.
    for (amplitude, most) in [(0.05, 10_001), (0.1, 10_001), (0.25, 5_000)] {
        let mut bench = Bench::new(setup(3.0, &[(amplitude, 2.0, 5)])).unwrap();
        bench.plant.servo.fault = ServoFault::Dead;
        bench.rig.start().unwrap();
        let ticks = stops(&mut bench, 5000, TripCause::NoResponse);
        assert!(ticks <= most, "{ticks} at {amplitude}");
    }
}

#[test]
fn a_sensor_dead_from_the_start_is_noticed_in_the_ramp() {
    for amplitude in [0.05, 0.1, 0.25] {
        let mut bench = Bench::new(setup(3.0, &[(amplitude, 2.0, 5)])).unwrap();
        bench.plant.displacement_sensor.fault = SensorFault::DroppedOut;
        bench.rig.start().unwrap();
        let ticks = stops(&mut bench, 5000, TripCause::DisplacementLost);
        assert!(ticks < 1_250, "{ticks}: a quarter of the ramp");
    }
}

#[test]
fn an_open_sensor_is_a_clipped_channel_at_once() {
    for force in [false, true] {
        let mut bench = started(setup(3.0, &[(0.2, 1.0, 5)]));
        for _ in 0..12_000 {
            bench.tick();
        }
        let (sensor, fault, channel) = if force {
            let sensor = &mut bench.plant.force_sensor;
            (sensor, TripCause::ForceClipped, Channel::Force)
        } else {
            let sensor = &mut bench.plant.displacement_sensor;
            (
                sensor,
                TripCause::DisplacementClipped,
                Channel::Displacement,
            )
        };
        sensor.fault = SensorFault::Open;
        assert_eq!(stops(&mut bench, 5000, fault), 1);
        let [event] = bench.rig.events() else {
            panic!("{:?}", bench.rig.events());
        };
        assert_eq!(event.cause, HealthCause::SensorClipped(channel));
    }
}
