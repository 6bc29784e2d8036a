//! A value that was repeated while the motion went on: a stuck channel, or rows of a logger that had nothing new.

use super::super::noise::noise_deviation;
use super::super::resample::Uniform;
use super::{ChannelFault, ChannelFaultKind, quantile, runs, sampled, spread};
use crate::extremes::least_and_largest;
use crate::policy::policy;

crate::numbers! {
    /// Which values were repeated while the motion went on.
    HeldPolicy {
        /// A run of fewer equal samples is no held value.
        shortest: usize = 4, Tuned("the injected channel faults");
        /// A run is one that rounding would not make where its chance anywhere in the recording is below this.
        chance: f64 = 1e-4, Convention("one false alarm in ten thousand recordings");
        /// Samples to each side of a run that say how often neighbours are equal there.
        around: usize = 40, Tuned("the injected channel faults");
        /// A channel that is let go jumps by more than this many times the steps, the rounding or the noise before it was held.
        jump: f64 = 8.0, Tuned("the injected channel faults");
        /// Neighbours differ by chance where the noise is more than this part of the rounding's step.
        noisy: f64 = 0.7, Tuned("the injected channel faults");
    }
}

/// Marks repeated values of displacement and force in `absent`.
pub(super) fn find(
    uniform: &Uniform,
    present: &[bool],
    absent: &mut [Vec<bool>; 2],
    faults: &mut Vec<ChannelFault>,
) {
    for (channel, values, absent) in sampled(uniform, absent) {
        let mut samples = 0;
        let held = held(values, present);
        for run in &held {
            // The first of them is a sample as good as any.
            absent[run.start + 1..run.end].fill(true);
            samples += run.len() - 1;
        }
        if samples > 0 {
            let kind = ChannelFaultKind::Held {
                samples,
                stretches: held.len(),
            };
            faults.push(ChannelFault { channel, kind });
        }
    }
}

fn held(values: &[f64], present: &[bool]) -> Vec<std::ops::Range<usize>> {
    let same = policy().faults.same_value * spread(values);
    let repeats: Vec<bool> = (0..values.len())
        .map(|index| {
            index > 0
                && present[index]
                && present[index - 1]
                && (values[index] - values[index - 1]).abs() <= same
        })
        .collect();
    let repeating = repeats.iter().filter(|&&repeats| repeats).count();
    if repeating == 0 {
        return Vec::new();
    }
    let stretches: Vec<_> = runs(&repeats)
        .into_iter()
        .map(|run| run.start - 1..run.end)
        .filter(|run| run.len() >= policy().held.shortest)
        .collect();
    // How often two neighbours are equal where nothing is held, by rounding alone.
    let in_stretches: usize = stretches.iter().map(|run| run.len() - 1).sum();
    let often = (repeating - in_stretches + 1) as f64 / (values.len() - in_stretches) as f64;
    let step = smallest_step(values, same);
    let noise = noise_deviation(values);
    let (low, high) = least_and_largest(values);
    stretches
        .into_iter()
        .filter(|run| {
            let value = values[run.start];
            let inside = run.start > 0 && run.end < values.len();
            let at_an_end = value - low <= same || high - value <= same;
            // Only noise of more than the rounding makes neighbours differ by chance.
            let often = often.max(often_around(&repeats, run));
            let unlikely = noise > policy().held.noisy * step
                && values.len() as f64 * often.powi(run.len() as i32 - 1) < policy().held.chance;
            inside && !at_an_end && (unlikely || jumps(values, run, step, noise))
        })
        .collect()
}

/// How often neighbours are equal in the samples around `run`: the turn of a rounded signal is slow.
fn often_around(repeats: &[bool], run: &std::ops::Range<usize>) -> f64 {
    let before = &repeats[run.start.saturating_sub(policy().held.around)..=run.start];
    let after = &repeats[run.end..(run.end + policy().held.around).min(repeats.len())];
    let equal = before
        .iter()
        .chain(after)
        .filter(|&&repeats| repeats)
        .count();
    equal as f64 / (before.len() + after.len()) as f64
}

/// Whether the channel jumps when it is let go, by more than the steps, the rounding and the noise before it was held.
fn jumps(values: &[f64], run: &std::ops::Range<usize>, step: f64, noise: f64) -> bool {
    let before = &values[run.start.saturating_sub(2 * policy().held.shortest)..=run.start];
    let mut steps: Vec<f64> = before
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    let jump = (values[run.end] - values[run.start]).abs();
    jump > policy().held.jump * (0.5 * quantile(&mut steps, 0.5)).max(step).max(noise)
}

/// The smallest difference between neighbours that are not the same.
fn smallest_step(values: &[f64], same: f64) -> f64 {
    values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|&difference| difference > same)
        .fold(f64::INFINITY, f64::min)
}
