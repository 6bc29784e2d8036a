//! Recordings of one specimen that is held away from its rest position, warms up, or has a force that settles over the cycles.

use mesh_damper_recording::Recording;
use mesh_damper_reference::law::Coefficients;
use mesh_damper_reference::protocol::{TestBlock, motion};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

/// Hz.
const RATE: f64 = 500.0;
/// RMS of the displacement's noise, mm.
const DISPLACEMENT_NOISE: f64 = 1e-4;
/// RMS of the force's noise over that of the force.
const FORCE_NOISE: f64 = 0.005;
/// Number of cycles after which 63 % of the change has occurred.
const SETTLES: f64 = 15.0;

/// A test of a specimen.
#[derive(Clone, Copy, Debug)]
pub struct Varied {
    /// Of the specimen at 20 °C and in the first cycle.
    pub coefficients: Coefficients,
    /// The fraction of its force that it loses per °C.
    pub loss: f64,
    /// The fraction of its force that it finally gains.
    pub gain: f64,
    /// Position at which it is held, mm.
    pub preload: f64,
    /// Position of the sensor's zero, mm.
    pub sensor: f64,
    /// Largest amplitude, mm.
    pub largest: f64,
    /// At the beginning and at the end, °C.
    pub temperature: [f64; 2],
    /// Number of repetitions of the blocks.
    pub rounds: usize,
    /// Draws amplitudes, frequencies and noise.
    pub seed: u64,
}

impl Varied {
    /// A test about the rest position, at 20 °C.
    pub fn of(coefficients: Coefficients, seed: u64) -> Self {
        Self {
            coefficients,
            loss: 0.0,
            gain: 0.0,
            preload: 0.0,
            sensor: 0.0,
            largest: 0.2,
            temperature: [20.0; 2],
            rounds: 1,
            seed,
        }
    }

    pub fn recording(&self) -> Recording {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let mut blocks = Vec::new();
        for _ in 0..self.rounds {
            blocks.extend(
                [
                    (0.5, 2.0, 3),
                    (1.0, 5.0, 5),
                    (0.25, 4.0, 4),
                    (0.75, 2.5, 4),
                    (0.5, 8.0, 8),
                    (1.0, 2.0, 3),
                ]
                .map(|(amplitude, frequency, cycles)| TestBlock {
                    amplitude: self.largest * amplitude * rng.random_range(0.9..1.1),
                    frequency: frequency * rng.random_range(0.9..1.1),
                    cycles,
                }),
            );
        }
        let samples = motion(&blocks, RATE);
        let end = samples.last().unwrap().time;
        let [from, to] = self.temperature;
        let warmth = |time: f64| from + (to - from) * time / end;
        let cycles = |time: f64| {
            let (mut begin, mut cycles) = (0.0, 0.0);
            for block in &blocks {
                let duration = f64::from(block.cycles) / block.frequency;
                cycles += (time - begin).clamp(0.0, duration) * block.frequency;
                begin += duration;
            }
            cycles
        };
        let force: Vec<f64> = samples
            .iter()
            .map(|at| {
                let law = self
                    .coefficients
                    .force(self.preload + at.displacement, at.velocity);
                let settled = 1.0 - (-cycles(at.time) / SETTLES).exp();
                law * (1.0 - self.loss * (warmth(at.time) - 20.0) + self.gain * settled)
            })
            .collect();
        let rms = (force.iter().map(|f| f * f).sum::<f64>() / force.len() as f64).sqrt();
        let [of_displacement, of_force] = [DISPLACEMENT_NOISE, FORCE_NOISE * rms]
            .map(|deviation| Normal::new(0.0, deviation).unwrap());
        let mut noisy = |value: f64, noise: &Normal<f64>| value + noise.sample(&mut rng);
        let displacement = samples
            .iter()
            .map(|at| {
                noisy(
                    self.preload + self.sensor + at.displacement,
                    &of_displacement,
                )
            })
            .collect();
        let force = force.iter().map(|&f| noisy(f, &of_force)).collect();
        let time: Vec<f64> = samples.iter().map(|at| at.time).collect();
        let temperature = time.iter().map(|&time| warmth(time)).collect();
        let name = format!("test {}", self.seed);
        let mut recording = Recording::new(name, time, displacement, force).unwrap();
        recording.temperature = Some(temperature);
        recording
    }
}
