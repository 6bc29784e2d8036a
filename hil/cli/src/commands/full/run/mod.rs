//! `hil run`: a test on the rig controller with a simulated actuator and specimen.

mod checks;
mod test;
mod trip;
mod watched;

use std::path::PathBuf;

use clap::Args;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::law::Law;
use mesh_damper::operating_range::OperatingRange;
use mesh_damper::sine::Programme;
use mesh_damper_model::extrapolation::RANGE_MARGIN;
use mesh_damper_model::file::{FittedRange, ModelFile, model_error};
use mesh_damper_model::{Control, MAX_EFFECTS, ModelError};
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_rig::specimen::{CURRENT, DamperForce as _, Specimen};
use mesh_damper_rig::{Journal, RigSetup, TICK_RATE};
use mesh_damper_tables::write::WriteAs;

use self::test::Test;
use super::drive::{DriveOptions, Driven};
use super::image::{LogLevel, Place};
use super::junit::judged;
use super::law::PublishedLaw;
use super::live::LiveOptions;
use super::meant_for;
use super::pace::Speed;
use super::programme::{MOST_BLOCKS, ProgrammeOptions};
use super::specimen::{SPECIMEN_AMPLITUDE, SpecimenOptions};
use crate::commands::reading::RecordingFiles;
use crate::commands::{Failure, warn};

pub(in crate::commands) use self::test::Summary;
pub(super) use self::trip::{Stop, in_words};
pub(super) use self::watched::{Watched, ended, refused, with_journal};

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
    #[command(flatten)]
    programme: ProgrammeOptions,
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

impl RunCommand {
    pub fn run(self) -> Result<(), Failure> {
        let table = (!self.drive.is_given()).then_some("cycles.csv");
        let name = format!("recording.{}", self.recording_as);
        let mut outputs = Plan::new()
            .reads(self.programme.file())
            .reads(self.drive.file())
            .reads(&self.model)
            .fills(self.out.as_path(), std::iter::once(&*name).chain(table))
            .writes(&self.json)
            .writes(&self.junit)
            .keeps(Journal::path_in(&self.out))
            .begin()?;
        self.live.check()?;
        let driven = self.drive.motion(&self.files, self.tick_rate)?;
        let programme = match driven {
            Some(_) => None,
            None => Some((self.programme).read(self.files.reading.limit, self.tick_rate)?),
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
