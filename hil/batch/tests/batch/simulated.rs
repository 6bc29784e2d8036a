//! Recordings of simulated specimens, each different.

use mesh_damper_recording::Recording;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::protocol::{TestBlock, motion};
use mesh_damper_rig::specimen::{DamperForce as _, Specimen, draw};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

/// Hz.
const RATE: f64 = 500.0;
/// RMS of the displacement's noise, mm.
const DISPLACEMENT_NOISE: f64 = 1e-4;
/// RMS of the force's noise over that of the force.
const FORCE_NOISE: f64 = 0.005;

/// A recording of a few seconds of the specimen drawn by `seed`, with a hidden effect.
pub fn drawn(seed: u64) -> Recording {
    recording(draw(seed).0, seed)
}

/// Another recording of the specimen drawn by `specimen`.
pub fn drawn_again(specimen: u64, seed: u64) -> Recording {
    recording(draw(specimen).0, seed)
}

/// A recording of a few seconds of a specimen with these coefficients and no other effect.
pub fn plain(coefficients: Coefficients, seed: u64) -> Recording {
    recording(Specimen::new(coefficients), seed)
}

/// Six blocks with amplitudes and frequencies drawn around those of the protocol, with noise; `seed` draws both.
fn recording(mut specimen: Specimen, seed: u64) -> Recording {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let blocks = [
        (0.1, 2.0, 3),
        (0.2, 5.0, 5),
        (0.05, 4.0, 4),
        (0.15, 2.5, 4),
        (0.1, 8.0, 8),
        (0.2, 2.0, 3),
    ]
    .map(|(amplitude, frequency, cycles)| TestBlock {
        amplitude: amplitude * rng.random_range(0.9..1.1),
        frequency: frequency * rng.random_range(0.9..1.1),
        cycles,
    });
    let samples = motion(&blocks, RATE);
    let force: Vec<f64> = samples
        .iter()
        .map(|at| {
            specimen.force(
                at.time,
                at.displacement,
                at.velocity,
                at.acceleration,
                1.0 / RATE,
            )
        })
        .collect();
    let rms = (force.iter().map(|force| force * force).sum::<f64>() / force.len() as f64).sqrt();
    let [of_displacement, of_force] = [DISPLACEMENT_NOISE, FORCE_NOISE * rms]
        .map(|deviation| Normal::new(0.0, deviation).unwrap());
    let displacement = samples
        .iter()
        .map(|at| at.displacement + of_displacement.sample(&mut rng))
        .collect();
    let force = force
        .iter()
        .map(|force| force + of_force.sample(&mut rng))
        .collect();
    let time = samples.iter().map(|at| at.time).collect();
    Recording::new(format!("specimen {seed}"), time, displacement, force).unwrap()
}
