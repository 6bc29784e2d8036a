//! Stiffness and loss factor of a recording.

use mesh_damper_characterize::{DynamicTest, StaticTest, dynamic_test_on, static_test};
use mesh_damper_output::{Label, LabelField, Labelled};
use pyo3::prelude::*;
use serde::Serialize;

use crate::error::refused;
use crate::model::json;
use crate::recording::Recording;
use crate::trace::{StatedRig, rig_facts};

/// The contents of `hil characterize --json`, after its label.
#[derive(Serialize)]
struct Summary<'a> {
    recording: &'a str,
    #[serde(flatten)]
    found: Found,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Found {
    Static(StaticTest),
    Dynamic(DynamicTest),
}

/// The points of a loop, mm and kN.
type Loop = Vec<(f64, f64)>;

/// The JSON of `hil characterize`, and for each cycle or block the measured loop and the line computed from it.
#[pyfunction]
#[pyo3(signature = (recording, is_static, rig=None))]
fn characterize(
    py: Python<'_>,
    recording: PyRef<'_, Recording>,
    is_static: bool,
    rig: Option<StatedRig>,
) -> PyResult<(String, Vec<(Loop, Loop)>)> {
    let inner = recording.inner.clone();
    let rig = rig_facts(rig)?;
    let found = py.detach(move || match is_static {
        true => static_test(&inner).map(Found::Static),
        false => dynamic_test_on(&inner, &rig).map(Found::Dynamic),
    });
    let found = found.map_err(|error| refused(&error))?;
    let loops = match &found {
        Found::Static(test) => {
            let cycles = test.cycles.iter();
            cycles
                .map(|each| (each.curve.clone(), each.middle.clone()))
                .collect()
        }
        Found::Dynamic(test) => {
            let blocks = test.blocks.iter();
            blocks
                .map(|each| (each.measured.clone(), each.averaged_loop.clone()))
                .collect()
        }
    };
    let summary = Summary {
        recording: &recording.inner.name,
        found,
    };
    let label = Label::new("characterize", LabelField::Format);
    Ok((json(&Labelled::new(label, &summary))?, loops))
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(characterize, module)?)
}
