//! Displacement and force in each other's columns.
//!
//! A passive specimen takes energy in: its force leads its displacement. With the two exchanged it leads backwards, in every block and
//! at every frequency, while the stiffness stays positive. A force that is late by more than the loss angle looks the same in a single
//! block. But a test moves the displacement, so that this is the smoother channel of the two: friction, a stop and every other property
//! of the specimen put corners into the force.

use std::f64::consts::TAU;

use nalgebra::{Cholesky, SMatrix, SVector};

use super::super::Recording;
use super::super::cycles::{Cycles, median};
use super::super::noise::noise_deviation;
use super::kind::{ChannelFault, ChannelFaultKind};
use super::median_filtered;
use super::sign::{SignPolicy, work};
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::control::correlation;

crate::numbers! {
    /// When displacement and force are exchanged.
    ExchangedPolicy {
        /// A channel is rougher than the other if its part beside the fundamental is more than this many times that of the other, both
        /// relative to the fundamental and without noise.
        rougher: f64 = 2.0, Convention("twice: a test that moves a force has a rough displacement too, but then the specimen takes energy in");
        /// The part beside the fundamental counts from this on, relative to the fundamental; a motion that is made has less in a block.
        visible: f64 = 0.005, Convention("half a per cent, below what friction makes and above what a servo leaves");
        /// A velocity is that of a channel if it is the channel's rate of change to within this fraction.
        slope: f64 = 0.1, Convention("a tenth, more than a sensor is off, and less than what two stiffnesses share by chance");
        /// A block is steady if it has at least this many cycles.
        steady: usize = 3, Convention("one cycle more than a start and an end");
    }
}

/// The mean, and cosine and sine of the fundamental.
const TERMS: usize = 3;

/// Exchanges displacement and force if no passive specimen can have them as recorded, and the displacement looks like a force. Says so if
/// only the former is certain. Whether it did either.
pub(super) fn repair(recording: &mut Recording) -> bool {
    let is_known = |fault: &ChannelFault| matches!(fault.kind, ChannelFaultKind::Exchanged { .. });
    if recording.faults.iter().any(is_known) {
        return false;
    }
    let Some(repaired) = found(recording) else {
        return false;
    };
    if repaired {
        // Each column keeps its name, so that its numbers are in the unit of the other quantity.
        let factor = recording.units.displacement.scale / recording.units.force.scale;
        std::mem::swap(&mut recording.displacement, &mut recording.force);
        recording.displacement.iter_mut().for_each(|y| *y *= factor);
        recording
            .force
            .iter_mut()
            .for_each(|force| *force /= factor);
    }
    recording.faults.push(ChannelFault {
        channel: Channel::Displacement,
        kind: ChannelFaultKind::Exchanged { repaired },
    });
    true
}

/// Whether the two are certainly exchanged; `None` if nothing speaks for that.
fn found(recording: &Recording) -> Option<bool> {
    let tick = recording.sample_period();
    // A spike must not decide.
    let [y, f] = [&recording.displacement, &recording.force].map(|all| median_filtered(all, 2));
    if let Some(velocity) = &recording.velocity {
        // A velocity says whose it is, whatever the specimen.
        let units = &recording.units;
        let factor = units.displacement.scale / units.force.scale;
        let [is_of_y, is_of_f] = [(&y, 1.0), (&f, factor)]
            .map(|(channel, factor)| is_rate(velocity, channel, factor / tick));
        match (is_of_y, is_of_f) {
            (true, false) => return None,
            (false, true) => return Some(true),
            _ => {}
        }
    }
    if correlation(&y, &f) < SignPolicy::in_use().with || !gives(&y, &f, 0..y.len()) {
        return None;
    }
    let ExchangedPolicy {
        rougher,
        visible,
        steady,
        ..
    } = *ExchangedPolicy::in_use();
    let blocks = Cycles::of(&y, tick).blocks;
    let mut blocks = blocks.iter().filter(|block| block.cycles.len() >= steady);
    let noise = [&recording.displacement, &recording.force].map(|all| noise_deviation(all));
    let [mut is_any, mut is_rough_motion, mut is_rough_force] = [false; 3];
    let all_give = blocks.all(|block| {
        is_any = true;
        let (first, last) = (&block.cycles[0], &block.cycles[block.cycles.len() - 1]);
        // A cycle in which the block begins must not decide either.
        let [of_y, of_f] = [
            (&recording.displacement, noise[0]),
            (&recording.force, noise[1]),
        ]
        .map(|(all, noise)| {
            let parts = block.cycles.iter();
            let part = median(parts.filter_map(|cycle| beside(&all[cycle.clone()], noise)));
            part.unwrap_or(0.0).max(0.0).sqrt()
        });
        is_rough_motion |= of_y > visible && of_y > rougher * of_f && of_f <= visible;
        is_rough_force |= of_f > visible && of_f > rougher * of_y;
        gives(&y, &f, first.start..last.end)
    });
    match (is_rough_motion, is_rough_force) {
        _ if !(is_any && all_give) => None,
        (true, false) => Some(true),
        (false, true) => None,
        _ => Some(false),
    }
}

/// Whether `velocity` is the rate of change of `channel`, in whose unit per sample it is when divided by `per_sample`. Noise of the
/// channel does not change the slope.
fn is_rate(velocity: &[f64], channel: &[f64], per_sample: f64) -> bool {
    let (mut product, mut square) = (0.0, 0.0);
    for (around, v) in channel.windows(3).zip(&velocity[1..]) {
        product += 0.5 * (around[2] - around[0]) * per_sample * v;
        square += v * v;
    }
    (product / square - 1.0).abs() < ExchangedPolicy::in_use().slope
}

/// Whether the specimen supplies energy in these samples.
fn gives(y: &[f64], f: &[f64], samples: std::ops::Range<usize>) -> bool {
    let SignPolicy {
        stride, certain, ..
    } = *SignPolicy::in_use();
    let [work, most] = work(y, f, samples, stride);
    work < -certain * most
}

/// The squared part of a cycle beside its mean and fundamental, without noise of this deviation, relative to the squared fundamental.
fn beside(values: &[f64], noise: f64) -> Option<f64> {
    let row = |index: usize| {
        let (sin, cos) = (TAU * index as f64 / values.len() as f64).sin_cos();
        SVector::from([1.0, cos, sin])
    };
    let mut gram = SMatrix::<f64, TERMS, TERMS>::zeros();
    let mut right = SVector::<f64, TERMS>::zeros();
    for (index, &value) in values.iter().enumerate() {
        let row = row(index);
        gram += row * row.transpose();
        right += row * value;
    }
    let terms = Cholesky::new(gram)?.solve(&right);
    let left = values.iter().enumerate();
    let left = left.map(|(index, value)| (value - row(index).dot(&terms)).powi(2));
    let free = values.len().saturating_sub(TERMS) as f64;
    let fundamental = 0.5 * (terms[1].powi(2) + terms[2].powi(2));
    (free > 0.0 && fundamental > 0.0)
        .then(|| (left.sum::<f64>() / free - noise * noise) / fundamental)
}
