//! Tests of the simulated rig.

use mesh_damper_demo::{Test, record};
use mesh_damper_output::error::InputError;
use pyo3::prelude::*;

use crate::error::refused;
use crate::model::json;
use crate::recording::Recording;
use crate::work::beside;

/// The recording of a test of the specimen that `seed` draws, and the hidden properties of the specimen as JSON.
#[pyfunction]
fn simulate(py: Python<'_>, seed: u64, is_check: bool) -> PyResult<(Recording, String)> {
    let test = match is_check {
        true => Test::Check,
        false => Test::Protocol,
    };
    let done = beside(py, None, move |_| record(seed, test))?;
    let (hidden, recording) = done.map_err(|error| {
        let name = format!("simulation of seed {seed}");
        refused(&InputError::new(
            name,
            error.to_string(),
            "give another seed",
        ))
    })?;
    Ok((Recording::of(recording), json(&hidden)?))
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(simulate, module)?)
}
