//! Refused input, as an exception with the text that the command prints.

use std::io::ErrorKind;
use std::path::Path;

use mesh_damper_identify::trace::TraceError;
use mesh_damper_output::error::InputError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// `mesh_damper.InputError`, a `ValueError`.
pub fn refused(error: &InputError) -> PyErr {
    raised("InputError", error.to_string())
}

/// The same for a file. A missing file gives a `mesh_damper.MissingFileError`, which is also a `FileNotFoundError`.
pub fn refused_of(path: &Path, error: &InputError) -> PyErr {
    let is_missing = |error: std::io::Error| error.kind() == ErrorKind::NotFound;
    if std::fs::metadata(path).is_err_and(is_missing) {
        return raised("MissingFileError", error.to_string());
    }
    refused(error)
}

/// The reason why there is no trace.
pub fn not_traced(error: &TraceError) -> PyErr {
    raised("InputError", error.to_string())
}

fn raised(class: &str, text: String) -> PyErr {
    static CLASSES: [PyOnceLock<Py<PyType>>; 2] = [PyOnceLock::new(), PyOnceLock::new()];
    let [input, missing] = &CLASSES;
    let cell = if class == "InputError" {
        input
    } else {
        missing
    };
    Python::attach(|py| match cell.import(py, "mesh_damper._errors", class) {
        Ok(class) => PyErr::from_type(class.clone(), text),
        Err(error) => error,
    })
}
