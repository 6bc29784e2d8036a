//! Telemetry of a rig on its own timer, from its tick to the sender, without waiting.
//!
//! A [`Channel`] has two ends. The tick's interrupt owns the [`Recorder`]. It puts a row into a queue every `every` ticks, from the
//! first tick at which the rig runs. It also puts a note into a queue where a cycle ends, the health monitor reports an event, or
//! the state of the rig changes. The main loop owns the [`Sender`], which makes frames of rows and notes. If a queue is full,
//! because the other end of the line does not read, a row is left out together with its number, so that the reader sees how many
//! are missing. Neither end ever waits for the other.
//!
//! ```
//! use mesh_damper::frame::{FrameBuffer, Frames};
//! use mesh_damper::message::{Telemetered, TelemetryConfig};
//! use mesh_damper::rig::{State, Telemetry};
//! use mesh_damper::telemetry::Channel;
//!
//! let mut channel = Channel::<16>::new();
//! let (mut recorder, mut sender) = channel.split();
//! // Every second tick; a row waits for three more ticks at most.
//! recorder.set(TelemetryConfig { every: 2, within: 3, ..TelemetryConfig::default() });
//! for tick in 0..5 {
//!     # let telemetry = Telemetry { tick, displacement: 0.1 * tick as f32, velocity: 0.0, measured_force: 1.0,
//!     #     controls: [0.0; 4], model_force: 1.0, command: 0.0, block: 0, cycle: 0, phase: 0, ramp: false,
//!     #     state: State::Running, report: None, event: None };
//!     // In the interrupt, after the rig's tick.
//!     recorder.tick(&telemetry, 20.0);
//! }
//! // In the main loop.
//! let mut frame = FrameBuffer::new();
//! assert!(sender.next(&mut frame));
//! let frame = Frames(frame.bytes()).next().unwrap();
//! let Some(Telemetered::Rows(rows)) = Telemetered::read(&frame) else { panic!() };
//! let displacements: Vec<f32> = rows.map(|row| row.displacement).collect();
//! assert_eq!(displacements, [0.0, 0.2, 0.4]);
//! ```

use core::sync::atomic::{AtomicBool, AtomicU8, Ordering::Relaxed};

use heapless::spsc::{Consumer, Producer, Queue};

use crate::frame::FrameBuffer;
use crate::message::{Note, ROWS, Row, TelemetryConfig, write_note, write_rows};
use crate::rig::{State, Telemetry};

/// Capacity for notes. A cycle makes one, and the shortest cycles have about ten ticks, so a main loop that is held up for some
/// cycles loses none.
const NOTES: usize = 8;

/// The queues between both ends. One of the `N` places stays empty. At 1 kHz, 256 rows are a quarter of a second.
pub struct Channel<const N: usize> {
    rows: Queue<Row, N>,
    notes: Queue<Note, NOTES>,
    shared: Shared,
}

/// State that both ends share, in addition to the queues.
#[derive(Debug)]
struct Shared {
    /// Rows have waited for the longest permitted time.
    due: AtomicBool,
    /// Control inputs to send with each row.
    controls: AtomicU8,
}

impl<const N: usize> Default for Channel<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Channel<N> {
    /// An empty channel.
    pub const fn new() -> Self {
        Self {
            rows: Queue::new(),
            notes: Queue::new(),
            shared: Shared {
                due: AtomicBool::new(false),
                controls: AtomicU8::new(0),
            },
        }
    }

    /// Returns both ends. No telemetry is requested yet.
    pub fn split(&mut self) -> (Recorder<'_>, Sender<'_>) {
        let (put_row, rows) = self.rows.split();
        let (put_note, notes) = self.notes.split();
        let recorder = Recorder {
            rows: put_row,
            notes: put_note,
            shared: &self.shared,
            config: TelemetryConfig::default(),
            next_row: 0,
            next_note: 0,
            ticks: 0,
            until_row: 0,
            waited: 0,
            phase: Phase::Before,
            state: None,
            pending_end: None,
        };
        let sender = Sender {
            rows,
            notes,
            shared: &self.shared,
            sequence: 0,
        };
        (recorder, sender)
    }
}

/// The tick's end.
pub struct Recorder<'c> {
    rows: Producer<'c, Row>,
    notes: Producer<'c, Note>,
    shared: &'c Shared,
    config: TelemetryConfig,
    next_row: u32,
    next_note: u32,
    /// Ticks since the rig first ran.
    ticks: u32,
    until_row: u32,
    /// Ticks since the oldest row was queued, or since the last request if there is none.
    waited: u32,
    phase: Phase,
    /// State of the rig at the last tick; `None` before the first tick after telemetry was requested.
    state: Option<State>,
    /// The tick at which the test ended, until a note of it is queued.
    pending_end: Option<u32>,
}

/// Progress of the test whose telemetry is requested.
#[derive(Clone, Copy, PartialEq)]
enum Phase {
    Before,
    UnderWay,
    Over,
}

impl Recorder<'_> {
    /// Sets the telemetry from the next tick on. Rows and notes are counted from 0.
    pub fn set(&mut self, config: TelemetryConfig) {
        self.config = config;
        self.shared.controls.store(config.controls, Relaxed);
        (self.next_row, self.next_note) = (0, 0);
        (self.ticks, self.until_row, self.waited) = (0, 0, 0);
        (self.phase, self.state, self.pending_end) = (Phase::Before, None, None);
    }

    /// Takes a tick of the rig, and the temperature of the specimen, °C.
    #[inline]
    pub fn tick(&mut self, telemetry: &Telemetry, temperature: f32) {
        if self.config.every == 0 {
            return;
        }
        let before = self.state.replace(telemetry.state);
        let changed = before.is_some_and(|before| before != telemetry.state);
        match telemetry.state {
            State::Running => self.phase = Phase::UnderWay,
            _ if self.phase != Phase::Before => {}
            // A test that stops in its first tick, or cannot begin.
            State::Faulted(_) if changed => self.phase = Phase::UnderWay,
            _ => return,
        }
        // After a fault the return to rest is still part of the test.
        let over = match telemetry.state {
            State::Running => false,
            State::Faulted(_) => telemetry.command == 0.0,
            State::Idle | State::Done => true,
        };
        if over && self.phase == Phase::UnderWay {
            self.phase = Phase::Over;
            self.pending_end = Some(self.ticks);
            self.waited = self.config.within;
        }
        let has_note = telemetry.report.is_some() || telemetry.event.is_some();
        if has_note || self.pending_end.is_some() || (changed && telemetry.state != State::Running)
        {
            self.note(telemetry);
        }
        if self.until_row == 0 {
            self.until_row = self.config.every;
            self.row(telemetry, temperature);
        }
        self.until_row -= 1;
        self.ticks = self.ticks.wrapping_add(1);
        self.waited = self.waited.saturating_add(1);
        if self.waited > self.config.within {
            self.waited = 0;
            self.shared.due.store(true, Relaxed);
        }
    }

    fn row(&mut self, telemetry: &Telemetry, temperature: f32) {
        let row = Row {
            number: self.next_row,
            displacement: telemetry.displacement,
            force: telemetry.measured_force,
            law_force: telemetry.model_force,
            command: telemetry.command,
            controls: telemetry.controls,
            temperature,
            state: telemetry.state,
            session: self.config.session,
        };
        self.next_row = self.next_row.wrapping_add(1);
        // A row without room leaves a gap in the numbers.
        let _ = self.rows.enqueue(row);
    }

    #[inline(never)]
    fn note(&mut self, telemetry: &Telemetry) {
        let note = Note {
            number: self.next_note,
            tick: self.pending_end.unwrap_or(self.ticks),
            state: telemetry.state,
            ends: self.pending_end.is_some(),
            report: telemetry.report,
            event: telemetry.event,
            session: self.config.session,
        };
        let queued = self.notes.enqueue(note).is_ok();
        // A note without room leaves a gap in the numbers; the note of the end is repeated until there is room.
        if queued || self.pending_end.is_none() {
            self.next_note = self.next_note.wrapping_add(1);
        }
        if queued {
            self.pending_end = None;
        }
    }
}

/// The main loop's end.
pub struct Sender<'c> {
    rows: Consumer<'c, Row>,
    notes: Consumer<'c, Note>,
    shared: &'c Shared,
    /// Sequence number of the next frame.
    sequence: u32,
}

impl Sender<'_> {
    /// Writes the next frame, once there is enough data for one or the data has waited long enough. Returns whether it wrote one.
    pub fn next(&mut self, frame: &mut FrameBuffer) -> bool {
        let sequence = self.sequence;
        let written = if let Some(note) = self.notes.dequeue() {
            write_note(sequence, &note, frame);
            true
        } else if self.rows.len() >= ROWS || self.shared.due.load(Relaxed) {
            self.write_rows(frame)
        } else {
            false
        };
        if written {
            self.sequence = sequence.wrapping_add(1);
        }
        written
    }

    fn write_rows(&mut self, frame: &mut FrameBuffer) -> bool {
        let controls = self.shared.controls.load(Relaxed);
        let written = write_rows(self.sequence, controls, &mut self.rows, frame);
        if self.rows.is_empty() {
            self.shared.due.store(false, Relaxed);
        }
        written
    }
}
