//! A model, and the force that it predicts.

use std::path::PathBuf;
use std::sync::Arc;

use mesh_damper_model::file::ModelFile;
use mesh_damper_recording::error::InputError;
use mesh_damper_recording::output::Plan;
use pyo3::prelude::*;
use serde::Serialize;

use crate::error::{refused, refused_of};

/// A law with its effects: the contents of model.json.
#[pyclass(frozen, module = "mesh_damper._core")]
pub struct Model {
    pub inner: Arc<ModelFile>,
    /// What errors call it.
    pub name: String,
}

impl Model {
    pub fn of(inner: Arc<ModelFile>) -> Self {
        Self {
            inner,
            name: "the model".into(),
        }
    }
}

#[pymethods]
impl Model {
    /// The model in a file.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        let file = ModelFile::read(&path).map_err(|error| refused_of(&path, &error))?;
        Ok(Self {
            inner: Arc::new(file),
            name: path.display().to_string(),
        })
    }

    /// The model in the text of such a file.
    #[staticmethod]
    fn of_json(text: &str) -> PyResult<Self> {
        let file = ModelFile::from_bytes("the model", text.as_bytes());
        Ok(Self::of(Arc::new(file.map_err(|error| refused(&error))?)))
    }

    /// The contents of model.json.
    fn to_json(&self) -> PyResult<String> {
        json(&*self.inner)
    }

    /// Which model it is, as packs and exports say it.
    #[getter]
    fn identity(&self) -> String {
        self.inner.identity().to_string()
    }

    /// Writes it as a file, whole or not at all.
    fn write(&self, path: PathBuf) -> PyResult<()> {
        let written = || {
            let mut outputs = Plan::new().writes([&path]).begin()?;
            outputs.add_json(&path, &*self.inner)?;
            outputs.write()
        };
        written().map_err(|error| refused(&error))
    }
}

/// As the commands write it.
pub fn json(value: &impl Serialize) -> PyResult<String> {
    let text = serde_json::to_string_pretty(value).map_err(|error| {
        let mend = "report this";
        refused(&InputError::new("JSON", error.to_string(), mend))
    })?;
    Ok(text + "\n")
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Model>()
}
