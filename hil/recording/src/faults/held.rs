//! A value repeated while the motion went on: a stuck channel, or rows of a logger without new data.

use std::f64::consts::PI;

use super::super::noise::noise_deviation;
use super::super::resample::Uniform;
use super::{ChannelFault, ChannelFaultKind, runs, sampled, spread};
use crate::extremes::{least_and_largest, quantile};
use crate::faults::FaultsPolicy;

crate::numbers! {
    /// Which values were repeated while the motion went on.
    HeldPolicy {
        /// A run of equal samples is a held value only if it has at least this many samples.
        shortest: usize = 4, Tuned("the injected channel faults");
        /// A run of equal samples is a held value if rounding makes such a run, anywhere in the recording, with a probability below this.
        chance: f64 = 1e-4, Convention("one false alarm in ten thousand recordings");
        /// This many samples on each side of a run of equal samples show how often neighbours are equal there.
        around: usize = 40, Tuned("the injected channel faults");
        /// A run of equal samples is a held value too if the channel then jumps by more than this many times the largest of three: half of
        /// its median step before the run, its rounding step and its noise.
        jump: f64 = 8.0, Tuned("the injected channel faults");
        /// The test `chance` applies only if the noise exceeds this fraction of the rounding step; with less noise, neighbours do not
        /// differ by chance.
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
            // The first of them is a valid sample.
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
    let same = FaultsPolicy::in_use().same_value * spread(values);
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
        .filter(|run| run.len() >= HeldPolicy::in_use().shortest)
        .collect();
    // Probability that two neighbours are equal by rounding alone, without a held value.
    let in_stretches: usize = stretches.iter().map(|run| run.len() - 1).sum();
    let often = (repeating - in_stretches + 1) as f64 / (values.len() - in_stretches) as f64;
    let step = smallest_step(values, same);
    let noise = noise_deviation(values);
    // In a slow motion, as at its turns, neighbours are equal as often as in a standing channel.
    let often = often.max(often_at_rest(step, noise));
    let (low, high) = least_and_largest(values);
    stretches
        .into_iter()
        .filter(|run| {
            let value = values[run.start];
            let inside = run.start > 0 && run.end < values.len();
            let at_an_end = value - low <= same || high - value <= same;
            // Only noise of more than the rounding makes neighbours differ by chance.
            let often = often.max(often_around(&repeats, run));
            let unlikely = noise > HeldPolicy::in_use().noisy * step
                && values.len() as f64 * often.powi(run.len() as i32 - 1)
                    < HeldPolicy::in_use().chance;
            inside && !at_an_end && (unlikely || jumps(values, run, step, noise))
        })
        .collect()
}

/// Probability that two neighbours of a standing channel are equal, where `noise` is rounded to `step`: the density of their
/// difference, with √2 times the deviation of the noise, at 0, times the step.
fn often_at_rest(step: f64, noise: f64) -> f64 {
    (step / (2.0 * noise * PI.sqrt())).min(1.0)
}

/// How often neighbours are equal in the samples around `run`: a rounded signal turns slowly.
fn often_around(repeats: &[bool], run: &std::ops::Range<usize>) -> f64 {
    let before = &repeats[run.start.saturating_sub(HeldPolicy::in_use().around)..=run.start];
    let after = &repeats[run.end..(run.end + HeldPolicy::in_use().around).min(repeats.len())];
    let equal = before
        .iter()
        .chain(after)
        .filter(|&&repeats| repeats)
        .count();
    equal as f64 / (before.len() + after.len()) as f64
}

/// Whether the channel jumps at the end of the hold, by more than the steps, the rounding and the noise before it.
fn jumps(values: &[f64], run: &std::ops::Range<usize>, step: f64, noise: f64) -> bool {
    let before = &values[run.start.saturating_sub(2 * HeldPolicy::in_use().shortest)..=run.start];
    let mut steps: Vec<f64> = before
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    let jump = (values[run.end] - values[run.start]).abs();
    jump > HeldPolicy::in_use().jump * (0.5 * quantile(&mut steps, 0.5)).max(step).max(noise)
}

/// The smallest difference between neighbours that differ.
pub(crate) fn smallest_step(values: &[f64], same: f64) -> f64 {
    values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|&difference| difference > same)
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::SeedableRng as _;
    use rand::rngs::StdRng;
    use rand_distr::{Distribution as _, StandardNormal};

    use super::held;

    /// A sine over `cycles` periods of `samples` each, rounded to steps of 1, `levels` of them from end to end, with `noise` before
    /// rounding. It grows a little, so that only the last turn is at an end.
    fn coarse(samples: usize, cycles: usize, levels: f64, noise: f64, seed: u64) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(seed);
        let count = samples * cycles;
        (0..count)
            .map(|index| {
                let growth = 1.0 + 0.05 * index as f64 / count as f64;
                let normal: f64 = StandardNormal.sample(&mut random);
                let sine = (TAU * index as f64 / samples as f64).sin();
                (0.5 * levels * growth * sine + noise * normal).round()
            })
            .collect()
    }

    fn held_of(values: &[f64]) -> Vec<std::ops::Range<usize>> {
        held(values, &vec![true; values.len()])
    }

    /// As from a converter of 8 to 14 bits in a test of 0.1 to 1 Hz: the turns of a slow motion keep one value for some samples.
    #[test]
    fn a_coarse_channel_is_not_held_where_the_motion_is_slow() {
        let mut wrong = Vec::new();
        let mut seed = 0;
        for bits in [8, 9, 10, 12, 14] {
            for samples in [256, 1000, 5000] {
                for noise in [0.0, 0.2, 0.5, 0.8, 1.0, 2.0] {
                    for _ in 0..16 {
                        seed += 1;
                        let values = coarse(samples, 8, f64::from(1 << bits), noise, seed);
                        for run in held_of(&values) {
                            wrong.push(format!("{bits} bits, {samples}, {noise}: {run:?}"));
                        }
                    }
                }
            }
        }
        assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
    }

    /// A channel that stands while the motion goes on jumps at the end, or repeats for longer than its noise would.
    #[test]
    fn a_coarse_channel_that_is_held_is_found() {
        for noise in [0.0, 1.0] {
            let mut values = coarse(1000, 8, 1024.0, noise, 1);
            let value = values[2010];
            values[2010..2060].fill(value);
            let found = held_of(&values);
            assert!(
                found.len() == 1 && found[0].start <= 2010 && found[0].end >= 2060,
                "{noise}: {found:?}"
            );
        }
    }
}
