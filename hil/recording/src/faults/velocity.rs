//! A measured velocity that is not the derivative of the displacement.

use super::super::resample::Uniform;
use crate::extremes::quantile;
use mesh_damper_tables::channel::Channel;

use super::kind::{ChannelFault, ChannelFaultKind};
use super::median_filtered;

crate::numbers! {
    /// When a measured velocity is not the derivative of the displacement.
    VelocityPolicy {
        /// A measured velocity is dropped if the magnitude of its correlation with the derivative of the displacement is below this.
        is_derivative: f64 = 0.8, Tuned("the injected channel faults");
        /// A measured velocity has the unit that its column states if its ratio to the derivative of the displacement is between these two.
        same_unit: [f64; 2] = [0.7, 1.4], Tuned("the injected channel faults");
        /// A measured velocity has another unit if its ratio to the derivative of the displacement is 10³, 10⁻³, 10⁶ or 10⁻⁶ to within this
        /// fraction; otherwise it is dropped.
        near: f64 = 0.2, Tuned("the injected channel faults");
        /// The derivative of the displacement is taken over enough samples that its steps are more than this many times the noise.
        beyond_noise: f64 = 10.0, Tuned("the injected channel faults");
        /// The steps of a displacement are as large as the step below which this fraction of them lie.
        moving: f64 = 0.8, Convention("one step in five is larger");
        /// The derivative of the displacement is taken over at most this many samples to each side.
        longest_stride: usize = 16, Convention("a slow motion that is sampled fast needs as many");
    }
}

/// Factors between units. Derived: the prefixes of the SI.
const THOUSANDS: [f64; 4] = [1e3, 1e-3, 1e6, 1e-6];

/// Repairs the velocity of `uniform` if its unit or sign is wrong, and drops it if it is another quantity. `unknown` displacements
/// are ignored.
pub(super) fn examine(uniform: &mut Uniform, unknown: &[bool], faults: &mut Vec<ChannelFault>) {
    let Some(velocity) = &mut uniform.velocity else {
        return;
    };
    let mut say = |kind| {
        faults.push(ChannelFault {
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
    if correlation.is_nan() || correlation.abs() < VelocityPolicy::in_use().is_derivative {
        say(ChannelFaultKind::NotDerivative);
        uniform.velocity = None;
        return;
    }
    if ratio < 0.0 {
        say(ChannelFaultKind::Flipped);
        velocity.iter_mut().for_each(|v| *v = -*v);
    }
    let size = ratio.abs();
    let [least, most] = VelocityPolicy::in_use().same_unit;
    if (least..most).contains(&size) {
        return;
    }
    let Some(unit) = THOUSANDS
        .into_iter()
        .find(|unit| (size / unit - 1.0).abs() < VelocityPolicy::in_use().near)
    else {
        say(ChannelFaultKind::NotDerivative);
        uniform.velocity = None;
        return;
    };
    velocity.iter_mut().for_each(|v| *v /= unit);
    say(ChannelFaultKind::Unit {
        factor: 1.0 / unit,
        samples: velocity.len(),
        repaired: true,
    });
}

/// Samples to each side of a slope, so that the displacement's rounding and noise are small compared with it.
fn stride(displacement: &[f64]) -> usize {
    let noise = super::super::noise::noise_deviation(displacement);
    let longest = VelocityPolicy::in_use().longest_stride;
    (1..=longest)
        .find(|&stride| {
            let mut steps: Vec<f64> = displacement
                .windows(2 * stride + 1)
                .map(|w| (w[2 * stride] - w[0]).abs())
                .collect();
            quantile(&mut steps, VelocityPolicy::in_use().moving)
                > VelocityPolicy::in_use().beyond_noise * noise
        })
        .unwrap_or(longest)
}
