//! A force with a reversed sign: opposite to the displacement, and supplying energy.

use std::ops::Range;

use super::super::Recording;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::control::correlation;

use super::kind::{ChannelFault, ChannelFaultKind};
use super::median_filtered;

crate::numbers! {
    /// When a force has the wrong sign.
    SignPolicy {
        /// The sign of a force is wrong if it supplies more than this fraction of the largest possible work, and its correlation with the
        /// displacement is below `against`.
        certain: f64 = 0.03, Tuned("the injected channel faults");
        /// A force whose correlation with the displacement is below this acts against a spring; its sign is wrong if it supplies energy too
        /// (see `certain`).
        against: f64 = -0.2, Tuned("the injected channel faults");
        /// The sign of a force is wrong if it supplies more than this fraction of the largest possible work, and its correlation with the
        /// displacement is below `with`: a damper with hardly any spring.
        gives: f64 = 0.5, Convention("a half: a sine supplies that with a phase 70° off, and the force of a spring is never that late");
        /// A force whose correlation with the displacement is at least this may be late, but its sign is not wrong.
        with: f64 = 0.3, Convention("at a smaller correlation the force leads or lags by 73° or more");
        /// The work is computed from steps of the displacement over this many samples, so that the noise is small compared with a step.
        stride: usize = 4, Convention("1/50 of a cycle of 5 Hz at 1 kHz");
    }
}

/// Reverses the force of `recording` if no passive damper can have it as recorded.
///
/// A force late by more than the loss angle supplies energy too, but keeps a positive stiffness. A mass makes the stiffness
/// negative, but absorbs energy. A damper without a spring has no stiffness as a criterion, but supplies nearly the largest
/// possible energy.
pub(super) fn repair(recording: &mut Recording) -> bool {
    if !is_flipped(&recording.displacement, &recording.force) {
        return false;
    }
    recording
        .force
        .iter_mut()
        .for_each(|force| *force = -*force);
    recording.faults.push(ChannelFault {
        channel: Channel::Force,
        kind: ChannelFaultKind::Flipped,
    });
    true
}

fn is_flipped(displacement: &[f64], force: &[f64]) -> bool {
    // A spike must not decide.
    let [y, f] = [displacement, force].map(|all| median_filtered(all, 2));
    let correlation = correlation(&y, &f);
    let [work, most] = work(&y, &f, 0..y.len(), SignPolicy::in_use().stride);
    let SignPolicy {
        certain,
        against,
        gives,
        with,
        ..
    } = *SignPolicy::in_use();
    correlation < against && work < -certain * most || correlation < with && work < -gives * most
}

/// Work of the force about its mean in these samples, and the work if all of it were done in one direction. Steps of the displacement are
/// over `stride` samples, so that its noise is small compared with them.
pub(crate) fn work(y: &[f64], f: &[f64], samples: Range<usize>, stride: usize) -> [f64; 2] {
    let mean = f[samples.clone()].iter().sum::<f64>() / samples.len() as f64;
    let (mut work, mut most) = (0.0, 0.0);
    for index in samples.start + stride..samples.end {
        let done = (f[index - stride / 2] - mean) * (y[index] - y[index - stride]);
        work += done;
        most += done.abs();
    }
    [work, most]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::is_flipped;

    /// For k·y + c·v under a sine, with the force late by a part of a cycle.
    fn is(stiffness: f64, damping: f64, late: f64) -> bool {
        let phase = |index: usize| TAU * index as f64 / 200.0;
        let samples = 0..2000;
        let displacement: Vec<f64> = samples.clone().map(|index| phase(index).sin()).collect();
        let force = |index: usize| {
            let (sin, cos) = (phase(index) - TAU * late).sin_cos();
            stiffness * sin + damping * cos
        };
        is_flipped(&displacement, &samples.map(force).collect::<Vec<_>>())
    }

    #[test]
    fn a_damper_that_is_no_spring_has_a_sign_too() {
        for stiffness in [-0.05, 0.0, 0.05, 0.2] {
            assert!(is(-stiffness, -1.0, 0.0), "{stiffness}");
            assert!(!is(stiffness, 1.0, 0.0), "{stiffness}");
        }
        assert!(!is(-3.0, 0.2, 0.0), "a mass");
        assert!(!is(1.0, 0.1, 0.15), "a spring with a late force");
        assert!(is(1.0, 0.1, 0.3), "no spring is late by 108°");
    }
}
