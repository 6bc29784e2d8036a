//! The rows of a batch: a trace each, with what became of it.

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
    /// What the list calls it: its group, or the recording's path.
    pub trace: String,
    /// The group that the table names.
    pub group: Option<String>,
    /// The specimen that the table names.
    pub specimen: Option<String>,
    /// Paths of the recordings that were fitted.
    pub recordings: Vec<String>,
    /// Paths of the recordings that were held out.
    pub held_out: Vec<String>,
    /// Paths of recordings that hold the same, and are no trace of their own.
    pub copies: Vec<String>,
    /// The identity of the trace: of what the recordings hold and of what it is made with. `None` where one could not be read.
    pub id: Option<String>,
    /// What became of it.
    #[serde(flatten)]
    pub outcome: Outcome,
}

impl Row {
    /// Makes one trace on one core and writes no file of it: for who has thousands of them made elsewhere, and keeps the rows. A
    /// recording that cannot be read or traced is a row with its error.
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

/// What a batch did: the contents of its JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Summary {
    /// The word by which the file is known.
    pub format: &'static str,
    /// Its version.
    pub version: u64,
    /// Traces that were made, now or earlier.
    pub traced: usize,
    /// Traces that failed.
    pub failed: usize,
    /// Traces that were made or failed now.
    pub computed: usize,
    /// Traces that an earlier run has kept.
    pub kept: usize,
    /// Recordings that are in several traces, in words.
    pub shared: Vec<String>,
    /// What it took, s.
    pub seconds: f64,
    /// The traces in the order of the list. Of those that hold the same the first one stands there.
    pub traces: Vec<Row>,
}
