//! A force whose sign is turned: against the displacement and giving energy at once.

use super::super::Recording;
use super::{Channel, ChannelFault, ChannelFaultKind, median_filtered};
use crate::policy::policy;

crate::numbers! {
    /// When a force has the wrong sign.
    SignPolicy {
        /// The energy's way is certain where the work is more than this part of what the force could do.
        certain: f64 = 0.03, Tuned("the injected channel faults");
        /// The force stands against the motion where its correlation with the displacement is below this.
        against: f64 = -0.2, Tuned("the injected channel faults");
        /// Samples that a step of displacement is taken over, so that its noise is small beside it.
        stride: usize = 4, Convention("a fiftieth of a cycle of 5 Hz at 1 kHz");
    }
}

/// Turns the force of `recording` where no passive damper has it as recorded.
///
/// A force late by more than the loss angle gives energy too, but keeps a positive stiffness; a mass turns the stiffness
/// negative, but takes energy.
pub(super) fn mend(recording: &mut Recording) {
    if !is_flipped(&recording.displacement, &recording.force) {
        return;
    }
    recording
        .force
        .iter_mut()
        .for_each(|force| *force = -*force);
    recording.faults.push(ChannelFault {
        channel: Channel::Force,
        kind: ChannelFaultKind::Flipped,
    });
}

fn is_flipped(displacement: &[f64], force: &[f64]) -> bool {
    // A spike must not decide.
    let y = about_mean(median_filtered(displacement, 2));
    let f = about_mean(median_filtered(force, 2));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let correlation = product(&y, &f) / (product(&y, &y) * product(&f, &f)).sqrt();
    let (mut work, mut most) = (0.0, 0.0);
    for index in policy().sign.stride..y.len() {
        let done =
            f[index - policy().sign.stride / 2] * (y[index] - y[index - policy().sign.stride]);
        work += done;
        most += done.abs();
    }
    correlation < policy().sign.against && work < -policy().sign.certain * most
}

fn about_mean(mut values: Vec<f64>) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
    values
}
