//! Samples that are outliers from both of their neighbours, and from the channel's usual behaviour in the same state.

use std::cell::LazyCell;
use std::collections::HashMap;
use std::ops::Range;

use super::super::noise::noise_deviation;
use super::super::resample::Uniform;
use super::{
    Channel, ChannelFault, ChannelFaultKind, bridge, mark, median_filtered, runs, sampled, spread,
};
use crate::extremes::{least_and_largest, place_of, quantile};
use crate::faults::FaultsPolicy;

crate::numbers! {
    /// Which samples are spikes. The deviation of a sample is its distance from the running median.
    SpikesPolicy {
        /// The running median reaches this many samples to each side. Up to this many samples in a row can be one spike.
        half: usize = 3, Tuned("the injected channel faults");
        /// A spike deviates from the running median by more than this many standard deviations of the noise.
        noises: f64 = 8.0, Tuned("the injected channel faults");
        /// A spike deviates from the running median by more than this fraction of the channel's spread.
        smallest: f64 = 0.06, Tuned("the injected channel faults");
        /// A spike is large if it deviates from the running median by more than this fraction of the channel's spread.
        large: f64 = 0.25, Tuned("the injected channel faults");
        /// A spike deviates by more than this many times the usual deviation in the same state of the motion; the first number is for small
        /// spikes, the second for large ones. Contact and friction return in every cycle, so small spikes must be rarer.
        times_usual: [f64; 2] = [8.0, 4.0], Tuned("the injected channel faults");
        /// A spike deviates by more than this many times the usual deviation of the samples around it, because a tone repeats too; the
        /// first number is for small spikes, the second for large ones.
        times_around: [f64; 2] = [8.0, 3.0], Tuned("the injected channel faults");
        /// The usual deviation around a spike is taken over this many samples to each side.
        around: usize = 25, Tuned("the injected channel faults");
        /// The usual deviation in a state of the motion is taken over at least this many samples.
        enough: usize = 30, Convention("the nine-tenths quantile of thirty samples is known to within a few samples");
        /// A state of the motion with too few samples (see `enough`) is joined with states up to this many levels of displacement and
        /// octaves of speed away.
        reach: i32 = 3, Tuned("the injected channel faults");
        /// If more than this fraction of all samples look like spikes, none of them is one: the channel is like that.
        most: f64 = 0.08, Tuned("the injected channel faults");
        /// The range of the displacement is divided into this many levels, to distinguish states of the motion.
        levels: f64 = 16.0, Tuned("the injected channel faults");
        /// The motion is at rest if the displacement changes, within the window of the running median, by less than its range divided by
        /// this.
        slowest: f64 = 256.0, Tuned("the injected channel faults");
        /// A spike is cut to the samples that deviate by more than this fraction of its largest deviation.
        high: f64 = 0.4, Tuned("the injected channel faults");
        /// Every sample of a spike is off the continuation of the samples on either side by more than this fraction of its largest
        /// deviation.
        beyond: f64 = 0.3, Tuned("the injected channel faults");
        /// Near an end of the samples, where one side is missing, a spike is off the continuation of the other by more than this many times
        /// as much as any samples between the ends.
        at_end: f64 = 1.5, Convention("a motion that stops or turns at an end does so between the ends too");
        /// The ends of fewer samples in a row than this are not searched.
        shortest: usize = 24, Convention("four times the samples about both ends");
    }
}

/// A channel is searched for spikes at most this many times: large spikes hide small ones beside them. Convention: a search ends
/// earlier if it finds nothing new.
const PASSES: usize = 4;

/// Marks the spikes of displacement and force in `absent`, and repairs those of velocity and temperature.
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
        let may_switch = channel == Channel::Temperature;
        let found = Spikes::of(values, &states, &usable, may_switch);
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

/// Level of displacement, and direction and octave of its change: the position of the motion at a sample.
type State = (i32, i32);

/// The state at every sample, from the displacement without its spikes.
fn states(displacement: &[f64]) -> Vec<State> {
    let y = median_filtered(displacement, SpikesPolicy::in_use().half);
    let range = 2.0 * spread(&y).max(f64::MIN_POSITIVE);
    (0..y.len())
        .map(|index| {
            let (before, after) = (
                index.saturating_sub(SpikesPolicy::in_use().half),
                (index + SpikesPolicy::in_use().half).min(y.len() - 1),
            );
            let change = (y[after] - y[before]) / range;
            let octave = (change.abs() * SpikesPolicy::in_use().slowest)
                .max(1.0)
                .log2()
                .floor() as i32;
            let level = (y[index] / range * SpikesPolicy::in_use().levels).floor() as i32;
            (level, (octave + 1) * change.signum() as i32)
        })
        .collect()
}

struct Spikes {
    marked: Vec<bool>,
    samples: usize,
    largest: f64,
    /// Samples between these are not spikes.
    switched: Option<[f64; 2]>,
}

impl Spikes {
    /// The spikes of a channel, which `may_switch` if it does not follow from the motion.
    fn of(values: &[f64], states: &[State], usable: &[bool], may_switch: bool) -> Self {
        let spread = spread(values);
        let floor = (SpikesPolicy::in_use().noises * noise_deviation(values))
            .max(SpikesPolicy::in_use().smallest * spread);
        let mut found = Self {
            marked: vec![false; values.len()],
            samples: 0,
            largest: 0.0,
            switched: may_switch.then(|| switched(values, floor)).flatten(),
        };
        // Without a spread, as in a long hold, no size is large.
        if spread <= 0.0 {
            return found;
        }
        let mut left = values.to_vec();
        let unusable: Vec<bool> = usable.iter().map(|usable| !usable).collect();
        bridge::lines(&mut left, &unusable);
        // Large ones hide small ones near them.
        for _ in 0..PASSES {
            let before = found.samples;
            found.look(
                &left,
                states,
                usable,
                floor,
                SpikesPolicy::in_use().large * spread,
            );
            if found.samples == before {
                break;
            }
            bridge::lines(&mut left, &found.marked);
        }
        found.look_at_ends(&left, usable, floor);
        if found.samples as f64 > SpikesPolicy::in_use().most * values.len() as f64 {
            found.marked.fill(false);
            found.samples = 0;
        }
        found
    }

    /// Whether a value lies beyond the levels between which the channel switches, by more than `least`.
    fn is_beyond_levels(&self, value: f64, least: f64) -> bool {
        let beyond = |[low, high]: [f64; 2]| value < low - least || value > high + least;
        self.switched.is_none_or(beyond)
    }

    /// Spikes within a few samples of an end of the recording, or of samples without a gap: no running median reaches there.
    fn look_at_ends(&mut self, values: &[f64], usable: &[bool], floor: f64) {
        let SpikesPolicy {
            half,
            at_end,
            shortest,
            ..
        } = *SpikesPolicy::in_use();
        // From the end backwards is from the start of the reversed samples.
        let count = values.len();
        let stretches = runs(usable);
        let reversed: Vec<f64> = values.iter().rev().copied().collect();
        for (values, is_reversed) in [(values, false), (&reversed[..], true)] {
            let stretches: Vec<Range<usize>> = (stretches.iter())
                .filter(|stretch| stretch.len() >= shortest)
                .map(|stretch| match is_reversed {
                    true => count - stretch.end..count - stretch.start,
                    false => stretch.clone(),
                })
                .collect();
            let inside = stretches.iter().map(|s| s.start + half..s.end - half);
            let inside: Vec<Range<usize>> = inside.collect();
            let mut most = vec![0.0_f64; half + 1];
            for (length, most) in most.iter_mut().enumerate().skip(1) {
                for stretch in &inside {
                    let starts = stretch.start..(stretch.end + 1).saturating_sub(length + half);
                    let each = starts.map(|start| off_what_follows(values, start..start + length));
                    *most = each.fold(*most, f64::max);
                }
            }
            for stretch in &stretches {
                // A spike of several samples, or one with a few good samples before it.
                let each = (1..=half)
                    .rev()
                    .flat_map(|length| (0..half).map(move |good| (good, length)));
                let mut each = each.map(|(good, length)| {
                    let start = stretch.start + good;
                    (good, start..start + length)
                });
                let is_spike = |(good, run): &(usize, Range<usize>)| {
                    let off = off_what_follows(values, run.clone());
                    let before = (*good > 0)
                        .then(|| off_one_side(values, run.clone(), run.start - 1, stretch.start));
                    off > floor
                        && off > at_end * most[run.len()]
                        && before.is_none_or(|before| {
                            before > floor.max(SpikesPolicy::in_use().beyond * off)
                        })
                        && run
                            .clone()
                            .all(|index| self.is_beyond_levels(values[index], floor))
                };
                let Some((_, run)) = each.find(is_spike) else {
                    continue;
                };
                let largest = off_what_follows(values, run.clone());
                for index in run {
                    let index = if is_reversed {
                        count - 1 - index
                    } else {
                        index
                    };
                    self.samples += usize::from(!self.marked[index]);
                    self.marked[index] = true;
                }
                self.largest = self.largest.max(largest);
            }
        }
    }

    fn look(&mut self, values: &[f64], states: &[State], usable: &[bool], floor: f64, large: f64) {
        let median = median_filtered(values, SpikesPolicy::in_use().half);
        let apart: Vec<f64> = values.iter().zip(&median).map(|(x, m)| x - m).collect();
        // Of a channel without a sample that could be one it is not needed.
        let usual = LazyCell::new(|| Usual::of(&apart, states));
        let mut candidates = vec![false; values.len()];
        for index in
            SpikesPolicy::in_use().half..values.len().saturating_sub(SpikesPolicy::in_use().half)
        {
            let size = apart[index].abs();
            let tier = usize::from(size > large);
            candidates[index] = usable[index]
                && !self.marked[index]
                && self.is_beyond_levels(values[index], floor)
                && size > floor
                && size > SpikesPolicy::in_use().times_around[tier] * around(&apart, index)
                && usual.is_exceeded(index, SpikesPolicy::in_use().times_usual[tier]);
        }
        for run in runs(&candidates) {
            let largest = apart[run.clone()]
                .iter()
                .fold(0.0_f64, |a, &b| if b.abs() > a.abs() { b } else { a });
            // The median of a few spikes and their neighbours is off, and the neighbours differ from it.
            let high = |&index: &usize| {
                apart[index] * largest.signum() > SpikesPolicy::in_use().high * largest.abs()
            };
            let (Some(first), Some(last)) = (run.clone().find(high), run.clone().rev().find(high))
            else {
                continue;
            };
            let run = first..last + 1;
            if run.len() <= SpikesPolicy::in_use().half
                && stands_out(
                    values,
                    run.clone(),
                    largest.signum(),
                    floor.max(SpikesPolicy::in_use().beyond * largest.abs()),
                )
            {
                self.marked[run.clone()].fill(true);
                self.samples += run.len();
                self.largest = self.largest.max(largest.abs());
            }
        }
    }
}

/// The lowest and the highest level of a channel that switches. It stays at one for longer than a spike lasts, and at its next stay
/// it differs from the first by more than `least`. A drift continues where it was before a spike.
fn switched(values: &[f64], least: f64) -> Option<[f64; 2]> {
    let mut stays: Vec<[f64; 2]> = Vec::new();
    let mut start = 0;
    for end in 1..=values.len() {
        if end < values.len() && (values[end] - values[end - 1]).abs() <= least {
            continue;
        }
        if end - start > SpikesPolicy::in_use().half {
            let (low, high) = least_and_largest(&values[start..end]);
            stays.push([low, high]);
        }
        start = end;
    }
    let apart =
        |pair: &&[[f64; 2]]| pair[1][0] - pair[0][1] > least || pair[0][0] - pair[1][1] > least;
    let levels = stays.windows(2).filter(apart).flatten();
    levels
        .copied()
        .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

/// Whether all of `run` lies beyond the continuation from either side, by more than `least`, in the direction `sign`. A step, the
/// corner of a triangle and a turn of the motion continue from at least one side.
fn stands_out(values: &[f64], run: Range<usize>, sign: f64, least: f64) -> bool {
    let beyond = |index: usize, near: usize, far: usize| {
        let slope = (values[near] - values[far]) / (near as f64 - far as f64);
        let led_to = values[near] + slope * (index as f64 - near as f64);
        sign * values[index] - (sign * values[near]).max(sign * led_to)
    };
    let (Some(far_left), far_right) = (
        run.start.checked_sub(SpikesPolicy::in_use().half),
        run.end + SpikesPolicy::in_use().half - 1,
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

/// How far all of `run` lies beyond the samples behind it and their continuation, in one direction.
fn off_what_follows(values: &[f64], run: Range<usize>) -> f64 {
    let far = (run.end + SpikesPolicy::in_use().half - 1).min(values.len() - 1);
    let near = run.end;
    off_one_side(values, run, near, far)
}

/// How far all of `run` lies beyond the samples from `near` to `far` on one side of it and their continuation, in one direction.
fn off_one_side(values: &[f64], run: Range<usize>, near: usize, far: usize) -> f64 {
    let slope = match near == far {
        true => 0.0,
        false => (values[near] - values[far]) / (near as f64 - far as f64),
    };
    let beyond = |sign: f64| {
        let each = run.clone().map(|index| {
            let led_to = values[near] + slope * (index as f64 - near as f64);
            sign * values[index] - (sign * values[near]).max(sign * led_to)
        });
        each.fold(f64::INFINITY, f64::min)
    };
    beyond(1.0).max(beyond(-1.0)).max(0.0)
}

/// The distance from the running median within which nine tenths of the samples around `index` lie, without it and its neighbours.
fn around(apart: &[f64], index: usize) -> f64 {
    let before = &apart[index.saturating_sub(SpikesPolicy::in_use().around)
        ..index.saturating_sub(SpikesPolicy::in_use().half)];
    let after = &apart[(index + SpikesPolicy::in_use().half + 1).min(apart.len())
        ..(index + SpikesPolicy::in_use().around + 1).min(apart.len())];
    let mut apart: Vec<f64> = before.iter().chain(after).map(|a| a.abs()).collect();
    quantile(&mut apart, FaultsPolicy::in_use().usually)
}

/// Usual distance of samples from the running median, state by state.
struct Usual<'a> {
    apart: &'a [f64],
    states: &'a [State],
    /// The distances in each state, the smallest first: a search for each sample that may be a spike is then short.
    sorted: HashMap<State, Vec<f64>>,
}

impl<'a> Usual<'a> {
    fn of(apart: &'a [f64], states: &'a [State]) -> Self {
        let mut sorted: HashMap<State, Vec<f64>> = HashMap::new();
        for (apart, &state) in apart.iter().zip(states) {
            sorted.entry(state).or_default().push(apart.abs());
        }
        for apart in sorted.values_mut() {
            apart.sort_unstable_by(f64::total_cmp);
        }
        Self {
            apart,
            states,
            sorted,
        }
    }

    /// Whether the distance of sample `index` is more than `times` that within which nine tenths of the samples in its state lie, without
    /// its neighbours; for a rare state, including the states around it.
    fn is_exceeded(&self, index: usize, times: f64) -> bool {
        let SpikesPolicy {
            half,
            enough,
            reach,
            ..
        } = *SpikesPolicy::in_use();
        let (size, state) = (self.apart[index].abs(), self.states[index]);
        let is_less = |apart: &f64| times * apart < size;
        let end = (index + half + 1).min(self.apart.len());
        let neighbours = index.saturating_sub(half)..end;
        let [mut count, mut less] = [0; 2];
        for reach in 0..=reach {
            [count, less] = [0; 2];
            let each = (-reach..=reach).flat_map(|level| {
                (-reach..=reach)
                    .map(move |octave| (state.0.wrapping_add(level), state.1.wrapping_add(octave)))
            });
            for sorted in each.filter_map(|near| self.sorted.get(&near)) {
                count += sorted.len();
                less += sorted.partition_point(is_less);
            }
            for other in neighbours.clone() {
                let (level, octave) = self.states[other];
                if level.abs_diff(state.0).max(octave.abs_diff(state.1)) <= reach as u32 {
                    count -= 1;
                    less -= usize::from(is_less(&self.apart[other].abs()));
                }
            }
            if count >= enough {
                break;
            }
        }
        // The one at that place, and thus all before it.
        count == 0 || less > place_of(FaultsPolicy::in_use().usually, count)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::rngs::StdRng;
    use rand::{RngExt as _, SeedableRng as _};

    use super::super::{Channel, ChannelFaultKind, examine};
    use crate::Recording;

    const SAMPLES: usize = 8000;

    /// Spikes found in a temperature of a test at 1 Hz, °C, whose times are off by up to `jitter` of a period.
    fn spikes(temperature: &[f64], jitter: f64, random: &mut StdRng) -> usize {
        let off = |random: &mut StdRng| jitter * random.random_range(-1.0..1.0);
        let time: Vec<f64> = (0..SAMPLES)
            .map(|index| 2e-3 * (index as f64 + off(random)))
            .collect();
        let displacement = time.iter().map(|time| (TAU * time).sin()).collect();
        let force = time.iter().map(|time| (TAU * time + 0.2).sin()).collect();
        let recording = Recording::new("test", time, displacement, force).unwrap();
        let recording = recording.with_temperature(temperature.to_vec()).unwrap();
        let faults = examine(&mut recording.uniform().unwrap()).into_iter();
        let found = faults.map(|fault| match fault.kind {
            ChannelFaultKind::Spikes { samples, .. } if fault.channel == Channel::Temperature => {
                samples
            }
            _ => 0,
        });
        found.sum()
    }

    /// At one of the `levels` for `stay` samples on average, with uniform `noise`.
    fn switching(levels: &[f64], stay: f64, noise: f64, random: &mut StdRng) -> Vec<f64> {
        let mut level = levels[0];
        let next = (0..SAMPLES).map(|_| {
            if random.random_bool(1.0 / stay) {
                level = levels[random.random_range(0..levels.len())];
            }
            level + noise * random.random_range(-1.0..1.0)
        });
        next.collect()
    }

    /// Between two levels or three, for long or for a few samples; also with interpolation between uneven times.
    #[test]
    fn a_channel_that_switches_has_no_spikes() {
        let mut random = StdRng::seed_from_u64(1);
        let square = |half: usize| -> Vec<f64> {
            let level = |index| [20.0, 60.0][index / half % 2];
            (0..SAMPLES).map(level).collect()
        };
        for jitter in [0.0, 0.15, 0.4] {
            for half in [40, 200, 1000] {
                let found = spikes(&square(half), jitter, &mut random);
                assert_eq!(found, 0, "{half}, jitter {jitter}");
            }
            for levels in [&[20.0, 60.0][..], &[20.0, 35.0, 60.0]] {
                for stay in [10.0, 40.0, 200.0] {
                    for noise in [0.0, 0.4] {
                        let values = switching(levels, stay, noise, &mut random);
                        let found = spikes(&values, jitter, &mut random);
                        assert_eq!(found, 0, "{levels:?}, {stay}, {noise}, jitter {jitter}");
                    }
                }
            }
        }
    }

    /// In one that drifts, and beyond the levels of one that switches.
    #[test]
    fn spikes_of_a_slow_channel_are_found() {
        let mut random = StdRng::seed_from_u64(2);
        let drift = |index| 20.0 + 20.0 * index as f64 / SAMPLES as f64;
        let drifting: Vec<f64> = (0..SAMPLES).map(drift).collect();
        let switching = switching(&[20.0, 60.0], 200.0, 0.4, &mut random);
        for (mut values, size) in [(drifting, 5.0), (switching, 60.0)] {
            // Not in the same states of the motion: that would be physics.
            let places = (50..SAMPLES).step_by(103);
            for place in places.clone() {
                values[place] += size;
            }
            let found = spikes(&values, 0.0, &mut random);
            assert_eq!(found, places.count(), "of {size} °C");
        }
    }
}
