//! Messages of the link: each is read from its frame as it was written. A truncated frame gives no message.

use mesh_damper::converter::Scale;
use mesh_damper::cycle::Cycle;
use mesh_damper::effects::Motion;
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::Adaptation;
use mesh_damper::frame::{Fields, Frame, FrameBuffer, Frames, PAYLOAD, Reader, Writer};
use mesh_damper::health::{Event, HealthCause, HealthSettings, Statistic};
use mesh_damper::message::{
    About, Answer, MOTIONS, Motions, Outcome, Refusal, Request, Sensors, Setup, Statistics,
    TelemetryConfig, write_about, write_again, write_forces, write_outcome, write_refusal,
    write_statistics,
};
use mesh_damper::pack::{Identity, PackError};
use mesh_damper::rig::{CycleReport, RigSettings, State, StreamSettings, Telemetry, TripCause};
use mesh_damper::sine::{Block, Programme};

fn frame(buffer: &FrameBuffer) -> Frame<'_> {
    Frames(buffer.bytes()).next().unwrap()
}

fn passes(request: Request<'_>) {
    let mut buffer = FrameBuffer::new();
    request.write(5, &mut buffer);
    let frame = frame(&buffer);
    assert_eq!((frame.header.sequence, frame.header.count), (5, 1));
    assert_eq!(Request::read(&frame), Some(request));
    for length in 0..frame.payload.len() {
        let payload = &frame.payload[..length];
        assert_eq!(Request::read(&Frame { payload, ..frame }), None);
    }
}

/// Every setting has a distinct value that differs from its default, and none of the derived values is 0.
#[test]
fn a_setup_passes() {
    let settings = RigSettings {
        displacement_limit: 0.7,
        force_limit: 5.5,
        tracking_limit: 0.2,
        trip_ticks: 11,
        stop_ticks: 6_000,
        link_ticks: 70_000,
        clock_rate: 48e6,
        observer_bandwidth: 30.0,
        observer_damping: 0.9,
        correction_gain: 0.6,
        correction_limit: 0.3,
        lead: 3e-3,
        glide: 7e-3,
        feedback: 4.0,
        temperature_range: [-30.0, 150.0],
        temperature_rate: 1.5,
        health: HealthSettings {
            size: 0.08,
            false_alarm_cycles: 1e5,
            learning_cycles: 20,
            run_in_cycles: 100,
            temperature_slope: 0.003,
            run_in_size: 0.12,
            follow: 0.15,
        },
    };
    passes(Request::Setup(Setup {
        displacement: Scale::new(1.5, 0.125).unwrap(),
        force: Scale::new(6.5, -0.25).unwrap(),
        command: Scale::new(2.5, 0.5).unwrap(),
        config: settings.at(8_000.0).unwrap(),
    }));
}

/// One block sweeps up and one down, so that the growth of the phase's increment has either sign.
#[test]
fn a_programme_passes() {
    let mut programme = Programme::<3>::new(10_000.0, 3).unwrap();
    for block in [
        Block::sine(0.1, 0.7, 5),
        Block::sweep(0.2, 1.3, 4.1, 6),
        Block::sweep(0.3, 5.3, 2.1, 7),
    ] {
        programme = programme.with(block.unwrap()).unwrap();
    }
    passes(Request::Programme(programme.head()));
    assert_eq!(programme.planned().len(), 3);
    // Assembled over another one.
    let mut again = Programme::<3>::new(1_000.0, 1).unwrap();
    again = again.with(Block::sine(0.4, 2.0, 8).unwrap()).unwrap();
    again.begin_planned(&programme.head());
    for block in programme.planned() {
        passes(Request::Block(block));
        again.push_planned(&block).unwrap();
    }
    assert_eq!(again, programme);
}

/// Each input has a distinct value, so that an exchange is detected.
#[test]
fn what_the_sensors_deliver_passes() {
    let sensors = Sensors {
        displacement: 0x1234,
        force: 0xfedc,
        temperature: 21.5,
        controls: [0.5, -1.5, 2.5, -3.5],
        clock: 0x89ab_cdef,
        tripped: false,
    };
    passes(Request::Tick(sensors));
    passes(Request::Tick(Sensors {
        tripped: true,
        ..sensors
    }));
    let mut buffer = FrameBuffer::new();
    Request::Tick(sensors).write(5, &mut buffer);
    assert_eq!(Sensors::read(&frame(&buffer)), Some(sensors));
    Request::Start.write(5, &mut buffer);
    assert_eq!(Sensors::read(&frame(&buffer)), None);
}

fn motion(number: usize) -> Motion<f32> {
    let number = number as f32;
    Motion {
        displacement: number + 0.5,
        velocity: -number,
        acceleration: 100.0 * number,
        cycles: number / 4.0,
        temperature: 20.0 + number,
        controls: [0.1, 0.2, 0.3, 0.4].map(|part| part * number),
    }
}

#[test]
fn as_many_motions_pass_as_fit_and_a_force_for_each() {
    let all: Vec<Motion<f32>> = (0..=MOTIONS).map(motion).collect();
    for count in [0, 1, 2, MOTIONS, MOTIONS + 1] {
        let taken = &all[..count.min(MOTIONS)];
        let mut bytes = [0; PAYLOAD];
        let mut buffer = FrameBuffer::new();
        Request::Motions(Motions::new(&all[..count], &mut bytes)).write(6, &mut buffer);
        let asked = frame(&buffer);
        assert_eq!(usize::from(asked.header.count), taken.len());
        let Some(Request::Motions(motions)) = Request::read(&asked) else {
            panic!("no motions in {asked:?}");
        };
        assert!(motions.eq(taken.iter().copied()));

        let mut answer = FrameBuffer::new();
        let law = |motion: &Motion<f32>| 3.0 * motion.cycles + motion.controls[3];
        write_forces(6, motions, law, &mut answer);
        let answered = frame(&answer);
        let header = answered.header;
        assert_eq!(
            (header.sequence, usize::from(header.count)),
            (6, taken.len())
        );
        let Some(Answer::Forces(forces)) = Answer::read(&answered) else {
            panic!("no forces in {answered:?}");
        };
        assert!(forces.eq(taken.iter().map(law)));
    }
}

#[test]
fn every_refusal_passes() {
    let mut buffer = FrameBuffer::new();
    for refusal in [
        Refusal::Order,
        Refusal::Converter,
        Refusal::Field("glide"),
        ConfigError::Removed("clock").into(),
        PackError::Magic.into(),
        PackError::Version { found: 9 }.into(),
        PackError::TickRate {
            expected: 1e4,
            found: None,
        }
        .into(),
        PackError::Identity {
            expected: Identity([1; 8]),
            found: None,
        }
        .into(),
        PackError::Revision {
            newer_than: 2,
            found: Some(2),
        }
        .into(),
        PackError::Checksum.into(),
        PackError::Body.into(),
        Refusal::PackLength,
        Refusal::PackOrder,
    ] {
        write_refusal(3, &refusal, &mut buffer);
        assert_eq!(
            Answer::read(&frame(&buffer)),
            Some(Answer::Refused(refusal))
        );
    }
}

#[test]
fn statistics_and_asking_again_pass() {
    let mut buffer = FrameBuffer::new();
    let statistics = Statistics {
        stack: 0x0102_0304,
        log_lost: 0x0506_0708,
    };
    write_statistics(4, &statistics, &mut buffer);
    let answered = frame(&buffer);
    assert_eq!((answered.header.sequence, answered.header.count), (4, 1));
    assert_eq!(
        Answer::read(&answered),
        Some(Answer::Statistics(statistics))
    );
    write_again(&mut buffer);
    assert_eq!(Answer::read(&frame(&buffer)), Some(Answer::Again));
}

#[test]
fn what_a_board_on_its_own_timer_is_and_sends_passes() {
    passes(Request::Join);
    passes(Request::Telemetry(TelemetryConfig {
        every: 0x0102_0304,
        within: 0x0506_0708,
        controls: 3,
        session: 0x0a,
    }));
    let about = About {
        own_timer: true,
        clock: 25_000_000,
        tick_rate: 8e3,
        state: State::Faulted(TripCause::LinkLost),
        law_waits: false,
        late_ticks: 0x0102_0304,
        identity: Identity([1, 2, 3, 4, 5, 6, 7, 8]),
        revision: 0x0a0b_0c0d,
    };
    let mut buffer = FrameBuffer::new();
    for about in [
        about,
        About {
            own_timer: false,
            law_waits: true,
            ..about
        },
    ] {
        write_about(4, &about, &mut buffer);
        assert_eq!(Answer::read(&frame(&buffer)), Some(Answer::About(about)));
    }
}

/// Its fields are `first`, `first` + 1 and so on.
pub fn cycle(first: f32) -> Cycle {
    let mut next = first - 1.0;
    let mut value = || {
        next += 1.0;
        next
    };
    Cycle {
        force_max: value(),
        force_min: value(),
        displacement_max: value(),
        displacement_min: value(),
        amplitude: value(),
        energy: value(),
        energy_harmonic: value(),
        stiffness: value(),
        elastic_energy: value(),
        loss_factor: value(),
        mean_force: value(),
        mean_displacement: value(),
        ticks: value(),
    }
}

fn telemetry() -> Telemetry {
    Telemetry {
        tick: 0x0123_4567_89ab_cdef,
        displacement: 0.25,
        velocity: -3.5,
        measured_force: 1.25,
        controls: [0.5, -1.5, 2.5, -3.5],
        model_force: 1.125,
        command: 0.375,
        block: 3,
        cycle: 41,
        phase: 0xfedc_ba98,
        ramp: false,
        state: State::Running,
        report: None,
        event: None,
    }
}

fn outcome_passes(code: u16, enabled: bool, telemetry: Telemetry) {
    let mut buffer = FrameBuffer::new();
    write_outcome(8, code, enabled, &telemetry, &mut buffer);
    let answered = frame(&buffer);
    assert_eq!((answered.header.sequence, answered.header.count), (8, 1));
    let outcome = Outcome {
        code,
        enabled,
        telemetry,
    };
    assert_eq!(Answer::read(&answered), Some(Answer::Outcome(outcome)));
    for length in 0..answered.payload.len() {
        let payload = &answered.payload[..length];
        assert_eq!(
            Answer::read(&Frame {
                payload,
                ..answered
            }),
            None
        );
    }
}

/// Each flag alone and all of them, so that an exchange is detected.
#[test]
fn an_outcome_passes() {
    let report = CycleReport {
        block: 2,
        cycle: 40,
        ramp: false,
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
        cause: HealthCause::WireBreakage,
        or: None,
        statistic: Statistic::Stiffness,
        value: -0.07,
        limit: 0.05,
        cycle: 39,
    };
    outcome_passes(0, false, telemetry());
    outcome_passes(0xfedc, true, telemetry());
    outcome_passes(
        1,
        false,
        Telemetry {
            ramp: true,
            ..telemetry()
        },
    );
    for ramp in [false, true] {
        let report = Some(CycleReport { ramp, ..report });
        outcome_passes(
            2,
            false,
            Telemetry {
                report,
                ..telemetry()
            },
        );
        outcome_passes(
            3,
            true,
            Telemetry {
                report,
                ramp: !ramp,
                event: Some(event),
                ..telemetry()
            },
        );
    }
    for cause in HealthCause::ALL {
        for statistic in Statistic::ALL {
            outcome_passes(
                4,
                false,
                Telemetry {
                    event: Some(Event {
                        cause,
                        or: (cause != HealthCause::Loosening).then_some(HealthCause::Loosening),
                        statistic,
                        ..event
                    }),
                    ..telemetry()
                },
            );
        }
    }
}

/// A newer sender may name causes that this version does not know: the event is a fault, and its evidence stays.
#[test]
fn an_unknown_cause_is_an_unexplained_one() {
    let event = Event {
        cause: HealthCause::RunIn,
        or: Some(HealthCause::Loosening),
        statistic: Statistic::Energy,
        value: 0.2,
        limit: 0.1,
        cycle: 9,
    };
    let sent = Telemetry {
        event: Some(event),
        ..telemetry()
    };
    let mut buffer = FrameBuffer::new();
    write_outcome(8, 1, false, &sent, &mut buffer);
    let answered = frame(&buffer);
    let mut payload = answered.payload.to_vec();
    // The event is the end of the payload: cause, statistic, other cause, nothing, and three numbers.
    let at = payload.len() - 16;
    (payload[at], payload[at + 2]) = (254, 253);
    let payload = &payload[..];
    let answer = Answer::read(&Frame {
        payload,
        ..answered
    });
    let Some(Answer::Outcome(outcome)) = answer else {
        panic!("{answer:?}")
    };
    let unexplained = HealthCause::Unexplained;
    assert_eq!(
        outcome.telemetry.event,
        Some(Event {
            cause: unexplained,
            or: Some(unexplained),
            ..event
        })
    );
}

#[test]
fn every_state_passes() {
    let faults = [
        TripCause::AdcBus,
        TripCause::DacBus,
        TripCause::EnableLine,
        TripCause::DisplacementClipped,
        TripCause::ForceClipped,
        TripCause::CommandClipped,
        TripCause::DisplacementLimit,
        TripCause::ForceLimit,
        TripCause::TrackingLimit,
        TripCause::NoResponse,
        TripCause::NotFinite,
        TripCause::DisplacementLost,
        TripCause::ForceLost,
        TripCause::LinkLost,
        TripCause::TickOverrun,
        TripCause::DemandLimit,
        TripCause::External,
        TripCause::CorrectionLimit,
    ]
    .map(State::Faulted);
    for state in [State::Idle, State::Running, State::Done]
        .into_iter()
        .chain(faults)
    {
        outcome_passes(
            5,
            true,
            Telemetry {
                state,
                ..telemetry()
            },
        );
    }
}

/// If any number of a setting on the link is replaced by one that no setting can give, the setting is refused.
#[test]
fn settings_that_nobody_may_set_are_refused() {
    fn refused<F: Fields + std::fmt::Debug>(good: &F) {
        let mut buffer = [0; 512];
        let mut writer = Writer::new(&mut buffer);
        good.write(&mut writer);
        let length = 512 - writer.left().unwrap();
        let bytes = &buffer[..length];
        assert!(F::read(&mut Reader(bytes)).is_some());
        for place in 0..length / 4 {
            for poison in [
                f32::NAN,
                f32::INFINITY,
                f32::NEG_INFINITY,
                f32::MAX,
                -f32::MAX,
            ] {
                let mut forged = bytes.to_vec();
                forged[4 * place..4 * place + 4].copy_from_slice(&poison.to_le_bytes());
                let read = F::read(&mut Reader(&forged));
                // The full scale is derived from the step.
                let is_spare = std::any::type_name::<F>().ends_with("Scale") && place == 0;
                assert!(
                    read.is_none() || is_spare,
                    "{poison} as word {place}: {read:?}"
                );
            }
        }
    }
    let clock_rate = 168e6;
    for settings in [
        RigSettings::default(),
        RigSettings {
            clock_rate,
            link_ticks: 50,
            ..RigSettings::default()
        },
    ] {
        refused(&settings.at(10_000.0).unwrap());
    }
    // The slowest observer at the fastest tick and the fastest at the slowest are not permitted.
    for (tick_rate, observer_bandwidth, observer_damping) in [
        (1e6, 1e-3, 0.3),
        (1e6, 1e-3, 3.0),
        (1.0, 0.1, 3.0),
        (1e4, 1e3, 0.3),
        (1e4, 20.0, 0.7),
    ] {
        let settings = RigSettings {
            observer_bandwidth,
            observer_damping,
            feedback: 0.0,
            glide: 1.0,
            ..RigSettings::default()
        };
        refused(&settings.at(tick_rate).unwrap());
    }
    refused(&Scale::new(-1.5, 0.125).unwrap());
    refused(&Scale::new(1e6, 0.0).unwrap());
    refused(&StreamSettings::default().at(1e4).unwrap());
}
