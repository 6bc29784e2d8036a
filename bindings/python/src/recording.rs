//! Recordings of files and of columns.

use std::path::PathBuf;
use std::sync::Arc;

use mesh_damper_output::error::InputError;
use mesh_damper_recording as recording;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::files::{self, Column, GivenColumn, Needs, Unmarked};
use mesh_damper_tables::read_limit::ReadLimit;
use mesh_damper_tables::units::Units;
use numpy::{IntoPyArray as _, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::error::{refused, refused_of};

/// The settings of recordings, and the channels that they must have.
#[pyclass(frozen, module = "mesh_damper._core")]
pub struct Reading {
    pub said: files::Reading,
    pub needs: Needs,
}

#[pymethods]
impl Reading {
    /// The values of the command's options `--channel`, `--unit`, `--rate`, `--table`, `--decimal` and `--max-read`. The `system` of
    /// units applies to channels whose unit nothing else states. `step` is the time between samples in the unit of time, in place of
    /// the `rate`. If `inputs` are given, only these control inputs are read, and each must be there.
    #[new]
    #[pyo3(signature = (
        channels=vec![], units=vec![], system=None, step=None, rate=None, table=None, decimal=None, inputs=None, max_read=None,
        needs_force=true,
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "the Python function before it names them"
    )]
    fn new(
        channels: Vec<(String, String)>,
        units: Vec<(String, String)>,
        system: Option<&str>,
        step: Option<f64>,
        rate: Option<f64>,
        table: Option<String>,
        decimal: Option<Bound<'_, PyAny>>,
        inputs: Option<Vec<String>>,
        max_read: Option<u64>,
        needs_force: bool,
    ) -> PyResult<Self> {
        let needs = Needs {
            inputs,
            unmarked: match system {
                Some("SI") => Unmarked::Stated(Units::SI),
                Some("mm-kN-s") => Unmarked::Stated(Units::default()),
                Some(other) => {
                    let problem = format!("no system is called '{other}'");
                    let remedy = "give \"SI\", \"mm-kN-s\" or a unit for each channel";
                    return Err(refused(&InputError::new("units", problem, remedy)));
                }
                None => Unmarked::Refused,
            },
            ..match needs_force {
                true => Needs::default(),
                false => Needs::motion(),
            }
        };
        let said = files::Reading {
            limit: max_read.map_or_else(ReadLimit::default, ReadLimit::new),
            channels,
            units,
            rate: rate.map(sampling_rate).transpose()?,
            table,
            decimal: decimal.as_ref().map(decimal_sign).transpose()?,
        };
        let mut reading = Self { said, needs };
        if let Some(step) = step {
            let seconds = step * reading.scale("time")?.unwrap_or(1.0);
            if !(seconds.is_finite() && seconds > 0.0) {
                let problem = format!("{step} is not a valid time between samples");
                let remedy = "give a number above 0, or the times of the samples";
                return Err(refused(&InputError::new("time", problem, remedy)));
            }
            reading.said.rate = Some(1.0 / seconds);
        }
        Ok(reading)
    }

    /// Size of the stated unit of a channel, in s, mm, kN or mm/s; `None` if no unit is stated.
    fn scale(&self, channel: &str) -> PyResult<Option<f64>> {
        let mut all = Channel::ALL.into_iter();
        let Some(channel) = all.find(|each| each.name() == channel) else {
            return Ok(None);
        };
        let mut said = self.said.units.iter();
        match (
            said.rfind(|(of, _)| of == channel.name()),
            self.needs.unmarked,
        ) {
            (Some((_, written)), _) => {
                let unit = channel.unit_written(written).ok_or_else(|| {
                    let units: Vec<&str> = channel.units().iter().map(|unit| unit.symbol).collect();
                    let problem = format!("unknown unit {written:?} of {}", channel.name());
                    let remedy = format!("give one of {}", units.join(", "));
                    refused(&InputError::new("units", problem, remedy))
                })?;
                Ok(Some(unit.scale))
            }
            (None, Unmarked::Stated(units)) => Ok(Some(channel.unit_in(&units).scale)),
            (None, _) => Ok(None),
        }
    }
}

impl Reading {
    /// The same for columns in memory, whose unit is assumed if nothing states it.
    pub fn needs_of_columns(&self) -> Needs {
        let unmarked = match self.needs.unmarked {
            Unmarked::Refused => Unmarked::Assumed(Units::default()),
            said => said,
        };
        Needs {
            unmarked,
            ..self.needs.clone()
        }
    }
}

/// A possible number of samples per second.
fn sampling_rate(rate: f64) -> PyResult<f64> {
    if rate.is_finite() && rate > 0.0 {
        return Ok(rate);
    }
    let problem = format!("{rate} is not a valid sampling rate");
    let remedy = "give samples per second, a finite number above 0";
    Err(refused(&InputError::new("rate", problem, remedy)))
}

/// The sign that is called `point` or `comma`.
fn decimal_sign(called: &Bound<'_, PyAny>) -> PyResult<char> {
    match called.extract::<String>().as_deref() {
        Ok("point") => Ok('.'),
        Ok("comma") => Ok(','),
        _ => {
            let problem = format!("no decimal sign is called {}", called.repr()?);
            let remedy = "give \"point\" or \"comma\"";
            Err(refused(&InputError::new("decimal", problem, remedy)))
        }
    }
}

/// The values of a column, or the reason why they are not numbers.
#[derive(FromPyObject)]
pub enum GivenValues<'py> {
    Numbers(PyReadonlyArray1<'py, f64>),
    Words(String),
}

/// A column with its name, whether its values are dates or durations in seconds after the first, and whether it is the index of its
/// frame.
pub type Given<'py> = (String, GivenValues<'py>, bool, bool);

/// The columns in the form of the core.
pub fn given_columns(columns: Vec<Given<'_>>) -> Vec<GivenColumn> {
    let column = |(name, values, is_stamp, is_index): Given<'_>| GivenColumn {
        column: Column {
            name,
            unit: is_stamp.then(|| "s".into()),
            is_stamp,
            is_time: is_stamp && is_index,
            ..Column::default()
        },
        values: match values {
            GivenValues::Numbers(values) => Ok(values.as_array().to_vec()),
            GivenValues::Words(problem) => Err(problem),
        },
    };
    columns.into_iter().map(column).collect()
}

/// Motion and force over time, in the form of the core.
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
    /// Reads the recording in a file, as `hil trace` does.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, reading: PyRef<'_, Reading>) -> PyResult<Self> {
        let (said, needs) = (&reading.said, &reading.needs);
        let read = py.detach(|| recording::Recording::read_for(&path, said, needs));
        read.map(Self::of)
            .map_err(|error| refused_of(&path, &error))
    }

    /// Reads the recording in columns in memory like a recording in a file with the same columns.
    #[staticmethod]
    fn of_columns(
        py: Python<'_>,
        name: String,
        columns: Vec<Given<'_>>,
        reading: PyRef<'_, Reading>,
    ) -> PyResult<Self> {
        let columns = given_columns(columns);
        let (said, needs) = (&reading.said, &reading.needs_of_columns());
        let made = py.detach(|| recording::Recording::of_columns_for(name, columns, said, needs));
        made.map(Self::of).map_err(|error| refused(&error))
    }

    /// Guesses about columns, in words.
    fn guesses(&self) -> Vec<String> {
        self.inner.guesses().to_vec()
    }

    /// Units that were assumed, in words.
    fn assumed(&self) -> Option<&str> {
        self.inner.assumed()
    }

    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    fn __len__(&self) -> usize {
        self.inner.len()
    }

    /// The rows, counted from 0, that are samples of the recording.
    fn rows<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let rows: Vec<i64> = self.inner.rows().map(|row| row as i64).collect();
        rows.into_pyarray(py)
    }

    /// The channels under their column names, in s, mm, kN, mm/s and °C.
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

/// Refuses files that are given twice.
#[pyfunction]
fn refuse_repeats(paths: Vec<PathBuf>) -> PyResult<()> {
    recording::refuse_repeats(&paths).map_err(|error| refused(&error))
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Reading>()?;
    module.add_class::<Recording>()?;
    module.add_function(wrap_pyfunction!(refuse_repeats, module)?)
}
