//! Makes the traces of a list with several workers, and stores each as soon as it is finished.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

use mesh_damper_output::Plan;
use mesh_damper_output::error::{InputError, quoted};

use crate::identity::{Content, contents, identity};
use crate::journal::Journal;
use crate::leftover;
use crate::list::{List, Task};
use crate::one;
use crate::outcome::{Failure, Outcome};
use crate::page::page;
use crate::row::{Row, Summary};
use crate::settings::Settings;
use crate::table::{outcomes, parameters};
use crate::work::{Workers, each};

/// The file with the finished traces.
const JOURNAL: &str = "journal.jsonl";
/// The folder that contains the folders of all traces.
const TRACES: &str = "traces";
/// The tables.
const OUTCOMES: &str = "outcomes.parquet";
const OUTCOMES_CSV: &str = "outcomes.csv";
const EFFECTS: &str = "effects.parquet";
/// The page.
const PAGE: &str = "index.html";

/// Most traces at the same time: above the number of cores of one machine, and below the number whose threads would overload it.
const MOST_JOBS: usize = 1024;

/// Traces to make, and the place for them.
#[derive(Clone, Debug)]
pub struct Batch {
    /// The traces.
    pub list: List,
    /// The settings of all traces.
    pub settings: Settings,
    /// Other files that were read for the batch, such as a law: no output may replace them.
    pub reads: Vec<PathBuf>,
    /// The folder of the tables and of the traces. Results from an earlier run in it are used.
    pub out: PathBuf,
    /// Traces that are made at the same time. Each has its recordings in memory.
    pub jobs: NonZeroUsize,
    /// Path of the summary as JSON, `-` for standard output.
    pub json: Option<PathBuf>,
}

/// The progress of a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Finished traces and copies.
    pub done: usize,
    /// Their total number.
    pub total: usize,
    /// Finished traces that could not be made.
    pub failed: usize,
    /// Finished traces that were made or failed in this run.
    pub computed: usize,
    /// Time since the beginning, s.
    pub seconds: f64,
}

impl Progress {
    /// Traces per second; `None` before the first.
    pub fn rate(&self) -> Option<f64> {
        (self.computed > 0).then(|| self.computed as f64 / self.seconds)
    }

    /// Remaining time if all other traces have to be made, s.
    pub fn left(&self) -> Option<f64> {
        self.rate()
            .map(|rate| (self.total - self.done) as f64 / rate)
    }
}

impl Batch {
    /// Makes the traces, and writes the tables. `progress` is called after each trace.
    ///
    /// A trace whose identity an earlier run stored, and whose files exist, is not made again. A recording that cannot be read or
    /// traced gives a row with its error.
    ///
    /// # Errors
    /// Another run uses the folder, or it is the recordings' folder; an output would destroy a file; a file cannot be written. The
    /// traces made so far are kept.
    pub fn run(&self, progress: &(dyn Fn(Progress) + Sync)) -> Result<Summary, InputError> {
        let started = Instant::now();
        self.refuse_own_folder()?;
        if self.jobs.get() > MOST_JOBS {
            let problem = format!("{} is above {MOST_JOBS}", self.jobs);
            let remedy = "give as many as the machine has cores";
            return Err(InputError::new("--jobs", problem, remedy));
        }
        let names = [OUTCOMES, OUTCOMES_CSV, EFFECTS, PAGE, JOURNAL];
        let mut outputs = Plan::new()
            .reads(&self.list.file)
            .reads(&self.reads)
            .reads(self.list.tasks.iter().flat_map(Task::paths))
            .fills(self.out.as_path(), names)
            .writes(&self.json)
            .begin()?;
        if self.out.join(JOURNAL).exists() {
            leftover::remove(&self.out);
        }
        let running = Running {
            batch: self,
            decisive: self.settings.decisive(),
            state: Mutex::new(State {
                journal: Journal::open(&self.out.join(JOURNAL))?,
                claims: BTreeMap::new(),
                unread: BTreeMap::new(),
                holders: BTreeMap::new(),
                failed: 0,
                computed: 0,
                kept: 0,
                done: 0,
            }),
            started,
            progress,
        };
        let workers = Workers::for_tasks(self.jobs, self.list.tasks.len());
        each(workers, self.list.tasks.len(), |which| {
            running.deal_with(which)
        })?;
        let summary = running.summary();
        let table = outcomes(&summary.traces);
        outputs.add(self.out.join(OUTCOMES), table.to_parquet()?);
        outputs.add(self.out.join(OUTCOMES_CSV), table.to_csv());
        outputs.add(
            self.out.join(EFFECTS),
            parameters(&summary.traces).to_parquet()?,
        );
        outputs.add(self.out.join(PAGE), page(&summary.traces, &self.out));
        if let Some(json) = &self.json {
            outputs.add_json(json, &summary)?;
        }
        outputs.write()?;
        Ok(summary)
    }

    /// The tables would be recordings of the next run.
    fn refuse_own_folder(&self) -> Result<(), InputError> {
        let Ok(out) = self.out.canonicalize() else {
            return Ok(());
        };
        let mut folders = self
            .list
            .tasks
            .iter()
            .flat_map(Task::paths)
            .filter_map(Path::parent)
            // A bare file name is in the working directory.
            .map(|folder| match folder.as_os_str().is_empty() {
                true => Path::new("."),
                false => folder,
            });
        match folders.find(|folder| folder.canonicalize().is_ok_and(|folder| folder == out)) {
            Some(_) => Err(InputError::new(
                self.out.display().to_string(),
                "holds recordings of the list",
                "name another folder with --out",
            )),
            None => Ok(()),
        }
    }
}

/// A batch in progress.
struct Running<'a> {
    batch: &'a Batch,
    decisive: String,
    state: Mutex<State>,
    started: Instant,
    progress: &'a (dyn Fn(Progress) + Sync),
}

struct State {
    journal: Journal,
    /// The tasks of each identity.
    claims: BTreeMap<String, Vec<usize>>,
    /// The reason why a task has no identity.
    unread: BTreeMap<usize, Failure>,
    /// The tasks with the same recording, by its contents.
    holders: BTreeMap<Content, Vec<(usize, PathBuf)>>,
    failed: usize,
    computed: usize,
    kept: usize,
    done: usize,
}

impl Running<'_> {
    /// Makes one trace unless it already exists.
    fn deal_with(&self, which: usize) -> Result<(), InputError> {
        let task = &self.batch.list.tasks[which];
        match contents(task, self.batch.settings.reading.limit) {
            Err(error) => {
                let failure = Failure::of(&error);
                self.with_state(|state| {
                    state.unread.insert(which, failure);
                    state.failed += 1;
                });
            }
            Ok(contents) => {
                let id = identity(task, &contents, &self.decisive);
                if self.claim(which, &id, &contents) {
                    self.make(task, &id, &contents)?;
                }
            }
        }
        let progress = self.with_state(|state| {
            state.done += 1;
            Progress {
                done: state.done,
                total: self.batch.list.tasks.len(),
                failed: state.failed,
                computed: state.computed,
                seconds: self.started.elapsed().as_secs_f64(),
            }
        });
        (self.progress)(progress);
        Ok(())
    }

    /// Whether the trace is still to be made.
    fn claim(&self, which: usize, id: &str, contents: &[Content]) -> bool {
        let task = &self.batch.list.tasks[which];
        self.with_state(|state| {
            for (content, path) in contents.iter().zip(task.paths()) {
                let holders = state.holders.entry(*content).or_default();
                holders.push((which, path.to_owned()));
            }
            let tasks = state.claims.entry(id.to_owned()).or_default();
            tasks.push(which);
            if tasks.len() > 1 {
                return false;
            }
            let settings = &self.batch.settings;
            let is_wanted = match state.journal.outcome(id) {
                None => true,
                Some(Outcome::Traced(found)) => {
                    !one::is_there(&self.batch.out.join(&found.folder), settings)
                }
                Some(Outcome::Failed(failure)) => {
                    let limit = settings.reading.limit.file();
                    let may_pass = failure.read_limit.is_some_and(|known| known != limit);
                    // Its text is about a file that may have another name now.
                    let is_renamed = !task
                        .paths()
                        .any(|path| failure.error.contains(&path.display().to_string()));
                    let is_wanted = may_pass || is_renamed;
                    state.failed += usize::from(!is_wanted);
                    is_wanted
                }
            };
            state.kept += usize::from(!is_wanted);
            is_wanted
        })
    }

    fn make(&self, task: &Task, id: &str, contents: &[Content]) -> Result<(), InputError> {
        // Files of many folders have the same name. 16 digits coincide for two of 10⁵ such files once in 10⁹ batches.
        let folder = format!("{TRACES}/{}-{}", short_name(&task.name), &id[..16]);
        let made = match one::twice(task, contents) {
            Some(failure) => Err(failure),
            None => one::trace(task, &self.batch.settings, folder.clone()),
        };
        let outcome = match made {
            Ok(made) => {
                let folder = self.batch.out.join(&folder);
                leftover::remove(&folder);
                made.write(&folder)?;
                Outcome::Traced(Box::new(made.found))
            }
            Err(failure) => Outcome::Failed(failure),
        };
        self.with_state(|state| {
            state.computed += 1;
            state.failed += usize::from(matches!(outcome, Outcome::Failed(_)));
            state.journal.keep(id, &outcome)
        })
    }

    fn with_state<T>(&self, of: impl FnOnce(&mut State) -> T) -> T {
        // If a worker panics while it holds the lock, the data stay as they were between two steps.
        let mut state = self
            .state
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        of(&mut state)
    }

    fn summary(self) -> Summary {
        let tasks = &self.batch.list.tasks;
        let state = self
            .state
            .into_inner()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        let mut rows: BTreeMap<usize, Row> = BTreeMap::new();
        for (&which, failure) in &state.unread {
            let outcome = Outcome::Failed(failure.clone());
            rows.insert(which, Row::of(&tasks[which], &[], None, outcome));
        }
        for (id, which) in &state.claims {
            let Some(outcome) = state.journal.outcome(id) else {
                continue;
            };
            let mut which = which.clone();
            which.sort_unstable();
            let copies: Vec<&Task> = which[1..].iter().map(|&copy| &tasks[copy]).collect();
            let row = Row::of(&tasks[which[0]], &copies, Some(id.clone()), outcome.clone());
            rows.insert(which[0], row);
        }
        let is_row = |which: &usize| rows.contains_key(which);
        let mut shared: Vec<String> = state
            .holders
            .into_values()
            .filter_map(|mut holders| {
                holders.retain(|(which, _)| is_row(which));
                holders.sort();
                let (first, path) = holders.first()?;
                let (other, _) = holders.iter().find(|(which, _)| which != first)?;
                Some(format!(
                    "{} is in {} and in {}",
                    path.display(),
                    quoted(&tasks[*first].name),
                    quoted(&tasks[*other].name)
                ))
            })
            .collect();
        shared.sort();
        let traces: Vec<Row> = rows.into_values().collect();
        let failed = traces
            .iter()
            .filter(|row| matches!(row.outcome, Outcome::Failed(_)));
        let failed = failed.count();
        Summary {
            format: "mesh-damper batch",
            version: 1,
            traced: traces.len() - failed,
            failed,
            computed: state.computed,
            kept: state.kept,
            shared,
            seconds: self.started.elapsed().as_secs_f64(),
            traces,
        }
    }
}

/// The folder name for a task: its last part, with letters, digits, dots, dashes and underscores.
fn short_name(name: &str) -> String {
    const LONGEST: usize = 48;
    let last = name.rsplit(['/', '\\']).find(|part| !part.is_empty());
    let last = last
        .unwrap_or("trace")
        .trim_end_matches(".gz")
        .trim_end_matches(".csv");
    let plain = |letter: char| match letter {
        'a'..='z' | 'A'..='Z' | '0'..='9' | '-' | '_' => letter,
        '.' => '.',
        _ => '_',
    };
    let short: String = last.chars().take(LONGEST).map(plain).collect();
    // Neither hidden nor the parent folder.
    short.trim_start_matches('.').to_owned()
}
