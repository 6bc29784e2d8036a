//! A model as files for firmware or a simulation.

use std::path::PathBuf;

use mesh_damper_export::{Exported, Format, Request};
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use pyo3::prelude::*;

use crate::error::refused;
use crate::model::{Model, json};

/// Writes the files of an export, completely or not at all. Returns the JSON of `hil export`, and its warnings.
#[pyfunction]
#[pyo3(signature = (model, path, format, tick_rate, name, revision, amplitude, density, allow_active, libraries, folders))]
#[expect(
    clippy::too_many_arguments,
    reason = "the Python function before it names them"
)]
fn export(
    py: Python<'_>,
    model: PyRef<'_, Model>,
    path: PathBuf,
    format: &str,
    tick_rate: f64,
    name: Option<String>,
    revision: u32,
    amplitude: Option<f64>,
    density: Option<f64>,
    allow_active: bool,
    libraries: Vec<PathBuf>,
    folders: Vec<PathBuf>,
) -> PyResult<(String, Vec<String>)> {
    let mut formats = Format::ALL.into_iter();
    let format = formats.find(|each| each.word() == format).ok_or_else(|| {
        let words = Format::ALL.map(Format::word).join(", ");
        let problem = format!("no format is called {format:?}");
        refused(&InputError::new(
            "format",
            problem,
            format!("give one of {words}"),
        ))
    })?;
    let request = Request {
        name,
        revision,
        amplitude,
        density,
        allow_active,
        libraries,
        folders,
        ..Request::new(&model.name, format, tick_rate, path)
    };
    let file = model.inner.clone();
    let written = py.detach(move || {
        let mut outputs = Plan::new()
            .reads([&request.model])
            .reads(&request.libraries)
            .writes(request.paths()?)
            .begin()?;
        let Exported {
            files,
            summary,
            warnings,
            ..
        } = request.export(&file)?;
        for (path, bytes) in files {
            outputs.add(path, bytes);
        }
        outputs.write()?;
        Ok((summary, warnings))
    });
    let (summary, warnings) = written.map_err(|error| refused(&error))?;
    Ok((json(&summary)?, warnings))
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(export, module)?)
}
