//! Telemetry: the frames contain the values of the ticks, and the numbers of the ticks show omissions.

use mesh_damper::effects::CONTROLS;
use mesh_damper::fast_law::Adaptation;
use mesh_damper::frame::{FrameBuffer, Frames, LARGEST};
use mesh_damper::health::{Event, HealthCause, Statistic};
use mesh_damper::message::{Note, ROWS, Row, Telemetered, TelemetryConfig};
use mesh_damper::rig::{CycleReport, State, Telemetry, TripCause};
use mesh_damper::telemetry::{Channel, Sender};
use proptest::prelude::*;

use crate::message::cycle;

/// Tick number `tick` of a rig, in `state`, with a distinct value in each field.
fn tick(tick: u32, state: State) -> Telemetry {
    let value = |place: u32| (tick * 8 + place) as f32;
    Telemetry {
        tick: tick.into(),
        displacement: value(0),
        velocity: 0.0,
        measured_force: value(1),
        controls: [4, 5, 6, 7].map(value),
        model_force: value(2),
        command: value(3),
        block: 0,
        cycle: 0,
        phase: 0,
        ramp: false,
        state,
        report: None,
        event: None,
    }
}

/// All rows and notes that are pending, and the number of their frames.
fn sent(sender: &mut Sender<'_>) -> (Vec<Row>, Vec<Note>, u32) {
    let (mut rows, mut notes, mut frames) = (Vec::new(), Vec::new(), 0);
    let mut buffer = FrameBuffer::new();
    while sender.next(&mut buffer) {
        assert!(buffer.bytes().len() <= LARGEST);
        let frame = Frames(buffer.bytes()).next().unwrap();
        match Telemetered::read(&frame).unwrap() {
            Telemetered::Rows(some) => rows.extend(some),
            Telemetered::Note(note) => notes.push(note),
        }
        frames += 1;
    }
    (rows, notes, frames)
}

proptest! {
    /// For any rate of the main loop, each row arrives once, in order, with its own values.
    #[test]
    fn every_row_comes_out_as_it_went_in(
        every in 1u32..5,
        within in 0u32..40,
        controls in 0u8..=CONTROLS as u8,
        // Ticks between two rounds of the main loop: never more rows than the queue holds.
        rounds in prop::collection::vec(1u32..60, 1..20),
        warmer in any::<bool>(),
    ) {
        let mut channel = Channel::<128>::new();
        let (mut recorder, mut sender) = channel.split();
        recorder.set(TelemetryConfig { every, within, controls, session: 7 });
        let mut ticks = 0;
        let mut rows = Vec::new();
        for round in rounds {
            for _ in 0..round {
                let temperature = if warmer { ticks as f32 } else { 20.0 };
                recorder.tick(&tick(ticks, State::Running), temperature);
                ticks += 1;
            }
            let (some, notes, _) = sent(&mut sender);
            prop_assert_eq!(notes.len(), 0);
            // Rows wait for the permitted time, or until they fill a frame.
            let waiting = ticks.div_ceil(every) as usize - rows.len() - some.len();
            prop_assert!(waiting * every as usize <= within as usize + 1 || waiting < ROWS);
            rows.extend(some);
        }
        // The end flushes the pending rows.
        recorder.tick(&tick(ticks, State::Done), 20.0);
        rows.extend(sent(&mut sender).0);
        rows.retain(|row| row.state == State::Running);
        prop_assert_eq!(rows.len() as u32, ticks.div_ceil(every));
        for (number, row) in (0u32..).zip(rows) {
            let at = tick(number * every, State::Running);
            let mut given = at.controls;
            given[controls.into()..].fill(0.0);
            let temperature = if warmer { (number * every) as f32 } else { 20.0 };
            prop_assert_eq!(row, Row {
                number,
                displacement: at.displacement,
                force: at.measured_force,
                law_force: at.model_force,
                command: at.command,
                controls: given,
                temperature,
                state: State::Running,
                session: 7,
            });
        }
    }

    /// If the queue is full, the numbers of the rows show how many are missing.
    #[test]
    fn rows_that_do_not_fit_are_counted(stalls in prop::collection::vec(0u32..200, 1..10)) {
        let mut channel = Channel::<32>::new();
        let (mut recorder, mut sender) = channel.split();
        recorder.set(TelemetryConfig { every: 1, within: 0, controls: 0, session: 0 });
        let (mut ticks, mut came) = (0u32, Vec::new());
        for stall in stalls {
            for _ in 0..stall {
                recorder.tick(&tick(ticks, State::Running), 20.0);
                ticks += 1;
            }
            came.extend(sent(&mut sender).0);
        }
        recorder.tick(&tick(ticks, State::Running), 20.0);
        came.extend(sent(&mut sender).0);
        let mut next = 0;
        let mut lost = 0;
        for row in &came {
            lost += row.number - next;
            next = row.number + 1;
            prop_assert_eq!(row.displacement, tick(row.number, State::Running).displacement);
        }
        prop_assert_eq!(next, ticks + 1);
        prop_assert_eq!(lost as usize + came.len(), ticks as usize + 1);
    }
}

#[test]
fn notes_say_what_a_cycle_and_the_monitor_said_and_when_the_test_is_over() {
    let mut channel = Channel::<64>::new();
    let (mut recorder, mut sender) = channel.split();
    // There is no telemetry before it is requested, nor before the rig runs.
    recorder.tick(&tick(0, State::Running), 20.0);
    recorder.set(TelemetryConfig {
        every: 10,
        within: 100,
        controls: 0,
        session: 3,
    });
    recorder.tick(&tick(0, State::Idle), 20.0);
    let report = CycleReport {
        block: 2,
        cycle: 40,
        ramp: true,
        measured: cycle(100.0),
        model: cycle(200.0),
        nrmse: 0.0625,
        followed: Adaptation {
            k1: -0.03,
            k3: 0.04,
            c: 0.05,
        },
    };
    let event = Event {
        cause: HealthCause::ALL[0],
        or: None,
        statistic: Statistic::Stiffness,
        value: 0.2,
        limit: 0.1,
        cycle: 4,
    };
    let fault = State::Faulted(TripCause::ForceLimit);
    let stopped = |command| Telemetry {
        command,
        ..tick(0, fault)
    };
    for telemetry in [
        tick(0, State::Running),
        Telemetry {
            report: Some(report),
            ..tick(1, State::Running)
        },
        Telemetry {
            event: Some(event),
            ..tick(2, State::Running)
        },
        // During the return to rest, at rest, and then only the notes.
        stopped(0.5),
        stopped(0.2),
        stopped(0.0),
        stopped(0.0),
    ] {
        recorder.tick(&telemetry, 20.0);
    }
    let (rows, notes, frames) = sent(&mut sender);
    // Four notes; the pending rows go with the end.
    assert_eq!((rows.len(), notes.len(), frames), (1, 4, 5));
    let note = |number, tick, state| Note {
        number,
        tick,
        state,
        ends: false,
        report: None,
        event: None,
        session: 3,
    };
    assert_eq!(
        notes,
        [
            Note {
                report: Some(report),
                ..note(0, 1, State::Running)
            },
            Note {
                event: Some(event),
                ..note(1, 2, State::Running)
            },
            note(2, 3, fault),
            Note {
                ends: true,
                ..note(3, 5, fault)
            },
        ]
    );
}

/// Other frames may be lost, but not the end: a recorder would wait for it forever.
#[test]
fn the_end_is_said_even_where_the_queue_of_notes_is_full_at_it() {
    let mut channel = Channel::<64>::new();
    let (mut recorder, mut sender) = channel.split();
    recorder.set(TelemetryConfig {
        every: 1000,
        within: 1000,
        controls: 0,
        session: 3,
    });
    let report = CycleReport {
        block: 0,
        cycle: 0,
        ramp: false,
        measured: cycle(1.0),
        model: cycle(2.0),
        nrmse: 0.0,
        followed: Adaptation {
            k1: 0.0,
            k3: 0.0,
            c: 0.0,
        },
    };
    for at in 0..20 {
        let ended = Telemetry {
            report: Some(report),
            ..tick(at, State::Running)
        };
        recorder.tick(&ended, 20.0);
    }
    for at in 20..30 {
        recorder.tick(&tick(at, State::Done), 20.0);
    }
    let (_, before, _) = sent(&mut sender);
    assert!(before.iter().all(|note| !note.ends) && before.len() < 20);
    recorder.tick(&tick(30, State::Done), 20.0);
    let (_, after, _) = sent(&mut sender);
    let ends: Vec<u32> = after.iter().map(|note| note.tick).collect();
    // At the tick at which the run ended, and only once.
    assert_eq!(ends, [20]);
    assert!(after[0].ends && after[0].number == 20);
    recorder.tick(&tick(31, State::Done), 20.0);
    assert_eq!(sent(&mut sender).1, []);
}

#[test]
fn a_test_that_stops_in_its_first_tick_is_one() {
    let mut channel = Channel::<64>::new();
    let (mut recorder, mut sender) = channel.split();
    recorder.set(TelemetryConfig {
        every: 10,
        within: 0,
        controls: 0,
        session: 3,
    });
    recorder.tick(&tick(0, State::Idle), 20.0);
    let fault = State::Faulted(TripCause::ForceClipped);
    let stopped = Telemetry {
        command: 0.0,
        ..tick(1, fault)
    };
    recorder.tick(&stopped, 20.0);
    let (rows, notes, _) = sent(&mut sender);
    assert_eq!(rows.len(), 1);
    let said: Vec<(u32, State, bool)> = notes
        .iter()
        .map(|note| (note.tick, note.state, note.ends))
        .collect();
    assert_eq!(said, [(0, fault, true)]);
}
