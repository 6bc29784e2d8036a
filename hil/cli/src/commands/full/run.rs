//! `hil run`: a test on the rig controller with a simulated actuator and specimen.

use std::path::PathBuf;

use clap::Args;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::health::Event;
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::rig::{CycleReport, Telemetry, TripCause};
use mesh_damper::sine::Programme;
use mesh_damper_link::lockstep::run_rig_on;
use mesh_damper_live::{About, State};
use mesh_damper_model::extrapolation::{Extrapolation, RANGE_MARGIN, percent};
use mesh_damper_model::file::{FittedRange, ModelFile, model_error};
use mesh_damper_model::{Control, MAX_EFFECTS, ModelError};
use mesh_damper_recording::error::InputError;
use mesh_damper_recording::output::{Outputs, Plan};
use mesh_damper_recording::{Recording, WriteAs};
use mesh_damper_rig::drive::limits::Demands;
use mesh_damper_rig::specimen::{CURRENT, DamperForce as _, Specimen};
use mesh_damper_rig::{Journal, RigRun, RigSetup, Samples, SetupError, TICK_RATE, Watch, run_rig};
use schemars::JsonSchema;
use serde::Serialize;

use super::cycles::{CycleRow, csv_of, print_blocks};
use super::drive::{DriveOptions, Driven, Followed};
use super::events::EventRow;
use super::image::{Linked, LogLevel, Place};
use super::junit::{Junit, judged};
use super::law::PublishedLaw;
use super::live::{Live, LiveOptions, LiveRow, MqttRow};
use super::meant_for::{self, FirstError};
use super::pace::{Pace, Speed};
use super::programme::{self, MOST_BLOCKS};
use super::specimen::{SPECIMEN_AMPLITUDE, SpecimenOptions};
use crate::commands::document::AddDocument as _;
use crate::commands::progress::Progress;
use crate::commands::reading::RecordingFiles;
use crate::commands::{Failure, is_free_for_text, say, warn};

/// Run a test on the rig controller with a simulated actuator and specimen
///
/// Writes into the folder of --out: recording.csv.gz (or the format of --recording-as), and cycles.csv with the per-cycle results of
/// measurement and law. During the run, recording.partial.csv holds the samples so far; an interrupted run leaves that file. With --drive
/// the rig follows a recorded or random motion. There is no cycles.csv then, because such a motion has no defined cycles.
///
/// Exit code 1: the rig tripped. The recording up to the trip is written.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil run --blocks 0.1:1:6,0.1:5:10\n  \
    hil run --effect stick_slip:stiffness=1.2,slip_limit=0.03 --out slip-out\n  \
    hil run --drive random:rms=0.08mm,from=0.5Hz,to=15Hz,duration=30s,seed=1 \\\n      \
    --out random-out")]
pub struct RunCommand {
    /// Where the controller runs
    ///
    /// `host`: in this process. `image`: in the firmware image, in an emulator. `serial:PORT`: on a board, in lockstep over a serial port;
    /// the specimen is simulated here. The results are the same to the last bit.
    #[arg(long, value_name = "PLACE", default_value_t = Place::Host)]
    on: Place,
    /// Print log messages of the image from this level on
    #[arg(long, value_enum, value_name = "LEVEL", default_value_t = LogLevel::Warn)]
    log: LogLevel,
    /// Blocks of sines as amplitude:frequency:cycles in mm and Hz; 0.1:1-20:50 is a sweep from 1 to 20 Hz
    #[arg(
        long,
        value_name = "BLOCKS",
        default_value = "0.1:1:6,0.1:5:10,0.2:1:6,0.2:5:10"
    )]
    blocks: String,
    /// Read the blocks from this JSON file
    #[arg(long, value_name = "FILE", conflicts_with = "blocks")]
    programme: Option<PathBuf>,
    #[command(flatten)]
    drive: DriveOptions,
    /// Law that the controller runs, a model.json of `hil trace`; the default is the paper's law
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Source of the paper's coefficients
    #[arg(long, value_enum, default_value_t = PublishedLaw::Tables, conflicts_with = "model")]
    law: PublishedLaw,
    #[command(flatten)]
    specimen: SpecimenOptions,
    /// Adaptation: let k1, k3 and c follow slow changes after the run-in, each by up to this part, 0 to 0.5
    #[arg(
        long,
        value_name = "PART",
        default_value_t = 0.0,
        conflicts_with = "drive"
    )]
    follow: f64,
    /// Tick rate of the controller, Hz
    #[arg(long, value_name = "HZ", default_value_t = TICK_RATE)]
    tick_rate: f64,
    /// Record one sample every this many ticks, 1 or more
    #[arg(long, value_name = "TICKS", default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..))]
    record_every: u64,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "run-out")]
    out: PathBuf,
    /// Format of the recording: csv, csv.gz, parquet, mat or mcap
    #[arg(long, value_name = "FORMAT", default_value_t = WriteAs::CsvGz)]
    recording_as: WriteAs,
    /// Write the result as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the checks, passed and failed, as JUnit XML to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    #[command(flatten)]
    live: LiveOptions,
    /// Speed of the test relative to real time, 0.001 to 1000, or `max`; the default is 1 with --live and `max` without
    #[arg(long, value_name = "FACTOR", help_heading = "While it runs")]
    speed: Option<Speed>,
    #[command(flatten, next_help_heading = "Recording of --drive")]
    files: RecordingFiles,
}

/// A test on the rig.
#[derive(JsonSchema, Serialize)]
pub(in crate::commands) struct Summary {
    /// The place where the crate ran.
    pub(super) on: Place,
    /// The specimen under test, in words.
    pub(super) specimen: String,
    /// Seed of the specimen and of the sensors' noise.
    pub(super) seed: u64,
    /// Tick rate of the crate, Hz.
    pub(super) tick_rate: f64,
    /// Number of ticks that the rig ran.
    pub(super) ticks: u64,
    /// Reasons why the model cannot belong to the specimen or the motion, as sentences.
    warnings: Vec<String>,
    /// The fraction of the blocks, or of the motion's knots, outside the operating range, as computed before the run; null without
    /// a model.
    asked_outside_operating_range: Option<Extrapolation>,
    /// Ticks outside the model's operating range; null without a model.
    outside_operating_range: Option<OutsideTicks>,
    /// The error of the model at the beginning; null without a model.
    first_error: Option<FirstError>,
    /// The motion that was followed; null for a programme.
    pub(super) drive: Option<Followed>,
    /// Per-cycle results; empty for a motion.
    pub(super) cycles: Vec<CycleRow>,
    /// Events of the monitor, once for each cause.
    events: Vec<EventRow>,
    /// The trip of the rig; null if it did not trip.
    pub(super) stopped: Option<Stop>,
    /// The live page; null without --live.
    live: Option<LiveRow>,
    /// The MQTT broker; null without --mqtt.
    mqtt: Option<MqttRow>,
}

/// Ticks that exceed the model's operating range by more than [`RANGE_MARGIN`].
#[derive(Clone, Copy, JsonSchema, Serialize)]
pub(super) struct OutsideTicks {
    /// Number of ticks.
    ticks: u64,
    /// Fraction of all ticks, 0…1.
    part: f64,
}

/// The time and the cause of a trip.
#[derive(JsonSchema, Serialize)]
pub(super) struct Stop {
    /// Time since the start, s.
    pub(super) time: f64,
    /// The trip cause, in words.
    pub(super) fault: String,
}

impl Stop {
    /// The stop by `fault` at `time`, s.
    pub(super) fn new((time, fault): (f64, TripCause)) -> Self {
        Self {
            time,
            fault: in_words(fault).to_owned(),
        }
    }

    pub(super) fn failure(&self) -> Failure {
        Failure::Check(format!(
            "the rig tripped {:.3} s after its start: {}",
            self.time, self.fault
        ))
    }
}

/// A test that was checked, and can begin.
struct Test {
    /// The specimen, in words.
    described: String,
    is_controlled: bool,
    programme: Option<Programme<MOST_BLOCKS>>,
    driven: Option<Driven>,
    asked: Option<Demands>,
    setup: RigSetup<Specimen, MOST_BLOCKS, MAX_EFFECTS>,
    /// The part outside the operating range of the model.
    beyond: Option<Extrapolation>,
    warnings: Vec<String>,
}

impl RunCommand {
    pub fn run(self) -> Result<(), Failure> {
        let table = (!self.drive.is_given()).then_some("cycles.csv");
        let name = format!("recording.{}", self.recording_as);
        let mut outputs = Plan::new()
            .reads(&self.programme)
            .reads(self.drive.file())
            .reads(&self.model)
            .fills(self.out.as_path(), std::iter::once(&*name).chain(table))
            .writes(&self.json)
            .writes(&self.junit)
            .keeps(Journal::path_in(&self.out))
            .begin()?;
        self.live.check()?;
        let driven = self.drive.motion(&self.files, self.tick_rate)?;
        let programme = match (&driven, &self.programme) {
            (Some(_), _) => None,
            (None, Some(path)) => Some(programme::read(
                path,
                self.files.reading.limit,
                self.tick_rate,
            )?),
            (None, None) => Some(programme::parse(&self.blocks, self.tick_rate)?),
        };
        let (specimen, density, described) = self.specimen.specimen()?;
        let is_controlled = specimen.control().is_some();
        let (mut setup, fitted_range) =
            self.setup(specimen, density, programme.as_ref(), driven.as_ref())?;
        setup.record_every = self.record_every;
        setup.settings.health.follow = self.follow;
        let asked = match &driven {
            Some(driven) => Some(driven.checked(&setup)?),
            None => None,
        };

        let beyond = fitted_range
            .map(|range| meant_for::outside(&range, programme.as_ref(), driven.as_ref()));
        let samples = match driven {
            Some(_) => "places of the motion",
            None => "blocks",
        };
        let mut warnings = Vec::new();
        if let (Some(path), Some(beyond)) = (&self.model, &beyond) {
            warnings.extend(beyond.in_words(samples, &path.display().to_string()));
        }
        // The warnings come before work that may take long.
        warnings.iter().for_each(|warning| warn(warning));

        let test = Test {
            described,
            is_controlled,
            programme,
            driven,
            asked,
            setup,
            beyond,
            warnings,
        };
        judged(
            "run",
            self.junit.as_deref(),
            &mut outputs,
            |junit, outputs| self.test(test, (name.as_str(), table), junit, outputs),
        )
    }

    /// Runs the test, and writes the recording as `name` and the cycles as `table` into the folder of results.
    fn test(
        &self,
        test: Test,
        (name, table): (&str, Option<&str>),
        junit: Junit,
        outputs: &mut Outputs,
    ) -> Result<(), Failure> {
        let Test {
            described,
            is_controlled,
            programme,
            driven,
            asked,
            setup,
            beyond,
            mut warnings,
        } = test;
        let linked = Linked::at(&self.on, self.log, self.tick_rate)?;
        let live = self.live.start(
            About {
                title: format!("hil run on {}", self.on),
                specimen: described.clone(),
                law: self.law_in_words(),
                sample_rate: self.tick_rate,
                duration: Some(match &setup.drive {
                    Some(motion) => motion.duration(),
                    None => setup.programme.duration(),
                }),
                has_cycles: setup.drive.is_none(),
            },
            self.tick_rate,
        )?;
        let progress = Progress::of(100);
        progress.step("running the rig");
        let mut comments = vec![
            format!("specimen: {described}"),
            format!("run: simulated rig, seed = {}", self.specimen.seed),
        ];
        comments.extend(driven.as_ref().map(Driven::comment));
        let mut watched = Watched {
            progress,
            journal: Journal::new(&self.out, comments.clone()).with_controls(
                is_controlled
                    .then(|| CURRENT.to_owned())
                    .into_iter()
                    .collect(),
            ),
            live,
            pace: Pace::new(self.speed.unwrap_or(match self.live.has_page() {
                true => Speed::Factor(1.0),
                false => Speed::Max,
            })),
        };
        let run = match linked {
            None => run_rig(setup, &mut watched),
            Some(Linked::Image(mut image)) => run_rig_on(&mut *image, setup, &mut watched),
            Some(Linked::Board(mut board)) => run_rig_on(&mut *board, setup, &mut watched),
        };
        let Watched {
            progress,
            journal,
            mut live,
            ..
        } = watched;
        drop(progress);
        let run = run.map_err(|error| broken_off(error, &journal));
        live.end(&ended(run.as_ref()));
        let run = run?;

        let first_error = self.model.as_ref().and_then(|_| FirstError::of(&run));
        if let (Some(path), Some(error)) = (&self.model, first_error)
            && let Some(words) = error.in_words(path)
        {
            warn(&words);
            warnings.push(words);
        }
        let summary = Summary {
            on: self.on.clone(),
            specimen: described.clone(),
            seed: self.specimen.seed,
            tick_rate: self.tick_rate,
            ticks: run.ticks,
            warnings,
            asked_outside_operating_range: beyond,
            first_error,
            outside_operating_range: run.outside.map(|ticks| OutsideTicks {
                ticks,
                part: ticks as f64 / run.ticks as f64,
            }),
            drive: driven
                .as_ref()
                .zip(asked)
                .map(|(driven, asked)| driven.followed(&run, asked)),
            cycles: run.cycles.iter().map(CycleRow::from).collect(),
            events: run.events.iter().map(EventRow::new).collect(),
            stopped: run.faults.first().map(|fault| Stop::new(*fault)),
            live: live.page_row(),
            mqtt: live.mqtt_row(),
        };
        if let (Some(path), Some(outside)) = (&self.model, summary.outside_operating_range)
            && outside.ticks > 0
        {
            warn(&format!(
                "{} of the ticks, {} of {}, lie outside the operating range of {}",
                percent(outside.part),
                outside.ticks,
                run.ticks,
                path.display()
            ));
        }
        let junit = summary.checked(junit, programme.as_ref());
        junit.add(outputs, self.junit.as_deref())?;
        let recording = self.out.join(name);
        let recorded = match (
            run.recording(recording.display().to_string()),
            &summary.stopped,
        ) {
            // A rig that trips at once has recorded nothing. The message then is the trip cause.
            (Err(_), Some(stop)) => {
                journal.remove();
                if self.junit.is_some() {
                    outputs.write()?;
                }
                return Err(stop.failure());
            }
            (recorded, _) => recorded?,
        };
        let recorded = comments.into_iter().fold(recorded, Recording::with_comment);
        let bytes = recorded.to_file(&recording);
        outputs.add(
            &recording,
            bytes.map_err(|error| with_journal(error, &journal))?,
        );
        if let Some(table) = table {
            outputs.add(self.out.join(table), csv_of(&summary.cycles)?);
        }
        if let Some(json) = &self.json {
            outputs.add_document(json, &summary)?;
        }
        outputs
            .write()
            .map_err(|error| with_journal(error, &journal))?;
        if is_free_for_text([&self.json, &self.junit]) {
            if let Some(programme) = &programme {
                print_blocks(&summary.cycles, Some(programme), self.tick_rate);
            }
            if let Some(followed) = &summary.drive {
                followed.print();
            }
            if self.follow > 0.0
                && let Some(last) = summary.cycles.last()
            {
                say(&last.followed_in_words());
            }
            for event in &summary.events {
                say(&event.in_words());
            }
            say(&format!("The recording is {}", recording.display()));
        }
        live.close();
        summary.stopped.map_or(Ok(()), |stop| Err(stop.failure()))
    }

    fn law_in_words(&self) -> String {
        match (&self.model, self.law) {
            (Some(path), _) => path.display().to_string(),
            (None, PublishedLaw::Tables) => "the published tables".into(),
            (None, PublishedLaw::Surfaces) => "the published surfaces".into(),
        }
    }

    /// Sets up the test of `specimen` with a density in g/cm³, for `programme` or the motion `driven`. Also returns the model's
    /// operating range, if there is a model.
    fn setup(
        &self,
        specimen: Specimen,
        density: f64,
        programme: Option<&Programme<MOST_BLOCKS>>,
        driven: Option<&Driven>,
    ) -> Result<
        (
            RigSetup<Specimen, MOST_BLOCKS, MAX_EFFECTS>,
            Option<FittedRange>,
        ),
        InputError,
    > {
        let blocks = programme.into_iter().flat_map(Programme::blocks);
        let amplitudes: Vec<f64> = blocks.map(|block| block.amplitude()).collect();
        let first = match (driven, amplitudes.first()) {
            (Some(driven), _) => driven.amplitude(),
            (None, first) => first.copied().unwrap_or_default(),
        };
        let Laws {
            law,
            block_laws,
            fitted_range,
            operating_range,
        } = self.laws(first, &amplitudes, density, specimen.control().is_some())?;
        let mut setup = match (driven, programme) {
            (Some(driven), _) => {
                RigSetup::driven(specimen, law, driven.motion.clone(), self.specimen.seed)
                    .map_err(|error| refused(error.into()))?
            }
            (None, Some(programme)) => {
                RigSetup::new(specimen, law, programme.clone(), self.specimen.seed)
            }
            (None, None) => return Err(InputError::new("the rig", "no motion", "give --blocks")),
        };
        setup.block_laws = block_laws;
        setup.operating_range = operating_range;
        Ok((setup, fitted_range))
    }

    /// The law for the amplitude `first` in mm, and eq 13 for each of `amplitudes`.
    /// `is_controlled` says whether the specimen is under a current.
    fn laws(
        &self,
        first: f64,
        amplitudes: &[f64],
        density: f64,
        is_controlled: bool,
    ) -> Result<Laws, InputError> {
        let Some(path) = &self.model else {
            return Ok(Laws {
                law: AugmentedLaw::new(self.law.at(density, SPECIMEN_AMPLITUDE)),
                block_laws: Vec::new(),
                fitted_range: None,
                operating_range: None,
            });
        };
        let file = ModelFile::read_within(path, self.files.reading.limit)?;
        let model = file.model();
        let unknown = |control: &&Control| !is_controlled || control.name != CURRENT;
        if let Some(control) = model.controls.iter().find(unknown) {
            return Err(InputError::new(
                path.display().to_string(),
                format!(
                    "its force depends on {}, but this specimen has no such control input",
                    control.name
                ),
                format!(
                    "test a specimen with {CURRENT}, by --effect control_input, or give another model"
                ),
            ));
        }
        let refused = |error| model_error(&path.display().to_string(), &error);
        let range = file.fitted_range().operating_range();
        let range = range
            .and_then(|range| range.widened(RANGE_MARGIN as f32))
            .map_err(|error| {
                refused(ModelError::Refused {
                    place: "fitted_range".into(),
                    error,
                })
            })?;
        let block_laws = amplitudes
            .iter()
            .map(|amplitude| model.law_at::<f32>(*amplitude))
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?;
        let law = model
            .augmented::<f32>(first, 1.0 / self.tick_rate)
            .map_err(refused)?;
        Ok(Laws {
            law,
            block_laws,
            fitted_range: Some(file.fitted_range()),
            operating_range: Some(range),
        })
    }
}

/// The law that runs in parallel to the specimen.
struct Laws {
    law: AugmentedLaw<f32, MAX_EFFECTS>,
    /// Eq 13 for each block.
    block_laws: Vec<Law<f32>>,
    /// The motion that the model was fitted on.
    fitted_range: Option<FittedRange>,
    /// The operating range of the model, with [`RANGE_MARGIN`].
    operating_range: Option<OperatingRange<f32>>,
}

/// Shows the progress of a run, stores its recording, and passes the data to the viewers.
pub(super) struct Watched {
    pub(super) progress: Progress,
    pub(super) journal: Journal,
    pub(super) live: Live,
    /// Pace of a rig without its own clock.
    pub(super) pace: Pace,
}

impl Watch for &mut Watched {
    fn tick(&mut self, telemetry: &Telemetry, time: f64, temperature: f64) {
        self.pace.wait(time);
        self.live.tick(telemetry, time, temperature);
    }

    fn cycle(&mut self, report: &CycleReport, time: f64) {
        self.live.cycle(report, time);
    }

    fn event(&mut self, event: &Event, time: f64) {
        self.live.event(event, time);
    }

    fn see(&mut self, part: f64, samples: &Samples) -> Result<(), InputError> {
        self.progress.done((100.0 * part) as u64);
        self.journal.write(samples)
    }
}

/// The end of a run, for the viewers.
pub(super) fn ended(run: Result<&RigRun, &InputError>) -> State {
    match run {
        Ok(run) => match run.faults.first() {
            Some(&(time, fault)) => State::Stopped {
                time,
                cause: in_words(fault).to_owned(),
            },
            None => State::Finished {
                time: run.samples.time.last().copied().unwrap_or_default(),
            },
        },
        Err(error) => State::BrokenOff {
            cause: error.to_string(),
        },
    }
}

/// The error for a part of the rig that rejects the setup.
pub(super) fn refused(error: SetupError) -> InputError {
    match error {
        SetupError::Link(error) | SetupError::Watch(error) | SetupError::Drive(error) => error,
        error => {
            let remedy = "change the blocks, the tick rate, the model or --follow";
            InputError::new("the rig", error.to_string(), remedy)
        }
    }
}

fn broken_off(error: SetupError, journal: &Journal) -> InputError {
    with_journal(refused(error), journal)
}

/// Adds to `error` the path of the recording up to it.
pub(super) fn with_journal(mut error: InputError, journal: &Journal) -> InputError {
    if journal.has_begun() && journal.path().exists() {
        let path = journal.path().display();
        error.remedy = format!(
            "{}; the samples recorded before are in {path}",
            error.remedy
        );
    }
    error
}

/// The trip cause, in words.
pub(super) fn in_words(fault: TripCause) -> &'static str {
    match fault {
        TripCause::AdcBus => "the ADC did not answer",
        TripCause::DacBus => "the DAC did not answer",
        TripCause::EnableLine => "the enable line could not be set",
        TripCause::DisplacementClipped => "the displacement channel is at an end of its range",
        TripCause::ForceClipped => "the force channel is at an end of its range",
        TripCause::CommandClipped => "the command is beyond the DAC's range",
        TripCause::DisplacementLimit => "the displacement exceeded its limit",
        TripCause::ForceLimit => "the force exceeded its limit",
        TripCause::TrackingLimit => "the displacement was too far from the demanded one",
        TripCause::NoResponse => "the displacement did not follow the demanded one",
        TripCause::NotFinite => "a force or command was not finite",
        TripCause::DisplacementLost => "the displacement sensor is lost",
        TripCause::ForceLost => "the force sensor is lost",
        TripCause::LinkLost => "the link was silent for too long",
        TripCause::TickOverrun => "a tick came late",
        TripCause::DemandLimit => "the streamed motion exceeded the limits of the rig",
        TripCause::External => "an external input requested the stop",
        TripCause::CorrectionLimit => {
            "the amplitude correction asked for more command than allowed"
        }
        _ => "an unknown trip cause",
    }
}
