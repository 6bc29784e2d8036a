//! Payloads of the link's frames: requests of the harness, answers of the image.
//!
//! [`Request::Programme`], its blocks, a coefficient pack in parts, and [`Request::Setup`] set up a test. Then follow
//! [`Request::Start`], and a [`Request::Tick`] for each tick of the rig. A streamed motion is set up by [`Request::Stream`] in
//! place of the programme, and its [`Request::Knots`] arrive before the ticks that need them. [`Request::Motions`] evaluates the
//! law alone. Numbers are transferred bit for bit, four bytes each, so that a target without f64 gets the numbers that a host
//! computed.

mod outcome;
mod refusal;
mod telemetry;

pub use outcome::{Outcome, write_outcome};
pub use refusal::{Refusal, write_refusal};
pub use telemetry::{Note, ROWS, Row, Rows, Telemetered, TelemetryConfig};
pub(crate) use telemetry::{write_note, write_rows};

use crate::converter::Scale;
use crate::effects::{CONTROLS, Motion};
use crate::frame::{Fields, Frame, FrameBuffer, Header, PAYLOAD, Reader, Writer};
use crate::pack::Identity;
use crate::rig::{Knot, RigConfig, State, StreamConfig};
use crate::sine::{PlannedBlock, ProgrammeHead};
use outcome::{read_outcome, state_code, state_of};
use refusal::read_refusal;

/// Most blocks of a programme that the image holds.
pub const MAX_BLOCKS: usize = 16;
/// Bytes of a motion: five numbers and its controls.
const MOTION: usize = 4 * (5 + CONTROLS);
/// Most motions in one frame.
pub const MOTIONS: usize = PAYLOAD / MOTION;
/// Bytes of a knot.
const KNOT: usize = 8;
/// Most bytes in a part of a pack.
pub const PART: usize = PAYLOAD - 2;

/// Numbers of the kinds of frames: requests first, answers from [`kind::DONE`] on.
mod kind {
    pub const PROGRAMME: u8 = 1;
    pub const BLOCK: u8 = 2;
    pub const PACK_PART: u8 = 3;
    pub const PACK_END: u8 = 4;
    pub const SETUP: u8 = 5;
    pub const START: u8 = 6;
    pub const STOP: u8 = 7;
    pub const CLEAR: u8 = 8;
    pub const TICK: u8 = 9;
    pub const REST: u8 = 10;
    pub const MOTIONS: u8 = 11;
    pub const STATISTICS: u8 = 12;
    pub const STREAM: u8 = 13;
    pub const KNOTS: u8 = 14;
    pub const HELLO: u8 = 15;
    pub const JOIN: u8 = 16;
    pub const TELEMETRY: u8 = 17;
    pub const DONE: u8 = 64;
    pub const REFUSED: u8 = 65;
    pub const OUTCOME: u8 = 66;
    pub const FORCES: u8 = 67;
    pub const STATISTICS_ANSWER: u8 = 68;
    pub const AGAIN: u8 = 69;
    pub const ABOUT: u8 = 70;
    pub const ROWS: u8 = 71;
    pub const NOTE: u8 = 72;
}

/// Wiring and settings of the rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Displacement at the ADC, mm.
    pub displacement: Scale,
    /// Force at the ADC, kN.
    pub force: Scale,
    /// Command at the DAC, mm.
    pub command: Scale,
    /// The rig's settings.
    pub config: RigConfig,
}

impl Fields for Setup {
    fn write(&self, writer: &mut Writer<'_>) {
        for scale in [&self.displacement, &self.force, &self.command] {
            scale.write(writer);
        }
        self.config.write(writer);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        Some(Self {
            displacement: Scale::read(reader)?,
            force: Scale::read(reader)?,
            command: Scale::read(reader)?,
            config: RigConfig::read(reader)?,
        })
    }
}

/// Sensor values at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sensors {
    /// The ADC's code of channel 0.
    pub displacement: u16,
    /// The ADC's code of channel 1.
    pub force: u16,
    /// Temperature, °C.
    pub temperature: f32,
    /// Control inputs, like those of [`crate::rig::Reading`].
    pub controls: [f32; CONTROLS],
    /// Reading of the harness's clock, as [`crate::rig::Controller::tick`] takes it.
    pub clock: u32,
    /// The stop input is active at this tick and until the next.
    pub tripped: bool,
}

impl Sensors {
    /// The sensors of a [`Request::Tick`] in `frame`. Separate from the other requests, because a tick leaves little time.
    #[inline(always)]
    pub fn read(frame: &Frame<'_>) -> Option<Self> {
        if frame.header.kind != kind::TICK {
            return None;
        }
        let mut reader = Reader(frame.payload);
        Some(Self {
            displacement: reader.u16()?,
            force: reader.u16()?,
            temperature: reader.f32()?,
            controls: reader.words()?.map(f32::from_bits),
            clock: reader.u32()?,
            tripped: reader.u8()? != 0,
        })
    }
}

/// A request to the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request<'a> {
    /// Begins a programme, without blocks.
    Programme(ProgrammeHead),
    /// Adds a block.
    Block(PlannedBlock),
    /// A part of a coefficient pack, to be placed at this byte.
    PackPart(u16, &'a [u8]),
    /// The pack is complete. If there is no rig yet, it is checked and its law taken at once. If there is one, each request does a
    /// slice of the check, at most about 600 instructions or one force of the law. The answer is no while slices remain: send the
    /// request again, with ticks in between as they are due. The answer is yes once the law waits for the next end of a cycle, or
    /// else a refusal. A new first part ends a check in progress.
    PackEnd,
    /// Wires up the rig.
    Setup(Setup),
    /// [`crate::rig::Controller::start`].
    Start,
    /// [`crate::rig::Controller::stop`].
    Stop,
    /// [`crate::rig::Controller::clear`].
    Clear,
    /// Runs one tick of the rig.
    Tick(Sensors),
    /// Puts the law's effects at rest, for the motions to come.
    Rest,
    /// Evaluates the law at these motions, one per tick.
    Motions(Motions<'a>),
    /// Asks for the image's use of resources.
    Statistics,
    /// The rig follows a stream in place of a programme.
    Stream(StreamConfig),
    /// The next knots of the stream; an empty list ends the stream with the knots sent so far. If there is no room, the answer is
    /// no, and the remaining knots are not taken.
    Knots(Knots<'a>),
    /// A new harness is at this end of the link, and requests number 0. A board that has already answered requests restarts, as
    /// after power-up, and answers when the request is repeated.
    Hello,
    /// A new harness is at this end of the link, and the board continues its work. Sequence numbers continue from that of this
    /// request, whatever it is.
    Join,
    /// A board on its own timer sends this telemetry from now on, until it restarts or gets another such request.
    Telemetry(TelemetryConfig),
}

/// Kind and state of a board. It is not logged, because it is requested five times a second.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct About {
    /// The board generates its ticks itself. A board that does not waits for [`Request::Tick`].
    pub own_timer: bool,
    /// Rate of the counter that checks the timing of ticks, Hz; 0 where ticks arrive over the link.
    pub clock: u32,
    /// Tick rate of its rig, Hz; 0 without a rig.
    pub tick_rate: f32,
    /// State of its rig.
    pub state: State,
    /// A law waits for the end of the cycle.
    pub law_waits: bool,
    /// Ticks that were not in time.
    pub late_ticks: u32,
    /// Identity of the pack received last: that of the waiting law, or of the running law. Identity and revision are 0 before the
    /// first pack, and for a pack without a stamp.
    pub identity: Identity,
    /// Revision of the same pack.
    pub revision: u32,
}

/// Knots in the layout of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knots<'a>(&'a [u8]);

impl<'a> Knots<'a> {
    /// Takes as many of `knots` as fit into `buffer`.
    pub fn new(knots: &[Knot], buffer: &'a mut [u8; PAYLOAD]) -> Self {
        let mut used = 0;
        for (knot, place) in knots.iter().zip(buffer.chunks_exact_mut(KNOT)) {
            Writer::new(place).words([knot.displacement.to_bits(), knot.velocity.to_bits()]);
            used += KNOT;
        }
        Self(buffer.get(..used).unwrap_or_default())
    }

    /// Whether there are no knots.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

impl Iterator for Knots<'_> {
    type Item = Knot;

    fn next(&mut self) -> Option<Knot> {
        let mut reader = Reader(self.0);
        let [displacement, velocity] = reader.words()?.map(f32::from_bits);
        self.0 = reader.rest();
        Some(Knot {
            displacement,
            velocity,
        })
    }
}

/// Motions in the layout of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motions<'a>(&'a [u8]);

impl<'a> Motions<'a> {
    /// Takes as many of `motions` as fit into `buffer`.
    pub fn new(motions: &[Motion<f32>], buffer: &'a mut [u8; PAYLOAD]) -> Self {
        let mut used = 0;
        for (motion, place) in motions.iter().zip(buffer.chunks_exact_mut(MOTION)) {
            let mut writer = Writer::new(place);
            let numbers = [
                motion.displacement,
                motion.velocity,
                motion.acceleration,
                motion.cycles,
                motion.temperature,
            ];
            writer.words(numbers.map(f32::to_bits));
            writer.words(motion.controls.map(f32::to_bits));
            used += MOTION;
        }
        Self(buffer.get(..used).unwrap_or_default())
    }

    fn count_in_frame(&self) -> u16 {
        (self.0.len() / MOTION) as u16
    }
}

impl Iterator for Motions<'_> {
    type Item = Motion<f32>;

    #[inline]
    fn next(&mut self) -> Option<Motion<f32>> {
        let mut reader = Reader(self.0);
        let [displacement, velocity, acceleration, cycles, temperature] =
            reader.words()?.map(f32::from_bits);
        let controls = reader.words()?.map(f32::from_bits);
        self.0 = reader.rest();
        Some(Motion {
            displacement,
            velocity,
            acceleration,
            cycles,
            temperature,
            controls,
        })
    }
}

impl<'a> Request<'a> {
    /// The request in `frame`; `None` if the frame is not a request. Not inlined, so that its stack is free again before the
    /// request is carried out.
    #[inline(never)]
    pub fn read(frame: &Frame<'a>) -> Option<Self> {
        let mut reader = Reader(frame.payload);
        Some(match frame.header.kind {
            kind::TICK => Self::Tick(Sensors::read(frame)?),
            kind::MOTIONS => Self::Motions(Motions(frame.payload)),
            kind::PACK_PART => Self::PackPart(reader.u16()?, reader.rest()),
            kind::PACK_END => Self::PackEnd,
            kind::PROGRAMME => Self::Programme(Fields::read(&mut reader)?),
            kind::BLOCK => Self::Block(Fields::read(&mut reader)?),
            kind::SETUP => Self::Setup(Fields::read(&mut reader)?),
            kind::START => Self::Start,
            kind::STOP => Self::Stop,
            kind::CLEAR => Self::Clear,
            kind::REST => Self::Rest,
            kind::STATISTICS => Self::Statistics,
            kind::STREAM => Self::Stream(Fields::read(&mut reader)?),
            kind::KNOTS => Self::Knots(Knots(frame.payload)),
            kind::HELLO => Self::Hello,
            kind::JOIN => Self::Join,
            kind::TELEMETRY => Self::Telemetry(Fields::read(&mut reader)?),
            _ => return None,
        })
    }

    /// Writes the request as the frame with number `sequence`.
    pub fn write(&self, sequence: u32, buffer: &mut FrameBuffer) {
        let (kind, count) = match self {
            Self::Programme(_) => (kind::PROGRAMME, 1),
            Self::Block(_) => (kind::BLOCK, 1),
            Self::PackPart(..) => (kind::PACK_PART, 1),
            Self::PackEnd => (kind::PACK_END, 1),
            Self::Setup(_) => (kind::SETUP, 1),
            Self::Start => (kind::START, 1),
            Self::Stop => (kind::STOP, 1),
            Self::Clear => (kind::CLEAR, 1),
            Self::Tick(_) => (kind::TICK, 1),
            Self::Rest => (kind::REST, 1),
            Self::Motions(motions) => (kind::MOTIONS, motions.count_in_frame()),
            Self::Statistics => (kind::STATISTICS, 1),
            Self::Stream(_) => (kind::STREAM, 1),
            Self::Knots(knots) => (kind::KNOTS, (knots.0.len() / KNOT) as u16),
            Self::Hello => (kind::HELLO, 1),
            Self::Join => (kind::JOIN, 1),
            Self::Telemetry(_) => (kind::TELEMETRY, 1),
        };
        let header = Header {
            kind,
            sequence,
            count,
        };
        buffer.write(header, |writer| match self {
            Self::Programme(programme) => programme.write(writer),
            Self::Block(block) => block.write(writer),
            Self::Setup(setup) => setup.write(writer),
            Self::PackPart(offset, bytes) => {
                writer.u16(*offset);
                writer.bytes(bytes);
            }
            Self::Tick(sensors) => {
                writer.u16(sensors.displacement);
                writer.u16(sensors.force);
                writer.f32(sensors.temperature);
                writer.words(sensors.controls.map(f32::to_bits));
                writer.u32(sensors.clock);
                writer.u8(sensors.tripped.into());
            }
            Self::Motions(motions) => writer.bytes(motions.0),
            Self::Stream(config) => config.write(writer),
            Self::Knots(knots) => writer.bytes(knots.0),
            Self::Telemetry(config) => config.write(writer),
            _ => {}
        });
    }
}

/// Whether `frame` is [`Request::Hello`].
pub fn is_hello(frame: &Frame<'_>) -> bool {
    frame.header.kind == kind::HELLO
}

/// Whether `frame` is [`Request::Join`].
pub fn is_join(frame: &Frame<'_>) -> bool {
    frame.header.kind == kind::JOIN
}

/// Resources used by the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Statistics {
    /// Most bytes of stack used since the start.
    pub stack: u32,
    /// Log messages that the log's channel lost.
    pub log_lost: u32,
}

/// An answer of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "the outcome is most of the answers, and there is no heap; only where pointers are short is it so much larger"
)]
pub enum Answer<'a> {
    /// Done. The value is no if there was no room for all knots or a pack's check continues, and yes otherwise.
    Done(bool),
    /// The request was not carried out.
    Refused(Refusal<'a>),
    /// Answer to [`Request::Tick`].
    Outcome(Outcome),
    /// Answer to [`Request::Motions`].
    Forces(Forces<'a>),
    /// Answer to [`Request::Statistics`].
    Statistics(Statistics),
    /// Answer to [`Request::Join`].
    About(About),
    /// The bytes received were not a whole and undamaged frame: repeat the request.
    Again,
}

/// Forces in kN in the layout of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces<'a>(&'a [u8]);

impl Iterator for Forces<'_> {
    type Item = f32;

    fn next(&mut self) -> Option<f32> {
        let mut reader = Reader(self.0);
        let force = reader.f32()?;
        self.0 = reader.rest();
        Some(force)
    }
}

impl<'a> Answer<'a> {
    /// The answer in `frame`; `None` if the frame is not an answer.
    pub fn read(frame: &Frame<'a>) -> Option<Self> {
        let mut reader = Reader(frame.payload);
        Some(match frame.header.kind {
            kind::DONE => Self::Done(reader.u8()? != 0),
            kind::REFUSED => Self::Refused(read_refusal(&mut reader)?),
            kind::OUTCOME => Self::Outcome(read_outcome(&mut reader)?),
            kind::FORCES => Self::Forces(Forces(frame.payload)),
            kind::STATISTICS_ANSWER => Self::Statistics(Statistics {
                stack: reader.u32()?,
                log_lost: reader.u32()?,
            }),
            kind::ABOUT => {
                let [clock, tick_rate, late_ticks] = reader.words()?;
                let [flags, state, ..] = reader.u32()?.to_le_bytes();
                let [first, second, revision] = reader.words()?;
                let identity = u64::from(first) | u64::from(second) << 32;
                let identity = Identity(identity.to_le_bytes());
                Self::About(About {
                    own_timer: flags & OWN_TIMER != 0,
                    clock,
                    tick_rate: f32::from_bits(tick_rate),
                    state: state_of(state)?,
                    law_waits: flags & LAW_WAITS != 0,
                    late_ticks,
                    identity,
                    revision,
                })
            }
            kind::AGAIN => Self::Again,
            _ => return None,
        })
    }
}

/// Writes [`Answer::Done`].
pub fn write_done(sequence: u32, done: bool, buffer: &mut FrameBuffer) {
    buffer.write(answer(kind::DONE, sequence, 1), |writer| {
        writer.u8(done.into())
    });
}

/// Writes [`Answer::Statistics`].
pub fn write_statistics(sequence: u32, statistics: &Statistics, buffer: &mut FrameBuffer) {
    buffer.write(answer(kind::STATISTICS_ANSWER, sequence, 1), |writer| {
        writer.words([statistics.stack, statistics.log_lost]);
    });
}

const OWN_TIMER: u8 = 1;
const LAW_WAITS: u8 = 2;

/// Writes [`Answer::About`].
pub fn write_about(sequence: u32, about: &About, buffer: &mut FrameBuffer) {
    let flag = |set: bool, flag: u8| if set { flag } else { 0 };
    let flags = flag(about.own_timer, OWN_TIMER) | flag(about.law_waits, LAW_WAITS);
    buffer.write(answer(kind::ABOUT, sequence, 1), |writer| {
        writer.words([
            about.clock,
            about.tick_rate.to_bits(),
            about.late_ticks,
            u32::from_le_bytes([flags, state_code(about.state), 0, 0]),
        ]);
        writer.bytes(&about.identity.0);
        writer.u32(about.revision);
    });
}

/// Writes [`Answer::Forces`]: the force of `law` at each of `motions`.
pub fn write_forces(
    sequence: u32,
    motions: Motions<'_>,
    mut law: impl FnMut(&Motion<f32>) -> f32,
    buffer: &mut FrameBuffer,
) {
    let header = answer(kind::FORCES, sequence, motions.count_in_frame());
    buffer.write(header, |writer| {
        for motion in motions {
            writer.f32(law(&motion));
        }
    });
}

/// Writes [`Answer::Again`].
pub fn write_again(buffer: &mut FrameBuffer) {
    buffer.write(answer(kind::AGAIN, 0, 0), |_| {});
}

fn answer(kind: u8, sequence: u32, count: u16) -> Header {
    Header {
        kind,
        sequence,
        count,
    }
}
