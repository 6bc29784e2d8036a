//! What a board on its own timer sends by itself: rows of measurements, and what each cycle and the monitor said.

use heapless::spsc::Consumer;

use super::kind;
use super::outcome::{read_event, read_report, state_code, state_of, write_event, write_report};
use crate::effects::CONTROLS;
use crate::frame::{Fields, Frame, FrameBuffer, Header, PAYLOAD, Reader, Writer};
use crate::health::Event;
use crate::rig::{CycleReport, State};

/// Bytes before the rows of a frame.
const HEAD: usize = 12;
/// Bytes of a row without control inputs.
const ROW: usize = 16;
/// Most rows of a frame without control inputs.
pub const ROWS: usize = (PAYLOAD - HEAD) / ROW;

/// Which telemetry a board is to send. The default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TelemetryConfig {
    /// Every how many ticks there is a row; 0 for none.
    pub every: u32,
    /// How many ticks a row may wait for others to go with.
    pub within: u32,
    /// How many control inputs go with a row, the first ones, 0 to [`CONTROLS`].
    pub controls: u8,
    /// Comes back in each frame: those of another one were asked for before.
    pub session: u8,
}

impl Fields for TelemetryConfig {
    fn write(&self, writer: &mut Writer<'_>) {
        writer.words([self.every, self.within]);
        writer.u8(self.controls);
        writer.u8(self.session);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let [every, within] = reader.words()?;
        Some(Self {
            every,
            within,
            controls: reader.u8()?,
            session: reader.u8()?,
        })
        .filter(|config| usize::from(config.controls) <= CONTROLS)
    }
}

/// A tick of which telemetry is sent.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Row {
    /// From 0 at the first tick at which the rig runs, also of those that were lost; wraps.
    pub number: u32,
    /// Measured, mm.
    pub displacement: f32,
    /// Measured, kN.
    pub force: f32,
    /// Of the law, kN.
    pub law_force: f32,
    /// What the actuator drives, mm.
    pub command: f32,
    /// Control inputs, in the units of the law's effects.
    pub controls: [f32; CONTROLS],
    /// Of the specimen, °C.
    pub temperature: f32,
    /// What the rig is doing.
    pub state: State,
    /// Of [`TelemetryConfig::session`].
    pub session: u8,
}

/// What a cycle's end, the monitor or a change of the rig's state says.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Note {
    /// From 0, also of those that were lost; wraps.
    pub number: u32,
    /// Ticks since the first one of the rows; wraps.
    pub tick: u32,
    /// What the rig is doing.
    pub state: State,
    /// The test is over with this tick: rows of later ones are of a rig at rest.
    pub ends: bool,
    /// The cycle that ended.
    pub report: Option<CycleReport>,
    /// What was found wrong.
    pub event: Option<Event>,
    /// Of [`TelemetryConfig::session`].
    pub session: u8,
}

/// Whether `row` may go into one frame with rows of which `last` is the last one: a frame says once what they share.
fn goes_with(last: &Row, row: &Row) -> bool {
    row.number == last.number.wrapping_add(1)
        && row.state == last.state
        && row.session == last.session
        && row.temperature.to_bits() == last.temperature.to_bits()
}

/// Takes those of `rows` that fit into one frame and writes it, each with the first `controls` of its inputs. Says no where there is
/// none.
pub fn write_rows(
    sequence: u32,
    controls: u8,
    rows: &mut Consumer<'_, Row>,
    buffer: &mut FrameBuffer,
) -> bool {
    let Some(first) = rows.peek().copied() else {
        return false;
    };
    let used = usize::from(controls).min(CONTROLS);
    let fits = (PAYLOAD - HEAD) / (ROW + 4 * used);
    let header = Header {
        kind: kind::ROWS,
        sequence,
        count: 1,
    };
    buffer.write(header, |writer| {
        writer.words([
            first.number,
            first.temperature.to_bits(),
            u32::from_le_bytes([state_code(first.state), first.session, used as u8, 0]),
        ]);
        let mut last = first;
        for written in 0..fits {
            let Some(row) = rows.peek().copied() else {
                break;
            };
            if written > 0 && !goes_with(&last, &row) {
                break;
            }
            let numbers = [row.displacement, row.force, row.law_force, row.command];
            writer.words(numbers.map(f32::to_bits));
            for control in row.controls.iter().take(used) {
                writer.f32(*control);
            }
            rows.dequeue();
            last = row;
        }
    });
    true
}

/// Writes `note` as a frame.
pub fn write_note(sequence: u32, note: &Note, buffer: &mut FrameBuffer) {
    let header = Header {
        kind: kind::NOTE,
        sequence,
        count: 1,
    };
    let flag = |set: bool, flag: u8| if set { flag } else { 0 };
    let flags = flag(note.report.is_some(), REPORT)
        | flag(note.report.is_some_and(|report| report.ramp), RAMP)
        | flag(note.event.is_some(), EVENT)
        | flag(note.ends, ENDS);
    buffer.write(header, |writer| {
        writer.words([
            note.number,
            note.tick,
            u32::from_le_bytes([flags, note.session, state_code(note.state), 0]),
        ]);
        if let Some(report) = &note.report {
            write_report(writer, report);
        }
        if let Some(event) = &note.event {
            write_event(writer, event);
        }
    });
}

const REPORT: u8 = 1;
const RAMP: u8 = 2;
const EVENT: u8 = 4;
const ENDS: u8 = 8;

/// What a board sends by itself. Its frames are counted by a number of their own: one that is missing was lost on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Telemetered<'a> {
    /// Rows, one after the other.
    Rows(Rows<'a>),
    /// A cycle's end, or an event.
    Note(Note),
}

impl<'a> Telemetered<'a> {
    /// What is in `frame`; `None` where that is no telemetry.
    pub fn read(frame: &Frame<'a>) -> Option<Self> {
        let mut reader = Reader(frame.payload);
        match frame.header.kind {
            kind::ROWS => {
                let [number, temperature] = reader.words()?;
                let [state, session, used, _] = reader.u32()?.to_le_bytes();
                if usize::from(used) > CONTROLS {
                    return None;
                }
                Some(Self::Rows(Rows {
                    next: Row {
                        number,
                        displacement: 0.0,
                        force: 0.0,
                        law_force: 0.0,
                        command: 0.0,
                        controls: [0.0; CONTROLS],
                        temperature: f32::from_bits(temperature),
                        state: state_of(state)?,
                        session,
                    },
                    used: usize::from(used),
                    rest: reader.rest(),
                }))
            }
            kind::NOTE => {
                let [number, tick] = reader.words()?;
                let [flags, session, state, _] = reader.u32()?.to_le_bytes();
                let report = match flags & REPORT {
                    0 => None,
                    _ => Some(read_report(&mut reader, flags & RAMP != 0)?),
                };
                let event = match flags & EVENT {
                    0 => None,
                    _ => Some(read_event(&mut reader)?),
                };
                Some(Self::Note(Note {
                    number,
                    tick,
                    state: state_of(state)?,
                    ends: flags & ENDS != 0,
                    report,
                    event,
                    session,
                }))
            }
            _ => None,
        }
    }
}

/// Rows as they lie in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows<'a> {
    /// The one that comes next, but for what each has of its own.
    next: Row,
    used: usize,
    rest: &'a [u8],
}

impl Iterator for Rows<'_> {
    type Item = Row;

    fn next(&mut self) -> Option<Row> {
        let mut reader = Reader(self.rest);
        let [displacement, force, law_force, command] = reader.words()?.map(f32::from_bits);
        let mut row = Row {
            displacement,
            force,
            law_force,
            command,
            ..self.next
        };
        for control in row.controls.iter_mut().take(self.used) {
            *control = reader.f32()?;
        }
        self.rest = reader.rest();
        self.next.number = self.next.number.wrapping_add(1);
        Some(row)
    }
}
