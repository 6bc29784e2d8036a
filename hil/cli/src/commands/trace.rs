//! `hil trace`: from recordings to the effect that the law lacks, and to the law with it.

use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_identify::base_law::BaseLaw;
use mesh_damper_identify::known_terms::{KnownTerm, known_terms};
use mesh_damper_identify::trace::{Role, Sought, Trace, trace_for};
use mesh_damper_model::Family;
use mesh_damper_model::file::{FittedRange, ModelFile};
use mesh_damper_recording::Recording;
use mesh_damper_recording::error::{InputError, Place};
use mesh_damper_recording::output::Plan;
use mesh_damper_recording::read_limit::ReadLimit;
use mesh_damper_report::{self as report, ReportData};

use super::progress::Progress;
use super::reading::Reading;
use super::separating;
use super::{Failure, say, summary};

/// Find what the law lacks in recordings, and mend it
///
/// Writes DIR/trace.json, DIR/model.json and DIR/report.html; and where several effects explain the recordings equally well
/// DIR/separating-test.csv, the motion that would tell them apart, which `hil run --drive` follows.
#[derive(Args, Debug)]
#[command(
    after_help = "Example:\n  hil trace rig-test.csv.gz --held-out other-amplitudes.csv.gz --out trace-out\n\n\
    With no --held-out, the last cycles of each block and one whole block are held out."
)]
pub struct TraceCommand {
    /// Recordings of one specimen to fit
    #[arg(value_name = "REC", required = true)]
    recordings: Vec<PathBuf>,
    /// Recordings that are never fitted, only predicted
    #[arg(long, value_name = "REC", num_args = 1..)]
    held_out: Vec<PathBuf>,
    /// Where the results go
    #[arg(long, value_name = "DIR", default_value = "trace-out")]
    out: PathBuf,
    /// Seek only these families of effects, as `stick_slip,yielding`; all where it is not given
    #[arg(long, value_name = "FAMILIES", value_delimiter = ',', value_parser = family)]
    families: Vec<Family>,
    /// Seek none of these families: what the specimen cannot have
    #[arg(long, value_name = "FAMILIES", value_delimiter = ',', value_parser = family)]
    exclude: Vec<Family>,
    /// What the law is without effects: eq 13, a spring and a dashpot, or nothing but the effects
    #[arg(long, value_name = "LAW", default_value = BaseLaw::default().word(), value_parser = base_law)]
    baseline: BaseLaw,
    /// A model whose effects are known: they stay in the law, and more is sought. Their parameters are fitted with the law's, from those of the model
    #[arg(long, value_name = "MODEL")]
    law: Option<PathBuf>,
    /// Where trace.json goes as well; `-` for standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    reading: Reading,
}

impl TraceCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .reads(&self.recordings)
            .reads(&self.held_out)
            .reads(&self.law)
            .fills(
                self.out.as_path(),
                ["trace.json", "model.json", "report.html", separating::FILE],
            )
            .writes(&self.json)
            .begin()?;
        reject_repeats(self.recordings.iter().chain(&self.held_out))?;
        let read = |paths: &[PathBuf]| {
            paths
                .iter()
                .map(|path| Recording::read_channels_within(path, self.reading.limit))
                .collect::<Result<Vec<_>, _>>()
        };
        let known = match &self.law {
            Some(path) => known_effects(path, self.reading.limit)?,
            None => Sought::default(),
        };
        let recordings = read(&self.recordings)?;
        let held_out = read(&self.held_out)?;
        let progress = Progress::steps();
        let sought = Sought {
            families: self.families,
            exclude: self.exclude,
            law: self.baseline,
            ..known
        };
        let found = trace_for(&sought, &recordings, &held_out, &|what| progress.step(what))?;
        let declared = declarations(&recordings);
        // The report needs memory of its own.
        drop((recordings, held_out));
        progress.step("writing the report");
        let names: Vec<String> = self.recordings.iter().map(|path| file_name(path)).collect();
        outputs.add_json(self.out.join("model.json"), &model_file(&found))?;
        let title = format!("Trace of {}", names.join(", "));
        let report = ReportData::of_trace(title, declared, found);
        outputs.add(self.out.join("report.html"), report::render(&report));
        let result = report.result;
        outputs.add_json(self.out.join("trace.json"), &result)?;
        let separating = self.out.join(separating::FILE);
        let separates = !result.separating_blocks.is_empty();
        if separates {
            outputs.add(&separating, separating::motion(&separating, &result)?);
        }
        if let Some(json) = &self.json {
            outputs.add_json(json, &result)?;
        }
        drop(progress);
        outputs.write()?;
        if self.json.as_deref() != Some(Path::new("-")) {
            summary::print(&result);
            if separates {
                say(&format!(
                    "Run that test: {}",
                    separating::command(&separating)
                ));
            }
            say(&format!(
                "The report is {}",
                self.out.join("report.html").display()
            ));
        }
        Ok(())
    }
}

fn family(name: &str) -> Result<Family, String> {
    Family::named(name).ok_or_else(|| {
        let all: Vec<&str> = Family::all().map(Family::name).collect();
        format!("no effect has that name; give one of {}", all.join(", "))
    })
}

fn base_law(word: &str) -> Result<BaseLaw, String> {
    let mut all = BaseLaw::ALL.into_iter();
    all.find(|law| law.word() == word).ok_or_else(|| {
        let words = BaseLaw::ALL.map(BaseLaw::word);
        format!("no law has that name; give one of {}", words.join(", "))
    })
}

/// The effects of a model as a fit has them, with the control inputs that they see.
fn known_effects(path: &Path, limit: ReadLimit) -> Result<Sought, InputError> {
    let model = ModelFile::read_within(path, limit)?.model();
    let refused = |field: &str, problem: &str, remedy: &str| {
        let place = Place::Field(field.to_owned());
        InputError::new(path.display().to_string(), problem, remedy).at(place)
    };
    if model.correction.is_some() {
        return Err(refused(
            "correction",
            "is a residual table, which stands for what is sought",
            "give a model without it",
        ));
    }
    let effects = model.effects.iter().enumerate().map(|(index, effect)| {
        known_terms(effect).ok_or_else(|| {
            refused(
                &format!("effects[{index}]"),
                "has parameters that no fit has",
                "give the effect as `hil trace` writes it, or leave it out",
            )
        })
    });
    let effects: Vec<Vec<KnownTerm>> = effects.collect::<Result<_, _>>()?;
    let controls = model.controls.into_iter().map(|control| control.name);
    Ok(Sought {
        known: effects.concat(),
        controls: controls.collect(),
        ..Sought::default()
    })
}

/// A file given twice would be held out and fitted, or counted twice.
fn reject_repeats<'a>(paths: impl Iterator<Item = &'a PathBuf>) -> Result<(), InputError> {
    let mut known = Vec::new();
    for path in paths {
        // What cannot be resolved is refused when it is read.
        let Ok(resolved) = path.canonicalize() else {
            continue;
        };
        if known.contains(&resolved) {
            return Err(InputError::new(
                path.display().to_string(),
                "is given twice",
                "give each recording once, either to fit or after --held-out",
            ));
        }
        known.push(resolved);
    }
    Ok(())
}

/// The model with the range of motion that it was fitted on.
pub fn model_file(found: &Trace) -> ModelFile {
    let fitted = |channel: fn(&mesh_damper_recording::motion::MotionEstimate) -> &Vec<f64>| {
        found.recordings.iter().flat_map(move |traced| {
            let values = channel(&traced.trajectory.motion);
            values
                .iter()
                .zip(&traced.roles)
                .filter(|(_, role)| **role != Role::HeldOut)
                .map(|(value, _)| value)
        })
    };
    let still = FittedRange {
        displacement: [0.0; 2],
        velocity: [0.0; 2],
    };
    let range = FittedRange::of(
        fitted(|motion| &motion.displacement),
        fitted(|motion| &motion.velocity),
    );
    ModelFile::new(found.model.clone(), range.unwrap_or(still))
}

/// What the recordings' comments declare.
fn declarations(recordings: &[Recording]) -> Vec<(String, String)> {
    ["specimen", "device", "excitation"]
        .into_iter()
        .filter_map(|key| {
            let text = recordings.iter().find_map(|r| r.declared(key))?;
            // Recordings of one specimen differ in their excitation.
            let same = recordings.iter().all(|r| r.declared(key) == Some(text));
            same.then(|| (key.to_owned(), text.to_owned()))
        })
        .collect()
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}
