//! The part of a force that eq 13 cannot absorb.

use mesh_damper_reference::protocol::{MotionSample, TestBlock};
use nalgebra::{Matrix3, Vector3};

use super::test_rig::Truth;

/// Exponents tried first, 0.05 apart, before the best is refined.
const EXPONENTS: usize = 30;
const EXPONENT_STEP: f64 = 0.05;
/// Golden sections of the interval around the best.
const SECTIONS: usize = 16;

/// RMS of the residual when eq 13 is fitted to `truth`, with separate coefficients at each amplitude of `blocks`, kN.
///
/// The ramp into each block is left out: its amplitude is not that of the block.
pub fn left_by_eq13(truth: &Truth, blocks: &[TestBlock]) -> f64 {
    let mut amplitudes: Vec<f64> = blocks.iter().map(|b| b.amplitude).collect();
    amplitudes.sort_by(f64::total_cmp);
    amplitudes.dedup();
    let mut starts = vec![0.0];
    for block in blocks {
        starts.push(starts[starts.len() - 1] + f64::from(block.cycles) / block.frequency);
    }
    let (mut sum, mut count) = (0.0, 0);
    for amplitude in amplitudes {
        let samples: Vec<[f64; 3]> = (0..truth.force.len())
            .filter(|&i| {
                let block = &blocks[truth.block[i]];
                let since = truth.motion[i].time - starts[truth.block[i]];
                block.amplitude == amplitude && since >= 0.5 / block.frequency
            })
            .map(|i| {
                let m = &truth.motion[i];
                [m.displacement, m.velocity, truth.force[i]]
            })
            .collect();
        sum += least_squares(&samples);
        count += samples.len();
    }
    (sum / count as f64).sqrt()
}

/// Approximate number of samples that determine how much of an effect eq 13 absorbs over any motion.
const SIZED_BY: usize = 4000;

/// RMS of the residual of eq 13 with one set of coefficients for all amplitudes, kN.
pub fn left_by_one_eq13(motion: &[MotionSample], force: &[f64]) -> f64 {
    let step = (force.len() / SIZED_BY).max(1);
    let samples = motion.iter().zip(force).step_by(step);
    let samples: Vec<[f64; 3]> = samples
        .map(|(m, force)| [m.displacement, m.velocity, *force])
        .collect();
    (least_squares(&samples) / samples.len() as f64).sqrt()
}

/// Smallest sum of squares of force − eq 13 over (displacement, velocity, force): a linear problem for each exponent.
fn least_squares(samples: &[[f64; 3]]) -> f64 {
    let rest = |alpha: f64| linear_rest(samples, alpha);
    let tried = (0..=EXPONENTS).map(|i| i as f64 * EXPONENT_STEP);
    let best = tried
        .map(|alpha| (alpha, rest(alpha)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map_or(0.0, |(alpha, _)| alpha);
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = ((best - EXPONENT_STEP).max(0.0), best + EXPONENT_STEP);
    for _ in 0..SECTIONS {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if rest(a) < rest(b) {
            high = b;
        } else {
            low = a;
        }
    }
    rest(0.5 * (low + high)).min(rest(best))
}

/// The smallest sum of squares with exponent `alpha`.
fn linear_rest(samples: &[[f64; 3]], alpha: f64) -> f64 {
    let row = |&[y, v, _]: &[f64; 3]| {
        let friction = if v == 0.0 {
            0.0
        } else {
            v.abs().powf(alpha) * v.signum()
        };
        Vector3::new(y, y.powi(3), friction)
    };
    // Columns of unit size: displacement cubed is a thousandth of displacement.
    let mut scale = Vector3::zeros();
    for sample in samples {
        scale += row(sample).map(|x| x * x);
    }
    let scale = scale.map(|x: f64| if x > 0.0 { 1.0 / x.sqrt() } else { 0.0 });
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for sample in samples {
        let row = row(sample).component_mul(&scale);
        normal += row * row.transpose();
        right += row * sample[2];
    }
    let Some(solution) = normal.cholesky().map(|factor| factor.solve(&right)) else {
        return f64::INFINITY;
    };
    samples
        .iter()
        .map(|sample| (sample[2] - row(sample).component_mul(&scale).dot(&solution)).powi(2))
        .sum()
}
