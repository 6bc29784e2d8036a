//! A channel that is clipped at the limit of its range: sample after sample at the same extreme value.

use super::super::noise::noise_deviation;
use super::super::resample::Uniform;
use super::{ChannelFault, ChannelFaultKind, mark, runs, sampled, spread};
use crate::extremes::least_and_largest;
use crate::faults::FaultsPolicy;

crate::numbers! {
    /// Which channels end at the limit of their range.
    ClippingPolicy {
        /// A channel is clipped only if at least this many samples are at its limit.
        samples: usize = 6, Tuned("the injected channel faults");
        /// A channel is clipped only if it stays at its limit at least this many times, for two samples or more each time.
        stays: usize = 2, Tuned("the injected channel faults");
        /// A channel is clipped only if more than this many times as many samples are at the limit as just below it. A smooth, rounded
        /// signal has as many samples in the next four steps below its turn as in the last step.
        pile: f64 = 2.5, Tuned("the injected channel faults");
        /// A channel is clipped only if the other channel (force or displacement) moves meanwhile by more than this fraction of its spread,
        /// in addition to its noise; otherwise the motion dwells.
        moves: f64 = 0.01, Tuned("the injected channel faults");
        /// Samples up to this many rounding steps below a limit count as just below it.
        steps: f64 = 4.0, Tuned("the injected channel faults");
    }
}

/// Marks samples of displacement and force at a limit in `absent`.
pub(super) fn find(
    uniform: &Uniform,
    present: &[bool],
    absent: &mut [Vec<bool>; 2],
    faults: &mut Vec<ChannelFault>,
) {
    let others = [&uniform.force, &uniform.displacement];
    for ((channel, values, absent), other) in sampled(uniform, absent).into_iter().zip(others) {
        for side in [1.0, -1.0] {
            let signed: Vec<f64> = values.iter().map(|value| side * value).collect();
            let Some((limit, mut marked)) = at_limit(&signed, present) else {
                continue;
            };
            if !goes_on(other, &marked) {
                continue;
            }
            for (marked, present) in marked.iter_mut().zip(present) {
                *marked &= present;
            }
            let samples = marked.iter().filter(|&&marked| marked).count();
            let limit = side * limit;
            let kind = ChannelFaultKind::Clipping { samples, limit };
            faults.push(ChannelFault { channel, kind });
            mark(absent, &marked);
        }
    }
}

/// The upper limit of `values` and the samples at it, and at it between two of them: samples far apart are one stay.
fn at_limit(values: &[f64], present: &[bool]) -> Option<(f64, Vec<bool>)> {
    let same = FaultsPolicy::in_use().same_value * spread(values);
    let limit = values
        .iter()
        .zip(present)
        .filter(|(_, p)| **p)
        .map(|(v, _)| *v)
        .fold(f64::NEG_INFINITY, f64::max);
    let marked: Vec<bool> = values.iter().map(|value| limit - value <= same).collect();
    let samples = marked
        .iter()
        .zip(present)
        .filter(|(marked, present)| **marked && **present);
    let samples = samples.count();
    let stays = runs(&marked).iter().filter(|run| run.len() >= 2).count();
    if samples < ClippingPolicy::in_use().samples || stays < ClippingPolicy::in_use().stays {
        return None;
    }
    let below = ClippingPolicy::in_use().steps * rounding(values, same) + same;
    let just_below = values
        .iter()
        .filter(|value| (same..=below).contains(&(limit - **value)))
        .count();
    let piled = samples as f64 > ClippingPolicy::in_use().pile * just_below as f64;
    piled.then_some((limit, marked))
}

/// The smallest difference between two values that differ by more than `same`: the step to which they were rounded, or almost 0.
pub(super) fn rounding(values: &[f64], same: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|&difference| difference > same)
        .fold(f64::INFINITY, f64::min)
}

/// Whether the other channel moves while this one stays: in a dwell of the motion both stand still.
fn goes_on(other: &[f64], marked: &[bool]) -> bool {
    let noise = noise_deviation(other);
    let (mut moved, mut by_noise, mut stays) = (0.0, 0.0, 0.0);
    for run in runs(marked).into_iter().filter(|run| run.len() >= 2) {
        // The ends of the stay belong to the motion before and after it.
        let inner = run.start + run.len() / 6..run.end - run.len() / 6;
        // About the range of n samples of white noise.
        by_noise += noise * (1.0 + 2.0 * (2.0 * (inner.len() as f64).ln()).sqrt());
        let (low, high) = least_and_largest(&other[inner]);
        moved += high - low;
        stays += 1.0;
    }
    moved > by_noise + ClippingPolicy::in_use().moves * spread(other) * stays
}
