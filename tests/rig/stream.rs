//! A rig that follows a streamed motion: the demand between knots, the limits, and the behaviour when the host falls silent.

use std::f64::consts::TAU;

use mesh_damper::adc::INPUT_RANGE;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::error::ConfigError;
use mesh_damper::health::{Channel, HealthCause};
use mesh_damper::law::Law;
use mesh_damper::rig::{
    Exciter as _, Knot, STREAM_QUEUE, State, Stream, StreamSettings, Telemetry, TripCause,
};
use mesh_damper::sine::{Excitation, Programme};
use mesh_damper_rig::drive::{Grid, RandomMotion};
use mesh_damper_rig::signals::{Interference, OnChannel};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Bench, Controlled as _, RigSetup};

const TICK_RATE: f64 = 10_000.0;
/// mm, Hz
const AMPLITUDE: f64 = 0.2;
const FREQUENCY: f64 = 5.0;

fn settings() -> StreamSettings {
    StreamSettings {
        displacement_limit: 0.5,
        velocity_limit: 50.0,
        knot_ticks: 10,
        hold_ticks: 100,
    }
}

fn stream() -> Stream {
    Stream::new(settings().at(TICK_RATE).unwrap())
}

/// A·(1 − cos ωt)/2, which begins at rest: displacement, velocity and acceleration.
fn haversine(time: f64) -> [f64; 3] {
    let w = TAU * FREQUENCY;
    let (sin, cos) = (w * time).sin_cos();
    let half = 0.5 * AMPLITUDE;
    [half * (1.0 - cos), half * w * sin, half * w * w * cos]
}

fn knot(displacement: f64, velocity: f64) -> Knot {
    Knot {
        displacement: displacement as f32,
        velocity: velocity as f32,
    }
}

fn knot_at(time: f64) -> Knot {
    let [y, v, _] = haversine(time);
    knot(y, v)
}

/// Ticks of a stream that has every knot of the haversine up to `knots`, and none after.
fn follow(stream: &mut Stream, knots: usize, ticks: usize) -> Vec<Excitation> {
    let mut given = 0;
    let tick = |_| {
        while given < knots && stream.room() > 0 {
            given += 1;
            assert!(stream.push(knot_at(given as f64 * 1e-3)));
        }
        stream.tick()
    };
    (0..ticks).map(tick).collect()
}

#[test]
fn between_its_knots_the_demand_is_the_motion() {
    let followed = follow(&mut stream(), 1000, 10_000);
    let w = TAU * FREQUENCY;
    // The cubic's error over a step T: (ωT)⁴/384 for the displacement, larger for each derivative; and the rounding of the floats.
    for (tick, at) in followed.iter().enumerate() {
        let [y, v, a] = haversine(tick as f64 * 1e-4);
        assert!(
            (f64::from(at.displacement) - y).abs() < 1e-7,
            "{tick}: {at:?}"
        );
        assert!(
            (f64::from(at.velocity) - v).abs() < 1e-4 * AMPLITUDE * w,
            "{tick}: {at:?}"
        );
        let bend = AMPLITUDE * w * w;
        assert!(
            (f64::from(at.acceleration) - a).abs() < 2e-3 * bend,
            "{tick}: {at:?}"
        );
    }
    // It never falls below 0, so that no cycle ends.
    assert!(followed.iter().all(|at| at.cycle == 0 && !at.done));
}

#[test]
fn a_cycle_ends_where_the_demand_rises_through_zero() {
    let mut stream = stream();
    let mut given = 0;
    let mut ends = Vec::new();
    for tick in 0..20_000 {
        while stream.room() > 0 {
            given += 1;
            let angle = TAU * 2.0 * f64::from(given) * 1e-3;
            // From rest at 0 to a sine within the first quarter of a second.
            let size = 0.1 * (4e-3 * f64::from(given)).min(1.0);
            assert!(stream.push(knot(size * angle.sin(), size * TAU * 2.0 * angle.cos())));
        }
        let at = stream.tick();
        if at.cycle_end {
            ends.push(tick);
        }
    }
    // 2 Hz: the first cycle ends after half a second, then one every half second.
    let expected: Vec<i32> = (1..4).map(|cycle| 5000 * cycle).collect();
    assert_eq!(ends.len(), expected.len());
    for (end, expected) in ends.iter().zip(expected) {
        assert!((end - expected).abs() <= 1, "{ends:?}");
    }
}

#[test]
fn silence_slows_the_demand_down_to_a_hold_and_then_stops_the_rig() {
    // The last knot is where the haversine is fastest.
    let knots = 50;
    let mut stream = stream();
    let followed = follow(&mut stream, knots, 10 * knots + 100);
    let (before, after) = followed.split_at(10 * knots);
    let [place, speed, _] = haversine(0.05);
    assert!((f64::from(after[0].velocity) - speed).abs() < 1e-3);
    let from = before[before.len() - 1].displacement;
    let mut last = after[0];
    assert!((last.displacement - from).abs() < 1.01e-4 * speed as f32);
    for at in after {
        // Without a step, with decreasing speed, v₀·(1 − s)².
        assert!((at.displacement - last.displacement).abs() < 1.01e-4 * speed as f32);
        assert!(at.velocity <= last.velocity && at.velocity >= -1e-5);
        last = *at;
    }
    let half = &after[50];
    assert!((f64::from(half.velocity) - 0.25 * speed).abs() < 1e-3 * speed);
    assert_eq!(stream.refusal(), None);
    // v₀·T/3 further, with T of 100 ticks.
    let held = stream.tick();
    assert!((f64::from(held.displacement) - (place + speed * 1e-2 / 3.0)).abs() < 1e-6);
    assert!(held.velocity == 0.0);
    assert_eq!(stream.refusal(), Some(TripCause::LinkLost));
}

#[test]
fn a_knot_that_comes_while_it_slows_down_is_followed_from_the_hold() {
    let mut stream = stream();
    let followed = follow(&mut stream, 50, 520);
    let moving = followed[519];
    let [place, speed, _] = haversine(0.05);
    let held = place + speed * 1e-2 / 3.0;
    assert!(stream.push(knot(held, 0.0)) && stream.push(knot(held - 0.001, 0.0)));
    let rest: Vec<Excitation> = (0..=100).map(|_| stream.tick()).collect();
    assert_eq!(stream.refusal(), None);
    let continuous = |pair: &[Excitation]| {
        (pair[1].displacement - pair[0].displacement).abs() < 1.01e-4 * speed as f32
    };
    assert!(continuous(&[moving, rest[0]]) && rest.windows(2).all(continuous));
    assert!((f64::from(rest[100].displacement) - (held - 0.001)).abs() < 1e-6);
}

#[test]
fn knots_beyond_the_limits_stop_it_wherever_they_stand_in_the_queue() {
    for beyond in [
        knot(0.51, 0.0),
        knot(-0.51, 0.0),
        knot(0.0, 51.0),
        knot(f64::NAN, 0.0),
        knot(0.0, f64::INFINITY),
        // 50 mm/s take it 0.05 mm from knot to knot.
        knot(0.06, 0.0),
    ] {
        let mut stream = stream();
        assert!(stream.push(knot(0.001, 0.0)) && stream.push(beyond));
        for tick in 0..10 {
            assert_eq!(
                (stream.tick().done, stream.refusal()),
                (false, None),
                "{tick}"
            );
        }
        let at = stream.tick();
        assert_eq!(stream.refusal(), Some(TripCause::DemandLimit), "{beyond:?}");
        assert!(at.displacement.is_finite() && at.velocity == 0.0);
    }
    let mut allowed = stream();
    assert!(allowed.push(knot(0.049, 50.0)));
    allowed.tick();
    assert_eq!(allowed.refusal(), None);
}

#[test]
fn a_full_queue_takes_no_more_and_a_complete_one_ends() {
    let mut stream = stream();
    for count in 0..STREAM_QUEUE {
        assert_eq!(stream.room(), STREAM_QUEUE - count);
        assert!(stream.push(knot(0.0, 0.0)));
    }
    assert!(!stream.push(knot(0.0, 0.0)));
    stream.complete();
    for _ in 0..10 * STREAM_QUEUE {
        assert!(!stream.tick().done);
    }
    assert!(stream.tick().done && stream.refusal().is_none());
    stream.restart();
    assert!(stream.room() == STREAM_QUEUE && !stream.tick().done);
}

#[test]
fn settings_that_cannot_be_are_refused_by_name() {
    let refused = |change: fn(&mut StreamSettings)| {
        let mut settings = settings();
        change(&mut settings);
        match settings.at(TICK_RATE) {
            Err(ConfigError::OutOfRange { field, .. } | ConfigError::NonFinite(field)) => field,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(
        refused(|s| s.displacement_limit = 0.0),
        "displacement_limit"
    );
    assert_eq!(refused(|s| s.velocity_limit = f64::NAN), "velocity_limit");
    assert_eq!(refused(|s| s.knot_ticks = 0), "knot_ticks");
    assert_eq!(refused(|s| s.hold_ticks = 0), "hold_ticks");
    assert!(settings().at(0.0).is_err());
}

/// A rig on the simulated actuator, a second into a motion of up to 8 Hz.
fn running() -> Bench<Specimen, 1, 1> {
    let random = RandomMotion {
        rms: 0.08,
        from: 0.5,
        to: 8.0,
        duration: 4.0,
        seed: 3,
    };
    let specimen = Specimen::of_density(3.0, 0.1);
    let c = specimen.coefficients();
    let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32).unwrap();
    let motion = random.motion(Grid::at(TICK_RATE)).unwrap();
    let setup = RigSetup::driven(specimen, AugmentedLaw::new(law), motion, 1).unwrap();
    let mut bench = Bench::new(setup).unwrap();
    bench.start().unwrap();
    for _ in 0..30_000 {
        assert_eq!(bench.tick().state, State::Running);
    }
    bench
}

/// Ticks until the rig is at rest after a trip. Checks in each that the line is low, and that the command goes straight to 0.
fn comes_to_rest(bench: &mut Bench<Specimen, 1, 1>, cause: TripCause) -> Vec<Telemetry> {
    let mut ticks: Vec<Telemetry> = Vec::new();
    loop {
        let telemetry = bench.tick();
        if let State::Faulted(fault) = telemetry.state {
            assert_eq!(fault, cause);
            assert!(!bench.enabled.get());
            if telemetry.command == 0.0 {
                return ticks;
            }
        } else {
            assert!(ticks.is_empty(), "{:?}", telemetry.state);
        }
        if !bench.enabled.get() {
            if let Some(last) = ticks.last() {
                assert!(telemetry.command.abs() < last.command.abs());
            }
            ticks.push(telemetry);
        }
        assert!(ticks.len() < 10_000);
    }
}

#[test]
fn a_host_that_falls_silent_leaves_the_rig_held_and_then_stopped() {
    let mut bench = running();
    bench.feeder = None;
    // At most 80 ticks are in the queue, and 1000 lead to the hold.
    let mut held = 0;
    let (mut last, mut quick) = (bench.tick(), 0.0_f32);
    while last.state == State::Running {
        quick = quick.max((bench.plant.servo.velocity() as f32).abs());
        last = bench.tick();
        held += 1;
        assert!(held <= 1080, "{:?}", last.state);
    }
    assert!(held > 1000, "{held}");
    assert_eq!(last.state, State::Faulted(TripCause::LinkLost));
    // It stood still before the line went low.
    assert!(
        bench.plant.servo.velocity().abs() < 0.1 && quick < 30.0,
        "{quick}"
    );
    comes_to_rest(&mut bench, TripCause::LinkLost);
    bench.rig.clear().unwrap();
}

/// The last bits of the stream are still followed. The feedback's integral moves the piston by the rest of the demand.
#[test]
fn a_displacement_that_is_frozen_stops_a_stream() {
    let mut bench = running();
    let step = 2.0 * INPUT_RANGE / 65_536.0;
    let frozen = Interference::Channel(Channel::Displacement, OnChannel::Frozen(step));
    bench.plant.signals.begin(frozen);
    let (mut ticks, mut furthest) = (0, 0.0_f64);
    while bench.rig.state() == State::Running {
        bench.tick();
        furthest = furthest.max(bench.plant.servo.displacement().abs());
        ticks += 1;
    }
    let told = bench
        .rig
        .events()
        .last()
        .map(|event| (event.cause, event.or));
    let dead = HealthCause::ActuatorDead;
    let stuck = HealthCause::SensorStuck(Channel::Displacement);
    assert_eq!(told, Some((dead, Some(stuck))));
    assert_eq!(bench.rig.state(), State::Faulted(TripCause::NoResponse));
    assert!(ticks < 8_000, "{ticks}");
    assert!(furthest < 0.4, "{furthest}");
}

#[test]
fn a_host_that_asks_for_a_jump_stops_the_rig_and_the_actuator_does_not_follow() {
    let mut bench = running();
    bench.feeder = None;
    while !bench.rig.exciter().stream().unwrap().push(knot(0.45, 0.0)) {
        assert_eq!(bench.tick().state, State::Running);
    }
    let before = bench.plant.servo.displacement();
    let mut furthest = 0.0_f64;
    for _ in 0..200 {
        let telemetry = bench.tick();
        furthest = furthest.max((bench.plant.servo.displacement() - before).abs());
        if telemetry.state != State::Running {
            break;
        }
    }
    comes_to_rest(&mut bench, TripCause::DemandLimit);
    assert!(furthest < 0.2, "{furthest}");
}

#[test]
fn a_rig_without_a_stream_has_none() {
    let specimen = Specimen::of_density(3.0, 0.1);
    let law = AugmentedLaw::new(Law::new(1.0, 0.0, 0.0, 0.5).unwrap());
    let programme = Programme::<1>::new(TICK_RATE, 1)
        .and_then(|p| p.with(mesh_damper::sine::Block::sine(0.1, 5.0, 2)?))
        .unwrap();
    let mut bench: Bench<Specimen, 1, 1> =
        Bench::new(RigSetup::new(specimen, law, programme, 1)).unwrap();
    assert!(bench.rig.exciter().stream().is_none());
}
