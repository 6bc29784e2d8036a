//! The telemetry of a board on its own timer, recorded.

use std::time::{Duration, Instant};

use mesh_damper::message::{Note, Row, TelemetryConfig};
use mesh_damper::rig::{State, Telemetry};
use mesh_damper_output::error::InputError;
use mesh_damper_rig::{RigRun, Samples, Watch};

use crate::lockstep::{Image, LinkError, Sent, Wire};

/// Interval of requests for the board's state: the board takes a silent harness for lost.
const ASK: Duration = Duration::from_millis(200);
/// Time for which nothing more may arrive after the end of the test: rows still missing then were lost.
const PATIENCE: Duration = Duration::from_millis(500);
/// Time for which the board may report that its rig does not run, before the note of the test's end counts as lost: a stopped rig
/// is at rest after half a second.
const GRACE: Duration = Duration::from_secs(2);

/// Telemetry that did not arrive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lost {
    /// Rows lost on the board or on the line.
    pub rows: u64,
    /// Notes of cycles, events and states.
    pub notes: u64,
    /// Frames sent by the board. If rows are missing and none of these is, the board lost them because its queue was full.
    pub frames: u64,
}

/// A test that a board ran by itself, as it sent it.
#[derive(Clone, Debug)]
pub struct BoardRun {
    /// The data received. The board does not send the samples' velocity, nor block, cycle and ramp.
    pub run: RigRun,
    /// The data lost.
    pub lost: Lost,
    /// Number of ticks that the board found out of time.
    pub late_ticks: u32,
}

/// Why a recording ended before the test did.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The link to the board.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The observer failed.
    #[error(transparent)]
    Watch(#[from] InputError),
}

/// Duration of a recording, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// Expected duration of the test, for observers.
    pub expected: f64,
    /// Time after which recording stops, and the rig is left as it is; infinite for no limit.
    pub most: f64,
}

/// Records the telemetry that the board at the other end of `image` sends of a rig of `tick_rate` Hz, as `config` requests it,
/// until the test is over, or for the time in `times`. `begin` starts the test, once telemetry has been requested. `watch` gets the
/// data so far from time to time, and at the end however the recording ends.
///
/// # Errors
/// The errors of the link, of `begin` and of `watch`.
pub fn record<W: Wire>(
    image: &mut Image<W>,
    config: TelemetryConfig,
    tick_rate: f64,
    times: Times,
    begin: impl FnOnce(&mut Image<W>) -> Result<(), LinkError>,
    watch: &mut impl Watch,
) -> Result<BoardRun, RecordError> {
    let mut taken = Taken {
        config,
        tick_rate,
        run: RigRun {
            samples: Samples::default(),
            cycles: Vec::new(),
            faults: Vec::new(),
            events: Vec::new(),
            is_controlled: config.controls > 0,
            ticks: 0,
            outside: None,
        },
        lost: Lost::default(),
        next: Numbers::default(),
        ends: None,
        ran: 0,
    };
    image.send_telemetry(config)?;
    begin(image)?;
    let ended = follow(image, &mut taken, times, watch);
    watch.see(1.0, &taken.run.samples)?;
    let late_ticks = ended?;
    image.send_telemetry(TelemetryConfig::default())?;
    Ok(BoardRun {
        run: taken.run,
        lost: taken.lost,
        late_ticks,
    })
}

/// Follows the test until it is over; returns how many ticks of the board were late.
fn follow<W: Wire>(
    image: &mut Image<W>,
    taken: &mut Taken,
    times: Times,
    watch: &mut impl Watch,
) -> Result<u32, RecordError> {
    let mut asked = Instant::now();
    let mut came = Instant::now();
    let mut about = image.about()?;
    let mut resting: Option<Instant> = None;
    loop {
        if let Some((number, sent)) = image.telemetry()? {
            taken.take(number, &sent, watch);
            came = Instant::now();
        }
        let rests = resting.is_some_and(|since| since.elapsed() > GRACE);
        if rests && taken.ends.is_none() {
            taken.end_without_note(about.state);
        }
        if taken.is_whole()
            || taken.time() >= times.most
            || (taken.ends.is_some() && (rests || came.elapsed() > PATIENCE))
        {
            taken.cut();
            return Ok(about.late_ticks);
        }
        if asked.elapsed() > ASK {
            about = image.about()?;
            if about.tick_rate == 0.0 {
                return Err(LinkError::Restarted.into());
            }
            if about.state == State::Running {
                resting = None;
            } else {
                resting.get_or_insert_with(Instant::now);
            }
            asked = Instant::now();
            watch.see((taken.time() / times.expected).min(1.0), &taken.run.samples)?;
        }
    }
}

/// The next expected numbers.
#[derive(Default)]
struct Numbers {
    frame: Option<u32>,
    row: u32,
    note: u32,
}

/// The data received so far.
struct Taken {
    config: TelemetryConfig,
    tick_rate: f64,
    run: RigRun,
    lost: Lost,
    next: Numbers,
    /// The tick at which the test was over.
    ends: Option<u32>,
    /// The last tick received with the rig running.
    ran: u32,
}

impl Taken {
    fn take(&mut self, number: u32, sent: &Sent, watch: &mut impl Watch) {
        if let Some(next) = self.next.frame {
            self.lost.frames += u64::from(number.wrapping_sub(next));
        }
        self.next.frame = Some(number.wrapping_add(1));
        let session = self.config.session;
        match sent {
            Sent::Rows(rows) => {
                for row in rows.iter().filter(|row| row.session == session) {
                    self.row(row, watch);
                }
            }
            Sent::Note(note) if note.session == session => self.note(note, watch),
            Sent::Note(_) => {}
        }
    }

    fn row(&mut self, row: &Row, watch: &mut impl Watch) {
        if row.number < self.next.row {
            return;
        }
        self.lost.rows += u64::from(row.number - self.next.row);
        self.next.row = row.number + 1;
        let tick = u64::from(row.number) * u64::from(self.config.every);
        self.run.ticks = tick + 1;
        if row.state == State::Running {
            self.ran = tick as u32;
        }
        let telemetry = Telemetry {
            tick,
            displacement: row.displacement,
            velocity: f32::NAN,
            measured_force: row.force,
            controls: row.controls,
            model_force: row.law_force,
            command: row.command,
            block: 0,
            cycle: 0,
            phase: 0,
            ramp: false,
            state: row.state,
            report: None,
            event: None,
        };
        let time = self.time_of(tick);
        self.run
            .samples
            .push(&telemetry, time, row.temperature.into());
        watch.tick(&telemetry, time, row.temperature.into());
    }

    fn note(&mut self, note: &Note, watch: &mut impl Watch) {
        self.lost.notes += u64::from(note.number.wrapping_sub(self.next.note));
        self.next.note = note.number.wrapping_add(1);
        let time = self.time_of(note.tick.into());
        if let Some(report) = note.report {
            watch.cycle(&report, time);
            self.run.cycles.push(report);
        }
        if let Some(event) = note.event {
            watch.event(&event, time);
            self.run.events.push((time, event));
        }
        self.fault(time, note.state);
        if note.ends {
            self.ends = Some(note.tick);
            self.run.ticks = u64::from(note.tick) + 1;
        }
    }

    fn fault(&mut self, time: f64, state: State) {
        if let State::Faulted(fault) = state
            && self.run.faults.is_empty()
        {
            self.run.faults.push((time, fault));
        }
    }

    /// The test is over according to the board's `state`, but the note with its time was lost: the end is the last row with a
    /// running rig.
    fn end_without_note(&mut self, state: State) {
        self.ends = Some(self.ran);
        self.fault(self.time_of(self.ran.into()), state);
    }

    /// Number of rows of the test, once it is over.
    fn rows(&self) -> Option<u32> {
        self.ends.map(|tick| tick / self.config.every.max(1) + 1)
    }

    /// Whether the data of a finished test is complete.
    fn is_whole(&self) -> bool {
        self.rows().is_some_and(|rows| self.next.row >= rows)
    }

    /// Time in s, computed as the simulated rig does.
    fn time_of(&self, tick: u64) -> f64 {
        tick as f64 * (1.0 / self.tick_rate)
    }

    /// Time of the last row, s.
    fn time(&self) -> f64 {
        self.run.samples.time.last().copied().unwrap_or_default()
    }

    /// Drops rows after the test's end, which are of a rig at rest, and counts rows missing before it as lost.
    fn cut(&mut self) {
        if let (Some(tick), Some(rows)) = (self.ends, self.rows()) {
            let time = self.time_of(tick.into());
            self.run.samples.cut(time);
            self.run.ticks = u64::from(tick) + 1;
            self.lost.rows = u64::from(rows) - self.run.samples.len() as u64;
        }
    }
}
