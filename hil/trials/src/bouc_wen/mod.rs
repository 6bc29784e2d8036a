//! The Bouc–Wen benchmark of nonlinear identification: does a trace find the oscillator that produced a record of force and
//! displacement?
//!
//! Noël and Schoukens (2016), Hysteretic benchmark with a dynamic nonlinearity, Workshop on Nonlinear System Identification
//! Benchmarks, Brussels. The force is the input u; as a damper's law, m·y″ + c·y′ + k·y + z = u has `inertia`, `viscous`, k1 and
//! `stick_slip`. The model from the training record is judged by its force on the tests' motion, and by the displacement that it
//! simulates under the tests' force, which is the benchmark's own figure of merit.

mod signals;
mod system;

use std::ops::Range;

use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_identify::trace::{Trace, TraceError, trace};
use mesh_damper_model::Model;
use mesh_damper_model::predict::{nrmse, predict};
use mesh_damper_model::respond::{Excitation, Settings, respond};
use mesh_damper_output::error::InputError;
use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_tables::units::FORCE;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use serde::Serialize;

use signals::{RATE, multisine, sweep, sweep_time};
use system::OVERSAMPLING;

pub use system::System;

/// RMS of the noise on the training's displacement, m.
const NOISE: f64 = 8e-6;
/// Periods before a record begins: the slowest oscillation has decayed to e^(−27) after one of the benchmark's periods.
const SETTLING: usize = 1;

/// The contents and the length of the records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Programme {
    /// The oscillator.
    pub system: System,
    /// Samples in a period of a multisine.
    pub samples: usize,
    /// Periods of the training record.
    pub periods: usize,
    /// Rise of the sweep's frequency, Hz a minute.
    pub sweep_rate: f64,
    /// Seed of phases and noise.
    pub seed: u64,
}

impl Programme {
    /// The benchmark's programme.
    pub fn of_benchmark(seed: u64) -> Self {
        Self {
            system: System::BENCHMARK,
            samples: 8192,
            periods: 3,
            sweep_rate: 10.0,
            seed,
        }
    }
}

/// A record that is never fitted, and the samples of it that are judged.
#[derive(Clone, Debug)]
pub struct Test {
    /// `multisine` or `sweep`.
    pub name: &'static str,
    /// Without noise.
    pub recording: Recording,
    /// The judged samples: all except the beginning of a record of a steady motion, because a simulation from rest does not know
    /// its history.
    pub judged: Range<usize>,
}

/// The records of the benchmark.
#[derive(Clone, Debug)]
pub struct Records {
    /// With noise on the displacement.
    pub training: Recording,
    /// Without noise.
    pub tests: Vec<Test>,
}

/// The score of a model on a test.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Score {
    /// The test's name.
    pub test: &'static str,
    /// RMS of the force difference between model and record, over the RMS of the record's force.
    pub force_nrmse: f64,
    /// RMS of the record's displacement, m.
    pub displacement_rms: f64,
    /// RMS error of the simulated displacement, m; null if the model gives no motion.
    pub displacement_error: Option<f64>,
    /// The reason why the model gives no motion; null if it gives one.
    pub refused: Option<String>,
}

/// The result of the benchmark.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BoucWenResult {
    /// Seed of the phases and the noise.
    pub seed: u64,
    /// Verdict of the trace.
    pub verdict: Verdict,
    /// Families that the trace named.
    pub families: Vec<String>,
    /// Mass that the trace found, kg; the true mass is 2 kg.
    pub mass: Option<f64>,
    /// Scores, test by test.
    pub scores: Vec<Score>,
}

/// Simulates the records.
///
/// # Errors
/// Never for a programme of some hundred samples or more: errors of a recording.
pub fn records(programme: &Programme) -> Result<Records, InputError> {
    let Programme {
        system,
        samples,
        periods,
        sweep_rate,
        seed,
    } = *programme;
    // A seed draws three signals.
    let of_multisine = |which: u64, periods: usize, name: &str| {
        let points = 2 * OVERSAMPLING * samples;
        let force = multisine(samples, points, seed.wrapping_mul(4).wrapping_add(which));
        let u = |half: usize| force[half % points];
        let first = SETTLING * samples;
        let all = system.displacements(1.0 / RATE, first + periods * samples, u);
        recording(name, &all[first..], u)
    };
    let mut training = of_multisine(0, periods, "training")?;
    let mut random = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(4).wrapping_add(2));
    if let Ok(noise) = Normal::new(0.0, 1e3 * NOISE) {
        for y in &mut training.displacement {
            *y += noise.sample(&mut random);
        }
    }
    // A simulation settles during the first of two periods.
    let steady = of_multisine(1, 2, "test-multisine")?;
    let half_step = 0.5 / (RATE * OVERSAMPLING as f64);
    let u = |half: usize| sweep(half as f64 * half_step, sweep_rate);
    let count = (sweep_time(sweep_rate) * RATE) as usize;
    let swept = system.displacements(1.0 / RATE, count, u);
    Ok(Records {
        training,
        tests: vec![
            Test {
                name: "multisine",
                recording: steady,
                judged: samples..2 * samples,
            },
            Test {
                name: "sweep",
                recording: recording("test-sweep", &swept, u)?,
                judged: 0..count,
            },
        ],
    })
}

/// For `displacement` in m under a force of `u` N at every half step.
fn recording(
    name: &str,
    displacement: &[f64],
    u: impl Fn(usize) -> f64,
) -> Result<Recording, InputError> {
    let count = displacement.len();
    let time = (0..count).map(|index| index as f64 / RATE);
    let force = (0..count).map(|index| 1e-3 * u(2 * OVERSAMPLING * index));
    let displacement = displacement.iter().map(|y| 1e3 * y);
    let mut recording = Recording::new(
        name,
        time.collect(),
        displacement.collect(),
        force.collect(),
    )?;
    if let Some(newton) = FORCE.iter().find(|unit| unit.symbol == "N") {
        recording.units.force = *newton;
    }
    Ok(recording)
}

/// Traces the training record and judges the model on the tests.
///
/// # Errors
/// Errors of the trace, and a test that cannot be prepared for a prediction.
pub fn bouc_wen(
    programme: &Programme,
    records: &Records,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<(Trace, BoucWenResult), TraceError> {
    let training = std::slice::from_ref(&records.training);
    let found = trace(training, &[], progress)?;
    progress("judging the model on the tests");
    let scores = records
        .tests
        .iter()
        .map(|test| score(&found.model, test))
        .collect::<Result<Vec<_>, _>>()?;
    let effects = &found.result.effects;
    let mass = effects.iter().find(|effect| effect.family == "inertia");
    let result = BoucWenResult {
        seed: programme.seed,
        verdict: found.result.verdict,
        families: effects.iter().map(|effect| effect.family.clone()).collect(),
        mass: mass.and_then(|effect| Some(effect.parameters.get("mass")?.value)),
        scores,
    };
    Ok((found, result))
}

/// The score of `model` on `test`.
///
/// # Errors
/// A test that cannot be prepared for a prediction, or a model that the crate refuses.
pub fn score(model: &Model, test: &Test) -> Result<Score, TraceError> {
    let recording = &test.recording;
    let trajectory = Trajectory::of(recording)?;
    let predicted = predict(model, &trajectory)?;
    let excitation = Excitation::force(1.0 / RATE, recording.force.clone());
    let simulated = respond(model, &excitation, &Settings::new(0.0));
    let judged = &recording.displacement[test.judged.clone()];
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| {
            (sum + value * value, count + 1.0)
        });
        // From mm.
        1e-3 * (sum / count).sqrt()
    };
    let (displacement_error, refused) = match &simulated {
        Ok(response) => {
            let own = response.moments[test.judged.clone()].iter();
            let mut error = own.zip(judged).map(|(own, y)| own.displacement - y);
            (Some(rms(&mut error)), None)
        }
        Err(error) => (None, Some(error.to_string())),
    };
    Ok(Score {
        test: test.name,
        force_nrmse: nrmse(&predicted, &trajectory.force, |index| {
            test.judged.contains(&index)
        }),
        displacement_rms: rms(&mut judged.iter().copied()),
        displacement_error,
        refused,
    })
}
