//! Trials over any motion: random, stepped, slow, swept, with pauses, recorded by typical sensors.
//!
//! A law is compared to the true law: the specimen itself, driven along the motion as estimated from the measured displacement.

mod floors;
mod judge;
mod path;
mod sensors;
mod summary;

use std::cell::OnceCell;
use std::ops::Range;

use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::protocol::MotionSample;
use mesh_damper_reference::tables;
use mesh_damper_rig::specimen::{CURRENT, DamperForce, HiddenEffect, Specimen};
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

pub use floors::{FLOORS, FLOORS_OF_A_PART, Floors};
pub use judge::{Mark, Outcome, judge};
pub use path::{Kind, Path};
pub use sensors::{Flaw, Sensors};
pub use summary::{Row, Summary};

use super::absorbed::least_squares;
use super::draw::rms;
use super::families::{LATER, effect, log_uniform};

/// Amplitude of the tables whose coefficients a specimen has at every amplitude, mm.
const AMPLITUDE: f64 = 0.1;
/// Lowest rate at which the specimen is computed, Hz; four times as often with a spring in series.
const CALL_RATE: f64 = 4000.0;
/// Residual of eq 13 for an effect, over the force's noise.
const SIZES: (f64, f64) = (6.0, 60.0);
/// Tolerance of the requested size, as a factor; and attempts.
const MISS: f64 = 1.5;
const SIZINGS: usize = 12;
/// Largest force of an effect, as a fraction of the law's force.
const LARGEST_SHARE: f64 = 1.0;
/// Approximate number of samples that determine how much of an effect eq 13 absorbs.
const SIZED_BY: usize = 4000;
/// Numbers in `families` of the effects that any motion shows: drift and temperature need a long test.
const SHOWN: [usize; 14] = [0, 1, 2, 3, 6, 7, 8, 9, 10, 11, 12, 13, 14, 17];
/// The first seed that may also draw the first of [`LATER`], in place of the seed given there: those below are the 112 whose figures
/// were published without it.
const FIRST_WITH_YIELDING: u64 = 112;

/// The truth and the test of a seed.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The seed.
    pub seed: u64,
    /// Motion of both tests.
    pub kind: Kind,
    /// Sensors of both tests.
    pub sensors: Sensors,
    /// Samples a second, Hz.
    pub rate: f64,
    /// The hidden effects: none, one or two.
    pub hidden: Vec<HiddenEffect>,
    /// Coefficients of the law.
    pub law: Coefficients,
    /// The true motion of the training test.
    pub motion: Vec<MotionSample>,
    /// The recording to fit.
    pub training: Recording,
    /// The recording to predict.
    pub held_out: Recording,
    /// RMS of the error of the true law on each, kN.
    pub reference: [f64; 2],
    /// RMS of the residual of eq 13 on the training test's true force, kN.
    pub left_by_eq13: f64,
}

/// The trial of `seed`, the same for the same seed. Kinds of motion take turns; a quarter hides nothing, a half one effect, a
/// quarter two. A draw that cannot be scaled to a visible size is drawn again.
pub fn draw(seed: u64) -> Trial {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    loop {
        if let Some(trial) = drawn(seed, &mut rng) {
            return trial;
        }
    }
}

fn drawn(seed: u64, rng: &mut impl Rng) -> Option<Trial> {
    let kinds = Kind::ALL.len() as u64;
    let kind = Kind::ALL[(seed % kinds) as usize];
    let effects = [0, 1, 2, 1][(seed / kinds % 4) as usize];
    let largest = rng.random_range(0.12..0.25);
    let paths = [1.0, 0.8].map(|part| Path::draw(kind, part * largest, rng));
    let coefficients = tables::interpolate(rng.random_range(2.0..4.0), AMPLITUDE);
    let specimen = Specimen::new(coefficients);
    let rate = match kind {
        Kind::QuasiStatic => *[10.0, 20.0, 50.0].choose(rng)?,
        _ => *[200.0, 500.0, 500.0, 1000.0].choose(rng)?,
    };
    let tests = paths.map(|path| Driven::new(path, rate));
    let law = tests[0].answer(&specimen);
    let flaw = *Flaw::DRAWN.choose(rng)?;
    let sensors = Sensors::draw(flaw, rms(&law.1), rng);
    let mut hidden: Vec<HiddenEffect> = Vec::new();
    for _ in 0..effects {
        let later = LATER.iter().enumerate().filter(|&(place, &(_, first))| {
            let is_yielding = place == 0;
            seed >= if is_yielding {
                FIRST_WITH_YIELDING
            } else {
                first
            }
        });
        let later = later.map(|(_, (which, _))| *which);
        let shown: Vec<usize> = SHOWN.into_iter().chain(later).collect();
        let example = effect(*shown.choose(rng)?, largest, rng);
        let family = example.effect.family();
        if hidden.iter().any(|other| other.family() == family) {
            return None;
        }
        let wanted = log_uniform(SIZES.0, SIZES.1, rng) * sensors.force_noise;
        let mut factor: f64 = example.factors.0.max(1e-3);
        let sized = (0..SIZINGS).find_map(|_| {
            let effect = example.effect.scaled(factor);
            let (motion, force) = tests[0].answer(&specimen.clone().with(effect));
            let left = left_by_eq13(&motion, &force);
            let ratio = wanted / left.max(1e-3 * wanted);
            let added: Vec<f64> = force.iter().zip(&law.1).map(|(a, b)| a - b).collect();
            let is_sized = (1.0 / MISS..MISS).contains(&ratio)
                && rms(&added) <= LARGEST_SHARE * rms(&law.1)
                && effect.is_admissible();
            factor = (factor * ratio.clamp(1e-3, 1e3)).clamp(example.factors.0, example.factors.1);
            is_sized.then_some(effect)
        });
        hidden.push(sized?);
    }
    let specimen = hidden
        .iter()
        .fold(specimen, |specimen, &effect| specimen.with(effect));
    let truths = tests.each_ref().map(|test| test.answer(&specimen));
    let mut recorded = |which: usize, name: &str| {
        let (motion, force) = &truths[which];
        let recording = sensors.record(
            format!("{name} of motion seed {seed}"),
            motion,
            force,
            rng.random(),
        );
        let control = |time: f64| specimen.control_at(time);
        match recording.time.iter().map(|&time| control(time)).collect() {
            Some(current) => recording.with_control(CURRENT, current),
            None => Ok(recording),
        }
        .expect("one value a sample")
    };
    let (training, held_out) = (recorded(0, "training test"), recorded(1, "held-out test"));
    let reference = [
        left_by_truth(&specimen, &training)?,
        left_by_truth(&specimen, &held_out)?,
    ];
    let left_by_eq13 = left_by_eq13(&truths[0].0, &truths[0].1);
    let [(motion, _), _] = truths;
    Some(Trial {
        seed,
        kind,
        sensors,
        rate,
        hidden,
        law: coefficients,
        motion,
        training,
        held_out,
        reference,
        left_by_eq13,
    })
}

/// A path at the samples of a test and, in steps of the specimen, between them.
struct Driven {
    rate: f64,
    /// In steps for a plain specimen, and for one with a spring in series if that was requested.
    fine: [OnceCell<Vec<MotionSample>>; 2],
    path: Path,
}

impl Driven {
    fn new(path: Path, rate: f64) -> Self {
        Self {
            rate,
            fine: Default::default(),
            path,
        }
    }

    /// Motion and force of `specimen` at the samples.
    fn answer(&self, specimen: &Specimen) -> (Vec<MotionSample>, Vec<f64>) {
        let mut specimen = specimen.at_rest();
        let steps = steps(&specimen, 1.0 / self.rate);
        let step = 1.0 / (self.rate * steps as f64);
        let fine = self.fine[usize::from(is_soft(&specimen))].get_or_init(|| {
            let count = (self.path.duration / step) as usize;
            (0..count)
                .map(|index| self.path.at(index as f64 * step))
                .collect()
        });
        let (mut motion, mut force) = (Vec::new(), Vec::new());
        for (index, now) in fine.iter().enumerate() {
            let answered = specimen.force(
                now.time,
                now.displacement,
                now.velocity,
                now.acceleration,
                step,
            );
            if index % steps == 0 {
                motion.push(*now);
                force.push(answered);
            }
        }
        (motion, force)
    }
}

fn is_soft(specimen: &Specimen) -> bool {
    let soft = |effect: HiddenEffect| matches!(effect, HiddenEffect::Compliance { .. });
    specimen.effects().any(soft)
}

/// Steps of the specimen in `tick` s.
fn steps(specimen: &Specimen, tick: f64) -> usize {
    let finer = if is_soft(specimen) { 4 } else { 1 };
    (CALL_RATE * tick).ceil() as usize * finer
}

/// RMS of the error of `specimen` against the measured force along the estimated motion, kN; `None` without an estimate.
fn left_by_truth(specimen: &Specimen, recording: &Recording) -> Option<f64> {
    let trajectory = Trajectory::of(recording).ok()?;
    let (motion, tick) = (&trajectory.motion, trajectory.tick);
    let mut specimen = specimen.at_rest();
    let steps = steps(&specimen, tick);
    let mut squares = 0.0;
    for index in 0..trajectory.len() {
        let last = index.saturating_sub(1);
        let mut force = 0.0;
        for step in 1..=steps {
            let part = step as f64 / steps as f64;
            let between = |values: &[f64]| values[last] + part * (values[index] - values[last]);
            force = specimen.force(
                (last as f64 + part) * tick,
                between(&motion.displacement) + trajectory.centre,
                between(&motion.velocity),
                between(&motion.acceleration),
                tick / steps as f64,
            );
        }
        squares += (force - trajectory.force[index]).powi(2);
    }
    Some((squares / trajectory.len() as f64).sqrt())
}

/// RMS of the residual of eq 13 with one set of coefficients, kN.
fn left_by_eq13(motion: &[MotionSample], force: &[f64]) -> f64 {
    let step = (force.len() / SIZED_BY).max(1);
    let samples = motion.iter().zip(force).step_by(step);
    let samples: Vec<[f64; 3]> = samples
        .map(|(m, force)| [m.displacement, m.velocity, *force])
        .collect();
    (least_squares(&samples) / samples.len() as f64).sqrt()
}

/// Runs the trials of `seeds`; `done` is called after each.
pub fn run(seeds: Range<u64>, done: &(dyn Fn() + Sync)) -> Summary {
    let outcomes = seeds.into_par_iter().map(|seed| {
        let outcome = judge(&draw(seed));
        done();
        outcome
    });
    Summary::of(outcomes.collect())
}
