//! Frames that a board on its own timer sends by itself: rows of measurements, and notes of cycles, events and changes of state.

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

/// Telemetry requested from a board. The default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TelemetryConfig {
    /// Number of ticks from row to row; 0 for no rows.
    pub every: u32,
    /// Number of ticks for which a row may wait for others.
    pub within: u32,
    /// Number of control inputs sent with a row, from the first on, 0 to [`CONTROLS`].
    pub controls: u8,
    /// Number of the request. Each frame repeats it, so that frames of an earlier request can be recognized.
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

/// Telemetry of one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Row {
    /// Number of the row, from 0 at the first tick at which the rig runs, with lost rows counted; wraps.
    pub number: u32,
    /// Measured displacement, mm.
    pub displacement: f32,
    /// Measured force, kN.
    pub force: f32,
    /// Force of the law, kN.
    pub law_force: f32,
    /// Command to the actuator, mm.
    pub command: f32,
    /// Control inputs, in the units of the law's effects.
    pub controls: [f32; CONTROLS],
    /// Temperature of the specimen, °C.
    pub temperature: f32,
    /// State of the rig.
    pub state: State,
    /// Number of the request, [`TelemetryConfig::session`].
    pub session: u8,
}

/// A note at a cycle's end, at an event of the health monitor, or at a change of the rig's state.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Note {
    /// Number of the note, from 0, with lost notes counted; wraps.
    pub number: u32,
    /// Ticks since that of the first row; wraps.
    pub tick: u32,
    /// State of the rig.
    pub state: State,
    /// Whether the test ended with this tick: later rows show a rig at rest.
    pub ends: bool,
    /// The cycle that ended.
    pub report: Option<CycleReport>,
    /// Event of the health monitor.
    pub event: Option<Event>,
    /// Number of the request, [`TelemetryConfig::session`].
    pub session: u8,
}

/// Whether `row` may go into one frame with rows that end with `last`: a frame holds their common fields once.
fn goes_with(last: &Row, row: &Row) -> bool {
    row.number == last.number.wrapping_add(1)
        && row.state == last.state
        && row.session == last.session
        && row.temperature.to_bits() == last.temperature.to_bits()
}

/// Removes from `rows` as many as fit into one frame and writes it, each with the first `controls` of its inputs. Returns whether
/// there were any.
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

/// Telemetry that a board sends by itself. Its frames have their own numbers, so that a missing number means a lost frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Telemetered<'a> {
    /// Successive rows.
    Rows(Rows<'a>),
    /// A cycle's end, or an event.
    Note(Note),
}

impl<'a> Telemetered<'a> {
    /// The telemetry in `frame`; `None` if the frame has none.
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

/// Rows in the layout of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows<'a> {
    /// The next row, without the fields that each row has separately.
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
