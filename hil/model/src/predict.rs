//! The force that a model predicts for a recorded motion, computed by the crate.

use mesh_damper::effects::{AugmentedState, CONTROLS, Motion};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::real::Real;
use mesh_damper_recording::trajectory::Trajectory;

use crate::{Model, ModelError};

/// The model's force in kN at every sample of `trajectory`, in f64 as identification fitted it, and as the recording's force
/// channel would show it.
///
/// # Errors
/// A model that the crate refuses.
pub fn predict(model: &Model, trajectory: &Trajectory) -> Result<Vec<f64>, ModelError> {
    Ok(trajectory.shown(run(model, trajectory, |force, _| force)?))
}

/// As [`predict`], with one more step between each two samples, at the interpolated motion. The error of the steps is the
/// difference from [`predict`] plus a third of that.
///
/// # Errors
/// A model that the crate refuses.
pub fn predict_in_half_steps(
    model: &Model,
    trajectory: &Trajectory,
) -> Result<Vec<f64>, ModelError> {
    let step = 0.5 * trajectory.tick;
    Ok(trajectory.shown(run_by(step, model, trajectory, |force, _| force)?))
}

/// A normal variable lies within this many deviations of its mean in 90 % of the cases: the quantile.
pub const NINETY_PERCENT: f64 = 1.645;

/// Half width in kN of the band about the model's force at every sample of `trajectory`. In 90 % of the cases the band contains the
/// model's force along the true motion, which was estimated from a noisy displacement. The band does not include the model's own
/// error.
///
/// # Errors
/// A model that the crate refuses.
pub fn band(model: &Model, trajectory: &Trajectory) -> Result<Vec<f64>, ModelError> {
    let force = predict(model, trajectory)?;
    let other = predict(model, &trajectory.as_it_may_be())?;
    let off: Vec<f64> = other
        .iter()
        .zip(force)
        .map(|(other, force)| other - force)
        .collect();
    let variance = trajectory.variance_of(&off);
    Ok(variance
        .into_iter()
        .map(|variance| NINETY_PERCENT * variance.sqrt())
        .collect())
}

/// The motion in the middle of a step of `tick` s, by cubics through both ends and their slopes.
fn halfway(from: &Motion<f64>, to: &Motion<f64>, tick: f64) -> Motion<f64> {
    let middle = |from: f64, to: f64| 0.5 * (from + to);
    let bent = |from_slope: f64, to_slope: f64| 0.125 * tick * (from_slope - to_slope);
    Motion {
        displacement: middle(from.displacement, to.displacement) + bent(from.velocity, to.velocity),
        velocity: middle(from.velocity, to.velocity) + bent(from.acceleration, to.acceleration),
        acceleration: middle(from.acceleration, to.acceleration),
        cycles: middle(from.cycles, to.cycles),
        temperature: middle(from.temperature, to.temperature),
        controls: to.controls,
    }
}

/// Calls `observe` with the force in kN and the effects' state at every sample of `trajectory`, and collects its results.
///
/// # Errors
/// A model that the crate refuses.
pub fn run<T>(
    model: &Model,
    trajectory: &Trajectory,
    observe: impl Fn(f64, &AugmentedState<f64>) -> T,
) -> Result<Vec<T>, ModelError> {
    run_by(trajectory.tick, model, trajectory, observe)
}

/// As [`run`], in steps of `step` s: either the recording's step, or half of it with one more step between each two samples.
fn run_by<T>(
    step: f64,
    model: &Model,
    trajectory: &Trajectory,
    observe: impl Fn(f64, &AugmentedState<f64>) -> T,
) -> Result<Vec<T>, ModelError> {
    let mut amplitude = trajectory.amplitude[0];
    let mut law = model.augmented::<f64>(amplitude, step)?;
    let mut state = law.at_rest();
    (0..trajectory.len())
        .map(|index| {
            if trajectory.amplitude[index] != amplitude {
                amplitude = trajectory.amplitude[index];
                law.set_law(model.law_at(amplitude)?);
            }
            let now = motion_at(trajectory, index);
            if step < trajectory.tick && index > 0 {
                let before = motion_at(trajectory, index - 1);
                law.force(&mut state, &halfway(&before, &now, trajectory.tick));
            }
            let force = law.force(&mut state, &now);
            Ok(observe(force, &state))
        })
        .collect()
}

/// As [`predict`], by the firmware's computation at the recording's tick: f32 throughout, with the damping from a table.
///
/// # Errors
/// A model that the crate refuses.
pub fn predict_embedded(model: &Model, trajectory: &Trajectory) -> Result<Vec<f64>, ModelError> {
    let mut amplitude = trajectory.amplitude[0];
    let mut law = FastLaw::new(model.augmented(amplitude, trajectory.tick)?);
    let mut running = RunningLaw::new(law.clone());
    let force = (0..trajectory.len())
        .map(|index| {
            if trajectory.amplitude[index] != amplitude {
                amplitude = trajectory.amplitude[index];
                law.set_law(model.law_at(amplitude)?);
                running.swap(law.clone());
                running.boundary();
            }
            Ok(f64::from(running.force(&motion_at(trajectory, index))))
        })
        .collect::<Result<_, ModelError>>()?;
    Ok(trajectory.shown(force))
}

/// The law's inputs at one sample, with the control inputs in the order of the trajectory.
#[inline]
pub fn motion_at<R: Real>(trajectory: &Trajectory, index: usize) -> Motion<R> {
    Motion {
        displacement: R::from_f64(trajectory.motion.displacement[index]),
        velocity: R::from_f64(trajectory.motion.velocity[index]),
        acceleration: R::from_f64(trajectory.motion.acceleration[index]),
        cycles: R::from_f64(trajectory.cycles[index]),
        temperature: R::from_f64(trajectory.temperature_at(index)),
        controls: controls_at(trajectory, index),
    }
}

/// The first control inputs of the trajectory, with 0 for each one that is absent.
#[inline]
fn controls_at<R: Real>(trajectory: &Trajectory, index: usize) -> [R; CONTROLS] {
    let mut controls = [R::ZERO; CONTROLS];
    for (control, channel) in controls.iter_mut().zip(trajectory.controls.iter()) {
        *control = R::from_f64(channel.values[index]);
    }
    controls
}

/// RMS of the error over the RMS of the measured force, for the samples that `included` picks.
pub fn nrmse(predicted: &[f64], measured: &[f64], included: impl Fn(usize) -> bool) -> f64 {
    let (error, force) = (0..measured.len()).filter(|&index| included(index)).fold(
        (0.0, 0.0),
        |(error, force), index| {
            let difference = predicted[index] - measured[index];
            (
                error + difference * difference,
                force + measured[index] * measured[index],
            )
        },
    );
    (error / force).sqrt()
}
