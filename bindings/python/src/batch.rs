//! Traces of many recordings, and models over time.

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::thread;

use mesh_damper_batch::compare::{Moment, compare};
use mesh_damper_batch::table::{Table, Values, outcomes, parameters};
use mesh_damper_batch::{Batch, List, Progress, Row, Settings, Task};
use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::InputError;
use mesh_damper_tables::read_limit::ReadLimit;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::error::{refused, refused_of};
use crate::model::{Model, json};
use crate::recording::Reading;
use crate::trace::{StatedRig, rig_facts, sought};
use crate::work::beside;

/// Settings of all traces in a batch.
#[pyclass(frozen, module = "mesh_damper._core")]
pub struct BatchSettings(Settings);

#[pymethods]
impl BatchSettings {
    #[new]
    #[pyo3(signature = (reading, families, exclude, baseline, law=None, rig=None, reports=false))]
    fn new(
        reading: PyRef<'_, Reading>,
        families: Vec<String>,
        exclude: Vec<String>,
        baseline: &str,
        law: Option<PyRef<'_, Model>>,
        rig: Option<StatedRig>,
        reports: bool,
    ) -> PyResult<Self> {
        Ok(Self(Settings {
            sought: sought(
                &families,
                &exclude,
                baseline,
                law.as_deref(),
                rig_facts(rig)?,
            )?,
            reading: reading.said.clone(),
            reports,
        }))
    }
}

/// The input of a batch: the path of a folder, list or table; paths; or a table as CSV.
#[derive(FromPyObject)]
enum Given {
    Path(PathBuf),
    Paths(Vec<PathBuf>),
}

/// The summary of a batch as JSON, its tables of outcomes and of effects as columns, and the sentence about files that are left out.
type Traced<'py> = (
    String,
    Bound<'py, PyDict>,
    Bound<'py, PyDict>,
    Option<String>,
);

/// Traces `given`, or the rows of `table`, into the folder `out`.
#[pyfunction]
#[pyo3(signature = (given, table, out, settings, jobs=None, progress=None))]
fn trace_many<'py>(
    py: Python<'py>,
    given: Option<Given>,
    table: Option<String>,
    out: PathBuf,
    settings: PyRef<'_, BatchSettings>,
    jobs: Option<usize>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Traced<'py>> {
    let settings = settings.0.clone();
    let limit = settings.reading.limit;
    let list = py.detach(move || match (given, table) {
        (Some(Given::Path(path)), _) => List::read(&path, limit),
        (Some(Given::Paths(paths)), _) => Ok(List::of_recordings(paths)),
        (None, table) => List::of_table("recordings", &table.unwrap_or_default()),
    });
    let list = list.map_err(|error| refused(&error))?;
    let left_out = list.left_out();
    let batch = Batch {
        list,
        settings,
        reads: Vec::new(),
        out,
        jobs: jobs_of(jobs)?,
        json: None,
    };
    let summary = beside(py, progress.as_ref(), move |step| {
        batch.run(&|done: Progress| step(&said(done)))
    })?;
    let summary = summary.map_err(|error| refused(&error))?;
    let tables = py.detach(|| (outcomes(&summary.traces), parameters(&summary.traces)));
    Ok((
        json(&summary)?,
        columns(py, &tables.0)?,
        columns(py, &tables.1)?,
        left_out,
    ))
}

fn jobs_of(jobs: Option<usize>) -> PyResult<NonZeroUsize> {
    match jobs {
        Some(jobs) => NonZeroUsize::new(jobs)
            .ok_or_else(|| refused(&InputError::new("jobs", "is 0", "give at least 1"))),
        None => Ok(thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)),
    }
}

fn said(done: Progress) -> String {
    let failed = match done.failed {
        0 => String::new(),
        failed => format!(", {failed} failed"),
    };
    format!("{} of {}{failed}", done.done, done.total)
}

/// The recordings of a folder, and its other files, as `hil batch` tells them apart.
#[pyfunction]
fn recordings_in(py: Python<'_>, folder: PathBuf) -> PyResult<(Vec<PathBuf>, Vec<PathBuf>)> {
    let list = py.detach(|| List::of_folder(&folder));
    let list = list.map_err(|error| refused_of(&folder, &error))?;
    let recordings = list.tasks.into_iter().flat_map(|task| task.recordings);
    Ok((recordings.collect(), list.ignored))
}

/// The identity of one trace, as in its row.
#[pyfunction]
fn identity(
    py: Python<'_>,
    recordings: Vec<PathBuf>,
    held_out: Vec<PathBuf>,
    settings: PyRef<'_, BatchSettings>,
) -> PyResult<String> {
    let (task, settings) = (task_of(recordings, held_out), &settings.0);
    let found = py.detach(|| settings.identity_of(&task));
    found.map_err(|error| match task.paths().find(|path| !path.exists()) {
        Some(missing) => refused_of(missing, &error),
        None => refused(&error),
    })
}

/// The row of one trace as JSON. It writes no file and uses one core.
#[pyfunction]
fn outcome(
    py: Python<'_>,
    recordings: Vec<PathBuf>,
    held_out: Vec<PathBuf>,
    settings: PyRef<'_, BatchSettings>,
) -> PyResult<String> {
    let settings = settings.0.clone();
    let task = task_of(recordings, held_out);
    let row = beside(py, None, move |_| Row::make(&task, &settings))?;
    json(&row)
}

/// A trace with the name of its first recording.
fn task_of(recordings: Vec<PathBuf>, held_out: Vec<PathBuf>) -> Task {
    Task {
        name: recordings
            .first()
            .map(|path| path.display().to_string())
            .unwrap_or_default(),
        recordings,
        held_out,
        ..Task::default()
    }
}

/// The table of rows as columns. Each row is the JSON of `outcome`.
#[pyfunction]
fn outcomes_of<'py>(py: Python<'py>, rows: Vec<String>) -> PyResult<Bound<'py, PyDict>> {
    let table = py.detach(move || table_of(&rows));
    columns(py, &table.map_err(|error| refused(&error))?)
}

fn table_of(rows: &[String]) -> Result<Table, InputError> {
    let row = |text: &String| {
        serde_json::from_str(text).map_err(|error| {
            InputError::new(
                "a row",
                format!("is not a row of a batch: {error}"),
                "give rows that outcome() returned",
            )
        })
    };
    let rows: Vec<Row> = rows.iter().map(row).collect::<Result<_, _>>()?;
    Ok(outcomes(&rows))
}

fn columns<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    for column in &table.0 {
        let values = match &column.values {
            Values::Text(values) => PyList::new(py, values)?,
            Values::Texts(values) => PyList::new(py, values)?,
            Values::Real(values) => PyList::new(py, values)?,
            Values::Count(values) => PyList::new(py, values)?,
            Values::Flag(values) => PyList::new(py, values)?,
        };
        columns.set_item(column.name, values)?;
    }
    Ok(columns)
}

/// A model over time: a path; or a name with the text of model.json and, if it is known, the text of trace.json.
#[derive(FromPyObject)]
enum GivenModel {
    Path(PathBuf),
    Texts(String, String, Option<String>),
}

/// The changes from model to model, as JSON, and the conclusion as a sentence.
#[pyfunction]
fn compare_models(
    py: Python<'_>,
    models: Vec<GivenModel>,
    times: Vec<f64>,
) -> PyResult<(String, &'static str)> {
    let compared = py.detach(move || {
        let moments = models
            .into_iter()
            .zip(times)
            .map(|(model, time)| moment(model, time));
        moments.collect::<Result<Vec<_>, _>>().and_then(compare)
    });
    let compared = compared.map_err(|error| refused(&error))?;
    Ok((json(&compared)?, compared.conclusion.sentence()))
}

fn moment(model: GivenModel, time: f64) -> Result<Moment, InputError> {
    match model {
        GivenModel::Path(path) => Moment::read(&path, time, ReadLimit::default()),
        GivenModel::Texts(name, model, trace) => {
            let model = ModelFile::from_bytes(&name, model.as_bytes())?;
            let trace = trace
                .map(|text| serde_json::from_str::<TraceResult>(&text))
                .transpose();
            let trace = trace.map_err(|error| {
                InputError::new(&name, format!("is no trace: {error}"), "trace it again")
            })?;
            Ok(Moment {
                name,
                time,
                model,
                trace,
            })
        }
    }
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<BatchSettings>()?;
    module.add_function(wrap_pyfunction!(trace_many, module)?)?;
    module.add_function(wrap_pyfunction!(recordings_in, module)?)?;
    module.add_function(wrap_pyfunction!(identity, module)?)?;
    module.add_function(wrap_pyfunction!(outcome, module)?)?;
    module.add_function(wrap_pyfunction!(outcomes_of, module)?)?;
    module.add_function(wrap_pyfunction!(compare_models, module)?)
}
