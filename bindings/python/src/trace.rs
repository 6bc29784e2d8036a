//! A trace, its result and its files.

use std::path::PathBuf;
use std::sync::Arc;

use mesh_damper_identify::base_law::BaseLaw;
use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_identify::trace::{Sought, trace_for};
use mesh_damper_model::Family;
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::InputError;
use mesh_damper_output::{Labelled, Plan};
use mesh_damper_recording as recording;
use mesh_damper_recording::rig::{DisplacementZero, RigFacts};
use mesh_damper_report::{self as report, ReportData, declared};
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{not_traced, refused};
use crate::model::{Model, json};
use crate::recording::Recording;
use crate::work::beside;

/// The result of a trace.
#[pyclass(frozen, module = "mesh_damper._core")]
pub struct Trace {
    report: ReportData,
    model: Arc<ModelFile>,
}

#[pymethods]
impl Trace {
    /// The contents of trace.json.
    fn to_json(&self) -> PyResult<String> {
        json(&Labelled::new(TraceResult::LABEL, &self.report.result))
    }

    /// The contents of model.json, as a model.
    #[getter]
    fn model(&self) -> Model {
        Model::of(Arc::clone(&self.model))
    }

    /// The contents of report.html.
    fn report(&self, py: Python<'_>) -> String {
        py.detach(|| report::render(&self.report))
    }

    /// The verdict as a heading and a sentence.
    fn verdict_in_words(&self) -> (String, String) {
        report::text::verdict(&self.report.result)
    }

    /// The channels and forces of each recording that a report draws, in s, mm and kN, and the samples of a cycle in each block.
    fn series<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        let all = self.report.series.iter();
        all.map(|series| {
            let drawn = PyDict::new(py);
            drawn.set_item("name", &series.name)?;
            for (name, values) in [
                ("time", &series.time),
                ("displacement", &series.displacement),
                ("velocity", &series.velocity),
                ("force", &series.force),
                ("before", &series.before),
                ("after", &series.after),
            ] {
                drawn.set_item(name, array(py, values))?;
            }
            drawn.set_item("measured", series.measured.clone().into_pyarray(py))?;
            let blocks = series.blocks.iter().map(|block| {
                let place = (block.cycle.start, block.cycle.end);
                (place, block.amplitude, block.frequency, block.held_out)
            });
            drawn.set_item("blocks", blocks.collect::<Vec<_>>())?;
            Ok(drawn)
        })
        .collect()
    }
}

fn array<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
    values.to_vec().into_pyarray(py)
}

/// Finds effects that the law does not contain in `recordings`, without the interpreter's lock.
#[pyfunction]
#[pyo3(signature = (title, recordings, held_out, families, exclude, baseline, law=None, rig=None, progress=None, adopt=false))]
#[expect(
    clippy::too_many_arguments,
    reason = "the Python function before it names them"
)]
fn trace(
    py: Python<'_>,
    title: String,
    recordings: Vec<PyRef<'_, Recording>>,
    held_out: Vec<PyRef<'_, Recording>>,
    families: Vec<String>,
    exclude: Vec<String>,
    baseline: &str,
    law: Option<PyRef<'_, Model>>,
    rig: Option<StatedRig>,
    progress: Option<Bound<'_, PyAny>>,
    adopt: bool,
) -> PyResult<Trace> {
    let rig = rig_facts(rig)?;
    let sought = Sought {
        adopt,
        ..sought(&families, &exclude, baseline, law.as_deref(), rig)?
    };
    let copied = |all: &[PyRef<'_, Recording>]| -> Vec<recording::Recording> {
        all.iter().map(|each| (*each.inner).clone()).collect()
    };
    let (fitted, held) = (copied(&recordings), copied(&held_out));
    let traced = beside(py, progress.as_ref(), move |step| {
        let found = trace_for(&sought, &fitted, &held, step)?;
        let facts = declared(&fitted);
        let model = Arc::new(found.model_file());
        let report = ReportData::of_trace(title, facts, found);
        Ok(Trace { report, model })
    })?;
    traced.map_err(|error| not_traced(&error))
}

/// The settings of a trace by the names of families and of the law without effects, beside the known effects of `law`.
pub fn sought(
    families: &[String],
    exclude: &[String],
    baseline: &str,
    law: Option<&Model>,
    rig: RigFacts,
) -> PyResult<Sought> {
    let known = match law {
        Some(model) => Sought::beside(&model.inner, &model.name).map_err(|e| refused(&e))?,
        None => Sought::default(),
    };
    let sought = Sought {
        families: named("families", families)?,
        exclude: named("exclude", exclude)?,
        law: base_law(baseline)?,
        ..known
    };
    sought.on_rig(rig).map_err(|error| refused(&error))
}

/// The mass between specimen and load cell in kg, the delay of the force in s, and the word for the zero of the displacement.
pub type StatedRig = (Option<f64>, Option<f64>, Option<String>);

/// What is stated about a rig.
pub fn rig_facts(stated: Option<StatedRig>) -> PyResult<RigFacts> {
    let (fixture_mass, force_delay, zero) = stated.unwrap_or_default();
    let zero = match zero {
        None => None,
        Some(word) => {
            let mut all = DisplacementZero::ALL.into_iter();
            let known = all.find(|zero| zero.word() == word);
            Some(known.ok_or_else(|| {
                let problem = format!("no zero is called {word:?}");
                refused(&InputError::new(
                    "zero",
                    problem,
                    "give mean, start or none",
                ))
            })?)
        }
    };
    Ok(RigFacts {
        fixture_mass,
        force_delay,
        zero,
    })
}

/// Writes texts as files, all of them or none.
#[pyfunction]
fn write_files(py: Python<'_>, files: Vec<(PathBuf, String)>) -> PyResult<()> {
    let written = py.detach(move || {
        let paths = files.iter().map(|(path, _)| path);
        let mut outputs = Plan::new().writes(paths).begin()?;
        for (path, text) in files {
            outputs.add(path, text);
        }
        outputs.write()
    });
    written.map_err(|error| refused(&error))
}

fn named(option: &str, names: &[String]) -> PyResult<Vec<Family>> {
    let family = |name: &String| {
        Family::named(name).ok_or_else(|| {
            let all: Vec<&str> = Family::all().map(Family::name).collect();
            let remedy = format!("give one of {}", all.join(", "));
            let problem = format!("no effect is called {name:?}");
            refused(&InputError::new(option, problem, remedy))
        })
    };
    names.iter().map(family).collect()
}

fn base_law(word: &str) -> PyResult<BaseLaw> {
    let mut all = BaseLaw::ALL.into_iter();
    all.find(|law| law.word() == word).ok_or_else(|| {
        let words = BaseLaw::ALL.map(BaseLaw::word).join(", ");
        let problem = format!("no law is called {word:?}");
        let remedy = format!("give one of {words}");
        refused(&InputError::new("baseline", problem, remedy))
    })
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Trace>()?;
    module.add_function(wrap_pyfunction!(trace, module)?)?;
    module.add_function(wrap_pyfunction!(write_files, module)?)
}
