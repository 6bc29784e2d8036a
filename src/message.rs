//! What the frames of the link carry: requests of the harness, answers of the image.
//!
//! A test is set up by [`Request::Programme`], its blocks, a coefficient pack in parts, and [`Request::Setup`]; then
//! [`Request::Start`], and a [`Request::Tick`] for each tick of the rig. [`Request::Motions`] instead evaluate the law
//! alone. Numbers go bit for bit, four bytes each: a target without f64 gets what a host computed.

use crate::converter::Scale;
use crate::cycle::Cycle;
use crate::effects::Motion;
use crate::error::ConfigError;
use crate::frame::{Fields, Frame, FrameBuffer, Header, PAYLOAD, Reader, Writer};
use crate::pack::PackError;
use crate::rig::{CycleReport, Fault, RigConfig, State, Telemetry};
use crate::sine::{PlannedBlock, ProgrammeHead};

/// Most blocks of a programme in the image.
pub const MAX_BLOCKS: usize = 16;
/// Bytes of a motion.
const MOTION: usize = 20;
/// Most motions of one frame.
pub const MOTIONS: usize = PAYLOAD / MOTION;
/// Most bytes of a part of a pack.
pub const PART: usize = PAYLOAD - 2;

/// Numbers of the kinds of frames. Requests come first, answers from [`kind::DONE`] on.
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
    pub const DONE: u8 = 64;
    pub const REFUSED: u8 = 65;
    pub const OUTCOME: u8 = 66;
    pub const FORCES: u8 = 67;
    pub const STATISTICS_ANSWER: u8 = 68;
    pub const AGAIN: u8 = 69;
}

/// How the rig is wired up and set.
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

/// What the sensors deliver at one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// The ADC's code of channel 0.
    pub displacement: u16,
    /// The ADC's code of channel 1.
    pub force: u16,
    /// °C.
    pub temperature: f32,
}

impl Sensors {
    /// Of a [`Request::Tick`] in `frame`, apart from the others, as it is what there is little time for.
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
        })
    }
}

/// What the image is asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request<'a> {
    /// A programme without blocks.
    Programme(ProgrammeHead),
    /// A block more.
    Block(PlannedBlock),
    /// A part of a coefficient pack, to be put at this byte.
    PackPart(u16, &'a [u8]),
    /// The pack is complete: its law is taken at the next end of a cycle, or at once where no rig is running.
    PackEnd,
    /// Wires up the rig.
    Setup(Setup),
    /// [`crate::rig::Rig::start`].
    Start,
    /// [`crate::rig::Rig::stop`].
    Stop,
    /// [`crate::rig::Rig::clear`].
    Clear,
    /// One tick of the rig.
    Tick(Sensors),
    /// The law's effects at rest, for motions to come.
    Rest,
    /// The law at these motions, one a tick.
    Motions(Motions<'a>),
    /// What the image took.
    Statistics,
}

/// Motions as they lie in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motions<'a>(&'a [u8]);

impl<'a> Motions<'a> {
    /// As many of `motions` as `buffer` takes.
    pub fn new(motions: &[Motion<f32>], buffer: &'a mut [u8; PAYLOAD]) -> Self {
        let mut used = 0;
        for (motion, place) in motions.iter().zip(buffer.chunks_exact_mut(MOTION)) {
            let mut writer = Writer::new(place);
            writer.f32(motion.displacement);
            writer.f32(motion.velocity);
            writer.f32(motion.acceleration);
            writer.f32(motion.cycles);
            writer.f32(motion.temperature);
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
        let motion = Motion {
            displacement: reader.f32()?,
            velocity: reader.f32()?,
            acceleration: reader.f32()?,
            cycles: reader.f32()?,
            temperature: reader.f32()?,
        };
        self.0 = reader.rest();
        Some(motion)
    }
}

impl<'a> Request<'a> {
    /// The request in `frame`; `None` where it is none.
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
            _ => return None,
        })
    }

    /// Writes the request as the frame number `sequence`.
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
            }
            Self::Motions(motions) => writer.bytes(motions.0),
            _ => {}
        });
    }
}

/// Why the image did not do what it was asked. A field's value and its range are not told: the harness has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal<'a> {
    /// It cannot be done in this order: a tick without a rig, or a law for a rig while there is none.
    Order,
    /// A converter did not answer its driver.
    Converter,
    /// This field of a configuration.
    Field(&'a str),
    /// [`PackError::Magic`].
    PackMagic,
    /// [`PackError::Version`].
    PackVersion,
    /// [`PackError::Length`].
    PackLength,
    /// [`PackError::Order`].
    PackOrder,
    /// [`PackError::Checksum`].
    PackChecksum,
    /// [`PackError::Body`].
    PackBody,
}

/// The refusals without a field by the number that they have on the link.
const REFUSALS: [Refusal<'static>; 8] = [
    Refusal::Order,
    Refusal::Converter,
    Refusal::PackMagic,
    Refusal::PackVersion,
    Refusal::PackLength,
    Refusal::PackOrder,
    Refusal::PackChecksum,
    Refusal::PackBody,
];

impl From<ConfigError> for Refusal<'static> {
    fn from(error: ConfigError) -> Self {
        let (ConfigError::NonFinite(field)
        | ConfigError::OutOfRange { field, .. }
        | ConfigError::NotIncreasing(field)
        | ConfigError::Full { field, .. }
        | ConfigError::Empty(field)) = error;
        Self::Field(field)
    }
}

impl From<PackError> for Refusal<'static> {
    fn from(error: PackError) -> Self {
        match error {
            PackError::Magic => Self::PackMagic,
            PackError::Version { .. } => Self::PackVersion,
            PackError::Length { .. } => Self::PackLength,
            PackError::Order { .. } => Self::PackOrder,
            PackError::Checksum => Self::PackChecksum,
            PackError::Body => Self::PackBody,
            PackError::Refused(error) => error.into(),
        }
    }
}

/// What one tick of the rig came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The DAC's code.
    pub code: u16,
    /// Level of the enable line.
    pub enabled: bool,
    /// What the rig reported.
    pub telemetry: Telemetry,
}

/// What the image took.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Statistics {
    /// Most bytes of stack used since the start.
    pub stack: u32,
    /// Log messages that the log's channel did not take.
    pub log_lost: u32,
}

/// What the image answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer<'a> {
    /// Done; the word is what a rig's `start` and `clear` say, and true for all else.
    Done(bool),
    /// Not done.
    Refused(Refusal<'a>),
    /// Of [`Request::Tick`].
    Outcome(Outcome),
    /// Of [`Request::Motions`].
    Forces(Forces<'a>),
    /// Of [`Request::Statistics`].
    Statistics(Statistics),
    /// What came was no whole and undamaged frame: ask again.
    Again,
}

/// Forces in kN as they lie in a frame.
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
    /// The answer in `frame`; `None` where it is none.
    pub fn read(frame: &Frame<'a>) -> Option<Self> {
        let mut reader = Reader(frame.payload);
        Some(match frame.header.kind {
            kind::DONE => Self::Done(reader.u8()? != 0),
            kind::REFUSED => Self::Refused(match reader.u8()? {
                FIELD => Refusal::Field(core::str::from_utf8(reader.rest()).ok()?),
                number => *REFUSALS.get(usize::from(number))?,
            }),
            kind::OUTCOME => Self::Outcome(read_outcome(&mut reader)?),
            kind::FORCES => Self::Forces(Forces(frame.payload)),
            kind::STATISTICS_ANSWER => Self::Statistics(Statistics {
                stack: reader.u32()?,
                log_lost: reader.u32()?,
            }),
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

/// Number of [`Refusal::Field`] on the link.
const FIELD: u8 = u8::MAX;

/// Writes [`Answer::Refused`].
pub fn write_refusal(sequence: u32, refusal: &Refusal<'_>, buffer: &mut FrameBuffer) {
    buffer.write(answer(kind::REFUSED, sequence, 1), |writer| {
        if let Refusal::Field(field) = refusal {
            writer.u8(FIELD);
            writer.bytes(field.as_bytes());
        } else {
            let number = (0..).zip(&REFUSALS).find(|(_, other)| *other == refusal);
            writer.u8(number.map_or(FIELD, |(number, _)| number));
        }
    });
}

/// Writes [`Answer::Statistics`].
pub fn write_statistics(sequence: u32, statistics: &Statistics, buffer: &mut FrameBuffer) {
    buffer.write(answer(kind::STATISTICS_ANSWER, sequence, 1), |writer| {
        writer.words([statistics.stack, statistics.log_lost]);
    });
}

/// Writes [`Answer::Forces`]: what `law` gives at each of `motions`.
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

const ENABLED: u8 = 1;
const RAMP: u8 = 2;
const REPORT: u8 = 4;
const REPORT_RAMP: u8 = 8;

/// Writes [`Answer::Outcome`].
#[inline(never)]
pub fn write_outcome(
    sequence: u32,
    code: u16,
    enabled: bool,
    telemetry: &Telemetry,
    buffer: &mut FrameBuffer,
) {
    let flag = |set: bool, flag: u8| if set { flag } else { 0 };
    let report = telemetry.report.as_ref();
    let flags = flag(enabled, ENABLED)
        | flag(telemetry.ramp, RAMP)
        | flag(report.is_some(), REPORT)
        | flag(report.is_some_and(|report| report.ramp), REPORT_RAMP);
    let state = state_code(telemetry.state);
    buffer.write(answer(kind::OUTCOME, sequence, 1), |writer| {
        // Four bytes at a time: it is done every tick.
        writer.words([
            u32::from(code) | u32::from(flags) << 16 | u32::from(state) << 24,
            telemetry.tick as u32,
            (telemetry.tick >> 32) as u32,
            telemetry.displacement.to_bits(),
            telemetry.velocity.to_bits(),
            telemetry.measured_force.to_bits(),
            telemetry.model_force.to_bits(),
            telemetry.command.to_bits(),
            telemetry.block as u32,
            telemetry.cycle,
            telemetry.phase,
        ]);
        if let Some(report) = report {
            write_report(writer, report);
        }
    });
}

fn read_outcome(reader: &mut Reader<'_>) -> Option<Outcome> {
    let code = reader.u16()?;
    let flags = reader.u8()?;
    let state = state_of(reader.u8()?)?;
    let tick = u64::from(reader.u32()?) | u64::from(reader.u32()?) << 32;
    let telemetry = Telemetry {
        tick,
        displacement: reader.f32()?,
        velocity: reader.f32()?,
        measured_force: reader.f32()?,
        model_force: reader.f32()?,
        command: reader.f32()?,
        block: reader.u32()? as usize,
        cycle: reader.u32()?,
        phase: reader.u32()?,
        ramp: flags & RAMP != 0,
        state,
        report: if flags & REPORT != 0 {
            Some(read_report(reader, flags & REPORT_RAMP != 0)?)
        } else {
            None
        },
    };
    Some(Outcome {
        code,
        enabled: flags & ENABLED != 0,
        telemetry,
    })
}

#[inline(never)]
fn write_report(writer: &mut Writer<'_>, report: &CycleReport) {
    writer.words([report.block as u32, report.cycle, report.nrmse.to_bits()]);
    write_cycle(writer, &report.measured);
    write_cycle(writer, &report.model);
}

#[inline(never)]
fn write_cycle(writer: &mut Writer<'_>, cycle: &Cycle) {
    let values = [
        cycle.force_max,
        cycle.force_min,
        cycle.displacement_max,
        cycle.displacement_min,
        cycle.amplitude,
        cycle.energy,
        cycle.energy_harmonic,
        cycle.stiffness,
        cycle.elastic_energy,
        cycle.loss_factor,
        cycle.mean_force,
        cycle.mean_displacement,
        cycle.ticks,
    ];
    writer.words(values.map(f32::to_bits));
}

fn read_report(reader: &mut Reader<'_>, ramp: bool) -> Option<CycleReport> {
    let (block, cycle, nrmse) = (reader.u32()?, reader.u32()?, reader.f32()?);
    let mut cycle_of = || {
        Some(Cycle {
            force_max: reader.f32()?,
            force_min: reader.f32()?,
            displacement_max: reader.f32()?,
            displacement_min: reader.f32()?,
            amplitude: reader.f32()?,
            energy: reader.f32()?,
            energy_harmonic: reader.f32()?,
            stiffness: reader.f32()?,
            elastic_energy: reader.f32()?,
            loss_factor: reader.f32()?,
            mean_force: reader.f32()?,
            mean_displacement: reader.f32()?,
            ticks: reader.f32()?,
        })
    };
    Some(CycleReport {
        block: block as usize,
        cycle,
        ramp,
        measured: cycle_of()?,
        model: cycle_of()?,
        nrmse,
    })
}

/// The faults by the number that they have on the link.
const FAULTS: [Fault; 11] = [
    Fault::AdcBus,
    Fault::DacBus,
    Fault::EnableLine,
    Fault::DisplacementClipped,
    Fault::ForceClipped,
    Fault::CommandClipped,
    Fault::DisplacementLimit,
    Fault::ForceLimit,
    Fault::TrackingLimit,
    Fault::NoResponse,
    Fault::NotFinite,
];
/// Number of the first one.
const FIRST_FAULT: u8 = 16;

fn state_code(state: State) -> u8 {
    match state {
        State::Idle => 0,
        State::Running => 1,
        State::Done => 2,
        State::Faulted(fault) => {
            let code = (FIRST_FAULT..)
                .zip(FAULTS)
                .find(|(_, other)| *other == fault);
            code.map_or(u8::MAX, |(code, _)| code)
        }
    }
}

fn state_of(code: u8) -> Option<State> {
    match code {
        0 => Some(State::Idle),
        1 => Some(State::Running),
        2 => Some(State::Done),
        _ => {
            let index = usize::from(code.checked_sub(FIRST_FAULT)?);
            FAULTS.get(index).copied().map(State::Faulted)
        }
    }
}
