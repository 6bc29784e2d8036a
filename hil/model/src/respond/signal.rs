//! A sampled signal and its slope between its samples.
//!
//! A force that is sampled a few times a period is no polygon: straight lines between the samples would take a part of its
//! amplitude. So a smooth signal is interpolated by a windowed sinc, which gives back what lies below 0.3 of the sampling rate.
//! That would ring beside a jump, so that a signal with jumps is interpolated by cubics through its samples.

use std::f64::consts::PI;

/// Samples that a sinc reaches over to each side.
const REACH: usize = 24;
/// Width of the sinc's Gaussian window, samples: at the ends of the reach it is e^(−16) = 1e-7, and a sine at 0.3 of the sampling
/// rate is off by erfc(π·6·0.2) = 1e-7 of its amplitude.
const WIDTH: f64 = 6.0;
/// Differences that are taken to see a jump: of a sine at 0.2 of the sampling rate they leave a 71st.
const DIFFERENCES: u32 = 8;
/// A signal whose differences exceed this part of its range has jumps: those of a jump by a seventh of the range do, and those of a
/// sine do above 0.23 of the sampling rate.
const JUMP: f64 = 0.02;

/// A signal at equal steps of time, finer than its samples.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fine {
    /// The signal.
    pub values: Vec<f64>,
    /// Its slope, per s.
    pub slopes: Vec<f64>,
}

/// `samples`, which are `tick` s apart, with `substeps` steps between each two, ends included.
pub(super) fn refined(samples: &[f64], tick: f64, substeps: usize) -> Fine {
    let last = samples.len().saturating_sub(1);
    // Beyond an end the signal goes on as before it, turned about the end: value and slope are continuous there.
    let sample = |index: isize| match usize::try_from(index) {
        Err(_) => 2.0 * samples[0] - samples[index.unsigned_abs().min(last)],
        Ok(index) if index > last => {
            2.0 * samples[last] - samples[(2 * last).saturating_sub(index)]
        }
        Ok(index) => samples[index],
    };
    let kernel: Vec<Vec<[f64; 2]>> = {
        let jumps = has_jumps(samples);
        (0..substeps)
            .map(|part| {
                let part = part as f64 / substeps as f64;
                if jumps { cubic(part) } else { sinc(part) }
            })
            .collect()
    };
    let points = last * substeps + 1;
    let mut fine = Fine {
        values: Vec::with_capacity(points),
        slopes: Vec::with_capacity(points),
    };
    for point in 0..points {
        let (at, weights) = (point / substeps, &kernel[point % substeps]);
        let first = at as isize + 1 - (weights.len() / 2) as isize;
        let (mut value, mut slope) = (0.0, 0.0);
        for (index, [of_value, of_slope]) in (first..).zip(weights) {
            let sample = sample(index);
            value += of_value * sample;
            slope += of_slope * sample;
        }
        fine.values.push(value);
        fine.slopes.push(slope / tick);
    }
    fine
}

/// Whether the signal has jumps, or as good as that.
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

/// Weights for the value and for the slope, a `part` of a step after the sample in the middle of the first half.
fn sinc(part: f64) -> Vec<[f64; 2]> {
    let mut weights: Vec<[f64; 2]> = (0..2 * REACH)
        .map(|index| {
            let t = part - (index as f64 + 1.0 - REACH as f64);
            let (sin, cos) = (PI * t).sin_cos();
            let [sinc, steepness] = if t.abs() < 1e-6 {
                [1.0, -PI * PI * t / 3.0]
            } else {
                [sin / (PI * t), (cos - sin / (PI * t)) / t]
            };
            let window = (-(t / WIDTH).powi(2)).exp();
            [
                sinc * window,
                (steepness - 2.0 * t / (WIDTH * WIDTH) * sinc) * window,
            ]
        })
        .collect();
    // A constant stays one.
    let sum: f64 = weights.iter().map(|weight| weight[0]).sum();
    let drift: f64 = weights.iter().map(|weight| weight[1]).sum();
    let count = weights.len() as f64;
    for [value, slope] in &mut weights {
        *value /= sum;
        *slope -= drift / count;
    }
    weights
}

/// The same of the cubic through two samples whose slopes are those of the parabolas through them and their neighbours.
fn cubic(part: f64) -> Vec<[f64; 2]> {
    let u = part;
    let (u2, u3) = (u * u, u * u * u);
    vec![
        [0.5 * (2.0 * u2 - u3 - u), 0.5 * (4.0 * u - 3.0 * u2 - 1.0)],
        [
            0.5 * (3.0 * u3 - 5.0 * u2 + 2.0),
            0.5 * (9.0 * u2 - 10.0 * u),
        ],
        [
            0.5 * (4.0 * u2 - 3.0 * u3 + u),
            0.5 * (8.0 * u - 9.0 * u2 + 1.0),
        ],
        [0.5 * (u3 - u2), 0.5 * (3.0 * u2 - 2.0 * u)],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Five samples a period: straight lines would take 13 % of the amplitude.
    #[test]
    fn a_sine_of_five_samples_a_period_comes_back_with_its_slope() {
        let (tick, frequency) = (0.002, 100.0);
        let omega = TAU * frequency;
        let samples: Vec<f64> = (0..400)
            .map(|i| (omega * tick * f64::from(i)).sin())
            .collect();
        let fine = refined(&samples, tick, 7);
        for point in 60 * 7..340 * 7 {
            let time = tick * point as f64 / 7.0;
            assert!((fine.values[point] - (omega * time).sin()).abs() < 1e-6);
            assert!((fine.slopes[point] - omega * (omega * time).cos()).abs() < 1e-5 * omega);
        }
    }

    #[test]
    fn a_jump_does_not_ring() {
        let samples: Vec<f64> = (0..100).map(|i| f64::from(u8::from(i >= 50))).collect();
        let fine = refined(&samples, 0.01, 8);
        assert!(fine.values[..48 * 8].iter().all(|&value| value == 0.0));
        let most = fine.values.iter().fold(0.0_f64, |most, &v| most.max(v));
        // A cubic overshoots by 2/27 in the step beside the jump.
        assert!(most < 1.0 + 2.01 / 27.0, "{most}");
        assert!(
            fine.values[52 * 8..]
                .iter()
                .all(|&value| (value - 1.0).abs() < 1e-12)
        );
    }

    #[test]
    fn a_constant_and_a_ramp_stay_what_they_are() {
        let ramp: Vec<f64> = (0..80).map(|i| 2.0 - 0.5 * f64::from(i)).collect();
        let fine = refined(&ramp, 0.1, 3);
        for (point, (value, slope)) in fine.values.iter().zip(&fine.slopes).enumerate() {
            assert!((value - (2.0 - 0.5 * point as f64 / 3.0)).abs() < 1e-6);
            assert!((slope + 5.0).abs() < 1e-5, "{slope}");
        }
        let constant = refined(&[3.0; 9], 0.1, 2);
        assert!(
            constant
                .values
                .iter()
                .all(|value| (value - 3.0).abs() < 1e-12)
        );
        assert!(constant.slopes.iter().all(|slope| slope.abs() < 1e-9));
    }
}
