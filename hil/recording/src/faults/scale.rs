//! Units off by a thousand: from some time on, or of a whole recording.

use std::ops::Range;

use super::super::Recording;
use super::super::noise::noise_deviation;
use mesh_damper_tables::channel::Channel;
use mesh_damper_tables::control::correlation;

use super::kind::{ChannelFault, ChannelFaultKind};
use super::spread;

crate::numbers! {
    /// How a unit that is wrong by a factor of 1000 is recognized.
    ScalePolicy {
        /// A change of unit is searched for by comparing the size of a channel over this fraction of the recording, before and after each
        /// sample.
        stretch: f64 = 0.05, Tuned("the injected channel faults");
        /// A change of unit is searched for by comparing the size of a channel over at least this many samples, before and after each
        /// sample.
        shortest: usize = 16, Tuned("the injected channel faults");
        /// A size that changes by more than this factor has changed its unit: no test of one specimen changes it as much, within a
        /// recording or between two recordings.
        unit_apart: f64 = 200.0, Tuned("the recordings of others, whose stiffness differs less between amplitudes");
        /// A size that changes by less than this factor has kept its unit.
        same_unit: f64 = 12.0, Tuned("the injected channel faults");
        /// A recording in which a unit changes more often than this is not repaired.
        most_changes: usize = 6, Convention("a logger is not switched more often in one test");
        /// Smallest and largest force per displacement of a declared mesh damper, kN/mm. Outside this range the unit of a channel may be
        /// wrong.
        mesh_stiffness: [f64; 2] = [0.01, 30.0],
            Convention("the paper's specimens have 0.2 to 9; for other sizes there is a factor of 20 below and of 3 above");
        /// Smallest and largest displacement in a test of a declared mesh damper, mm. Outside this range the unit of the displacement may
        /// be wrong.
        mesh_travel: [f64; 2] = [0.002, 8.0],
            Convention("from the noise of a sensor to half the height of the paper's specimens, which is 15 mm");
        /// A force per displacement above this is reported as a wrong unit, for any damper, kN/mm.
        stiffest: f64 = 300.0, Convention("ten times the stiffest mesh damper");
        /// A force per displacement below this is mentioned, for any damper, kN/mm: the unit of a channel may be wrong, or the columns may
        /// be swapped.
        softest: f64 = 0.001, Convention("a tenth of the softest mesh damper; a damper of another kind had 0.006 in a travel of 50 mm");
        /// A channel has changed its unit only if its smaller part correlates with the other channel by at least this; otherwise it is at
        /// rest there.
        follows: f64 = 0.3, Tuned("the injected channel faults");
        /// A channel has changed its unit only if its smaller part is at least this many times its noise there; otherwise it is at rest
        /// there.
        above_noise: f64 = 4.0, Tuned("the injected channel faults, and motions with pauses");
        /// The sample at which a unit changes is searched for within this many samples of the first estimate, to either side.
        near: usize = 24, Tuned("the injected channel faults");
        /// A declared sampling rate has a wrong unit if it is 1000 times that of the times, or a thousandth of it, to within this fraction.
        same_rate: f64 = 0.05, Convention("a declared rate is a round number");
    }
}

/// Ratio between neighbouring units. Derived: the prefixes of the SI.
const THOUSAND: f64 = 1000.0;

/// Repairs units that change within a recording, and those of a declared mesh damper; reports cases that cannot be decided.
pub(super) fn repair(recording: &mut Recording) -> bool {
    let known = recording.faults.len();
    find(recording);
    recording.faults.len() > known
}

fn find(recording: &mut Recording) {
    for channel in [Channel::Force, Channel::Displacement] {
        repair_changes(recording, channel);
    }
    let stiffness = stiffness(recording);
    let travel = spread(&recording.displacement);
    let is_known = |recording: &Recording, channel| {
        let known = |fault: &ChannelFault| {
            let kind = &fault.kind;
            fault.channel == channel
                && matches!(
                    kind,
                    ChannelFaultKind::Unit { .. } | ChannelFaultKind::Soft { .. }
                )
        };
        recording.faults.iter().any(known)
    };
    if is_mesh(recording) {
        let can_have = |range: [f64; 2], value: f64| range[0] <= value && value < range[1];
        let is_travel = |travel: f64| can_have(ScalePolicy::in_use().mesh_travel, travel);
        let is_stiffness =
            |stiffness: f64| can_have(ScalePolicy::in_use().mesh_stiffness, stiffness);
        for factor in [1.0 / THOUSAND, THOUSAND] {
            if !is_travel(travel) && is_travel(travel * factor) && is_stiffness(stiffness / factor)
            {
                multiply(recording, Channel::Displacement, 0..recording.len(), factor);
                return;
            }
            if is_travel(travel) && !is_stiffness(stiffness) && is_stiffness(stiffness * factor) {
                multiply(recording, Channel::Force, 0..recording.len(), factor);
                return;
            }
        }
    }
    if stiffness > ScalePolicy::in_use().stiffest && !is_known(recording, Channel::Force) {
        say(
            recording,
            Channel::Force,
            1.0 / THOUSAND,
            recording.len(),
            false,
        );
    }
    // Without a force, as where a law predicts one, there is nothing to judge.
    if stiffness > 0.0
        && stiffness < ScalePolicy::in_use().softest
        && !is_known(recording, Channel::Force)
        && !is_known(recording, Channel::Displacement)
    {
        let kind = ChannelFaultKind::Soft { stiffness };
        recording.faults.push(ChannelFault {
            channel: Channel::Force,
            kind,
        });
    }
    if let Some(rate) = declared_rate(recording)
        && !is_known(recording, Channel::Time)
    {
        let factor = 1.0 / (rate * recording.sample_period());
        if [THOUSAND, 1.0 / THOUSAND]
            .iter()
            .any(|unit| (factor / unit - 1.0).abs() < ScalePolicy::in_use().same_rate)
        {
            say(recording, Channel::Time, factor, recording.len(), false);
        }
    }
}

fn values(recording: &Recording, channel: Channel) -> &[f64] {
    match channel {
        Channel::Displacement => &recording.displacement,
        _ => &recording.force,
    }
}

fn multiply(recording: &mut Recording, channel: Channel, samples: Range<usize>, factor: f64) {
    let count = samples.len();
    let values = match channel {
        Channel::Displacement => &mut recording.displacement,
        _ => &mut recording.force,
    };
    values[samples]
        .iter_mut()
        .for_each(|value| *value *= factor);
    say(recording, channel, factor, count, true);
}

fn say(recording: &mut Recording, channel: Channel, factor: f64, samples: usize, repaired: bool) {
    let kind = ChannelFaultKind::Unit {
        factor,
        samples,
        repaired,
    };
    recording.faults.push(ChannelFault { channel, kind });
}

/// Finds where the size of one channel, and not that of the other, jumps by a unit, and repairs the smaller part.
fn repair_changes(recording: &mut Recording, channel: Channel) {
    let other = match channel {
        Channel::Force => Channel::Displacement,
        _ => Channel::Force,
    };
    let mut levels: Vec<(usize, i32)> = vec![(0, 0)];
    let mut repaired = values(recording, channel).to_vec();
    for _ in 0..ScalePolicy::in_use().most_changes {
        let Some((at, up)) = change(&repaired, values(recording, other)) else {
            break;
        };
        let factor = if up { 1.0 / THOUSAND } else { THOUSAND };
        repaired[at..].iter_mut().for_each(|value| *value *= factor);
        levels.push((at, if up { 1 } else { -1 }));
    }
    if levels.len() == 1 || change(&repaired, values(recording, other)).is_some() {
        return;
    }
    // Powers of a thousand of each sample relative to the first one's unit.
    levels.sort_by_key(|&(at, _)| at);
    let count = repaired.len();
    let mut above = vec![0; count];
    for &(at, step) in &levels {
        above[at..].iter_mut().for_each(|above| *above += step);
    }
    // The unit of most of the samples is the right one.
    let most = (-1..=1).max_by_key(|level| above.iter().filter(|above| *above == level).count());
    let most = most.unwrap_or(0);
    let wrong = above.iter().filter(|&&level| level != most).count();
    let towards = (above.iter().find(|&&level| level != most)).map_or(0, |&level| most - level);
    let values = match channel {
        Channel::Displacement => &mut recording.displacement,
        _ => &mut recording.force,
    };
    for (value, level) in values.iter_mut().zip(&above) {
        *value *= THOUSAND.powi(most - level);
    }
    say(recording, channel, THOUSAND.powi(towards), wrong, true);
}

/// Where the size of `values` jumps by a unit, permanently or for a stretch, while `other` continues; and whether upwards.
fn change(values: &[f64], other: &[f64]) -> Option<(usize, bool)> {
    let stretch = ((ScalePolicy::in_use().stretch * values.len() as f64) as usize)
        .max(ScalePolicy::in_use().shortest);
    if values.len() < 3 * stretch {
        return None;
    }
    let (own, others) = (Sizes::of(values), Sizes::of(other));
    let ratio = |sizes: &Sizes, at: usize| {
        sizes.deviation(at..at + stretch) / sizes.deviation(at - stretch..at)
    };
    let beyond = |ratio: f64| ratio.max(1.0 / ratio);
    let (at, _) = (stretch..values.len() - stretch)
        .map(|at| (at, beyond(ratio(&own, at))))
        .filter(|&(at, jump)| {
            let others = beyond(ratio(&others, at));
            jump > ScalePolicy::in_use().unit_apart
                && jump < ScalePolicy::in_use().unit_apart * ScalePolicy::in_use().unit_apart
                && others < ScalePolicy::in_use().same_unit
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    let up = ratio(&own, at) > 1.0;
    let smaller = if up {
        at - stretch..at
    } else {
        at..at + stretch
    };
    // A channel at rest is small too, but does not follow the other.
    if correlation(&values[smaller.clone()], &other[smaller.clone()]).abs()
        < ScalePolicy::in_use().follows
    {
        return None;
    }
    // Nor is one that rests after a motion in another unit: that would be more than a few times its noise.
    let noise = noise_deviation(&values[smaller.clone()]);
    if own.deviation(smaller.clone()) < ScalePolicy::in_use().above_noise * noise {
        return None;
    }
    let around = at - stretch..at + stretch;
    let too_large = |index: &usize| {
        values[*index].abs() > ScalePolicy::in_use().same_unit * own.rms(smaller.clone())
    };
    let at = if up {
        around.clone().find(too_large)?
    } else {
        around.clone().rev().find(too_large)? + 1
    };
    // Samples about 0 are not too large in either unit: the change is where the repaired channel is smoothest.
    let near = at.saturating_sub(ScalePolicy::in_use().near).max(2)
        ..(at + ScalePolicy::in_use().near).min(values.len() - 2);
    let roughness = |change: usize| -> f64 {
        let factor = if up { 1.0 / THOUSAND } else { THOUSAND };
        let repaired = |index: usize| values[index] * if index < change { 1.0 } else { factor };
        let bend = |index: usize| repaired(index + 1) - 2.0 * repaired(index) + repaired(index - 1);
        let size = if up { 1.0 } else { THOUSAND };
        near.clone().map(|index| (bend(index) / size).powi(2)).sum()
    };
    let at = near
        .clone()
        .min_by(|&a, &b| roughness(a).total_cmp(&roughness(b)))?;
    Some((at, up))
}

/// Sums of values and of their squares up to each sample.
struct Sizes(Vec<(f64, f64)>);

impl Sizes {
    fn of(values: &[f64]) -> Self {
        let (mut sum, mut square) = (0.0, 0.0);
        let sums = values.iter().map(|value| {
            sum += value;
            square += value * value;
            (sum, square)
        });
        Self(std::iter::once((0.0, 0.0)).chain(sums).collect())
    }

    fn mean_square(&self, samples: &Range<usize>) -> (f64, f64) {
        let ((from, from_square), (to, to_square)) = (self.0[samples.start], self.0[samples.end]);
        let count = samples.len() as f64;
        ((to - from) / count, (to_square - from_square) / count)
    }

    fn rms(&self, samples: Range<usize>) -> f64 {
        self.mean_square(&samples).1.sqrt()
    }

    /// About the stretch's own mean; never 0.
    fn deviation(&self, samples: Range<usize>) -> f64 {
        let (mean, square) = self.mean_square(&samples);
        (square - mean * mean)
            .max(1e-14 * square)
            .sqrt()
            .max(f64::MIN_POSITIVE)
    }
}

/// Force per displacement, kN/mm, insensitive to spikes.
fn stiffness(recording: &Recording) -> f64 {
    spread(&recording.force) / spread(&recording.displacement)
}

/// Whether the comments declare a metal mesh damper.
fn is_mesh(recording: &Recording) -> bool {
    ["specimen", "device"]
        .iter()
        .filter_map(|key| recording.declared(key))
        .any(|text| text.contains("MMD") || text.to_lowercase().contains("mesh"))
}

/// `sample_rate_hz = 500` in the comments, Hz.
fn declared_rate(recording: &Recording) -> Option<f64> {
    recording.comments.iter().find_map(|comment| {
        let (name, rate) = comment.split_once(['=', ':'])?;
        let is_rate = name.trim().eq_ignore_ascii_case("sample_rate_hz");
        is_rate.then(|| rate.trim().parse().ok()).flatten()
    })
}
