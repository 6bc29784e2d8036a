//! A measured velocity that is not the derivative of the displacement.

use super::super::resample::Uniform;
use super::{Channel, Fault, Kind, median_filtered, quantile};

/// Correlation with the derivative below which a velocity is none.
const IS_DERIVATIVE: f64 = 0.8;
/// A velocity between these times the derivative has the unit that its column says.
const SAME_UNIT: std::ops::Range<f64> = 0.7..1.4;
/// Factors between units, and how near to one a ratio has to be.
const THOUSANDS: [f64; 4] = [1e3, 1e-3, 1e6, 1e-6];
const NEAR: f64 = 0.2;

/// Mends the velocity of `uniform` where it is a unit or a sign off, and drops it where it is something else. `unknown`
/// displacements say nothing.
pub(super) fn examine(uniform: &mut Uniform, unknown: &[bool], faults: &mut Vec<Fault>) {
    let Some(velocity) = &mut uniform.velocity else {
        return;
    };
    let mut say = |kind| {
        faults.push(Fault {
            channel: Channel::Velocity,
            kind,
        });
    };
    let stride = stride(&uniform.displacement);
    let y = median_filtered(&uniform.displacement, 1);
    let pairs: Vec<(f64, f64)> = (stride..y.len() - stride)
        .filter(|&index| !unknown[index - stride..=index + stride].contains(&true))
        .map(|index| {
            // Both averaged over the same stretch.
            let slope =
                (y[index + stride] - y[index - stride]) / (2.0 * stride as f64 * uniform.period);
            let around = &velocity[index - stride..=index + stride];
            let ends = 0.5 * (around[0] + around[2 * stride]);
            let inner: f64 = around[1..2 * stride].iter().sum();
            (slope, (ends + inner) / (2 * stride) as f64)
        })
        .collect();
    let sum = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let (product, slopes, velocities) =
        (sum(|p| p.0 * p.1), sum(|p| p.0 * p.0), sum(|p| p.1 * p.1));
    let correlation = product / (slopes * velocities).sqrt();
    let ratio = product / slopes;
    // A velocity that never changes has no correlation.
    if correlation.is_nan() || correlation.abs() < IS_DERIVATIVE {
        say(Kind::NotDerivative);
        uniform.velocity = None;
        return;
    }
    if ratio < 0.0 {
        say(Kind::Flipped);
        velocity.iter_mut().for_each(|v| *v = -*v);
    }
    let size = ratio.abs();
    if SAME_UNIT.contains(&size) {
        return;
    }
    let Some(unit) = THOUSANDS
        .into_iter()
        .find(|unit| (size / unit - 1.0).abs() < NEAR)
    else {
        say(Kind::NotDerivative);
        uniform.velocity = None;
        return;
    };
    velocity.iter_mut().for_each(|v| *v /= unit);
    say(Kind::Unit {
        factor: 1.0 / unit,
        samples: velocity.len(),
        mended: true,
    });
}

/// Samples to each side that a slope is taken over, so that the displacement's rounding and noise are small beside it.
fn stride(displacement: &[f64]) -> usize {
    let noise = super::super::noise::noise_deviation(displacement);
    (1..=16)
        .find(|&stride| {
            let mut steps: Vec<f64> = displacement
                .windows(2 * stride + 1)
                .map(|w| (w[2 * stride] - w[0]).abs())
                .collect();
            quantile(&mut steps, 0.8) > 10.0 * noise
        })
        .unwrap_or(16)
}
