//! One trace of a batch, and its files.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_identify::trace::trace_for;
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::InputError;
use mesh_damper_output::{Labelled, Plan};
use mesh_damper_recording::Recording;
use mesh_damper_report::{self as report, ReportData};

use crate::identity::Content;
use crate::list::Task;
use crate::outcome::{Failure, Found};
use crate::settings::Settings;

/// A finished trace that is still to be written.
pub(crate) struct Made {
    pub found: Found,
    result: TraceResult,
    model: ModelFile,
    report: Option<String>,
}

/// Traces the recordings of `task`. An error in them, or a fault in the trace itself, fails only this task.
pub(crate) fn trace(task: &Task, settings: &Settings, folder: String) -> Result<Made, Failure> {
    // Nothing of it is used after a panic.
    catch_unwind(AssertUnwindSafe(|| try_to_trace(task, settings, folder))).unwrap_or_else(
        |panic| {
            Err(Failure::of(&format!(
                "an internal error of the trace, please report it: {}",
                said(&*panic)
            )))
        },
    )
}

fn said(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or(panic.downcast_ref::<&str>().copied())
        .unwrap_or("no reason given")
}

fn try_to_trace(task: &Task, settings: &Settings, folder: String) -> Result<Made, Failure> {
    let started = Instant::now();
    let read = |path: &PathBuf| {
        Recording::read_channels(path, &settings.reading).map_err(|error| Failure {
            error: error.to_string(),
            read_limit: Some(settings.reading.limit.file()),
        })
    };
    let mut recordings = Vec::new();
    for path in task.recordings.iter().chain(&task.held_out) {
        recordings.push(read(path)?);
    }
    let (fitted, held_out) = recordings.split_at(task.recordings.len());
    let trace = trace_for(&settings.sought, fitted, held_out, &|_| ())
        .map_err(|error| Failure::of(&error))?;
    let model = trace.model_file();
    let seconds = started.elapsed().as_secs_f64();
    let range = model.fitted_range();
    let found = Found::of(&trace, &recordings, range, folder, seconds);
    let declared = report::declared(&recordings);
    // The report needs memory of its own.
    drop(recordings);
    let (result, report) = match settings.reports {
        false => (trace.result, None),
        true => {
            let data = ReportData::of_trace(format!("Trace of {}", task.name), declared, trace);
            let page = report::render(&data);
            (data.result, Some(page))
        }
    };
    Ok(Made {
        found,
        result,
        model,
        report,
    })
}

/// The error of a task that has one recording twice: it would count twice, or be both fitted and held out.
pub(crate) fn twice(task: &Task, contents: &[Content]) -> Option<Failure> {
    let paths: Vec<&Path> = task.paths().collect();
    contents.iter().enumerate().find_map(|(place, content)| {
        let other = contents[..place]
            .iter()
            .position(|other| other == content)?;
        let error = InputError::new(
            paths[place].display().to_string(),
            format!("is the same recording as {}", paths[other].display()),
            "give each recording of a trace once",
        );
        Some(Failure::of(&error))
    })
}

/// The names of a trace's files.
pub(crate) const TRACE: &str = "trace.json";
pub(crate) const MODEL: &str = "model.json";
pub(crate) const REPORT: &str = "report.html";

impl Made {
    /// Writes the files into `folder`, each completely or not at all.
    pub fn write(&self, folder: &Path) -> Result<(), InputError> {
        let [trace, model, page] = [TRACE, MODEL, REPORT].map(|name| folder.join(name));
        let mut outputs = Plan::new().writes([&trace, &model, &page]).begin()?;
        outputs.add_json(trace, &Labelled::new(TraceResult::LABEL, &self.result))?;
        outputs.add_json(model, &self.model)?;
        if let Some(report) = &self.report {
            outputs.add(page, report.as_str());
        }
        outputs.write()
    }
}

/// Whether the files of a finished trace exist.
pub(crate) fn is_there(folder: &Path, settings: &Settings) -> bool {
    let has = |name: &str| folder.join(name).is_file();
    has(TRACE) && has(MODEL) && (has(REPORT) || !settings.reports)
}
