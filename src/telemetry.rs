//! Telemetry of a rig on its own timer: from its tick to whoever sends it, without a wait.
//!
//! A [`Channel`] has two ends. The tick's interrupt owns the [`Recorder`], which puts a row into a queue every `every` ticks from the first
//! one at which the rig runs, and a note where a cycle ends, the monitor names something or the rig's state changes. The main loop owns the [`Sender`], which makes frames of them. Where a
//! queue is full, because whoever is at the other end of the line does not read, a row is left out and its number with it: who reads
//! the rows sees how many are missing. Neither end ever waits for the other.
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

/// Places for notes. A cycle has one, and the shortest are of some ten ticks: a main loop that is held up for some cycles loses none.
const NOTES: usize = 8;

/// The queues between both ends. One of the `N` places stays empty. At a rate of 1 kHz 256 rows are what is measured in a quarter of a
/// second.
pub struct Channel<const N: usize> {
    rows: Queue<Row, N>,
    notes: Queue<Note, NOTES>,
    shared: Shared,
}

/// What both ends see beside the queues.
#[derive(Debug)]
struct Shared {
    /// Rows have waited for as long as they may.
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
    /// Nothing in it.
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

    /// Both ends. No telemetry is asked for yet.
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
            unsaid: None,
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
    /// Since the rig ran first.
    ticks: u32,
    until_row: u32,
    /// Ticks that the oldest row has waited, or no row.
    waited: u32,
    phase: Phase,
    /// Of the rig, at the last tick; none before the first one since telemetry was asked for.
    state: Option<State>,
    /// The tick at which the test was over, as long as nobody could be told.
    unsaid: Option<u32>,
}

/// How far the test is of which telemetry is asked for.
#[derive(Clone, Copy, PartialEq)]
enum Phase {
    Before,
    UnderWay,
    Over,
}

impl Recorder<'_> {
    /// From the next tick on. Rows and notes are counted from 0.
    pub fn set(&mut self, config: TelemetryConfig) {
        self.config = config;
        self.shared.controls.store(config.controls, Relaxed);
        (self.next_row, self.next_note) = (0, 0);
        (self.ticks, self.until_row, self.waited) = (0, 0, 0);
        (self.phase, self.state, self.unsaid) = (Phase::Before, None, None);
    }

    /// A tick of the rig, and the temperature of the specimen at it, °C.
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
        // A fault's way back to rest belongs to the test.
        let over = match telemetry.state {
            State::Running => false,
            State::Faulted(_) => telemetry.command == 0.0,
            State::Idle | State::Done => true,
        };
        if over && self.phase == Phase::UnderWay {
            self.phase = Phase::Over;
            self.unsaid = Some(self.ticks);
            self.waited = self.config.within;
        }
        let says = telemetry.report.is_some() || telemetry.event.is_some();
        if says || self.unsaid.is_some() || (changed && telemetry.state != State::Running) {
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
        // One for which there is no room is missing from the numbers.
        let _ = self.rows.enqueue(row);
    }

    #[inline(never)]
    fn note(&mut self, telemetry: &Telemetry) {
        let note = Note {
            number: self.next_note,
            tick: self.unsaid.unwrap_or(self.ticks),
            state: telemetry.state,
            ends: self.unsaid.is_some(),
            report: telemetry.report,
            event: telemetry.event,
            session: self.config.session,
        };
        let told = self.notes.enqueue(note).is_ok();
        // One for which there is no room is missing from the numbers; the end is said again until there is room.
        if told || self.unsaid.is_none() {
            self.next_note = self.next_note.wrapping_add(1);
        }
        if told {
            self.unsaid = None;
        }
    }
}

/// The main loop's end.
pub struct Sender<'c> {
    rows: Consumer<'c, Row>,
    notes: Consumer<'c, Note>,
    shared: &'c Shared,
    /// Of the next frame.
    sequence: u32,
}

impl Sender<'_> {
    /// The next frame, once there is enough for one or something has waited for long enough; says no where there is none.
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
