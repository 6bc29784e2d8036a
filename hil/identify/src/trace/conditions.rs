//! The choice of blocks and conditions of recordings to hold out.

use std::ops::Range;

use mesh_damper_recording::cycles::{FoundBlock, same_amplitude};
use mesh_damper_recording::trajectory::Trajectory;

use super::left_out::LeftOutPolicy;
use super::split::Roles;

/// At most this many blocks are left out of a fit, one at a time. Convention: bounds the time: each needs a fit.
const MOST_BLOCKS: usize = 4;

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

/// Blocks to leave out, evenly spread over amplitude and frequency, from those whose amplitude another block has, so that eq 13 is
/// known there. If there are few such blocks, also blocks with amplitudes between others; if there are none, all blocks. The first
/// and the last block of a recording are not left out if there are others.
pub(super) fn blocks<'t>(
    trajectories: &'t [Trajectory],
    roles: &Roles,
) -> Vec<(usize, &'t FoundBlock)> {
    let blocks = blocks_of_cycles(trajectories, roles, 2);
    if blocks.len() < LeftOutPolicy::in_use().fewest_blocks {
        return Vec::new();
    }
    let has_another = |block: &FoundBlock| {
        let mut others = blocks.iter().filter(|(_, b)| !std::ptr::eq(*b, block));
        others.any(|(_, other)| same_amplitude(other.amplitude, block.amplitude))
    };
    let (least, largest) = (blocks[0].1.amplitude, blocks[blocks.len() - 1].1.amplitude);
    let is_between = |block: &FoundBlock| {
        let is_end = |end: f64| same_amplitude(block.amplitude, end);
        !is_end(least) && !is_end(largest)
    };
    let few = blocks.iter().filter(|(_, b)| has_another(b)).count() < MOST_BLOCKS;
    let known: Vec<(usize, &FoundBlock)> = blocks
        .iter()
        .filter(|(_, block)| has_another(block) || few && is_between(block))
        .copied()
        .collect();
    let known = if known.is_empty() { blocks } else { known };
    // A change over time is not known before the first open block nor after the last.
    let is_inner = |(which, block): &(usize, &FoundBlock)| {
        let all = trajectories[*which].blocks.iter();
        let mut open = all.filter(|block| block.samples.clone().any(|i| roles.is_open(*which, i)));
        let (first, last) = (open.next(), open.next_back());
        let is = |end: Option<&FoundBlock>| end.is_some_and(|end| std::ptr::eq(end, *block));
        let is_only = last.is_none();
        is_only || !(is(first) || is(last))
    };
    let inner: Vec<(usize, &FoundBlock)> = known.iter().copied().filter(is_inner).collect();
    let known = if inner.len() < LeftOutPolicy::in_use().fewest_inner {
        known
    } else {
        inner
    };
    let count = known.len().min(MOST_BLOCKS);
    (0..count)
        .map(|place| known[(2 * place + 1) * known.len() / (2 * count)])
        .collect()
}

/// Samples of one trajectory that are held out together.
pub(super) struct Condition {
    /// Index of the trajectory.
    pub which: usize,
    /// Its samples.
    pub samples: Range<usize>,
    /// Squared force of these samples over the squared force that errors are divided by. For a stretch the latter is that of the
    /// recording, because the stretch may be at rest.
    pub loud: f64,
    /// Whether no other condition has as small an amplitude, or none has as large a one: a prediction there is an extrapolation.
    pub is_end: bool,
}

/// Open conditions, evenly spread over amplitude and frequency and including those at the ends: blocks of several cycles, or
/// recordings if there are few blocks, or stretches if there are few recordings too.
pub(super) fn conditions(trajectories: &[Trajectory], roles: &Roles) -> Vec<Condition> {
    let LeftOutPolicy {
        fewest_conditions,
        most_conditions,
        stretches,
        ..
    } = *LeftOutPolicy::in_use();
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
            let each = open.chunks(length).map(|some| Condition {
                which,
                samples: some[0]..some[some.len() - 1] + 1,
                loud: power(some) / of_all,
                is_end: false,
            });
            each.collect::<Vec<_>>()
        };
        let all = trajectories.iter().enumerate().flat_map(cut).collect();
        return evenly(all, most_conditions);
    }
    // They are in the order of their amplitudes.
    let amplitudes: Vec<f64> = blocks.iter().map(|(_, block)| block.amplitude).collect();
    let is_end = |amplitude: f64| {
        let alone_at = |end: f64, next: f64| amplitude == end && !same_amplitude(end, next);
        let last = amplitudes.len() - 1;
        alone_at(amplitudes[0], amplitudes[1]) || alone_at(amplitudes[last], amplitudes[last - 1])
    };
    let each = evenly(blocks, most_conditions).into_iter();
    each.map(|(which, block)| Condition {
        which,
        samples: block.samples.clone(),
        loud: 1.0,
        is_end: is_end(block.amplitude),
    })
    .collect()
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

    use super::super::left_out::LeftOut;
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

    /// The blocks that are left out, with their recordings.
    fn left_out(trajectories: &[Trajectory]) -> Vec<(usize, usize)> {
        let roles = Roles::all_fit(trajectories);
        let number = |(which, block): (usize, &FoundBlock)| {
            let blocks = &trajectories[which].blocks;
            let same = |other: &FoundBlock| std::ptr::eq(other, block);
            (which, blocks.iter().position(same).unwrap())
        };
        let mut places: Vec<_> = blocks(trajectories, &roles)
            .into_iter()
            .map(number)
            .collect();
        places.sort_unstable();
        places
    }

    #[test]
    fn what_lies_beyond_all_other_amplitudes_counts_only_where_little_else_is() {
        let counted = |amplitudes: &[f64]| {
            let trajectories = [test(amplitudes)];
            let roles = Roles::all_fit(&trajectories);
            let left_out = LeftOut::of(&trajectories, [&roles, &roles]);
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
            left_out.in_turn(&|_| Ok(no_force())).unwrap().len()
        };
        assert_eq!(counted(&[0.2, 0.1, 0.2, 0.3, 0.2]), 3);
        assert_eq!(counted(&[0.1, 0.3, 0.2, 0.1, 0.3]), 5, "no end is alone");
        assert_eq!(
            counted(&[0.2, 0.1, 0.2, 0.3]),
            4,
            "two alone decide nothing"
        );
    }

    #[test]
    fn the_ends_of_a_recording_are_left_out_only_where_little_is_between() {
        // Each amplitude has another block.
        let long = test(&[0.1, 0.2, 0.3, 0.1, 0.2, 0.3]);
        assert_eq!(left_out(&[long]), [(0, 1), (0, 2), (0, 3), (0, 4)]);
        let mixed = [test(&[0.1, 0.2, 0.1, 0.2]), test(&[0.1])];
        assert_eq!(left_out(&mixed), [(0, 1), (0, 2), (1, 0)]);
        let short = [test(&[0.1, 0.2, 0.1]), test(&[0.2])];
        assert_eq!(left_out(&short), [(0, 1), (1, 0)]);
        let single = [0.1, 0.2, 0.1, 0.2].map(|amplitude| test(&[amplitude]));
        assert_eq!(left_out(&single), [(0, 0), (1, 0), (2, 0), (3, 0)]);
    }
}
