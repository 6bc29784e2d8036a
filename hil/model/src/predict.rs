//! The force that a model gives for a recorded motion, evaluated by the crate.

use mesh_damper::effects::{AugmentedState, CONTROLS, Motion};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::real::Real;
use mesh_damper_recording::trajectory::Trajectory;

use crate::{Model, ModelError};

/// The model's force in kN at every sample of `trajectory` in f64, as identification fitted it and as the recording's channel
/// would show it.
///
/// # Errors
/// A model that the crate refuses.
pub fn predict(model: &Model, trajectory: &Trajectory) -> Result<Vec<f64>, ModelError> {
    Ok(trajectory.shown(run(model, trajectory, |force, _| force)?))
}

/// [`predict`] with a step more between any two samples, at a motion that is interpolated: by how much it differs from that is
/// by how much the steps themselves err, and a third of that again.
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

/// A normal variable is within this many deviations of its mean in 90 % of the cases. Derived: the quantile.
pub const NINETY_PERCENT: f64 = 1.645;

/// Half width of the band in kN about the model's force at every sample of `trajectory` that holds the model's force along the true motion
/// in 90 % of the cases: the motion was estimated from a noisy displacement. The model's own error is not in it.
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

/// The motion in the middle of a `tick` s, by cubics through both ends and their slopes.
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

/// What `seen` makes of the force in kN and the effects' state at every sample of `trajectory`.
///
/// # Errors
/// A model that the crate refuses.
pub fn run<T>(
    model: &Model,
    trajectory: &Trajectory,
    seen: impl Fn(f64, &AugmentedState<f64>) -> T,
) -> Result<Vec<T>, ModelError> {
    run_by(trajectory.tick, model, trajectory, seen)
}

/// [`run`] in steps of `step` s: the recording's, or half of it, with one more between any two samples.
fn run_by<T>(
    step: f64,
    model: &Model,
    trajectory: &Trajectory,
    seen: impl Fn(f64, &AugmentedState<f64>) -> T,
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
            Ok(seen(force, &state))
        })
        .collect()
}

/// The same by what the firmware runs, at the recording's tick: f32 throughout, the damping from a table.
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

/// What the law sees at one sample, its control inputs in the order of the trajectory.
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

/// The first of the control inputs; 0 in the place of one that there is none of.
#[inline]
fn controls_at<R: Real>(trajectory: &Trajectory, index: usize) -> [R; CONTROLS] {
    let mut controls = [R::ZERO; CONTROLS];
    for (control, channel) in controls.iter_mut().zip(trajectory.controls.iter()) {
        *control = R::from_f64(channel.values[index]);
    }
    controls
}

/// RMS of the error over the RMS of the measured force, over the samples that `included` picks.
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
