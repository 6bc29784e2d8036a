//! Clean recordings: motions, hidden effects and noise.

use std::f64::consts::TAU;

use mesh_damper_recording::Recording;
use mesh_damper_reference::protocol::{PROTOCOL, TestBlock, motion};
use mesh_damper_rig::specimen::{DamperForce as _, HiddenEffect, SlipShape, Specimen};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};

/// One sample of a motion: time s, displacement mm, velocity mm/s, acceleration mm/s².
pub type Sample = [f64; 4];

/// A clean channel set.
#[derive(Clone)]
pub struct Clean {
    pub time: Vec<f64>,
    pub displacement: Vec<f64>,
    pub force: Vec<f64>,
    pub velocity: Vec<f64>,
}

impl Clean {
    pub fn recording(&self) -> Recording {
        let (time, displacement) = (self.time.clone(), self.displacement.clone());
        Recording::new("test", time, displacement, self.force.clone()).unwrap()
    }
}

/// The effect that a specimen of 3 g/cm³ hides: one of [`HiddenEffect`], or one that is not among these.
#[derive(Clone, Copy, Debug)]
pub enum Hides {
    Nothing,
    Listed(HiddenEffect),
    /// One-sided contact.
    Stop,
    /// A tone that does not depend on the motion.
    Tone,
    /// Friction that acts against the motion at once.
    Coulomb,
}

pub const HIDES: [Hides; 13] = [
    Hides::Nothing,
    Hides::Listed(HiddenEffect::Offset { force: 0.05 }),
    Hides::Listed(HiddenEffect::Asymmetry { k2: 3.0 }),
    Hides::Listed(HiddenEffect::Hardening { k5: 1500.0 }),
    Hides::Listed(HiddenEffect::StickSlip {
        stiffness: 1.2,
        slip_limit: 0.03,
        shape: SlipShape::Sharp,
    }),
    Hides::Listed(HiddenEffect::Viscous { c: 0.01 }),
    Hides::Listed(HiddenEffect::Relaxation {
        stiffness: 1.5,
        time: 0.05,
    }),
    Hides::Listed(HiddenEffect::Inertia { mass: 120.0 }),
    Hides::Listed(HiddenEffect::Drift {
        stiffness: 0.5,
        cycles: 15.0,
    }),
    Hides::Listed(HiddenEffect::Temperature {
        beta: 0.004,
        rise: 30.0,
        time: 6.0,
    }),
    Hides::Stop,
    Hides::Tone,
    Hides::Coulomb,
];

pub fn sines(rate: f64) -> Vec<Sample> {
    samples_of(&PROTOCOL, rate)
}

pub fn samples_of(blocks: &[TestBlock], rate: f64) -> Vec<Sample> {
    motion(blocks, rate)
        .iter()
        .map(|m| [m.time, m.displacement, m.velocity, m.acceleration])
        .collect()
}

/// Up, dwell, down, dwell, at 1 Hz; ±0.15 mm.
pub fn trapezoids(rate: f64) -> Vec<Sample> {
    (0..(12.0 * rate) as usize)
        .map(|index| {
            let time = index as f64 / rate;
            let phase = (time + 0.125).fract();
            let (y, v) = match phase {
                p if p < 0.25 => (-0.15 + 1.2 * p, 1.2),
                p if p < 0.5 => (0.15, 0.0),
                p if p < 0.75 => (0.15 - 1.2 * (p - 0.5), -1.2),
                _ => (-0.15, 0.0),
            };
            [time, y, v, 0.0]
        })
        .collect()
}

/// One amplitude, 1 Hz.
pub fn one_sine(rate: f64) -> Vec<Sample> {
    let block = TestBlock::new(0.1, 1.0, 15);
    samples_of(&[block], rate)
}

/// The channels of a specimen under `motion`, with `noise` as a part of the RMS force, and a thousandth of the
/// displacement's RMS; rounded as a 16-bit converter does where `rounded`.
pub fn test(motion: &[Sample], hides: Hides, noise: f64, rounded: bool, seed: u64) -> Clean {
    let mut specimen = Specimen::of_density(3.0, 0.1);
    if let Hides::Listed(effect) = hides {
        specimen = specimen.with(effect);
    }
    let dt = motion[1][0] - motion[0][0];
    let mut force: Vec<f64> = motion
        .iter()
        .map(|&[t, y, v, a]| {
            let extra = match hides {
                Hides::Stop => 6.0 * (y - 0.12).max(0.0),
                Hides::Tone => 0.06 * (TAU * 50.0 * t + 0.4).sin(),
                Hides::Coulomb => 0.05 * v.signum(),
                _ => 0.0,
            };
            specimen.force(t, y, v, a, dt) + extra
        })
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let rms =
        |values: &[f64]| (values.iter().map(|f| f * f).sum::<f64>() / values.len() as f64).sqrt();
    let mut spoil = |values: &mut [f64], noise: f64| {
        let full = 1.5 * values.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
        for value in values {
            let normal: f64 = StandardNormal.sample(&mut random);
            *value += noise * normal;
            if rounded {
                *value = (*value / full * 32768.0).round() * full / 32768.0;
            }
        }
    };
    let deviation = noise * rms(&force);
    spoil(&mut force, deviation);
    let mut displacement: Vec<f64> = motion.iter().map(|s| s[1]).collect();
    let deviation = 1e-3 * rms(&displacement);
    spoil(&mut displacement, deviation);
    Clean {
        time: motion.iter().map(|s| s[0]).collect(),
        displacement,
        force,
        velocity: motion.iter().map(|s| s[2]).collect(),
    }
}
