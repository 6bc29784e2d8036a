//! Samples that stand out from both of their neighbours, and from what the channel does elsewhere in the same state.

use std::collections::HashMap;

use super::super::noise::noise_deviation;
use super::super::resample::Uniform;
use super::{
    Channel, ChannelFault, ChannelFaultKind, bridge, mark, median_filtered, quantile, runs,
    sampled, spread,
};
use crate::policy::policy;

crate::numbers! {
    /// Which samples are spikes.
    SpikesPolicy {
        /// Samples to each side of the running median; up to this many in a row are seen as one spike.
        half: usize = 3, Tuned("the injected channel faults");
        /// A spike stands out by more than this many deviations of the noise.
        noises: f64 = 8.0, Tuned("the injected channel faults");
        /// A spike stands out by more than this part of the channel's spread.
        smallest: f64 = 0.06, Tuned("the injected channel faults");
        /// A spike that stands out by more than this part of the channel's spread is a large one.
        large: f64 = 0.25, Tuned("the injected channel faults");
        /// A small and a large spike stand out by this many times what is usual in the same state: contact and friction come back in
        /// every cycle, and small spikes have to be the rarer.
        times_usual: [f64; 2] = [8.0, 4.0], Tuned("the injected channel faults");
        /// A small and a large spike stand out by this many times what is usual around them: a tone comes back too.
        times_around: [f64; 2] = [8.0, 3.0], Tuned("the injected channel faults");
        /// Samples to each side that are around a spike.
        around: usize = 25, Tuned("the injected channel faults");
        /// Fewest samples that say what is usual in a state.
        enough: usize = 30, Convention("of thirty, nine tenths is known to within a few");
        /// States around a rare one are counted with it up to this many levels and octaves away.
        reach: i32 = 3, Tuned("the injected channel faults");
        /// What stands out in more than this part of all samples is how the channel is.
        most: f64 = 0.08, Tuned("the injected channel faults");
        /// Times that a channel is searched: large spikes hide small ones beside them.
        passes: usize = 4, Convention("a search ends earlier where nothing new is found");
        /// Levels of displacement by which states are told apart.
        levels: f64 = 16.0, Tuned("the injected channel faults");
        /// A change of displacement of less than one in this many of the range is rest.
        slowest: f64 = 256.0, Tuned("the injected channel faults");
        /// A run is cut to its samples that stand out by more than this part of its largest.
        high: f64 = 0.4, Tuned("the injected channel faults");
        /// Every sample of a run stands out of what either side leads to by more than this part of its largest.
        beyond: f64 = 0.3, Tuned("the injected channel faults");
    }
}

/// Marks the spikes of displacement and force in `absent`, and mends those of velocity and temperature.
pub(super) fn find(
    uniform: &mut Uniform,
    present: &[bool],
    absent: &mut [Vec<bool>; 2],
    faults: &mut Vec<ChannelFault>,
) {
    let states = states(&uniform.displacement);
    let period = uniform.period;
    let mut examine = |channel, values: &[f64], absent: &[bool]| -> Vec<bool> {
        let usable: Vec<bool> = present.iter().zip(absent).map(|(p, a)| *p && !a).collect();
        let found = Spikes::of(values, &states, &usable);
        if found.samples > 0 {
            let kind = ChannelFaultKind::Spikes {
                samples: found.samples,
                largest: found.largest / spread(values),
            };
            faults.push(ChannelFault { channel, kind });
        }
        found.marked
    };
    for (channel, values, absent) in sampled(uniform, absent) {
        let spiked = examine(channel, values, absent);
        mark(absent, &spiked);
    }
    let nothing = vec![false; present.len()];
    for (channel, values) in [
        (Channel::Velocity, &mut uniform.velocity),
        (Channel::Temperature, &mut uniform.temperature),
    ] {
        if let Some(values) = values {
            let spiked = examine(channel, values, &nothing);
            bridge::bridge(values, &spiked, period);
        }
    }
}

/// Level of displacement, and direction and octave of its change: where on its way the motion is at a sample.
type State = (i32, i32);

/// The state at every sample, read off the displacement without its spikes.
fn states(displacement: &[f64]) -> Vec<State> {
    let y = median_filtered(displacement, policy().spikes.half);
    let range = 2.0 * spread(&y).max(f64::MIN_POSITIVE);
    (0..y.len())
        .map(|index| {
            let (before, after) = (
                index.saturating_sub(policy().spikes.half),
                (index + policy().spikes.half).min(y.len() - 1),
            );
            let change = (y[after] - y[before]) / range;
            let octave = (change.abs() * policy().spikes.slowest)
                .max(1.0)
                .log2()
                .floor() as i32;
            let level = (y[index] / range * policy().spikes.levels).floor() as i32;
            (level, (octave + 1) * change.signum() as i32)
        })
        .collect()
}

struct Spikes {
    marked: Vec<bool>,
    samples: usize,
    largest: f64,
}

impl Spikes {
    fn of(values: &[f64], states: &[State], usable: &[bool]) -> Self {
        let mut found = Self {
            marked: vec![false; values.len()],
            samples: 0,
            largest: 0.0,
        };
        let spread = spread(values);
        let floor = (policy().spikes.noises * noise_deviation(values))
            .max(policy().spikes.smallest * spread);
        let mut left = values.to_vec();
        let unusable: Vec<bool> = usable.iter().map(|usable| !usable).collect();
        bridge::lines(&mut left, &unusable);
        // Large ones hide small ones beside them.
        for _ in 0..policy().spikes.passes {
            let before = found.samples;
            found.look(&left, states, usable, floor, policy().spikes.large * spread);
            if found.samples == before {
                break;
            }
            bridge::lines(&mut left, &found.marked);
        }
        if found.samples as f64 > policy().spikes.most * values.len() as f64 {
            found.marked.fill(false);
            found.samples = 0;
        }
        found
    }

    fn look(&mut self, values: &[f64], states: &[State], usable: &[bool], floor: f64, large: f64) {
        let median = median_filtered(values, policy().spikes.half);
        let apart: Vec<f64> = values.iter().zip(&median).map(|(x, m)| x - m).collect();
        let usual = Usual::of(&apart, states);
        let mut candidates = vec![false; values.len()];
        for index in policy().spikes.half..values.len().saturating_sub(policy().spikes.half) {
            let size = apart[index].abs();
            let tier = usize::from(size > large);
            candidates[index] = usable[index]
                && !self.marked[index]
                && size > floor
                && size > policy().spikes.times_around[tier] * around(&apart, index)
                && size > policy().spikes.times_usual[tier] * usual.at(index, states[index]);
        }
        for run in runs(&candidates) {
            let largest = apart[run.clone()]
                .iter()
                .fold(0.0_f64, |a, &b| if b.abs() > a.abs() { b } else { a });
            // The median of a few spikes and their neighbours is off, and the neighbours from it.
            let high = |&index: &usize| {
                apart[index] * largest.signum() > policy().spikes.high * largest.abs()
            };
            let (Some(first), Some(last)) = (run.clone().find(high), run.clone().rev().find(high))
            else {
                continue;
            };
            let run = first..last + 1;
            if run.len() <= policy().spikes.half
                && stands_out(
                    values,
                    run.clone(),
                    largest.signum(),
                    floor.max(policy().spikes.beyond * largest.abs()),
                )
            {
                self.marked[run.clone()].fill(true);
                self.samples += run.len();
                self.largest = self.largest.max(largest.abs());
            }
        }
    }
}

/// Whether all of `run` lies beyond what either side leads to, by more than `least`, in the direction `sign`. A step, the
/// corner of a triangle and a turn of the motion are led to from one side at least.
fn stands_out(values: &[f64], run: std::ops::Range<usize>, sign: f64, least: f64) -> bool {
    let beyond = |index: usize, near: usize, far: usize| {
        let slope = (values[near] - values[far]) / (near as f64 - far as f64);
        let led_to = values[near] + slope * (index as f64 - near as f64);
        sign * values[index] - (sign * values[near]).max(sign * led_to)
    };
    let (Some(far_left), far_right) = (
        run.start.checked_sub(policy().spikes.half),
        run.end + policy().spikes.half - 1,
    ) else {
        return false;
    };
    if far_right >= values.len() {
        return false;
    }
    let (left, right) = (run.start - 1, run.end);
    run.into_iter().all(|index| {
        beyond(index, left, far_left) > least && beyond(index, right, far_right) > least
    })
}

/// Nine tenths of the samples around `index`, it and its neighbours left out, lie nearer to the running median than this.
fn around(apart: &[f64], index: usize) -> f64 {
    let before = &apart
        [index.saturating_sub(policy().spikes.around)..index.saturating_sub(policy().spikes.half)];
    let after = &apart[(index + policy().spikes.half + 1).min(apart.len())
        ..(index + policy().spikes.around + 1).min(apart.len())];
    let mut apart: Vec<f64> = before.iter().chain(after).map(|a| a.abs()).collect();
    quantile(&mut apart, policy().faults.usually)
}

/// How far from the running median samples usually lie, state by state.
struct Usual<'a> {
    apart: &'a [f64],
    samples: HashMap<State, Vec<usize>>,
}

impl<'a> Usual<'a> {
    fn of(apart: &'a [f64], states: &[State]) -> Self {
        let mut samples: HashMap<State, Vec<usize>> = HashMap::new();
        for (index, &state) in states.iter().enumerate() {
            samples.entry(state).or_default().push(index);
        }
        Self { apart, samples }
    }

    /// Nine tenths of the samples in the state of `index` lie nearer than this, those beside it left out; of a rare state,
    /// those in the states around it too.
    fn at(&self, index: usize, state: State) -> f64 {
        let mut around: Vec<f64> = Vec::new();
        for reach in 0..=policy().spikes.reach {
            around.clear();
            for level in -reach..=reach {
                for octave in -reach..=reach {
                    let near = self.samples.get(&(state.0 + level, state.1 + octave));
                    let others = near
                        .into_iter()
                        .flatten()
                        .filter(|other| other.abs_diff(index) > policy().spikes.half);
                    around.extend(others.map(|&other| self.apart[other].abs()));
                }
            }
            if around.len() >= policy().spikes.enough {
                break;
            }
        }
        quantile(&mut around, policy().faults.usually)
    }
}
