//! `hil trace`: from recordings to the effect that the law lacks, and to the law with it.

use std::path::{Path, PathBuf};
use std::sync::Once;

use clap::Args;
use mesh_damper_identify::trace::{Sought, trace_for};
use mesh_damper_output::Plan;
use mesh_damper_recording::notes::shared;
use mesh_damper_recording::{Recording, refuse_repeats};
use mesh_damper_report::{self as report, ReportData, declared};

use super::document::AddDocument as _;
use super::progress::Progress;
use super::reading::RecordingFiles;
use super::seeking::Seeking;
use super::separating;
use super::{Failure, say, summary};

/// Find the effects that the law lacks in recordings, and write the augmented law
///
/// Writes trace.json, model.json and report.html into the folder of --out. If several effects explain the recordings equally well, it
/// also writes separating-test.csv: the motion of a test that tells them apart. `hil run --drive` follows that motion.
#[derive(Args, Debug)]
#[command(after_help = "Examples:\n  hil demo --seed 4\n  \
    hil trace demo-out/recording.csv.gz\n  \
    hil trace demo-out/recording.csv.gz --exclude inertia,offset --out trace-2")]
pub struct TraceCommand {
    /// Recordings of one specimen; the model is fitted to them
    #[arg(value_name = "REC", required = true)]
    recordings: Vec<PathBuf>,
    /// Recordings for the test: the model predicts them and is never fitted to them
    ///
    /// Without this option, the trace holds out the last cycles of each block and one whole block.
    #[arg(long, value_name = "REC", num_args = 1..)]
    held_out: Vec<PathBuf>,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "trace-out")]
    out: PathBuf,
    #[command(flatten)]
    seeking: Seeking,
    /// Write effects or a residual table into model.json even if they are not shown to be better
    ///
    /// If the effects found do not explain the recordings, the model is tested on conditions left out of the fit. Without this option, the
    /// law alone is written unless they show that the model predicts better.
    #[arg(long)]
    adopt: bool,
    /// Write trace.json to this file too; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    files: RecordingFiles,
}

impl TraceCommand {
    pub fn run(self) -> Result<(), Failure> {
        let mut outputs = Plan::new()
            .reads(&self.recordings)
            .reads(&self.held_out)
            .reads(self.seeking.law())
            .fills(
                self.out.as_path(),
                ["trace.json", "model.json", "report.html", separating::FILE],
            )
            .writes(&self.json)
            .begin()?;
        refuse_repeats(self.recordings.iter().chain(&self.held_out))?;
        let sought = Sought {
            adopt: self.adopt,
            ..self.seeking.sought(self.files.reading.limit)?
        };
        let [recordings, held_out] =
            (self.files).channels_of([&self.recordings, &self.held_out])?;
        let progress = Progress::steps();
        let begun = Once::new();
        let found = trace_for(&sought, &recordings, &held_out, &|what| {
            begun.call_once(|| warn_of_units(&progress, recordings.iter().chain(&held_out)));
            progress.step(what);
        })?;
        let declared = declared(&recordings);
        // The report needs memory of its own.
        drop((recordings, held_out));
        progress.step("writing the report");
        let names: Vec<String> = self.recordings.iter().map(|path| file_name(path)).collect();
        outputs.add_document(self.out.join("model.json"), &found.model_file())?;
        let title = format!("Trace of {}", names.join(", "));
        let report = ReportData::of_trace(title, declared, found);
        outputs.add(self.out.join("report.html"), report::render(&report));
        let result = report.result;
        outputs.add_document(self.out.join("trace.json"), &result)?;
        let separating = self.out.join(separating::FILE);
        let separates = !result.separating_blocks.is_empty();
        if separates {
            outputs.add(&separating, separating::motion(&separating, &result)?);
        }
        outputs.add_document_if(&self.json, &result)?;
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

/// A search with a wrong unit takes long, or ends in an error that does not name the unit.
fn warn_of_units<'r>(progress: &Progress, recordings: impl Iterator<Item = &'r Recording>) {
    let (mut names, mut doubts) = (Vec::new(), Vec::new());
    for recording in recordings {
        names.push(recording.name.as_str());
        let repaired = recording.repaired();
        let faults = repaired.faults().iter();
        let doubtful = faults.filter(|fault| fault.is_doubtful_unit());
        doubts.extend(doubtful.map(|fault| format!("{}: {fault}", recording.name)));
    }
    for doubt in shared(names, doubts) {
        progress.warn(&doubt);
    }
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}
