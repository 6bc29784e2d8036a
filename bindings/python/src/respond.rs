//! The motion of a mass on a damper.

use mesh_damper_model::Model as Law;
use mesh_damper_model::respond::{
    EnergyBalance, Excitation, LeftOut, Moment, Settings, SweepRange, respond as integrate,
    sweep as steady,
};
use mesh_damper_output::error::InputError;
use mesh_damper_recording::input::InputSignal;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::control::ControlChannel;
use numpy::IntoPyArray as _;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use crate::error::{refused, refused_of};
use crate::model::{Model, json};
use crate::recording::{Given, Reading, given_columns};
use crate::work::beside;

/// A force on the mass or a displacement of its base, at equal steps of time.
#[pyclass(frozen, module = "mesh_damper._core")]
pub struct Drive {
    signal: InputSignal,
    is_force: bool,
}

#[pymethods]
impl Drive {
    /// Reads a file as `hil respond` does.
    #[staticmethod]
    fn read(
        py: Python<'_>,
        path: std::path::PathBuf,
        reading: PyRef<'_, Reading>,
        is_force: bool,
    ) -> PyResult<Self> {
        let said = &reading.said;
        let signal = py.detach(|| InputSignal::read(&path, channel(is_force), said));
        let signal = signal.map_err(|error| refused_of(&path, &error))?;
        Ok(Self { signal, is_force })
    }

    /// Reads columns in memory like a file with the same columns.
    #[staticmethod]
    fn of_columns(
        py: Python<'_>,
        name: String,
        columns: Vec<Given<'_>>,
        reading: PyRef<'_, Reading>,
        is_force: bool,
    ) -> PyResult<Self> {
        let columns = given_columns(columns);
        let (said, unmarked) = (&reading.said, reading.needs_of_columns().unmarked);
        let read = || InputSignal::of_columns(name, columns, channel(is_force), said, unmarked);
        let signal = py.detach(read);
        let signal = signal.map_err(|error| refused(&error))?;
        Ok(Self { signal, is_force })
    }

    #[getter]
    fn name(&self) -> &str {
        &self.signal.name
    }

    /// Guesses about columns, in words.
    fn guesses(&self) -> Vec<String> {
        self.signal.guesses.clone()
    }

    /// Units that were assumed, in words.
    fn assumed(&self) -> Option<&str> {
        self.signal.assumed.as_deref()
    }
}

fn channel(is_force: bool) -> Channel {
    match is_force {
        true => Channel::Force,
        false => Channel::Displacement,
    }
}

/// A channel of a response.
type Of = fn(&Moment) -> f64;

/// Information about a response other than its motion.
#[derive(Serialize)]
struct Summary<'a> {
    step: f64,
    change_on_halving: f64,
    settled: bool,
    model_mass: f64,
    energy: EnergyBalance,
    left_out: &'a [LeftOut],
    warnings: Vec<String>,
}

/// The motion of `mass` kg on the damper as columns, and information about it as JSON.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "the Python function before it names them"
)]
fn respond<'py>(
    py: Python<'py>,
    model: PyRef<'py, Model>,
    drive: PyRef<'py, Drive>,
    mass: f64,
    with_offset: bool,
    tolerance: Option<f64>,
    controls: Vec<(String, f64)>,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyDict>, String)> {
    let settings = Settings {
        offset: with_offset,
        tolerance: tolerance.unwrap_or(Settings::TOLERANCE),
        ..Settings::new(mass)
    };
    let file = model.inner.clone();
    let law = file.model();
    let signal = drive.signal.clone();
    let is_force = drive.is_force;
    let known = (signal.name.as_str(), signal.controls.as_slice());
    let given = held_controls(&law, known, &controls, signal.values.len())?;
    let mut warnings: Vec<String> = Vec::new();
    for (channel, control) in given.iter().zip(&law.controls) {
        warnings.extend(control.beyond(&channel.values));
    }
    warnings.extend(signal.warning.clone());
    let excitation = match is_force {
        true => Excitation::force(signal.tick, signal.values.clone()),
        false => Excitation::base(signal.tick, signal.values.clone()),
    }
    .with_temperature(signal.temperature.clone())
    .with_controls(given.into_iter().map(|each| each.values).collect());
    let moved = beside(py, progress.as_ref(), move |step| {
        step("integrating the motion");
        integrate(&law, &excitation, &settings)
    })?;
    let response = moved.map_err(|error| refused(&error.about(&model.name)))?;
    if !response.settled {
        warnings.push(format!(
            "displacements still change by {:.2} % if the time step of {:.1e} s is halved: the motion may depend on the time step",
            100.0 * response.change,
            2.0 * response.step
        ));
    }
    let outside = response.extrapolation(&file.fitted_range());
    warnings.extend(outside.in_words("samples", &model.name));

    let moments = &response.moments;
    let columns = PyDict::new(py);
    let time = (0..moments.len()).map(|index| signal.start + index as f64 * signal.tick);
    columns.set_item("time_s", time.collect::<Vec<f64>>().into_pyarray(py))?;
    let channels: [(&str, Of); 6] = [
        ("displacement_mm", |m| m.relative_displacement),
        ("velocity_mm_s", |m| m.relative_velocity),
        ("force_kN", |m| m.force),
        ("mass_displacement_mm", |m| m.displacement),
        ("mass_velocity_mm_s", |m| m.velocity),
        ("mass_acceleration_mm_s2", |m| m.acceleration),
    ];
    for (name, channel) in channels {
        let values: Vec<f64> = moments.iter().map(channel).collect();
        columns.set_item(name, values.into_pyarray(py))?;
    }
    let driving = match is_force {
        true => "applied_force_kN",
        false => "base_displacement_mm",
    };
    columns.set_item(driving, signal.values.clone().into_pyarray(py))?;
    let summary = Summary {
        step: response.step,
        change_on_halving: response.change,
        settled: response.settled,
        model_mass: response.model_mass,
        energy: response.energy,
        left_out: &response.left_out,
        warnings,
    };
    Ok((columns, json(&summary)?))
}

/// The steady motions of `mass` kg on a base that moves in sines, as JSON.
#[pyfunction]
#[expect(
    clippy::too_many_arguments,
    reason = "the Python function before it names them"
)]
fn sweep(
    py: Python<'_>,
    model: PyRef<'_, Model>,
    mass: f64,
    amplitudes: Vec<f64>,
    range: (f64, f64, usize),
    with_offset: bool,
    controls: Vec<(String, f64)>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<String> {
    let (from, to, points) = range;
    let law = model.inner.model();
    let mut settings = Settings {
        offset: with_offset,
        ..Settings::new(mass)
    };
    let held = held_controls(&law, (&model.name, &[]), &controls, 1)?;
    for (place, control) in settings.controls.iter_mut().zip(held) {
        *place = control.values[0];
    }
    let range = SweepRange { from, to, points };
    let total = amplitudes.len() * points;
    let found = beside(py, progress.as_ref(), move |step| {
        steady(&law, &settings, &amplitudes, range, &mut |done| {
            step(&format!("{done} of {total} motions"));
        })
    })?;
    json(&found.map_err(|error| refused(&error.about(&model.name)))?)
}

/// The control inputs of `model` in their order, `count` samples each: the given ones, or the columns `known` of `file`.
fn held_controls(
    model: &Law,
    (file, known): (&str, &[ControlChannel]),
    given: &[(String, f64)],
    count: usize,
) -> PyResult<Vec<ControlChannel>> {
    model
        .held_controls((file, known), given, count)
        .map_err(|error: InputError| refused(&error))
}

pub fn add_to(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Drive>()?;
    module.add_function(wrap_pyfunction!(respond, module)?)?;
    module.add_function(wrap_pyfunction!(sweep, module)?)
}
