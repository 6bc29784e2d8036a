//! A model, and the force that it predicts.

use std::path::PathBuf;
use std::sync::Arc;

use mesh_damper_model::extrapolation::Extrapolation;
use mesh_damper_model::file::{ModelFile, model_error};
use mesh_damper_model::predict::{predict, predict_embedded};
use mesh_damper_output::Plan;
use mesh_damper_output::error::InputError;
use mesh_damper_recording as recording;
use mesh_damper_recording::trajectory::{Known, Trajectory, Zero};
use numpy::{IntoPyArray as _, PyArray1};
use pyo3::prelude::*;
use serde::Serialize;

use crate::error::{refused, refused_of};
use crate::recording::Recording;

/// A law with its effects: the contents of model.json.
#[pyclass(frozen, module = "mesh_damper._core")]
pub struct Model {
    pub inner: Arc<ModelFile>,
    /// Name of the model in errors.
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
    /// Reads the model in a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let file = py.detach(|| ModelFile::read(&path));
        let file = file.map_err(|error| refused_of(&path, &error))?;
        Ok(Self {
            inner: Arc::new(file),
            name: path.display().to_string(),
        })
    }

    /// Reads the model from the text of such a file.
    #[staticmethod]
    fn of_json(text: &str) -> PyResult<Self> {
        let file = ModelFile::from_bytes("the model", text.as_bytes());
        Ok(Self::of(Arc::new(file.map_err(|error| refused(&error))?)))
    }

    /// The contents of model.json.
    fn to_json(&self) -> PyResult<String> {
        json(&*self.inner)
    }

    /// Identity of the model, as in packs and exports.
    #[getter]
    fn identity(&self) -> String {
        self.inner.identity().to_string()
    }

    /// The force in kN for the motion of a recording, at its samples, as computed by `hil predict`: in f64 as it was fitted, or in
    /// f32 as in firmware. Also returns its notes.
    ///
    /// A motion without a force is used as it is. A motion with a force is shifted to the rest position of the specimen, which the
    /// force shows, and the returned force has the delay of the recorded force.
    fn predict<'py>(
        &self,
        py: Python<'py>,
        recording: PyRef<'py, Recording>,
        has_force: bool,
        is_embedded: bool,
        controls: Vec<(String, f64)>,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Vec<String>)> {
        let (file, name) = (Arc::clone(&self.inner), self.name.clone());
        let inner = Arc::clone(&recording.inner);
        let work = move || predicted(&file, &name, &inner, has_force, is_embedded, &controls);
        let (force, warnings) = py.detach(work).map_err(|error| refused(&error))?;
        Ok((force.into_pyarray(py), warnings))
    }

    /// Writes the model as a file, completely or not at all.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let file = Arc::clone(&self.inner);
        let written = py.detach(move || {
            let mut outputs = Plan::new().writes([&path]).begin()?;
            outputs.add_json(&path, &*file)?;
            outputs.write()
        });
        written.map_err(|error| refused(&error))
    }
}

fn predicted(
    file: &ModelFile,
    name: &str,
    recording: &recording::Recording,
    has_force: bool,
    is_embedded: bool,
    controls: &[(String, f64)],
) -> Result<(Vec<f64>, Vec<String>), InputError> {
    let model = file.model();
    // As in a trace, the same faults are repaired.
    let mut repaired = recording.repaired();
    let known = (recording.name.as_str(), repaired.controls.as_slice());
    let held = model.held_controls(known, controls, repaired.len())?;
    let mut warnings: Vec<String> = (held.iter().zip(&model.controls))
        .filter_map(|(channel, control)| control.beyond(&channel.values))
        .collect();
    if held != repaired.controls {
        repaired.to_mut().controls = held;
    }
    let uniform = repaired.uniform()?;
    let known = match has_force {
        true => Known::default(),
        false => Known {
            late: Some(0.0),
            zero: Some(Zero::Recorded),
            ..Known::default()
        },
    };
    let trajectory = Trajectory::knowing(&repaired, known)?;
    let force = match is_embedded {
        true => predict_embedded(&model, &trajectory),
        false => predict(&model, &trajectory),
    };
    let force = force.map_err(|error| model_error(name, &error))?;
    let faults = trajectory.faults.iter();
    warnings.extend(faults.map(|fault| format!("{}: {fault}", recording.name)));
    let motion = &trajectory.motion;
    let outside = Extrapolation::of(&file.fitted_range(), &motion.displacement, &motion.velocity);
    warnings.extend(outside.in_words("samples", name));
    if recording.temperature.is_none() && model.depends_on_temperature() {
        warnings.push(format!(
            "{name} depends on temperature, and {} has none: {} °C is assumed",
            recording.name,
            trajectory.temperature_at(0)
        ));
    }
    Ok((uniform.at_samples_of(&repaired, &force), warnings))
}

/// The value as JSON, in the form that the commands write.
pub fn json(value: &impl Serialize) -> PyResult<String> {
    let text = serde_json::to_string_pretty(value).map_err(|error| {
        let remedy = "report this";
        refused(&InputError::new("JSON", error.to_string(), remedy))
    })?;
    Ok(text + "\n")
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Model>()
}
