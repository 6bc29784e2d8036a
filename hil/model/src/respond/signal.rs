//! A sampled signal between its samples.
//!
//! Straight lines between the samples would reduce the amplitude of a force that has only a few samples in a period. So a smooth
//! signal is interpolated by a windowed sinc, which preserves frequencies below 0.3 of the sampling rate. A sinc would ring next to
//! a jump, so a signal with jumps is interpolated by cubics through its samples.

use std::f64::consts::PI;

/// Samples that a sinc covers on each side.
const REACH: usize = 24;
/// Width of the sinc's Gaussian window, samples: at the ends of the reach it is e^(−16) = 1e-7, and a sine at 0.3 of the sampling
/// rate is off by erfc(π·6·0.2) = 1e-7 of its amplitude.
const WIDTH: f64 = 6.0;
/// Order of the differences that reveal a jump: they leave a 71st of a sine at 0.2 of the sampling rate.
const DIFFERENCES: u32 = 8;
/// A signal has jumps if its differences exceed this fraction of its range. The differences of a jump by a seventh of the range do,
/// and those of a sine do above 0.23 of the sampling rate.
const JUMP: f64 = 0.02;

/// `samples`, at least two, with `substeps` steps between each two, both ends included.
pub(super) fn refined(samples: &[f64], substeps: usize) -> Vec<f64> {
    let last = samples.len() - 1;
    // Beyond an end the signal continues as its own image, rotated about the end: value and slope are continuous there.
    let sample = |index: isize| match usize::try_from(index) {
        Err(_) => 2.0 * samples[0] - samples[index.unsigned_abs().min(last)],
        Ok(index) if index > last => {
            2.0 * samples[last] - samples[(2 * last).saturating_sub(index)]
        }
        Ok(index) => samples[index],
    };
    let weights_at = if has_jumps(samples) { cubic } else { sinc };
    let kernel: Vec<Vec<f64>> = (0..substeps)
        .map(|part| weights_at(part as f64 / substeps as f64))
        .collect();
    (0..=last * substeps)
        .map(|point| {
            let (at, weights) = (point / substeps, &kernel[point % substeps]);
            let first = at as isize + 1 - (weights.len() / 2) as isize;
            let each = (first..).zip(weights);
            each.map(|(index, weight)| weight * sample(index)).sum()
        })
        .collect()
}

/// Whether the signal has jumps or changes nearly as fast.
fn has_jumps(samples: &[f64]) -> bool {
    let mut differences = samples.to_vec();
    for _ in 0..DIFFERENCES {
        differences = differences
            .windows(2)
            .map(|pair| 0.5 * (pair[1] - pair[0]))
            .collect();
    }
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let (low, high) = mesh_damper_recording::extremes::least_and_largest(samples);
    largest(&differences) > JUMP * (high - low)
}

/// Weights of the samples about a place that is `part` of a step after the last sample of their first half.
fn sinc(part: f64) -> Vec<f64> {
    let weight = |index: usize| {
        let t = part - (index as f64 + 1.0 - REACH as f64);
        let sinc = if t.abs() < 1e-9 {
            1.0
        } else {
            (PI * t).sin() / (PI * t)
        };
        sinc * (-(t / WIDTH).powi(2)).exp()
    };
    let weights: Vec<f64> = (0..2 * REACH).map(weight).collect();
    // A constant remains constant.
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|weight| weight / sum).collect()
}

/// The weights of the cubic through two samples, with the slopes of the parabolas through them and their neighbours.
fn cubic(part: f64) -> Vec<f64> {
    let (u, u2, u3) = (part, part * part, part * part * part);
    [
        2.0 * u2 - u3 - u,
        3.0 * u3 - 5.0 * u2 + 2.0,
        4.0 * u2 - 3.0 * u3 + u,
        u3 - u2,
    ]
    .map(|weight| 0.5 * weight)
    .into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Five samples a period: straight lines would reduce the amplitude by 13 %.
    #[test]
    fn a_sine_of_five_samples_a_period_comes_back() {
        let sine = |place: f64| (TAU * place / 5.0).sin();
        let samples: Vec<f64> = (0..400).map(|i| sine(f64::from(i))).collect();
        let fine = refined(&samples, 7);
        let inner = fine.iter().enumerate().take(340 * 7).skip(60 * 7);
        for (point, value) in inner {
            assert!((value - sine(point as f64 / 7.0)).abs() < 1e-6);
        }
    }

    #[test]
    fn a_jump_does_not_ring() {
        let samples: Vec<f64> = (0..100).map(|i| f64::from(u8::from(i >= 50))).collect();
        let fine = refined(&samples, 8);
        assert!(fine[..48 * 8].iter().all(|&value| value == 0.0));
        let most = fine.iter().fold(0.0_f64, |most, &v| most.max(v));
        // A cubic overshoots by 2/27 in the step next to the jump.
        assert!(most < 1.0 + 2.01 / 27.0, "{most}");
        let after = &fine[52 * 8..];
        assert!(after.iter().all(|&value| (value - 1.0).abs() < 1e-12));
    }

    #[test]
    fn a_constant_and_a_ramp_stay_what_they_are() {
        let ramp: Vec<f64> = (0..80).map(|i| 2.0 - 0.5 * f64::from(i)).collect();
        for (point, value) in refined(&ramp, 3).iter().enumerate() {
            assert!((value - (2.0 - 0.5 * point as f64 / 3.0)).abs() < 1e-6);
        }
        let constant = refined(&[3.0; 9], 2);
        assert!(constant.iter().all(|value| (value - 3.0).abs() < 1e-12));
    }
}
