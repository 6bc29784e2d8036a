//! Frames of the link, damaged and forged.

use mesh_damper::converter::Scale;
use mesh_damper::effects::Motion;
use mesh_damper::frame::{Frame, FrameBuffer, Frames, Header, PAYLOAD};
use mesh_damper::message::{
    About, Answer, Knots, Motions, Outcome, ROWS, Refusal, Request, Sensors, Setup, Statistics,
    Telemetered, TelemetryConfig, write_about, write_again, write_done, write_forces,
    write_outcome, write_refusal, write_statistics,
};
use mesh_damper::pack::Identity;
use mesh_damper::rig::{Knot, RigSettings, State, StreamSettings, Telemetry};
use mesh_damper::sine::{Block, Programme};
use mesh_damper::telemetry::Channel;
use std::sync::LazyLock;

use crate::edit::edited;

/// Fields of a frame, as bytes.
const WORDS: [&str; 6] = [
    "MD",
    "MD\u{7}",
    "\0\0\0\0",
    "\u{1}",
    "\0",
    "MD\u{7}\t\0\0\0\0\u{1}\0\u{18}\0",
];

/// One frame of every kind.
pub static GOOD: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let programme = Programme::<2>::new(1e4, 1)
        .and_then(|programme| programme.with(Block::sine(0.1, 2.0, 3)?))
        .and_then(|programme| programme.with(Block::sweep(0.05, 1.0, 9.0, 4)?))
        .expect("all are in range");
    let scale = Scale::new(1.0, 0.0).expect("it is in range");
    let config = RigSettings::default()
        .at(1e4)
        .expect("they are the default");
    let motion = Motion {
        controls: [0.5, -1.5, 0.0, 9.0],
        ..Motion::at(0.1, -2.0)
    };
    let knot = Knot {
        displacement: 0.1,
        velocity: -2.0,
    };
    let (mut buffer, mut knots) = ([0; PAYLOAD], [0; PAYLOAD]);
    let mut requests = vec![
        Request::Programme(programme.head()),
        Request::PackPart(0, b"a part of a pack"),
        Request::PackEnd,
        Request::Setup(Setup {
            displacement: scale,
            force: scale,
            command: scale,
            config,
        }),
        Request::Start,
        Request::Tick(Sensors {
            displacement: 0x8123,
            force: 0x7fed,
            temperature: 21.5,
            controls: [0.5, -1.5, 0.0, 9.0],
            clock: 0x1234_5678,
            tripped: false,
        }),
        Request::Stop,
        Request::Clear,
        Request::Rest,
        Request::Motions(Motions::new(&[motion; 3], &mut buffer)),
        Request::Statistics,
        Request::Stream(
            StreamSettings::default()
                .at(1e4)
                .expect("they are the default"),
        ),
        Request::Knots(Knots::new(&[knot; 2], &mut knots)),
        Request::Hello,
        Request::Join,
        Request::Telemetry(TelemetryConfig {
            every: 10,
            within: 500,
            controls: 2,
            session: 9,
        }),
    ];
    requests.extend(programme.planned().map(Request::Block));
    let mut frame = FrameBuffer::new();
    let mut good = Vec::new();
    for (sequence, request) in (0..).zip(&requests) {
        request.write(sequence, &mut frame);
        good.push(frame.bytes().to_vec());
    }
    let mut written = |write: &dyn Fn(&mut FrameBuffer)| {
        write(&mut frame);
        good.push(frame.bytes().to_vec());
    };
    written(&|frame| write_done(3, true, frame));
    written(&|frame| write_refusal(4, &Refusal::PackChecksum, frame));
    written(&|frame| write_refusal(5, &Refusal::Field("k1"), frame));
    written(&|frame| {
        write_statistics(
            6,
            &Statistics {
                stack: 900,
                log_lost: 1,
            },
            frame,
        )
    });
    let motions = Motions::new(&[motion; 2], &mut buffer);
    written(&|frame| write_forces(7, motions, |motion| motion.displacement, frame));
    written(&write_again);
    let about = About {
        own_timer: true,
        clock: 25_000_000,
        tick_rate: 1e4,
        state: State::Running,
        law_waits: true,
        late_ticks: 3,
        identity: Identity([1, 2, 3, 4, 5, 6, 7, 8]),
        revision: 2,
    };
    written(&|frame| write_about(8, &about, frame));
    let mut channel = Channel::<8>::new();
    let (mut recorder, mut sender) = channel.split();
    recorder.set(TelemetryConfig {
        every: 1,
        within: 2,
        controls: 2,
        session: 9,
    });
    for state in [State::Running, State::Running, State::Done] {
        recorder.tick(&telemetry(state), 21.5);
    }
    while sender.next(&mut frame) {
        good.push(frame.bytes().to_vec());
    }
    good
});

fn telemetry(state: State) -> Telemetry {
    Telemetry {
        tick: 7,
        displacement: 0.1,
        velocity: -2.0,
        measured_force: 1.0,
        controls: [0.5, -1.5, 0.0, 0.0],
        model_force: 1.1,
        command: 0.2,
        block: 0,
        cycle: 0,
        phase: 0,
        ramp: false,
        state,
        report: None,
        event: None,
    }
}

static STREAM: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| vec![GOOD.concat()]);

/// Damages a stream of frames, and checks each frame that the reader finds in it. Returns these frames.
pub fn damaged(script: &[u8]) -> Vec<Vec<u8>> {
    let stream = edited(&STREAM, &WORDS, script);
    let mut found = Vec::new();
    for frame in Frames(&stream) {
        is_what_it_says(&frame);
        found.push(sealed(frame.header, frame.payload).bytes().to_vec());
    }
    found
}

/// The check of [`damaged`]. In addition, a forged payload with a correct checksum is refused or read consistently.
pub fn check(script: &[u8]) {
    damaged(script);
    if let Some((&kind, payload)) = script.split_first() {
        // Mostly an existing kind.
        let kind = if kind < 128 {
            kind % 19
        } else {
            64 + kind % 10
        };
        let header = Header {
            kind,
            sequence: 9,
            count: 1,
        };
        let forged = sealed(header, &payload[..payload.len().min(PAYLOAD)]);
        let frame = Frames(forged.bytes())
            .next()
            .expect("its checksum is right");
        is_what_it_says(&frame);
    }
}

fn sealed(header: Header, payload: &[u8]) -> FrameBuffer {
    let mut buffer = FrameBuffer::new();
    buffer.write(header, |writer| writer.bytes(payload));
    buffer
}

/// A frame that was read, written and read again is the same, bit for bit.
fn is_what_it_says(frame: &Frame<'_>) {
    if let Some(Telemetered::Rows(rows)) = Telemetered::read(frame) {
        assert!(rows.count() <= ROWS);
    }
    if let Some(first) = written_again(frame) {
        let frame = Frames(first.bytes()).next().expect("it was written");
        let second = written_again(&frame).expect("it is of the same kind");
        assert_eq!(first.bytes(), second.bytes());
    }
}

fn written_again(frame: &Frame<'_>) -> Option<FrameBuffer> {
    let mut buffer = FrameBuffer::new();
    let sequence = frame.header.sequence;
    if let Some(request) = Request::read(frame) {
        request.write(sequence, &mut buffer);
        return Some(buffer);
    }
    match Answer::read(frame)? {
        Answer::Done(done) => write_done(sequence, done, &mut buffer),
        Answer::Refused(refusal) => write_refusal(sequence, &refusal, &mut buffer),
        Answer::Outcome(Outcome {
            code,
            enabled,
            telemetry,
        }) => write_outcome(sequence, code, enabled, &telemetry, &mut buffer),
        Answer::Statistics(statistics) => write_statistics(sequence, &statistics, &mut buffer),
        Answer::About(about) => write_about(sequence, &about, &mut buffer),
        // Their bytes are passed on unchanged.
        Answer::Forces(_) | Answer::Again => return None,
    }
    Some(buffer)
}
