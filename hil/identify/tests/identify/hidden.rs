//! Specimens with an effect of no family, and tests of them.

use std::f64::consts::TAU;

use mesh_damper_model::{LawNode, Model};
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_reference::protocol::{TestBlock, motion};
use mesh_damper_reference::tables;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Hz
pub const RATE: f64 = 500.0;
/// g/cm³
pub const DENSITY: f64 = 3.0;
/// Noise of the force over its RMS.
pub const NOISE: f64 = 0.004;

/// The quantities that a specimen's force may depend on.
pub struct Sample {
    /// s
    pub time: f64,
    /// mm
    pub displacement: f64,
    /// mm/s
    pub velocity: f64,
    /// Hz, of the block.
    pub frequency: f64,
    /// Since the test began.
    pub cycles: f64,
    /// kN, of eq 13.
    pub law: f64,
    /// °C
    pub temperature: f64,
}

/// Force in addition to eq 13, kN, with its memory.
pub type Hidden = Box<dyn FnMut(&Sample) -> f64>;

pub fn block(amplitude: f64, frequency: f64, cycles: u32) -> TestBlock {
    TestBlock::new(amplitude, frequency, cycles)
}

pub fn fitted() -> Vec<TestBlock> {
    let amplitudes = [0.05, 0.1, 0.2];
    let pairs = amplitudes.map(|a| [block(a, 1.0, 6), block(a, 5.0, 10)]);
    pairs
        .concat()
        .into_iter()
        .chain([block(0.15, 2.0, 8)])
        .collect()
}

/// A test of a specimen with eq 13 tabulated over amplitude.
pub fn record(blocks: &[TestBlock], hidden: Hidden, seed: u64) -> Trajectory {
    record_at(|_| None, blocks, hidden, seed)
}

/// The same with a temperature in °C over the time in s, if one is measured.
pub fn record_at(
    temperature: impl Fn(f64) -> Option<f64>,
    blocks: &[TestBlock],
    mut hidden: Hidden,
    seed: u64,
) -> Trajectory {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut normal = move || {
        let (radius, angle): (f64, f64) = (1.0 - rng.random::<f64>(), rng.random());
        (-2.0 * radius.ln()).sqrt() * (TAU * angle).cos()
    };
    let mut remaining = blocks.iter();
    let (mut now, mut start, mut end, mut before) = (blocks[0], 0.0, 0.0, 0.0);
    let clean: Vec<(f64, f64)> = motion(blocks, RATE)
        .iter()
        .map(|m| {
            if m.time > end - 0.5 / RATE {
                before += (end - start) * now.frequency;
                now = *remaining.next().unwrap_or(&now);
                start = end;
                end += f64::from(now.cycles) / now.frequency;
            }
            let law = tables::interpolate(DENSITY, now.amplitude).force(m.displacement, m.velocity);
            let sample = Sample {
                time: m.time,
                displacement: m.displacement,
                velocity: m.velocity,
                frequency: now.frequency,
                cycles: before + (m.time - start) * now.frequency,
                law,
                temperature: temperature(m.time).unwrap_or_default(),
            };
            (m.displacement, law + hidden(&sample))
        })
        .collect();
    let power = clean.iter().map(|(_, force)| force * force).sum::<f64>();
    let rms = (power / clean.len() as f64).sqrt();
    let force: Vec<f64> = clean
        .iter()
        .map(|(_, force)| force + NOISE * rms * normal())
        .collect();
    let displacement: Vec<f64> = clean.iter().map(|(y, _)| y + 1e-4 * normal()).collect();
    let temperature = (0..force.len()).map(|sample| temperature(sample as f64 / RATE));
    let temperature = temperature.collect();
    Trajectory::new("test", 1.0 / RATE, &displacement, force, None, temperature)
}

/// The published law at the fitted amplitudes, with the errors of a fit that absorbs an unknown effect into eq 13.
pub fn start() -> Model {
    let node = |amplitude| {
        let law = tables::interpolate(DENSITY, amplitude);
        LawNode {
            amplitude,
            k1: 1.2 * law.k1,
            k3: law.k3 - 5.0,
            c: 0.9 * law.c,
            alpha: law.alpha - 0.1,
        }
    };
    Model {
        law: [0.05, 0.1, 0.15, 0.2].map(node).to_vec(),
        effects: Vec::new(),
        correction: None,
        controls: Vec::new(),
    }
}
