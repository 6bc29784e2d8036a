//! A force whose sign is turned: against the displacement and giving energy at once.

use super::super::Recording;
use super::{Channel, Fault, Kind, median_filtered};

/// Part of the work that the force could do, above which the energy's way is certain.
const CERTAIN: f64 = 0.03;
/// Correlation of force with displacement below which the force stands against the motion.
const AGAINST: f64 = -0.2;
/// Samples that a step of displacement is taken over.
const STRIDE: usize = 4;

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
    recording.faults.push(Fault {
        channel: Channel::Force,
        kind: Kind::Flipped,
    });
}

fn is_flipped(displacement: &[f64], force: &[f64]) -> bool {
    // A spike must not decide.
    let y = about_mean(median_filtered(displacement, 2));
    let f = about_mean(median_filtered(force, 2));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let correlation = product(&y, &f) / (product(&y, &y) * product(&f, &f)).sqrt();
    let (mut work, mut most) = (0.0, 0.0);
    for index in STRIDE..y.len() {
        let done = f[index - STRIDE / 2] * (y[index] - y[index - STRIDE]);
        work += done;
        most += done.abs();
    }
    correlation < AGAINST && work < -CERTAIN * most
}

fn about_mean(mut values: Vec<f64>) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter_mut().for_each(|value| *value -= mean);
    values
}
