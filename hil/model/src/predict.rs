//! The force that a model predicts for a recorded motion, computed by the crate.

use mesh_damper::effects::{AugmentedState, CONTROLS, Motion};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::real::Real;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::Stride;

use crate::file::Elsewhere;
use crate::{Model, ModelError};

/// The model's force in kN at every sample of `trajectory`, in f64 as identification fitted it, and as the recording's force
/// channel would show it.
///
/// # Errors
/// A model that the crate refuses.
pub fn predict(model: &Model, trajectory: &Trajectory) -> Result<Vec<f64>, ModelError> {
    Ok(trajectory.shown(run(model, trajectory, |force, _| force)?))
}

/// As [`predict`], at the samples that `strides` visit, in steps from one to the next; 0 elsewhere. No effect of the model counts
/// ticks, and the force channel shows no averages.
///
/// # Errors
/// A model that the crate refuses at the trajectory's tick or at that of one of the strides.
pub fn predict_along(
    model: &Model,
    trajectory: &Trajectory,
    strides: &[Stride],
) -> Result<Vec<f64>, ModelError> {
    // An effect that is too slow for the recorded steps may run in long ones.
    model.augmented::<f64>(trajectory.amplitude[0], trajectory.tick)?;
    let mut force = vec![0.0; trajectory.len()];
    let mut state = None;
    for stride in strides {
        let mut amplitude = trajectory.amplitude[stride.samples.start];
        let tick = stride.step as f64 * trajectory.tick;
        let mut law = model.augmented::<f64>(amplitude, tick)?;
        let state = state.get_or_insert_with(|| law.at_rest());
        for sample in stride.visits() {
            if trajectory.amplitude[sample] != amplitude {
                amplitude = trajectory.amplitude[sample];
                law.set_law(model.law_at(amplitude)?);
            }
            force[sample] = law.force(state, &motion_at(trajectory, sample));
        }
    }
    Ok(force)
}

/// As [`predict`], with twice as many steps, at the interpolated motion. The error of the steps is the difference from [`predict`]
/// plus a third of that.
///
/// # Errors
/// A model that the crate refuses.
pub fn predict_in_half_steps(
    model: &Model,
    trajectory: &Trajectory,
) -> Result<Vec<f64>, ModelError> {
    let steps = 2 * steps_for(model, trajectory)?;
    Ok(trajectory.shown(run_by(steps, model, trajectory, |force, _| force)?))
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

/// The [`band`] of noise, with the error of the model itself: half the width in kN of what holds nine of ten errors at every sample of
/// `trajectory`, for which the model predicts `force`. Its own errors are those on motions that it was not fitted to, relative to the RMS
/// force of a block of cycles, or of the whole trajectory where there is none.
pub fn whole_band(
    of_noise: &[f64],
    elsewhere: &Elsewhere,
    trajectory: &Trajectory,
    force: &[f64],
) -> Vec<f64> {
    let half = |force: &[f64]| {
        let squares: f64 = force.iter().map(|force| force * force).sum();
        elsewhere.most * (squares / force.len().max(1) as f64).sqrt()
    };
    let mut own = vec![half(force); force.len()];
    for block in trajectory
        .blocks
        .iter()
        .filter(|block| !block.cycles.is_empty())
    {
        let of_block = half(&force[block.samples.clone()]);
        own[block.samples.clone()].fill(of_block);
    }
    let pairs = own.iter().zip(of_noise);
    pairs.map(|(own, noise)| own.hypot(*noise)).collect()
}

/// More steps than this between two samples are not tried. Convention: a second at 20 Hz becomes one at 1280 Hz.
const MOST_STEPS: u32 = 64;

/// The number of steps from one sample to the next: one, or the fewest with which the crate runs the model. A recording may be slower
/// than the effects of a model that was fitted to a faster one.
///
/// # Errors
/// A model that the crate refuses with any number.
fn steps_for(model: &Model, trajectory: &Trajectory) -> Result<u32, ModelError> {
    let runs = |steps: u32| {
        let law =
            model.augmented::<f64>(trajectory.amplitude[0], trajectory.tick / f64::from(steps));
        law.map(|_| steps)
    };
    runs(1).or_else(|refused| {
        let mut more = (2..=MOST_STEPS).filter_map(|steps| runs(steps).ok());
        more.next().ok_or(refused)
    })
}

/// The motion at this `part` of the time from one sample to the next, `tick` s, by cubics through both ends and their slopes.
fn between(from: &Motion<f64>, to: &Motion<f64>, part: f64, tick: f64) -> Motion<f64> {
    let rest = 1.0 - part;
    let line = |from: f64, to: f64| rest * from + part * to;
    let cubic = |[from, from_slope]: [f64; 2], [to, to_slope]: [f64; 2]| {
        rest * rest * ((1.0 + 2.0 * part) * from + part * tick * from_slope)
            + part * part * ((1.0 + 2.0 * rest) * to - rest * tick * to_slope)
    };
    Motion {
        displacement: cubic(
            [from.displacement, from.velocity],
            [to.displacement, to.velocity],
        ),
        velocity: cubic(
            [from.velocity, from.acceleration],
            [to.velocity, to.acceleration],
        ),
        acceleration: line(from.acceleration, to.acceleration),
        cycles: line(from.cycles, to.cycles),
        temperature: line(from.temperature, to.temperature),
        controls: to.controls,
    }
}

/// The motions of the steps that end at a sample.
fn motions(
    trajectory: &Trajectory,
    index: usize,
    steps: u32,
) -> impl Iterator<Item = Motion<f64>> + '_ {
    let now = motion_at(trajectory, index);
    let before = index.checked_sub(1).filter(|_| steps > 1);
    let before = before.map(|before| motion_at(trajectory, before));
    let inner = before.into_iter().flat_map(move |before| {
        (1..steps).map(move |step| {
            let part = f64::from(step) / f64::from(steps);
            between(&before, &now, part, trajectory.tick)
        })
    });
    inner.chain([now])
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
    run_by(steps_for(model, trajectory)?, model, trajectory, observe)
}

/// As [`run`], in this many steps from one sample to the next.
fn run_by<T>(
    steps: u32,
    model: &Model,
    trajectory: &Trajectory,
    observe: impl Fn(f64, &AugmentedState<f64>) -> T,
) -> Result<Vec<T>, ModelError> {
    let mut amplitude = trajectory.amplitude[0];
    let mut law = model.augmented::<f64>(amplitude, trajectory.tick / f64::from(steps))?;
    let mut state = law.at_rest();
    (0..trajectory.len())
        .map(|index| {
            if trajectory.amplitude[index] != amplitude {
                amplitude = trajectory.amplitude[index];
                law.set_law(model.law_at(amplitude)?);
            }
            let forces = motions(trajectory, index, steps).map(|now| law.force(&mut state, &now));
            let force = forces.last().unwrap_or_default();
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
    let steps = steps_for(model, trajectory)?;
    let step = trajectory.tick / f64::from(steps);
    let mut law = FastLaw::new(model.augmented(amplitude, step)?);
    let mut running = RunningLaw::new(law.clone());
    let force = (0..trajectory.len())
        .map(|index| {
            if trajectory.amplitude[index] != amplitude {
                amplitude = trajectory.amplitude[index];
                law.set_law(model.law_at(amplitude)?);
                running.swap(law.clone());
                running.boundary();
            }
            let forces = motions(trajectory, index, steps).map(|now| running.force(&rounded(&now)));
            Ok(f64::from(forces.last().unwrap_or_default()))
        })
        .collect::<Result<_, ModelError>>()?;
    Ok(trajectory.shown(force))
}

/// The law's inputs at one sample, with the control inputs in the order of the trajectory.
#[inline(always)]
pub fn motion_at<R: Real>(trajectory: &Trajectory, index: usize) -> Motion<R> {
    rounded(&Motion {
        displacement: trajectory.motion.displacement[index],
        velocity: trajectory.motion.velocity[index],
        acceleration: trajectory.motion.acceleration[index],
        cycles: trajectory.cycles[index],
        temperature: trajectory.temperature_at(index),
        controls: controls_at(trajectory, index),
    })
}

/// The same inputs in another float.
#[inline(always)]
fn rounded<R: Real>(motion: &Motion<f64>) -> Motion<R> {
    Motion {
        displacement: R::from_f64(motion.displacement),
        velocity: R::from_f64(motion.velocity),
        acceleration: R::from_f64(motion.acceleration),
        cycles: R::from_f64(motion.cycles),
        temperature: R::from_f64(motion.temperature),
        controls: motion.controls.map(R::from_f64),
    }
}

/// The first control inputs of the trajectory, with 0 for each one that is absent.
#[inline(always)]
fn controls_at(trajectory: &Trajectory, index: usize) -> [f64; CONTROLS] {
    let mut controls = [0.0; CONTROLS];
    for (control, channel) in controls.iter_mut().zip(trajectory.controls.iter()) {
        *control = channel.values[index];
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::f64::consts::TAU;

    use mesh_damper_recording::Recording;
    use mesh_damper_recording::trajectory::strides::strides;

    use super::*;
    use crate::{AddedEffect, Family, LawNode};

    /// A branch behind a law of two amplitudes, along steps of different lengths.
    #[test]
    fn a_prediction_along_strides_is_that_of_every_sample() {
        let branch = AddedEffect {
            family: Family::named("relaxation").unwrap(),
            parameters: BTreeMap::from([("stiffness".to_owned(), 1.5), ("time".to_owned(), 0.05)]),
        };
        let node = |amplitude: f64, k1: f64| LawNode {
            amplitude,
            k1,
            k3: 2.0,
            c: 0.05,
            alpha: 0.4,
        };
        let model = Model {
            law: vec![node(0.1, 3.0), node(0.3, 2.0)],
            effects: vec![branch],
            correction: None,
            controls: Vec::new(),
        };
        let displacement: Vec<f64> = (0..16_000)
            .map(|n| {
                let (amplitude, hertz) = if n < 8000 { (0.1, 0.5) } else { (0.3, 2.0) };
                amplitude * (TAU * hertz * f64::from(n) / 1000.0).sin()
            })
            .collect();
        let force = displacement.clone();
        let trajectory = Trajectory::new("two", 1e-3, &displacement, force, None, None);
        let few = strides(std::slice::from_ref(&trajectory), 1, |_, _| true).remove(0);
        let visited: Vec<usize> = few.iter().flat_map(Stride::visits).collect();
        assert!(visited.len() < trajectory.len() / 4);
        let each = predict(&model, &trajectory).unwrap();
        let along = predict_along(&model, &trajectory, &few).unwrap();
        for &sample in &visited {
            let off = (along[sample] - each[sample]).abs();
            assert!(off < 2e-3, "{sample}: {off} kN of 0.7 kN");
        }
        let whole = Stride::each(trajectory.len());
        assert_eq!(predict_along(&model, &trajectory, &whole).unwrap(), each);
    }

    /// Two blocks of sines: the band is the same part of each block's force.
    #[test]
    fn a_models_own_band_follows_the_force_of_the_block() {
        let time: Vec<f64> = (0..8000).map(|index| f64::from(index) / 500.0).collect();
        let amplitude = |t: f64| if t < 8.0 { 0.1 } else { 0.3 };
        let displacement: Vec<f64> = time
            .iter()
            .map(|&t| amplitude(t) * (TAU * 2.0 * t).sin())
            .collect();
        let force: Vec<f64> = displacement.iter().map(|y| 2.0 * y).collect();
        let recording = Recording::new("two", time, displacement, force.clone()).unwrap();
        let trajectory = Trajectory::of(&recording).unwrap();
        assert_eq!(trajectory.blocks.len(), 2);
        let elsewhere = Elsewhere {
            conditions: 3,
            most: 0.1,
        };
        let of_noise = vec![0.0; force.len()];
        let band = whole_band(&of_noise, &elsewhere, &trajectory, &force);
        for (sample, force) in [(2000, 0.2), (6000, 0.6)] {
            let expected = 0.1 * force / f64::sqrt(2.0);
            assert!(
                (band[sample] / expected - 1.0).abs() < 0.02,
                "{sample}: {}",
                band[sample]
            );
        }
    }
}
