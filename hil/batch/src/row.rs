//! The rows of a batch: one per trace, with its outcome.

use std::path::PathBuf;

use rayon::ThreadPoolBuilder;
use serde::{Deserialize, Serialize};

use crate::identity::{contents, identity};
use crate::list::Task;
use crate::one;
use crate::outcome::{Failure, Outcome};
use crate::settings::Settings;

/// One trace of a batch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Row {
    /// Name of the trace in the list: its group, or the path of its recording.
    pub trace: String,
    /// The group from the table.
    pub group: Option<String>,
    /// The specimen from the table.
    pub specimen: Option<String>,
    /// Paths of the recordings that were fitted.
    pub recordings: Vec<String>,
    /// Paths of the recordings that were held out.
    pub held_out: Vec<String>,
    /// Paths of recordings with the same contents, which have no separate trace.
    pub copies: Vec<String>,
    /// Identity of the trace, a hash of the contents of the recordings and the settings. Null if a recording could not be read.
    pub id: Option<String>,
    /// The outcome.
    #[serde(flatten)]
    pub outcome: Outcome,
}

impl Row {
    /// Makes one trace on one core and writes no files, for callers that distribute thousands of traces and store the rows
    /// themselves. A recording that cannot be read or traced gives a row with its error.
    pub fn make(task: &Task, settings: &Settings) -> Self {
        let make = || Self::made(task, settings);
        match ThreadPoolBuilder::new().num_threads(1).build() {
            Ok(pool) => pool.install(make),
            Err(_) => make(),
        }
    }

    fn made(task: &Task, settings: &Settings) -> Self {
        let made = contents(task, settings.reading.limit).map(|contents| {
            let id = identity(task, &contents, &settings.decisive());
            let outcome = match one::twice(task, &contents) {
                Some(failure) => Outcome::Failed(failure),
                None => match one::trace(task, settings, String::new()) {
                    Ok(made) => Outcome::Traced(Box::new(made.found)),
                    Err(failure) => Outcome::Failed(failure),
                },
            };
            (Some(id), outcome)
        });
        let (id, outcome) =
            made.unwrap_or_else(|error| (None, Outcome::Failed(Failure::of(&error))));
        Self::of(task, &[], id, outcome)
    }

    pub(crate) fn of(task: &Task, copies: &[&Task], id: Option<String>, outcome: Outcome) -> Self {
        let shown = |paths: &[PathBuf]| {
            let paths = paths.iter().map(|path| path.display().to_string());
            paths.collect::<Vec<_>>()
        };
        Self {
            trace: task.name.clone(),
            group: task.group.clone(),
            specimen: task.specimen.clone(),
            recordings: shown(&task.recordings),
            held_out: shown(&task.held_out),
            copies: copies
                .iter()
                .flat_map(|copy| copy.paths())
                .map(|path| path.display().to_string())
                .collect(),
            id,
            outcome,
        }
    }
}

/// The result of a batch: the contents of its JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// The format of the document.
    pub format: &'static str,
    /// The version of the format.
    pub version: u64,
    /// Number of traces that were made, in this run or earlier.
    pub traced: usize,
    /// Number of traces that failed.
    pub failed: usize,
    /// Number of traces that were made or failed in this run.
    pub computed: usize,
    /// Number of traces kept from an earlier run.
    pub kept: usize,
    /// Recordings that belong to several traces, as sentences.
    pub shared: Vec<String>,
    /// Duration of this run, s.
    pub seconds: f64,
    /// The traces in the order of the list. Traces with the same contents appear once, at the place of the first.
    pub traces: Vec<Row>,
}
