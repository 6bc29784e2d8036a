//! The simulated test for a trial's recordings: it has no controller, only a motion, a specimen and sensors.

use mesh_damper_recording::Recording;
use mesh_damper_reference::protocol::{MotionSample, TestBlock, motion};
use mesh_damper_reference::tables;
use mesh_damper_rig::specimen::{CURRENT, DamperForce, HiddenEffect, Specimen};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// RMS of the displacement sensor's noise, mm.
pub const DISPLACEMENT_NOISE: f64 = 1e-4;
/// Range of the displacement sensor, ± mm.
const DISPLACEMENT_RANGE: f64 = 1.0;
/// Steps of both converters: 16 bits over twice the range.
const STEPS: f64 = 65536.0;
/// RMS of the thermometer's noise, and its step, °C.
const TEMPERATURE_NOISE: f64 = 0.02;
const TEMPERATURE_STEP: f64 = 0.01;

/// The true motion and force.
pub struct Truth {
    /// At each sample.
    pub motion: Vec<MotionSample>,
    /// kN, at each sample.
    pub force: Vec<f64>,
    /// °C, at each sample.
    pub temperature: Vec<f64>,
    /// The control input at each sample; none for a specimen without one.
    pub control: Vec<f64>,
    /// Index of the block within `blocks`, at each sample.
    pub block: Vec<usize>,
}

/// The response of a specimen of `density` g/cm³ with `effects` to `blocks`, sampled `rate` times a second.
///
/// Coefficients are those of the tables at the block's amplitude. The specimen is computed about `call_rate` times a second, and
/// four times as often with a spring in series, whose steps are of first order.
pub fn answer(
    density: f64,
    effects: &[HiddenEffect],
    blocks: &[TestBlock],
    rate: f64,
    call_rate: f64,
) -> Truth {
    let soft = effects
        .iter()
        .any(|effect| matches!(effect, HiddenEffect::Compliance { .. }));
    let oversampling = (call_rate / rate).ceil() as usize * if soft { 4 } else { 1 };
    let coefficients = |block: &TestBlock| tables::interpolate(density, block.amplitude);
    let mut specimen = effects.iter().fold(
        Specimen::new(coefficients(&blocks[0])),
        |specimen, &effect| specimen.with(effect),
    );
    let fine = rate * oversampling as f64;
    let mut truth = Truth {
        motion: Vec::new(),
        force: Vec::new(),
        temperature: Vec::new(),
        control: Vec::new(),
        block: Vec::new(),
    };
    let mut end = 0.0;
    let mut next = 0;
    for (i, m) in motion(blocks, fine).into_iter().enumerate() {
        while next < blocks.len() && (next == 0 || m.time >= end - 0.5 / fine) {
            let block = &blocks[next];
            specimen.begin_block(coefficients(block), block.frequency);
            end += f64::from(block.cycles) / block.frequency;
            next += 1;
        }
        let force = specimen.force(
            m.time,
            m.displacement,
            m.velocity,
            m.acceleration,
            1.0 / fine,
        );
        if i % oversampling == 0 {
            truth.motion.push(m);
            truth.force.push(force);
            truth.temperature.push(specimen.temperature());
            truth.control.extend(specimen.control_at(m.time));
            truth.block.push(next - 1);
        }
    }
    truth
}

/// How a test is recorded.
#[derive(Clone, Copy, Debug)]
pub struct Sensors {
    /// RMS of the force's noise, kN.
    pub force_noise: f64,
    /// Whether the temperature is recorded.
    pub thermometer: bool,
    /// Seed of the noise.
    pub seed: u64,
}

/// The recording of `truth`: white noise on every channel, then the converters' steps.
///
/// # Panics
/// The test has fewer than eight samples, or does not move.
pub fn record(name: String, truth: &Truth, sensors: &Sensors) -> Recording {
    let mut rng = ChaCha8Rng::seed_from_u64(sensors.seed);
    let largest = truth.force.iter().fold(0.0_f64, |x, f| x.max(f.abs()));
    let force_range = (1.2 * largest).log2().ceil().exp2();
    let time = truth.motion.iter().map(|m| m.time).collect();
    // Sample by sample, so that a longer test has the same noise at its beginning.
    let channels: Vec<[f64; 3]> = truth
        .motion
        .iter()
        .zip(&truth.force)
        .zip(&truth.temperature)
        .map(|((m, force), temperature)| {
            [
                noisy(
                    m.displacement,
                    DISPLACEMENT_NOISE,
                    2.0 * DISPLACEMENT_RANGE / STEPS,
                    &mut rng,
                ),
                noisy(
                    *force,
                    sensors.force_noise,
                    2.0 * force_range / STEPS,
                    &mut rng,
                ),
                noisy(*temperature, TEMPERATURE_NOISE, TEMPERATURE_STEP, &mut rng),
            ]
        })
        .collect();
    let channel = |i: usize| {
        channels
            .iter()
            .map(|sample| sample[i])
            .collect::<Vec<f64>>()
    };
    let recording = Recording::new(name, time, channel(0), channel(1));
    let recording = if sensors.thermometer {
        recording.and_then(|recording| recording.with_temperature(channel(2)))
    } else {
        recording
    };
    let recording = match truth.control.as_slice() {
        [] => recording,
        // The set value is known exactly.
        control => recording.and_then(|r| r.with_control(CURRENT, control.to_vec())),
    };
    recording.expect("a simulated test moves")
}

fn noisy(value: f64, noise: f64, step: f64, rng: &mut impl Rng) -> f64 {
    let normal: f64 = StandardNormal.sample(rng);
    ((value + noise * normal) / step).round() * step
}
