//! `hil record`: a test on a board's own timer, recorded.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper::effects::{AugmentedLaw, CONTROLS};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::message::{About, MAX_BLOCKS, TelemetryConfig};
use mesh_damper::pack::{LARGEST, PackInfo, encode};
use mesh_damper::rig::{RigSettings, State};
use mesh_damper::sine::Programme;
use mesh_damper_link::lockstep::{Image, LinkError, Serial, described};
use mesh_damper_link::own_timer::{BoardRun, Lost, RecordError, Times, record};
use mesh_damper_live::About as LiveAbout;
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_recording::Recording;
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Journal, RigSetup, SetupError, TICK_RATE};
use mesh_damper_tables::write::WriteAs;
use schemars::JsonSchema;
use serde::Serialize;

use super::board::Port;
use super::cycles::{CycleRow, print_blocks};
use super::events::EventRow;
use super::law::PublishedLaw;
use super::live::{LiveOptions, LiveRow, MqttRow};
use super::pace::{Pace, Speed};
use super::pack::read_pack;
use super::programme::{LONGEST, MOST_BLOCKS, ProgrammeOptions};
use super::run::{Stop, Watched, ended, in_words, refused, with_journal};
use super::specimen::SPECIMEN_AMPLITUDE;
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::reading::Reading;
use crate::commands::{Failure, say, warn};

/// Record a test that a board runs on its own timer
///
/// Restarts the board, sets it up, starts its rig, and writes a recording that `hil trace` reads. During the test, REC.partial.csv holds
/// the data received so far; an interrupted recording leaves that file. With --join, the command sets nothing up and records the test
/// that is already running.
///
/// Exit code 1: the rig tripped. The recording up to the trip is written.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  \
    hil record --from serial:/dev/ttyACM0 --force-range 5 --out recording.csv.gz\n  \
    hil record --from serial:/dev/ttyACM0 --force-range 5 --pack mount.mdcp \\\n      \
    --blocks 0.12:4:400 --duration 4 --keep-running --out before.csv.gz\n  \
    hil record --from serial:/dev/ttyACM0 --join --duration 4 --out after.csv.gz")]
pub struct RecordCommand {
    /// The board's serial port, such as serial:/dev/ttyACM0; its firmware runs on its own timer
    #[arg(long, value_name = "serial:PORT")]
    from: Port,
    #[command(flatten)]
    programme: ProgrammeOptions,
    /// Law that the board runs, a file of `hil export --format pack`; the default is the paper's law
    #[arg(long, value_name = "FILE")]
    pack: Option<PathBuf>,
    /// Density of the specimen in g/cm³, 2 to 4; it selects the paper's law
    #[arg(long, value_name = "G_PER_CM3", default_value_t = 3.0)]
    density: f64,
    /// Full scale of the force channel, kN; required unless --join is given
    #[arg(long, value_name = "KN", required_unless_present = "join")]
    force_range: Option<f64>,
    /// Full scale of the displacement channel, mm
    #[arg(long, value_name = "MM", default_value_t = 1.0)]
    displacement_range: f64,
    /// Displacement at full scale of the command output, mm
    #[arg(long, value_name = "MM", default_value_t = 1.0)]
    command_range: f64,
    /// Force at which the rig trips, kN; the default is 0.95 of --force-range
    #[arg(long, value_name = "KN")]
    force_limit: Option<f64>,
    /// Displacement at which the rig trips, mm
    #[arg(long, value_name = "MM", default_value_t = RigSettings::default().displacement_limit)]
    displacement_limit: f64,
    /// Tracking error (measured minus demanded displacement) at which the rig trips, mm
    #[arg(long, value_name = "MM", default_value_t = RigSettings::default().tracking_limit)]
    tracking_limit: f64,
    /// Known delay of the actuator, s; the rig finds the rest of the delay itself
    #[arg(long, value_name = "S", default_value_t = LEAD)]
    lead: f64,
    /// Tick rate of the rig, Hz
    #[arg(long, value_name = "HZ", default_value_t = TICK_RATE)]
    tick_rate: f64,
    /// Record one row every this many ticks, 1 to 1000000; 115200 baud carry every 20th tick at 10 kHz
    #[arg(long, value_name = "TICKS", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    record_every: u32,
    /// Control input that the board measures, such as current_A; give it once for each, in the order of the law
    #[arg(long, value_name = "NAME_UNIT")]
    control: Vec<String>,
    /// The rig trips if it hears nothing from this command for this long, in s, 0.5 to 100; 0 turns this off
    #[arg(long, value_name = "S", default_value_t = 2.0, conflicts_with_all = ["keep_running", "join"])]
    silence: f64,
    /// Stop the recording after this time of the test, in s, 0.001 to 3600
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// Leave the rig running if the recording ends before the test
    #[arg(long)]
    keep_running: bool,
    /// Record the test that is already running; set nothing up, and leave the rig running
    #[arg(long, conflicts_with_all = ["blocks", "programme", "pack", "density", "force_range", "displacement_range", "command_range", "force_limit", "displacement_limit", "tracking_limit", "lead", "tick_rate", "keep_running"])]
    join: bool,
    /// File for the recording: .csv, .csv.gz, .parquet, .mat or .mcap
    #[arg(long, value_name = "REC")]
    out: PathBuf,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    live: LiveOptions,
    #[command(flatten, next_help_heading = "Files")]
    reading: Reading,
}

/// A test that a board ran on its own timer.
#[derive(JsonSchema, Serialize)]
pub(in crate::commands) struct Summary {
    /// The board, as `serial:PORT`.
    from: Port,
    /// Tick rate of the rig, Hz.
    tick_rate: f64,
    /// Number of ticks from the first row to the last.
    ticks: u64,
    /// Number of rows recorded.
    rows: usize,
    /// Data that the board sent but that did not arrive.
    lost: LostRow,
    /// Number of ticks that were late.
    late_ticks: u32,
    /// Per-cycle results.
    cycles: Vec<CycleRow>,
    /// Events of the monitor.
    events: Vec<EventRow>,
    /// The trip of the rig; null if it did not trip.
    stopped: Option<Stop>,
    /// The live page; null without --live.
    live: Option<LiveRow>,
    /// The MQTT broker; null without --mqtt.
    mqtt: Option<MqttRow>,
}

/// Data that did not arrive.
#[derive(JsonSchema, Serialize)]
struct LostRow {
    /// Number of lost rows.
    rows: u64,
    /// Number of lost notes: results of cycles, events and similar.
    notes: u64,
    /// Number of frames that arrived damaged.
    frames: u64,
}

/// Lead of the simulated actuator, s, the same as for the rig of `hil run`.
const LEAD: f64 = 9e-3;
/// Longest time for which rows wait before they are sent, s.
const WITHIN: f64 = 0.05;

impl RecordCommand {
    pub fn run(self) -> Result<(), Failure> {
        let partial = self.partial();
        let mut outputs = Plan::new()
            .reads(self.programme.file())
            .reads(&self.pack)
            .writes([self.out.as_path()])
            .writes(&self.json)
            .keeps(&partial)
            .begin()?;
        WriteAs::of(&self.out)?;
        self.live.check()?;
        self.check()?;
        let pack = match &self.pack {
            Some(path) => Some(read_pack(path)?),
            None => None,
        };
        let programme = (self.programme).read(self.reading.limit, self.tick_rate)?;
        if !self.join && programme.blocks().len() > MAX_BLOCKS {
            return Err(
                InputError::from(LinkError::TooManyBlocks(programme.blocks().len())).into(),
            );
        }
        let (mut board, about) = Image::join(self.from.path())?;
        let tick_rate = if self.join {
            self.joined_rate(&about)?
        } else {
            drop(board);
            board = self.wired(&programme, pack, &about)?;
            self.tick_rate
        };
        let about = board.about().map_err(InputError::from)?;
        let comments = vec![format!(
            "recorded from the board at {}, law = {}, revision = {}",
            self.from, about.identity, about.revision
        )];
        let most = self.duration.unwrap_or(f64::INFINITY);
        let times = Times {
            expected: match self.join {
                true => most,
                false => programme.duration().min(most),
            },
            most,
        };
        let live = self.live.start(
            LiveAbout {
                title: format!("hil record from {}", self.from),
                specimen: "at the board".into(),
                law: format!("{}, revision {}", about.identity, about.revision),
                sample_rate: tick_rate / f64::from(self.record_every),
                duration: Some(times.expected).filter(|expected| expected.is_finite()),
                has_cycles: true,
            },
            tick_rate,
        )?;
        let progress = Progress::of(100);
        progress.step("recording");
        let mut watched = Watched {
            progress,
            journal: Journal::at(partial, comments.clone()).with_controls(self.control.clone()),
            live,
            // The board runs on its own clock.
            pace: Pace::new(Speed::Max),
        };
        let config = TelemetryConfig {
            every: self.record_every,
            within: (WITHIN * tick_rate) as u32,
            controls: self.control.len() as u8,
            session: session(),
        };
        let begin = |board: &mut Image<Serial>| match self.join {
            true => Ok(()),
            false => board.start_rig(),
        };
        let recorded = record(
            &mut board,
            config,
            tick_rate,
            times,
            begin,
            &mut &mut watched,
        );
        let (journal, mut live) = watched.over();
        // Stops the rig at once. A failure is reported after the recording is written.
        let rested = match self.join || self.keep_running || recorded.is_err() {
            true => Ok(()),
            false => board.stop_rig().map_err(InputError::from),
        };
        let recorded = recorded.map_err(|error| {
            let error = match error {
                RecordError::Link(error) => error.into(),
                RecordError::Watch(error) => error,
            };
            with_journal(error, &journal)
        });
        live.end(&ended(recorded.as_ref().map(|recorded| &recorded.run)));
        let BoardRun {
            run,
            lost,
            late_ticks,
        } = recorded?;
        let stopped = run.faults.first().map(|fault| Stop::new(*fault));
        let summary = Summary {
            from: self.from.clone(),
            tick_rate,
            ticks: run.ticks,
            rows: run.samples.len(),
            lost: LostRow {
                rows: lost.rows,
                notes: lost.notes,
                frames: lost.frames,
            },
            late_ticks,
            cycles: run.cycles.iter().map(CycleRow::from).collect(),
            events: run.events.iter().map(EventRow::new).collect(),
            stopped,
            live: live.page_row(),
            mqtt: live.mqtt_row(),
        };
        let written = self.recording(&run).map(|recording| {
            comments
                .into_iter()
                .fold(recording, Recording::with_comment)
        })?;
        let bytes = written.to_file(&self.out);
        outputs.add(
            &self.out,
            bytes.map_err(|error| with_journal(error, &journal))?,
        );
        outputs.add_document_if(&self.json, &summary)?;
        outputs
            .write()
            .map_err(|error| with_journal(error, &journal))?;
        journal.remove();
        if lost != Lost::default() {
            warn(&lost_in_words(lost));
        }
        if self.json.as_deref() != Some(Path::new("-")) {
            summary.print((!self.join).then_some(&programme));
            say(&format!("The recording is {}", self.out.display()));
        }
        live.close();
        rested?;
        summary.stopped.map_or(Ok(()), |stop| Err(stop.failure()))
    }

    /// Path of the partial recording during the test.
    fn partial(&self) -> PathBuf {
        let mut name = self.out.as_os_str().to_owned();
        name.push(".partial.csv");
        name.into()
    }

    fn check(&self) -> Result<(), InputError> {
        // The harness sends a message to the board five times a second.
        let silence = Some(self.silence).filter(|silence| *silence != 0.0);
        for (field, unit, value, low, high) in [
            ("--silence", "s", silence, 0.5, 100.0),
            ("--duration", "s", self.duration, 1e-3, LONGEST),
            ("--density", "g/cm³", Some(self.density), 2.0, 4.0),
        ] {
            if let Some(value) = value
                && !(low..=high).contains(&value)
            {
                return Err(InputError::new(
                    field,
                    format!("{value} {unit} is outside its range"),
                    format!("give {low} to {high}"),
                ));
            }
        }
        if self.control.len() > CONTROLS {
            return Err(InputError::new(
                "--control",
                format!("{} control inputs are too many", self.control.len()),
                format!("give at most {CONTROLS}"),
            ));
        }
        self.check_controls()
    }

    /// Checks that a recording with these columns is read as intended.
    fn check_controls(&self) -> Result<(), InputError> {
        let refused = |problem: String| {
            let remedy = "name another quantity with its unit, each once, such as current_A";
            InputError::new("--control", problem, remedy)
        };
        if self.control.is_empty() {
            return Ok(());
        }
        let mut text = format!(
            "time_s,displacement_mm,force_kN,{}\n",
            self.control.join(",")
        );
        for row in 0..8 {
            let cells = vec![format!("0.{row}"); 3 + self.control.len()];
            text += &format!("{}\n", cells.join(","));
        }
        let read = Recording::from_bytes(Path::new("--control"), text.into_bytes())
            .map_err(|error| refused(error.problem))?;
        let named = read.controls.iter().map(|control| &control.name);
        if !named.eq(&self.control) {
            return Err(refused(format!(
                "{} does not read as a control input",
                self.control.join(", ")
            )));
        }
        Ok(())
    }

    /// Tick rate of the running rig, Hz.
    fn joined_rate(&self, about: &About) -> Result<f64, InputError> {
        if about.tick_rate > 0.0 && about.state == State::Running {
            return Ok(about.tick_rate.into());
        }
        let problem = match about.state {
            State::Faulted(fault) => format!("the board's rig has tripped: {}", in_words(fault)),
            _ => "no rig is running on the board".into(),
        };
        Err(InputError::new(
            self.from.to_string(),
            problem,
            "leave out --join, so that hil sets it up and starts it",
        ))
    }

    /// Restarts the board and sets up a rig that runs `programme`.
    fn wired(
        &self,
        programme: &Programme<MOST_BLOCKS>,
        pack: Option<Vec<u8>>,
        about: &About,
    ) -> Result<Image<Serial>, InputError> {
        if about.state == State::Running {
            return Err(InputError::new(
                self.from.to_string(),
                "a rig is running on the board, and recording would restart the board",
                format!(
                    "stop it with `hil stop --at {}`, or record it with --join",
                    self.from
                ),
            ));
        }
        let law =
            AugmentedLaw::<f32, 1>::new(PublishedLaw::Tables.at(self.density, SPECIMEN_AMPLITUDE));
        let pack = match pack {
            Some(pack) => pack,
            None => {
                let mut buffer = [0; LARGEST];
                let info = PackInfo::at(self.tick_rate as f32);
                let pack = encode(&FastLaw::new(law.clone()), &info, &mut buffer);
                pack.map_err(|error| refused(SetupError::Pack(error)))?
                    .to_vec()
            }
        };
        // Only the ranges and the settings matter: the specimen is the board's.
        let specimen = Specimen::of_density(3.0, SPECIMEN_AMPLITUDE);
        let mut setup = RigSetup::new(specimen, law, programme.clone(), 0);
        setup.displacement_sensor.full_scale = self.displacement_range;
        if let Some(range) = self.force_range {
            setup.force_sensor.full_scale = range;
            setup.settings.force_limit = self.force_limit.unwrap_or(0.95 * range);
        }
        setup.command_range = self.command_range;
        setup.settings.displacement_limit = self.displacement_limit;
        setup.settings.tracking_limit = self.tracking_limit;
        setup.settings.lead = self.lead;
        setup.settings.clock_rate = about.clock.into();
        if !self.keep_running {
            setup.settings.link_ticks = (self.silence * self.tick_rate) as u32;
        }
        let described = described(&setup).map_err(|error| refused(error.into()))?;
        let mut board = Image::at(self.from.path())?;
        board.send_pack(&pack)?;
        board.set_up(programme, &described)?;
        Ok(board)
    }

    fn recording(&self, run: &mesh_damper_rig::RigRun) -> Result<Recording, InputError> {
        let plain = mesh_damper_rig::RigRun {
            is_controlled: false,
            ..run.clone()
        };
        let recording = plain.recording(self.out.display().to_string())?;
        let mut named = self.control.iter().enumerate();
        named.try_fold(recording, |recording, (place, name)| {
            let mut column = run.samples.control(place).to_vec();
            column.resize(run.samples.len(), 0.0);
            recording.with_control(name, column)
        })
    }
}

/// Distinguishes this recording's telemetry from that of an earlier one, which may still be in transit.
fn session() -> u8 {
    std::process::id() as u8
}

fn lost_in_words(lost: Lost) -> String {
    let Lost {
        rows,
        notes,
        frames,
    } = lost;
    if frames == 0 {
        format!(
            "{rows} rows and {notes} reports of cycles were lost on the board, whose queue was full: the line is too slow for \
             --record-every, or this machine was busy"
        )
    } else {
        format!(
            "{rows} rows and {notes} reports of cycles were lost, at least some of them on the line: {frames} frames are missing"
        )
    }
}

impl Summary {
    fn print(&self, programme: Option<&Programme<MOST_BLOCKS>>) {
        print_blocks(&self.cycles, programme, self.tick_rate);
        for event in &self.events {
            say(&event.in_words());
        }
        say(&format!(
            "{} ticks, {} of them late; {} rows, {} lost",
            self.ticks, self.late_ticks, self.rows, self.lost.rows
        ));
    }
}
