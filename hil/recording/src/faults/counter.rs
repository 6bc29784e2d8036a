//! A displacement whose counter begins again at the end of its range: it jumps from one end to the other while the force goes on.

use mesh_damper_tables::channel::Channel;

use super::super::Recording;
use super::clipping::rounding;
use super::kind::{ChannelFault, ChannelFaultKind};
use super::{FaultsPolicy, spread};
use crate::extremes::{least_and_largest, quantile};

crate::numbers! {
    /// When a displacement jumps because its counter began again.
    CounterPolicy {
        /// A jump is at least this part of the distance between the lowest and the highest displacement.
        jump: f64 = 0.7, Derived("a counter reaches both ends to within the step of a sample");
        /// The displacement moves on from jump to jump by at most this part of the range in a sample.
        step: f64 = 0.2, Convention("otherwise the direction of a step is not certain");
        /// The ranges that single jumps show differ by at most this many times the usual step of the displacement.
        same: f64 = 2.0, Convention("each jump has the step of a sample in it, which is known to within itself");
        /// The force goes on at a jump if it changes by at most this many times the step below which nine tenths of its steps lie.
        force: f64 = 3.0, Convention("a jump of the displacement itself would change the force by most of its range");
        /// Of the jumps, at least this part goes on with the force.
        most: f64 = 0.9, Convention("a spike in one force may meet a jump");
    }
}

/// A single jump this many samples from an end is none of a counter. Convention: a spike may last as long.
const NEAR_END: usize = 4;

/// Continues the displacement beyond the ends of the counter's range.
pub(super) fn repair(recording: &mut Recording) -> bool {
    let Some((range, jumps)) = wraps(&recording.displacement, &recording.force) else {
        return false;
    };
    let mut turns = 0.0;
    let mut jumps_left = jumps.iter().peekable();
    for (index, y) in recording.displacement.iter_mut().enumerate() {
        if let Some((_, up)) = jumps_left.next_if(|(at, _)| *at == index) {
            turns += if *up { -1.0 } else { 1.0 };
        }
        *y += turns * range;
    }
    recording.faults.push(ChannelFault {
        channel: Channel::Displacement,
        kind: ChannelFaultKind::Counter {
            range,
            times: jumps.len(),
        },
    });
    true
}

/// The range of the counter, and the samples that are first beyond an end of it, each with whether it jumped up.
fn wraps(y: &[f64], force: &[f64]) -> Option<(f64, Vec<(usize, bool)>)> {
    let CounterPolicy {
        jump,
        step,
        same,
        force: goes_on,
        most,
    } = *CounterPolicy::in_use();
    let (low, high) = least_and_largest(y);
    let whole = high - low;
    let steps: Vec<f64> = y.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let jumps: Vec<usize> = (0..steps.len())
        .filter(|&index| steps[index].abs() > jump * whole)
        .collect();
    // What comes once near an end is a spike.
    let is_inside = |jump: &usize| *jump >= NEAR_END && jump + NEAR_END < steps.len();
    if jumps.is_empty() || jumps.len() == 1 && !jumps.iter().all(is_inside) {
        return None;
    }
    let others = (0..steps.len()).filter(|index| steps[*index].abs() <= jump * whole);
    let mut others: Vec<f64> = others.map(|index| steps[index].abs()).collect();
    let largest = others.iter().fold(0.0_f64, |most, step| most.max(*step));
    if largest > step * whole {
        return None;
    }
    let usual = quantile(&mut others, 0.9);
    // A counter passes from one end to the other, a spike from anywhere.
    let at_ends = |&index: &usize| {
        let [before, after] = [y[index], y[index + 1]];
        let from_end = (before.min(after) - low).max(high - before.max(after));
        from_end <= 2.0 * largest
    };
    if !jumps.iter().all(at_ends) {
        return None;
    }
    // What a sample moves there is the mean of the steps around it, unless these jump too.
    let moved = |index: usize| {
        let near = [index.checked_sub(1), Some(index + 1)];
        let near = near
            .into_iter()
            .flatten()
            .filter_map(|near| steps.get(near));
        let near = near.filter(|step| step.abs() <= jump * whole);
        let (sum, count) = near.fold((0.0, 0.0), |(sum, count), step| (sum + step, count + 1.0));
        sum / f64::max(count, 1.0)
    };
    let mut ranges: Vec<f64> = (jumps.iter())
        .map(|&index| (steps[index] - moved(index)).abs())
        .collect();
    let (shortest, longest) = least_and_largest(&ranges);
    if longest - shortest > same * usual.max(f64::EPSILON * whole) {
        return None;
    }
    let range = whole_steps(quantile(&mut ranges, 0.5), usual, y);
    // A sawtooth jumps too, and the force with it.
    let mut changes: Vec<f64> = force
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    let at_jumps = jumps
        .iter()
        .map(|&index| (force[index + 1] - force[index]).abs());
    let at_jumps: Vec<f64> = at_jumps.collect();
    let limit = goes_on * quantile(&mut changes, 0.9);
    let going_on = at_jumps.iter().filter(|change| **change <= limit).count();
    if limit == 0.0 || (going_on as f64) < most * jumps.len() as f64 {
        return None;
    }
    let each = jumps.into_iter();
    Some((
        range,
        each.map(|index| (index + 1, steps[index] > 0.0)).collect(),
    ))
}

/// A range of `about` this length, to within `off`: the power of two of the resolution of `y`, if it has one that fits.
fn whole_steps(about: f64, off: f64, y: &[f64]) -> f64 {
    let resolution = rounding(y, FaultsPolicy::in_use().same_value * spread(y));
    let bits = (about / resolution).log2().round();
    let range = bits.exp2() * resolution;
    if (range - about).abs() <= off {
        range
    } else {
        about
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use proptest::prelude::*;

    use super::*;

    /// A sum of sines, rounded to the counter's resolution, and the force of a spring with friction.
    fn test(resolution: f64, bits: i32, travel: f64, centre: f64, phase: f64) -> [Vec<f64>; 3] {
        let range = resolution * 2.0_f64.powi(bits);
        let truth: Vec<f64> = (0..4000)
            .map(|n| {
                let turn = TAU * f64::from(n) / 400.0 + phase;
                let y = range * (centre + travel * (turn.sin() + 0.2 * (2.7 * turn).sin()));
                (y / resolution).round() * resolution
            })
            .collect();
        let force = (0..4000).map(|n: usize| {
            let way = truth[(n + 1).min(3999)] - truth[n.saturating_sub(1)];
            truth[n] / range + 0.02 * (100.0 * way / range).tanh()
        });
        let shown = truth
            .iter()
            .map(|y| (y + 0.5 * range).rem_euclid(range) - 0.5 * range);
        [shown.collect(), force.collect(), truth.clone()]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn a_counter_is_continued(resolution in 1e-4..2e-3_f64, bits in 10..18_i32, travel in 0.3..1.5_f64,
            centre in -0.5..0.5_f64, phase in 0.0..6.0_f64) {
            let [shown, force, truth] = test(resolution, bits, travel, centre, phase);
            let half = 0.5 * resolution * 2.0_f64.powi(bits);
            let near_end = |shown: &[f64]| shown.windows(2).any(|pair| (pair[1] - pair[0]).abs() > half);
            prop_assume!(!near_end(&shown[..10]) && !near_end(&shown[3990..]));
            let mut recording = Recording::new("test", (0..4000).map(|n| 0.01 * f64::from(n)).collect(), shown, force).unwrap();
            let jumps = recording.displacement.windows(2).any(|pair| (pair[1] - pair[0]).abs() > 0.5 * resolution * 2.0_f64.powi(bits));
            prop_assert_eq!(repair(&mut recording), jumps);
            let off = recording.displacement[0] - truth[0];
            let worst = recording.displacement.iter().zip(&truth).map(|(y, truth)| (y - truth - off).abs()).fold(0.0, f64::max);
            prop_assert!(worst < 1e-6 * resolution * 2.0_f64.powi(bits), "{worst} mm");
        }
    }

    /// A motion that itself jumps takes the force along.
    #[test]
    fn a_sawtooth_is_no_counter() {
        let y: Vec<f64> = (0..4000).map(|n| 0.01 * f64::from(n % 200)).collect();
        let force: Vec<f64> = y.iter().map(|y| 3.0 * y).collect();
        assert_eq!(wraps(&y, &force), None);
        let square: Vec<f64> = (0..4000).map(|n| f64::from(n / 100 % 2)).collect();
        let force: Vec<f64> = square.iter().map(|y| 3.0 * y).collect();
        assert_eq!(wraps(&square, &force), None);
    }
}
