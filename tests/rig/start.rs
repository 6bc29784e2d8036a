//! When a start is refused, and the command before its first tick.

use mesh_damper::converter::{Sample, Scale};
use mesh_damper::effects::{AugmentedLaw, CONTROLS};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::rig::{
    Controller, Reading, RigController, RigSettings, StartRefused, State, TripCause, Wiring,
};
use mesh_damper::sine::{Block, Programme, SineGenerator};

use crate::support::Ticks;

type Controlled = RigController<1, SineGenerator<1>>;

const TICK_RATE: f64 = 1000.0;

/// 0.2 mm at 5 Hz, a range of 1 mm and 1 kN, and one of the command in mm.
fn rig(command: f64, change: impl Fn(&mut RigSettings)) -> Controlled {
    let unit = Scale::new(1.0, 0.0).unwrap();
    let wiring = Wiring {
        displacement: unit,
        force: unit,
        command: Scale::new(command, 0.0).unwrap(),
    };
    let mut settings = RigSettings {
        stop_ticks: 50,
        ..RigSettings::default()
    };
    change(&mut settings);
    let programme = Programme::new(TICK_RATE, 1).unwrap();
    let programme = programme
        .with(Block::sine(0.2, 5.0, 1000).unwrap())
        .unwrap();
    let law = AugmentedLaw::new(Law::new(0.9, 0.0, 0.0, 0.0).unwrap());
    RigController::new(
        &settings,
        &wiring,
        programme,
        RunningLaw::new(FastLaw::new(law)),
    )
    .unwrap()
}

/// A reading of a displacement in mm and a force in kN. Neither code is at an end of its range, for any value.
fn reading(displacement: f32, force: f32, step: u16) -> Option<Reading> {
    let unit = Scale::new(1.0, 0.0).unwrap();
    let sample = |value: f32| Sample {
        value,
        code: unit.encode(value.clamp(-0.9, 0.9)).code + step % 2,
    };
    Some(Reading {
        displacement: sample(displacement),
        force: sample(force),
        controls: [0.0; CONTROLS],
    })
}

/// Runs for `ticks` ticks with an actuator that goes to `gain` times the command.
fn run(rig: &mut Controlled, clock: &mut Ticks, ticks: u16, gain: f32) {
    for tick in 0..ticks {
        let at = gain * rig.driven();
        let seen = rig.tick(reading(at, 0.9 * at, tick), clock.next());
        assert_eq!(seen.state, State::Running, "tick {tick}");
    }
}

/// At the crest the piston is beyond the tracking limit, which does not affect a refused start.
#[test]
fn a_start_that_is_not_due_changes_nothing() {
    let mut rig = rig(1.0, |settings| settings.tracking_limit = 0.15);
    let mut clock = Ticks::default();
    rig.start().unwrap();
    // A ramp, and a quarter of a cycle.
    run(&mut rig, &mut clock, 250, 1.0);
    assert!(rig.driven() > 0.18, "{}", rig.driven());
    assert_eq!(rig.start(), Err(StartRefused::Running));
    assert_eq!(rig.state(), State::Running);
    run(&mut rig, &mut clock, 50, 1.0);
    rig.stop();
    assert_eq!(rig.start(), Err(StartRefused::Moving));
    assert_eq!(rig.state(), State::Idle);
}

#[test]
fn a_start_is_refused_where_the_last_reading_is_beyond_a_limit() {
    let clipped = |mut read: Reading| {
        read.force.code = u16::MAX;
        read
    };
    let within = reading(0.1, 0.1, 0).unwrap();
    for (read, cause) in [
        (reading(0.31, 0.0, 0).unwrap(), TripCause::TrackingLimit),
        (reading(-0.31, 0.0, 0).unwrap(), TripCause::TrackingLimit),
        (reading(f32::NAN, 0.0, 0).unwrap(), TripCause::TrackingLimit),
        (reading(0.0, -0.51, 0).unwrap(), TripCause::ForceLimit),
        (reading(0.0, f32::NAN, 0).unwrap(), TripCause::ForceLimit),
        (clipped(within), TripCause::ForceClipped),
    ] {
        let mut rig = rig(1.0, |settings| settings.force_limit = 0.5);
        let mut clock = Ticks::default();
        rig.tick(Some(read), clock.next());
        assert_eq!(rig.start(), Err(StartRefused::Faulted(cause)));
        assert_eq!((rig.state(), rig.driven()), (State::Faulted(cause), 0.0));
        // A reading from before a clear is not a reason for a refusal; a reading after it is.
        rig.clear().unwrap();
        rig.tick(Some(within), clock.next());
        rig.start().unwrap();
    }
}

/// The motion to the start begins at the piston's position. A command whose range does not include that position is not driven.
#[test]
fn a_start_that_begins_beyond_the_command_s_range_is_refused() {
    let mut clock = Ticks::default();
    let mut small = rig(0.1, |_| {});
    small.tick(reading(-0.2, 0.0, 0), clock.next());
    let refused = StartRefused::Faulted(TripCause::CommandClipped);
    assert_eq!(small.start(), Err(refused));
    assert_eq!(small.state(), State::Faulted(TripCause::CommandClipped));
    assert_eq!(small.driven(), 0.0);
    let mut wide = rig(1.0, |_| {});
    wide.tick(reading(-0.2, 0.0, 0), clock.next());
    wide.start().unwrap();
    assert_eq!(wide.driven(), -0.2);
}

/// An actuator that goes to four fifths of the command requires a correction of 1.25, which also applies to the first command of a
/// start.
#[test]
fn a_start_that_keeps_the_correction_does_not_step() {
    for keeps in [false, true] {
        let mut rig = rig(1.0, |settings| settings.feedback = 0.0);
        let mut clock = Ticks::default();
        rig.start().unwrap();
        run(&mut rig, &mut clock, 250 + 20 * 200, 0.8);
        let corrected = rig.driven();
        assert!((corrected - 0.25).abs() < 0.01, "{corrected}");
        rig.stop();
        for tick in 0..60 {
            rig.tick(reading(0.1, 0.0, tick), clock.next());
        }
        if keeps {
            rig.keep_correction();
        }
        rig.start().unwrap();
        let before = rig.driven();
        let expected = if keeps { 0.125 } else { 0.1 };
        assert!((before - expected).abs() < 0.005, "{before}");
        let first = rig.tick(reading(0.1, 0.0, 0), clock.next()).command;
        // A fiftieth of the way in each tick.
        assert!(
            (first - before).abs() < 1.1 * before / 50.0,
            "{before}, {first}"
        );
    }
}

/// An actuator that moves in the opposite direction, or a channel that shows it so, with limits that permit it.
#[test]
fn an_answer_that_is_the_opposite_is_none() {
    for (gain, refused) in [(-1.0, true), (-0.5, true), (0.6, false)] {
        let mut rig = rig(1.0, |settings| {
            settings.tracking_limit = 1.0;
            settings.correction_limit = 10.0;
            settings.feedback = 0.0;
        });
        let mut clock = Ticks::default();
        rig.start().unwrap();
        let mut state = State::Running;
        for tick in 0..800 {
            let at = gain * rig.driven();
            state = rig.tick(reading(at, 0.9 * at, tick), clock.next()).state;
        }
        let stopped = State::Faulted(TripCause::NoResponse);
        assert_eq!(state == stopped, refused, "{gain}: {state:?}");
    }
}
