//! Trials over any motion: random, stepped, slow, swept, with pauses, recorded by typical sensors.
//!
//! A law is compared to the true law: the specimen itself, driven along the motion as estimated from the measured displacement.

use std::cell::OnceCell;

use mesh_damper_recording::Recording;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::protocol::MotionSample;
use mesh_damper_reference::tables;
use mesh_damper_rig::specimen::{CURRENT, DamperForce, HiddenEffect, Specimen};
use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::absorbed::left_by_one_eq13;
use super::blocks::rms;
use super::families::{Version, log_uniform};
use super::path::{Kind, Path};
use super::sensors::{Flaw, MotionSensors};
use super::trial::{AnyMotion, Class, Hidden, Secret, Sized, Test, Trial};

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

/// The trial of `seed`, the same for the same seed. Kinds of motion take turns; a quarter hides nothing, a half one effect, a
/// quarter two. A draw that cannot be scaled to a visible size is drawn again.
pub(super) fn draw(version: Version, seed: u64) -> Trial {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    loop {
        if let Some(trial) = drawn(version, seed, &mut rng) {
            return trial;
        }
    }
}

fn drawn(version: Version, seed: u64, rng: &mut ChaCha8Rng) -> Option<Trial> {
    let kinds = Kind::ALL.len() as u64;
    let kind = Kind::ALL[(seed % kinds) as usize];
    let effects = [0, 1, 2, 1][(seed / kinds % 4) as usize];
    let largest = rng.random_range(0.12..0.25);
    let paths = [1.0, 0.8].map(|part| Path::draw(kind, part * largest, rng));
    let density = rng.random_range(2.0..4.0);
    let specimen = Specimen::new(law(density));
    let rate = match kind {
        Kind::QuasiStatic => *[10.0, 20.0, 50.0].choose(rng)?,
        _ => *[200.0, 500.0, 500.0, 1000.0].choose(rng)?,
    };
    let tests = paths.map(|path| Driven::new(path, rate));
    let law = tests[0].answer(&specimen);
    let flaw = *Flaw::DRAWN.choose(rng)?;
    let sensors = MotionSensors::draw(flaw, rms(&law.1), rng);
    let mut hidden: Vec<HiddenEffect> = Vec::new();
    let mut sized: Vec<Sized> = Vec::new();
    for _ in 0..effects {
        let example = version.effect(*version.in_any_motion().choose(rng)?, largest, rng)?;
        let family = example.effect.family();
        if hidden.iter().any(|other| other.family() == family) {
            return None;
        }
        let wanted = log_uniform(SIZES.0, SIZES.1, rng) * sensors.force_noise;
        let mut factor: f64 = example.factors.0.max(1e-3);
        let (effect, size) = (0..SIZINGS).find_map(|_| {
            let effect = example.effect.scaled(factor);
            let (motion, force) = tests[0].answer(&specimen.clone().with(effect));
            let left = left_by_one_eq13(&motion, &force);
            let ratio = wanted / left.max(1e-3 * wanted);
            let added: Vec<f64> = force.iter().zip(&law.1).map(|(a, b)| a - b).collect();
            let is_sized = (1.0 / MISS..MISS).contains(&ratio)
                && rms(&added) <= LARGEST_SHARE * rms(&law.1)
                && effect.is_admissible();
            factor = (factor * ratio.clamp(1e-3, 1e3)).clamp(example.factors.0, example.factors.1);
            let size = Sized {
                effect: Hidden::Specimen(effect),
                size: rms(&added) / sensors.force_noise,
                visible: left / sensors.force_noise,
            };
            is_sized.then_some((effect, size))
        })?;
        hidden.push(effect);
        sized.push(size);
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
    let left = left_by_one_eq13(&truths[0].0, &truths[0].1);
    let [(motion, _), _] = truths;
    Some(Trial {
        secret: Secret {
            seed,
            class: match effects {
                0 => Class::None,
                1 => Class::Listed,
                _ => Class::Pair,
            },
            density,
            effects: sized,
            rate,
            test: Test::Motion(AnyMotion {
                kind,
                sensors,
                visible: left / reference[0],
            }),
        },
        held_out_noise: reference[1] / rms(&held_out.force),
        motion,
        training,
        held_out,
    })
}

/// Eq 13 of a specimen, the same at every amplitude.
pub(super) fn law(density: f64) -> Coefficients {
    tables::interpolate(density, AMPLITUDE)
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
