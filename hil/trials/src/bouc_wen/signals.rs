//! The benchmark's excitations.

use std::f64::consts::TAU;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Sampling rate, Hz.
pub const RATE: f64 = 750.0;
/// Lowest and highest frequency of a multisine, Hz.
const BAND: [f64; 2] = [5.0, 150.0];
/// RMS of a multisine, N.
const MULTISINE_RMS: f64 = 50.0;
/// Frequencies of the sweep, Hz, and its amplitude, N.
const SWEEP: [f64; 2] = [20.0, 50.0];
const SWEEP_AMPLITUDE: f64 = 40.0;

/// One period of a multisine with random phases at every line of the band, N, at `points` equal steps; the period has `samples`
/// samples of [`RATE`].
pub fn multisine(samples: usize, points: usize, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let spacing = RATE / samples as f64;
    let [first, last] = [(BAND[0] / spacing).ceil(), (BAND[1] / spacing).floor()];
    let mut force = vec![0.0; points];
    for line in first as usize..=last as usize {
        let (mut sin, mut cos) = random.random_range(0.0..TAU).sin_cos();
        let (turn_sin, turn_cos) = (TAU * line as f64 / points as f64).sin_cos();
        for point in &mut force {
            *point += cos;
            (sin, cos) = (
                sin * turn_cos + cos * turn_sin,
                cos * turn_cos - sin * turn_sin,
            );
        }
    }
    let mean_square = force.iter().map(|u| u * u).sum::<f64>() / points as f64;
    let scale = MULTISINE_RMS / mean_square.sqrt();
    force.iter().map(|u| scale * u).collect()
}

/// A sine sweep, N, `time` s after its start, whose frequency rises by `rate` Hz a minute.
pub fn sweep(time: f64, rate: f64) -> f64 {
    SWEEP_AMPLITUDE * (TAU * (SWEEP[0] + 0.5 * rate / 60.0 * time) * time).sin()
}

/// Duration of the sweep, s.
pub fn sweep_time(rate: f64) -> f64 {
    60.0 * (SWEEP[1] - SWEEP[0]) / rate
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_multisine_has_its_size_and_its_band() {
        let samples = 1024;
        let force = multisine(samples, samples, 1);
        let rms = (force.iter().map(|u| u * u).sum::<f64>() / samples as f64).sqrt();
        assert!((rms - MULTISINE_RMS).abs() < 1e-9);
        let power = |frequency: f64| {
            let part = |turn: f64| -> f64 {
                let each = force.iter().enumerate();
                each.map(|(i, u)| u * (TAU * frequency * i as f64 / RATE + turn).sin())
                    .sum()
            };
            part(0.0).hypot(part(TAU / 4.0))
        };
        // Lines are 0.73 Hz apart.
        let line = |number: f64| power(number * RATE / samples as f64);
        assert!((line(20.0) / line(150.0) - 1.0).abs() < 1e-9);
        assert!(line(3.0) < 1e-6 * line(20.0) && line(210.0) < 1e-6 * line(20.0));
        assert_ne!(force, multisine(samples, samples, 2));
    }

    #[test]
    fn a_sweep_ends_at_its_last_frequency() {
        let (rate, end) = (10.0, sweep_time(10.0));
        assert_eq!(end, 180.0);
        let crossings = |from: f64, to: f64| {
            let count = 100_000;
            let at = |i: i32| sweep(from + (to - from) * f64::from(i) / f64::from(count), rate);
            (0..count)
                .filter(|&i| at(i) < 0.0 && at(i + 1) >= 0.0)
                .count()
        };
        assert!((19..=21).contains(&crossings(0.0, 1.0)));
        assert!((49..=51).contains(&crossings(end - 1.0, end)));
    }
}
