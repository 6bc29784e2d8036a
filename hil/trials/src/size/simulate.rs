//! Simulated tests of any number of rows.

use std::f64::consts::TAU;

use mesh_damper_recording::Recording;
use mesh_damper_reference::protocol::{MotionSample, TestBlock};
use mesh_damper_reference::tables;
use mesh_damper_rig::specimen::{DamperForce, HiddenEffect, Specimen};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::blind::{Sensors, Truth, answer, record};

/// The motion of a specimen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Blocks of sines, at 1 kHz.
    Sines,
    /// A random motion without similar cycles, at 100 Hz.
    Random,
}

impl Motion {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Sines, Self::Random];

    /// Its name in file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sines => "sines",
            Self::Random => "random",
        }
    }

    /// Its name in a table.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Sines => "blocks of sines",
            Self::Random => "random",
        }
    }

    /// Rows a second.
    pub fn rate(self) -> f64 {
        match self {
            Self::Sines => 1000.0,
            Self::Random => 100.0,
        }
    }
}

/// Density of the specimen, g/cm³.
const DENSITY: f64 = 3.0;
/// Its effect in addition to the mixed damping law: a trace then finds an effect, and takes longer than without.
const HIDDEN: HiddenEffect = HiddenEffect::Relaxation {
    stiffness: 1.0,
    time: 0.05,
};
const SENSORS: Sensors = Sensors {
    force_noise: 1e-3,
    thermometer: false,
    seed: 1,
};
/// Amplitudes of the blocks, mm, and their frequencies, Hz: each amplitude slowly and fast. Convention: the paper's.
const AMPLITUDES: [f64; 4] = [0.05, 0.1, 0.15, 0.2];
const FREQUENCIES: [f64; 2] = [1.0, 5.0];
/// Number of tones of the random motion, and their band, Hz. Convention: the vibration of a machine on a floor.
const TONES: usize = 60;
const BAND: [f64; 2] = [0.5, 8.0];
/// Its displacement, mm RMS.
const RMS: f64 = 0.06;

/// A test of a specimen with one hidden effect, with `rows` rows. Blocks of sines have up to an eighth more or less, because they
/// consist of whole cycles.
///
/// # Panics
/// With fewer than 32 rows.
pub fn simulate(motion: Motion, rows: usize) -> Recording {
    assert!(rows >= 32, "a test of {rows} rows is none");
    let truth = match motion {
        Motion::Sines => sines(rows),
        Motion::Random => random(rows),
    };
    record(
        format!("{} of {rows} rows", motion.name()),
        &truth,
        &SENSORS,
    )
}

fn sines(rows: usize) -> Truth {
    let rate = Motion::Sines.rate();
    let blocks = AMPLITUDES.len() * FREQUENCIES.len();
    let time = rows as f64 / rate / blocks as f64;
    let blocks: Vec<TestBlock> = AMPLITUDES
        .iter()
        .flat_map(|&amplitude| FREQUENCIES.map(|frequency| (amplitude, frequency)))
        .map(|(amplitude, frequency)| TestBlock {
            amplitude,
            frequency,
            cycles: (time * frequency).round().max(1.0) as u32,
        })
        .collect();
    answer(DENSITY, &[HIDDEN], &blocks, rate, rate)
}

fn random(rows: usize) -> Truth {
    let step = 1.0 / Motion::Random.rate();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut tones: Vec<Tone> = (0..TONES)
        .map(|_| {
            let turn = TAU * rng.random_range(BAND[0]..BAND[1]);
            Tone::new(turn, rng.random_range(0.0..TAU), step)
        })
        .collect();
    // A sum of this many sines with random phases is normal about 0; its variance is half the sum of their squared amplitudes.
    let size = RMS * (2.0 / TONES as f64).sqrt();
    let mut specimen = Specimen::new(tables::interpolate(DENSITY, AMPLITUDES[1])).with(HIDDEN);
    let mut truth = Truth {
        motion: Vec::with_capacity(rows),
        force: Vec::with_capacity(rows),
        temperature: Vec::with_capacity(rows),
        control: Vec::new(),
        block: vec![0; rows],
    };
    for row in 0..rows {
        let [displacement, velocity, acceleration] = tones
            .iter_mut()
            .map(Tone::next)
            .fold([0.0; 3], |sum, tone| {
                [0, 1, 2].map(|i| sum[i] + size * tone[i])
            });
        let now = MotionSample {
            time: row as f64 * step,
            displacement,
            velocity,
            acceleration,
        };
        truth
            .force
            .push(specimen.force(now.time, displacement, velocity, acceleration, step));
        truth.temperature.push(specimen.temperature());
        truth.motion.push(now);
    }
    truth
}

/// A sine with its derivatives, each step rotated from the one before: millions of sines take longer than everything else here.
struct Tone {
    /// rad/s
    turn: f64,
    at: [f64; 2],
    ahead: [f64; 2],
}

impl Tone {
    fn new(turn: f64, phase: f64, step: f64) -> Self {
        let of = |angle: f64| [angle.sin(), angle.cos()];
        Self {
            turn,
            at: of(phase),
            ahead: of(turn * step),
        }
    }

    fn next(&mut self) -> [f64; 3] {
        let ([s, c], [ds, dc]) = (self.at, self.ahead);
        self.at = [s * dc + c * ds, c * dc - s * ds];
        [s, self.turn * c, -self.turn * self.turn * s]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_has_its_rows_and_its_rate() {
        for motion in Motion::ALL {
            let recording = simulate(motion, 100_000);
            let off = (recording.len() as f64 / 1e5 - 1.0).abs();
            assert!(off < 0.05, "{} rows", recording.len());
            let rate = 1.0 / recording.sample_period();
            assert!((rate / motion.rate() - 1.0).abs() < 1e-6, "{rate} Hz");
        }
    }

    #[test]
    fn the_random_motion_has_its_size() {
        let displacement = simulate(Motion::Random, 50_000).displacement;
        let squares = displacement.iter().map(|y| y * y).sum::<f64>();
        let rms = (squares / displacement.len() as f64).sqrt();
        assert!((rms / RMS - 1.0).abs() < 0.05, "{rms} mm");
    }
}
