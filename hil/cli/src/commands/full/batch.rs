//! `hil batch`: traces of many recordings.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::Args;
use mesh_damper_batch::outcome::Outcome;
use mesh_damper_batch::{Batch, List, Progress as Done, Settings, Summary};
use mesh_damper_identify::trace::conclusion::Conclusion;
use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_output::error::InputError;
use mesh_damper_output::terminal::duration;

use crate::commands::progress::Progress;
use crate::commands::reading::RecordingFiles;
use crate::commands::seeking::Seeking;
use crate::commands::{Failure, say, warn};

/// Trace many recordings and write one row of results for each
///
/// Writes into the folder of --out: outcomes.parquet and outcomes.csv with one row per trace, effects.parquet with one row per parameter,
/// index.html, and one folder per trace with trace.json and model.json.
///
/// If a batch was interrupted, start it again with the same options: it keeps the finished traces and does the rest.
///
/// A table of paths is CSV or Parquet with a column `path`. The columns `group`, `specimen` and `role` (`fit` or `held_out`) are
/// optional. Rows with the same group make one trace.
///
/// Exit codes: 0: all recordings were traced. 1: some were not; their rows hold the errors.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  hil demo --seed 4 --out tests/4\n  hil demo --seed 7 --out tests/7\n  \
    hil batch tests/4/recording.csv.gz tests/7/recording.csv.gz --reports\n  \
    find tests -name 'recording.csv.gz' | hil batch - --out listed-out"
)]
pub struct BatchCommand {
    /// A folder of recordings, a text file with one path per line (`-` is standard input), a table of paths, or several recordings
    #[arg(value_name = "DIR|LIST", required = true)]
    inputs: Vec<PathBuf>,
    /// Folder for the results; a batch that was interrupted continues there
    #[arg(long, value_name = "DIR", default_value = "batch-out")]
    out: PathBuf,
    /// Number of traces at the same time, 1 or more; the default is the number of cores
    ///
    /// Each trace uses one core and holds its recordings in memory.
    #[arg(long, value_name = "N", value_parser = jobs)]
    jobs: Option<NonZeroUsize>,
    /// Also write report.html for each trace
    #[arg(long)]
    reports: bool,
    /// Write the outcomes as JSON to this file; `-` is standard output
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    #[command(flatten)]
    seeking: Seeking,
    #[command(flatten)]
    files: RecordingFiles,
}

impl BatchCommand {
    pub fn run(self) -> Result<(), Failure> {
        let limit = self.files.reading.limit;
        let list = match &self.inputs[..] {
            [one] if one.as_path() == Path::new("-") => listed_on_standard_input()?,
            [one] => List::read(one, limit)?,
            several => of_recordings(several)?,
        };
        if let Some(sentence) = list.left_out() {
            warn(&sentence);
        }
        let cores = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
        let batch = Batch {
            list,
            settings: Settings {
                sought: self.seeking.sought(limit)?,
                reading: self.files.stated(),
                reports: self.reports,
            },
            reads: self.seeking.law().map(Path::to_owned).into_iter().collect(),
            out: self.out,
            jobs: self.jobs.unwrap_or(cores),
            json: self.json,
        };
        let progress = Progress::of(batch.list.tasks.len() as u64);
        progress.step("tracing");
        let summary = batch.run(&|done| {
            progress.step(&far(done));
            progress.done(done.done as u64);
        })?;
        drop(progress);
        for shared in &summary.shared {
            warn(&format!(
                "{shared}: two traces of one recording are not independent"
            ));
        }
        if batch.json.as_deref() != Some(Path::new("-")) {
            print(&summary, &batch.out);
        }
        match summary.failed {
            0 => Ok(()),
            failed => Err(Failure::Check(format!(
                "{failed} of {} failed; the column `error` of {} gives the reasons{}",
                counted(summary.traces.len(), "trace"),
                batch.out.join("outcomes.csv").display(),
                first_error(&summary)
                    .map_or_else(String::new, |error| format!("; the first is: {error}"))
            ))),
        }
    }
}

fn jobs(text: &str) -> Result<NonZeroUsize, String> {
    text.parse()
        .map_err(|_| "write a whole number of 1 or more".to_owned())
}

fn first_error(summary: &Summary) -> Option<&str> {
    summary.traces.iter().find_map(|row| match &row.outcome {
        Outcome::Failed(failure) => Some(failure.error.as_str()),
        Outcome::Traced(_) => None,
    })
}

/// The list of several inputs.
fn of_recordings(paths: &[PathBuf]) -> Result<List, InputError> {
    match paths.iter().find(|path| path.is_dir()) {
        Some(folder) => Err(InputError::new(
            folder.display().to_string(),
            "is a folder among several inputs",
            "give one folder alone, or the paths of recordings as a list on standard input: find DIR… -name '*.csv' | hil batch -",
        )),
        None => Ok(List::of_recordings(paths)),
    }
}

fn listed_on_standard_input() -> Result<List, InputError> {
    let mut text = String::new();
    std::io::stdin()
        .read_to_string(&mut text)
        .map_err(|error| InputError::io(Path::new("standard input"), "read", &error))?;
    List::of_lines("standard input", &text)
}

/// The progress, in words.
fn far(done: Done) -> String {
    let mut text = format!("{} of {}", done.done, done.total);
    if done.failed > 0 {
        text.push_str(&format!(", {} failed", done.failed));
    }
    if let (Some(rate), Some(left)) = (done.rate(), done.left()) {
        text.push_str(&format!(", {rate:.1} a second, {} left", duration(left)));
    }
    text
}

fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    }
}

const fn words(conclusion: Conclusion) -> &'static str {
    match conclusion {
        Conclusion::Found => "effects are found",
        Conclusion::NothingMissing => "no effect is missing: the law explains the recordings",
        Conclusion::Hidden => {
            "not decided: the uncertainty of the estimated velocity can hide an effect"
        }
        Conclusion::Contradicted => "not decided: the held-out data contradict the law",
        Conclusion::Ambiguous => "effects are found that the data cannot tell apart",
        Conclusion::Unlisted => "unmodelled: no family of effects explains the residual",
    }
}

fn print(summary: &Summary, out: &Path) {
    let earlier = match summary.kept {
        0 => String::new(),
        kept => format!(", {kept} of them kept from an earlier run"),
    };
    say(&format!(
        "{}{earlier}, in {}",
        counted(summary.traces.len(), "trace"),
        duration(summary.seconds)
    ));
    let found = summary.traces.iter().filter_map(|row| match &row.outcome {
        Outcome::Traced(found) => Some(found),
        Outcome::Failed(_) => None,
    });
    for conclusion in Conclusion::ALL {
        let with = found
            .clone()
            .filter(|found| found.conclusion() == conclusion);
        say(&format!("  {:>6}  {}", with.count(), words(conclusion)));
    }
    if summary.failed > 0 {
        say(&format!("  {:>6}  failed", summary.failed));
    }
    let with_warnings = found.clone().filter(|found| !found.warnings.is_empty());
    match with_warnings.count() {
        0 => {}
        count => say(&format!(
            "{} with warnings: see the column `warnings` of {}",
            counted(count, "trace"),
            out.join("outcomes.csv").display()
        )),
    }
    let mut families: BTreeMap<&str, usize> = BTreeMap::new();
    for effect in found
        .filter(|found| found.verdict != Verdict::Ambiguous)
        .flat_map(|found| &found.effects)
    {
        *families.entry(&effect.family).or_default() += 1;
    }
    if !families.is_empty() {
        let families = families
            .iter()
            .map(|(family, count)| format!("{family} {count}"));
        say(&format!(
            "Effects: {}",
            families.collect::<Vec<_>>().join(", ")
        ));
    }
    let copies: Vec<String> = summary
        .traces
        .iter()
        .filter(|row| !row.copies.is_empty())
        .map(|row| format!("{} as {}", row.copies.join(", "), row.trace))
        .collect();
    if !copies.is_empty() {
        say(&format!(
            "The same recording, counted once: {}",
            copies.join("; ")
        ));
    }
    say(&format!(
        "The outcomes are {}, the page is {}",
        out.join("outcomes.parquet").display(),
        out.join("index.html").display()
    ));
}
