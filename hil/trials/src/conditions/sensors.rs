//! The sensors of a trial: the same for all of its recordings.

use mesh_damper_recording::Recording;
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use super::programme::Programme;
use crate::blind::{log_uniform, rms};

/// The true channels of a condition.
pub struct Truth {
    /// s, from 0
    pub time: Vec<f64>,
    /// mm
    pub displacement: Vec<f64>,
    /// kN
    pub force: Vec<f64>,
}

/// Noise and steps of both channels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sensors {
    /// RMS of the force's noise, kN.
    pub force_noise: f64,
    /// Step of the force, kN.
    pub force_step: f64,
    /// Force without load, kN.
    pub force_zero: f64,
    /// RMS of the displacement's noise, mm.
    pub displacement_noise: f64,
    /// Step of the displacement, mm.
    pub displacement_step: f64,
}

/// RMS of the force's noise over the RMS of the force in a middle recording: from a laboratory's load cell to one that is too large.
const FORCE_NOISE: (f64, f64) = (0.001, 0.02);
/// RMS of the displacement's noise over a middle amplitude.
const DISPLACEMENT_NOISE: (f64, f64) = (1e-4, 3e-3);
/// The force without load over the same RMS, in [`PART_WITH_ZERO`] of the trials: a tare that was forgotten.
const ZERO: f64 = 0.2;
const PART_WITH_ZERO: f64 = 0.2;
/// Range of a converter over the largest value that it sees.
const RANGE: (f64, f64) = (1.1, 4.0);

impl Sensors {
    /// For these `truths` of a programme.
    pub fn draw(programme: &Programme, truths: &[Truth], rng: &mut impl Rng) -> Self {
        let middle = |values: &mut dyn Iterator<Item = f64>| {
            let logs: Vec<f64> = values.map(f64::ln).collect();
            (logs.iter().sum::<f64>() / logs.len() as f64).exp()
        };
        let force = middle(&mut truths.iter().map(|truth| rms(&truth.force)));
        let amplitude = middle(&mut programme.all().map(|condition| condition.amplitude));
        let bits = *[12, 16, 16].choose(rng).unwrap_or(&16);
        let mut step = |channel: fn(&Truth) -> &Vec<f64>| {
            let values = truths.iter().flat_map(channel);
            let most = values.fold(0.0, |most: f64, value| most.max(value.abs()));
            2.0 * most * rng.random_range(RANGE.0..RANGE.1) / 2.0_f64.powi(bits)
        };
        let (force_step, displacement_step) = (step(|t| &t.force), step(|t| &t.displacement));
        let has_zero = rng.random_bool(PART_WITH_ZERO);
        Self {
            force_noise: force * log_uniform(FORCE_NOISE.0, FORCE_NOISE.1, rng),
            force_step,
            force_zero: if has_zero {
                force * rng.random_range(-ZERO..ZERO)
            } else {
                0.0
            },
            displacement_noise: amplitude
                * log_uniform(DISPLACEMENT_NOISE.0, DISPLACEMENT_NOISE.1, rng),
            displacement_step,
        }
    }

    /// The recording of `truth`; `None` if it does not move by a step of its sensor.
    pub fn record(&self, name: String, truth: Truth, rng: &mut impl Rng) -> Option<Recording> {
        let mut sensed = |values: Vec<f64>, zero: f64, noise: f64, step: f64| {
            let each = values.into_iter().map(|value| {
                let normal: f64 = StandardNormal.sample(rng);
                ((value + zero + noise * normal) / step).round() * step
            });
            each.collect::<Vec<f64>>()
        };
        let displacement = sensed(
            truth.displacement,
            0.0,
            self.displacement_noise,
            self.displacement_step,
        );
        let force = sensed(
            truth.force,
            self.force_zero,
            self.force_noise,
            self.force_step,
        );
        let moves = displacement.iter().any(|&y| y != displacement[0]);
        moves.then(|| {
            let recording = Recording::new(name, truth.time, displacement, force);
            recording.expect("a simulated recording is complete")
        })
    }
}
