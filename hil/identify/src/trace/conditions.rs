//! The conditions of recordings that are held out, one after the other.

use std::ops::Range;

use mesh_damper_recording::cycles::{FoundBlock, alike, same_amplitude};
use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_recording::trajectory::Trajectory;

use super::left_out::LeftOutPolicy;
use super::split::Roles;

/// At most this many conditions are held out in turn: each needs a fit.
const MOST_CONDITIONS: usize = 8;

/// Blocks of at least that many open cycles, by their amplitude, then by their frequency.
fn blocks_of_cycles<'t>(
    trajectories: &'t [Trajectory],
    roles: &Roles,
    fewest: usize,
) -> Vec<(usize, &'t FoundBlock)> {
    let each = trajectories.iter().enumerate();
    let each = each
        .flat_map(|(which, trajectory)| trajectory.blocks.iter().map(move |block| (which, block)));
    let mut blocks: Vec<(usize, &FoundBlock)> = each
        .filter(|(which, block)| {
            let mut samples = block.samples.clone();
            let trajectory = &trajectories[*which];
            block.cycles.len() >= fewest
                && samples.any(|i| roles.is_open(*which, i) && trajectory.is_telling(i))
        })
        .collect();
    blocks.sort_by(|(_, a), (_, b)| {
        let by_amplitude = a.amplitude.total_cmp(&b.amplitude);
        by_amplitude.then(a.frequency.total_cmp(&b.frequency))
    });
    blocks
}

/// Samples that are held out together: one motion, wherever it was recorded. A repetition that stays in the fit would say what the
/// motion that is held out looks like.
pub(super) struct Condition {
    /// Its blocks, recordings or stretches, in the order of the recordings.
    pub parts: Vec<Part>,
    /// Whether no other condition has as small an amplitude, or none has as large a one: a prediction there is an extrapolation.
    pub is_end: bool,
    /// Whether the conditions are different motions. Otherwise they are repetitions of a few, or parts of one recording.
    pub is_motion: bool,
    /// Whether no other condition has its amplitude: with coefficients for each amplitude, the law's own are unknown there.
    pub is_alone: bool,
}

impl Condition {
    /// Whether it has a sample of a trajectory.
    pub fn contains(&self, which: usize, sample: usize) -> bool {
        self.is_within(which, sample, 0)
    }

    /// Whether a sample of a trajectory is in it, or at most `margin` samples before or after.
    pub fn is_within(&self, which: usize, sample: usize, margin: usize) -> bool {
        let mut parts = self.parts.iter();
        parts.any(|part| {
            let Range { start, end } = part.samples;
            part.which == which && start <= sample + margin && sample < end + margin
        })
    }
}

/// A block, a recording or a stretch of one.
#[derive(Clone)]
pub(super) struct Part {
    /// Index of the trajectory.
    pub which: usize,
    /// Its samples.
    pub samples: Range<usize>,
    /// Squared force of these samples over the squared force that errors are divided by. For a stretch the latter is that of the
    /// recording, because the stretch may be at rest.
    pub loud: f64,
}

/// What makes two motions the same: each value of one is [`alike`] that of the other.
type Motion = Vec<f64>;

/// Open conditions, evenly spread over amplitude and frequency and including those at the ends: blocks of several cycles, or
/// recordings if there are few blocks, or stretches if there are few recordings too. Parts of the same motion under the same control
/// inputs are one condition, unless that leaves too few.
pub(super) fn conditions(trajectories: &[Trajectory], roles: &Roles) -> Vec<Condition> {
    let fewest_conditions = LeftOutPolicy::in_use().fewest_conditions;
    let blocks = blocks_of_cycles(trajectories, roles, LeftOutPolicy::in_use().some_cycles);
    // The cycles of a random motion resemble others only by chance: its blocks are no conditions.
    let open = |which: usize, samples: &Range<usize>| {
        samples.clone().filter(|&i| roles.is_open(which, i)).count()
    };
    let in_blocks: usize = blocks
        .iter()
        .map(|(which, block)| open(*which, &block.samples))
        .sum();
    let all = trajectories.iter().enumerate();
    let all: usize = all
        .map(|(which, trajectory)| open(which, &(0..trajectory.len())))
        .sum();
    if blocks.len() < fewest_conditions || 2 * in_blocks < all {
        let parts = recordings(trajectories, roles);
        let each = parts.into_iter().map(|part| {
            let motion = motion_of(&trajectories[part.which], &part.samples);
            (motion, part)
        });
        let is_cut = trajectories.len() < fewest_conditions;
        let (groups, differ) = grouped(each.collect(), fewest_conditions);
        let conditions = groups.into_iter().map(|parts| Condition {
            parts,
            is_end: false,
            is_motion: differ && !is_cut,
            is_alone: false,
        });
        return evenly(conditions.collect(), MOST_CONDITIONS);
    }
    let each = blocks.iter().map(|&(which, block)| {
        let part = Part {
            which,
            samples: block.samples.clone(),
            loud: 1.0,
        };
        let controls = levels_of_controls(&trajectories[which], &part.samples);
        let motion = [block.amplitude, block.frequency].into_iter();
        (motion.chain(controls).collect(), part)
    });
    let amplitude = |part: &Part| {
        let mut of_trajectory = trajectories[part.which].blocks.iter();
        let block = of_trajectory.find(|block| block.samples == part.samples);
        block.map_or(0.0, |block| block.amplitude)
    };
    let (groups, is_motion) = grouped(each.collect(), fewest_conditions);
    // They are in the order of their amplitudes.
    let amplitudes: Vec<f64> = groups.iter().map(|parts| amplitude(&parts[0])).collect();
    let is_end = |amplitude: f64| {
        let alone_at = |end: f64, next: f64| amplitude == end && !same_amplitude(end, next);
        let last = amplitudes.len() - 1;
        alone_at(amplitudes[0], amplitudes[1]) || alone_at(amplitudes[last], amplitudes[last - 1])
    };
    let is_alone = |amplitude: f64| {
        let same = amplitudes
            .iter()
            .filter(|&&other| same_amplitude(other, amplitude));
        same.count() == 1
    };
    let conditions = groups.into_iter().map(|parts| Condition {
        is_end: is_end(amplitude(&parts[0])),
        is_alone: is_alone(amplitude(&parts[0])),
        is_motion,
        parts,
    });
    evenly(conditions.collect(), MOST_CONDITIONS)
}

/// The open samples of each recording, or of stretches if there are few recordings.
fn recordings(trajectories: &[Trajectory], roles: &Roles) -> Vec<Part> {
    let LeftOutPolicy {
        fewest_conditions,
        stretches,
        ..
    } = *LeftOutPolicy::in_use();
    let pieces = if trajectories.len() < fewest_conditions {
        stretches
    } else {
        1
    };
    let cut = |(which, trajectory): (usize, &Trajectory)| {
        let open: Vec<usize> = (0..trajectory.len())
            .filter(|&i| roles.is_open(which, i))
            .collect();
        let length = open.len().div_ceil(pieces).max(1);
        let power = |samples: &[usize]| {
            let squares = samples.iter().map(|&i| trajectory.force[i].powi(2));
            squares.sum::<f64>() / samples.len() as f64
        };
        let of_all = power(&open);
        let each = open.chunks(length).map(|some| Part {
            which,
            samples: some[0]..some[some.len() - 1] + 1,
            loud: power(some) / of_all,
        });
        each.collect::<Vec<_>>()
    };
    trajectories.iter().enumerate().flat_map(cut).collect()
}

/// Range of the displacement in mm, RMS of the velocity in mm/s, and levels of the control inputs: what a test programme sets.
fn motion_of(trajectory: &Trajectory, samples: &Range<usize>) -> Motion {
    let (low, high) = least_and_largest(&trajectory.motion.displacement[samples.clone()]);
    let velocity = trajectory.motion.velocity[samples.clone()].iter();
    let speed = (velocity.map(|v| v * v).sum::<f64>() / samples.len() as f64).sqrt();
    let controls = levels_of_controls(trajectory, samples);
    [high - low, speed].into_iter().chain(controls).collect()
}

/// The mean of each control input there, in its unit.
fn levels_of_controls(trajectory: &Trajectory, samples: &Range<usize>) -> Motion {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let each = trajectory.controls.iter();
    each.map(|control| mean(&control.values[samples.clone()]))
        .collect()
}

/// Parts of the same motion together, or each alone if there are fewer than `fewest` motions; and whether there are enough.
fn grouped(parts: Vec<(Motion, Part)>, fewest: usize) -> (Vec<Vec<Part>>, bool) {
    let mut groups: Vec<(Motion, Vec<Part>)> = Vec::new();
    let each = parts.clone();
    for (motion, part) in parts {
        let same = |known: &Motion| {
            known
                .iter()
                .zip(&motion)
                .all(|(a, b)| a == b || alike(*a, *b))
        };
        match groups.iter_mut().find(|(known, _)| same(known)) {
            Some((_, parts)) => parts.push(part),
            None => groups.push((motion, vec![part])),
        }
    }
    let enough = groups.len() >= fewest;
    let groups = match enough {
        true => groups.into_iter().map(|(_, parts)| parts).collect(),
        false => each.into_iter().map(|(_, part)| vec![part]).collect(),
    };
    (groups, enough)
}

/// At most `most` of `all`, including the first and the last.
fn evenly<T>(all: Vec<T>, most: usize) -> Vec<T> {
    let (length, count) = (all.len(), all.len().min(most));
    let mut places = (0..count)
        .map(|place| place * (length - 1) / (count - 1).max(1))
        .peekable();
    let picked = all.into_iter().enumerate();
    picked
        .filter(|(place, _)| places.next_if_eq(place).is_some())
        .map(|(_, one)| one)
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::left_out::{LeftOut, Samples};
    use super::*;
    use mesh_damper_model::{LawNode, Model};
    use mesh_damper_recording::Recording;

    /// Consecutive sines of 1 Hz with these amplitudes in mm.
    fn test(amplitudes: &[f64]) -> Trajectory {
        let samples = 0..amplitudes.len() * 2000;
        let sine = |i: usize| amplitudes[i / 2000] * (TAU * i as f64 / 500.0).sin();
        let displacement: Vec<f64> = samples.clone().map(sine).collect();
        let force = displacement.iter().map(|y| 2.0 * y).collect();
        let time = samples.map(|i| i as f64 / 500.0).collect();
        let recording = Recording::new("test", time, displacement, force).unwrap();
        let trajectory = Trajectory::of(&recording).unwrap();
        assert_eq!(trajectory.blocks.len(), amplitudes.len());
        trajectory
    }

    #[test]
    fn what_lies_beyond_all_other_amplitudes_counts_only_where_little_else_is() {
        let counted = |amplitudes: &[f64]| {
            let trajectories = [test(amplitudes)];
            let roles = Roles::all_fit(&trajectories);
            let left_out = LeftOut::of(&trajectories, &roles);
            let no_force = || Model {
                law: vec![LawNode {
                    amplitude: 0.1,
                    k1: 0.0,
                    k3: 0.0,
                    c: 0.0,
                    alpha: 1.0,
                }],
                effects: Vec::new(),
                correction: None,
                controls: Vec::new(),
            };
            left_out.in_turn(Samples::All, &|_| Ok(no_force())).len()
        };
        assert_eq!(counted(&[0.2, 0.1, 0.2, 0.3, 0.2]), 3);
        assert_eq!(
            counted(&[0.1, 0.3, 0.2, 0.1, 0.3]),
            3,
            "a repetition is no other condition, and one alone decides nothing"
        );
        assert_eq!(
            counted(&[0.2, 0.1, 0.2, 0.3]),
            3,
            "one alone decides nothing"
        );
    }

    #[test]
    fn repetitions_of_a_motion_are_held_out_together() {
        let parts = |trajectories: &[Trajectory]| -> Vec<Vec<(usize, usize)>> {
            let roles = Roles::all_fit(trajectories);
            let conditions = conditions(trajectories, &roles).into_iter();
            let place = |part: Part| (part.which, part.samples.start / 2000);
            conditions
                .map(|condition| condition.parts.into_iter().map(place).collect())
                .collect()
        };
        let long = test(&[0.1, 0.2, 0.3, 0.1, 0.2]);
        let again = test(&[0.3]);
        assert_eq!(
            parts(&[long, again]),
            [
                vec![(0, 0), (0, 3)],
                vec![(0, 1), (0, 4)],
                vec![(0, 2), (1, 0)]
            ]
        );
        let two_motions = test(&[0.1, 0.2, 0.1]);
        assert_eq!(
            parts(&[two_motions]),
            [vec![(0, 0)], vec![(0, 2)], vec![(0, 1)]],
            "two conditions would be too few"
        );
    }
}
