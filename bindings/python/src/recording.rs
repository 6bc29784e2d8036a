//! Recordings of files and of columns.

use std::path::PathBuf;
use std::sync::Arc;

use mesh_damper_recording::error::InputError;
use mesh_damper_recording::faults::Channel;
use mesh_damper_recording::files::Reading;
use mesh_damper_recording::read_limit::ReadLimit;
use mesh_damper_recording::{self as recording};
use numpy::{IntoPyArray as _, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::error::{refused, refused_of};

/// Motion and force over time, as the core takes them.
#[pyclass(frozen, module = "mesh_damper._core")]
pub struct Recording {
    pub inner: Arc<recording::Recording>,
}

impl Recording {
    pub fn of(recording: recording::Recording) -> Self {
        Self {
            inner: Arc::new(recording),
        }
    }
}

#[pymethods]
impl Recording {
    /// The recording in a file, as `hil trace` reads it, with what its options `--channel`, `--unit` and `--rate` say; of the control
    /// inputs only `inputs`, where these are given.
    #[staticmethod]
    #[pyo3(signature = (path, max_read=None, channels=vec![], units=vec![], rate=None, inputs=None))]
    fn read(
        py: Python<'_>,
        path: PathBuf,
        max_read: Option<u64>,
        channels: Vec<(String, String)>,
        units: Vec<(String, String)>,
        rate: Option<f64>,
        inputs: Option<Vec<String>>,
    ) -> PyResult<Self> {
        let reading = Reading {
            limit: max_read.map_or_else(ReadLimit::default, ReadLimit::new),
            channels,
            units,
            rate,
            ..Reading::default()
        };
        let read = py.detach(|| {
            let mut read = recording::Recording::read_channels(&path, &reading)?;
            if let Some(inputs) = &inputs {
                read.arrange_controls(inputs.iter().map(String::as_str))?;
            }
            Ok(read)
        });
        read.map(Self::of)
            .map_err(|error| refused_of(&path, &error))
    }

    /// A recording of columns whose names are those of a file: `time_s`, `displacement_mm`, `force_N`.
    #[staticmethod]
    #[pyo3(signature = (name, columns, needs_force=true))]
    fn of_columns(
        py: Python<'_>,
        name: String,
        columns: Vec<(String, PyReadonlyArray1<'_, f64>)>,
        needs_force: bool,
    ) -> PyResult<Self> {
        let columns: Vec<(String, Vec<f64>)> = columns
            .into_iter()
            .map(|(name, values)| (name, values.as_array().to_vec()))
            .collect();
        let made = py.detach(|| match needs_force {
            true => recording::Recording::of_columns(name, columns, &Reading::default()),
            false => recording::Recording::motion_of_columns(name, columns, &Reading::default()),
        });
        made.map(Self::of).map_err(|error| refused(&error))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    fn __len__(&self) -> usize {
        self.inner.len()
    }

    /// Of the rows that it was made of, counted from 0, those that are samples.
    fn rows<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let rows: Vec<i64> = self.inner.rows().map(|row| row as i64).collect();
        rows.into_pyarray(py)
    }

    /// Its channels under the names of their columns, in s, mm, kN, mm/s and °C.
    fn columns<'py>(&self, py: Python<'py>) -> Vec<(String, Bound<'py, PyArray1<f64>>)> {
        let recording = &*self.inner;
        let channels = [
            ("time_s", Some(&recording.time)),
            ("displacement_mm", Some(&recording.displacement)),
            ("force_kN", Some(&recording.force)),
            ("velocity_mm_s", recording.velocity.as_ref()),
            ("temperature_degC", recording.temperature.as_ref()),
        ];
        let channels = channels
            .into_iter()
            .filter_map(|(name, channel)| Some((name.to_owned(), channel?)));
        let controls = recording.controls.iter();
        let controls = controls.map(|control| (control.name.clone(), &control.values));
        channels
            .chain(controls)
            .map(|(name, values)| (name, values.clone().into_pyarray(py)))
            .collect()
    }
}

/// The units that each channel may have, as a column's name carries them.
#[pyfunction]
fn units() -> Vec<(&'static str, Vec<&'static str>)> {
    Channel::ALL
        .into_iter()
        .map(|channel| {
            let units = channel.units().iter().map(|unit| unit.symbol);
            (channel.name(), units.collect())
        })
        .collect()
}

/// How many kN a unit of force is, which must be one of [`units`].
#[pyfunction]
fn kilonewtons(unit: &str) -> PyResult<f64> {
    let mut known = Channel::Force.units().iter();
    let found = known.find(|each| each.symbol == unit).ok_or_else(|| {
        let problem = format!("unknown unit {unit:?} of force");
        let mend = format!("name it as one of {}", Channel::Force.column_names());
        refused(&InputError::new("units", problem, mend))
    });
    found.map(|unit| unit.scale)
}

/// Refuses a file that is given twice.
#[pyfunction]
fn refuse_repeats(paths: Vec<PathBuf>) -> PyResult<()> {
    recording::refuse_repeats(&paths).map_err(|error| refused(&error))
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Recording>()?;
    module.add_function(wrap_pyfunction!(units, module)?)?;
    module.add_function(wrap_pyfunction!(kilonewtons, module)?)?;
    module.add_function(wrap_pyfunction!(refuse_repeats, module)?)
}
