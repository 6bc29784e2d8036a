//! A load cell zero that differs between recordings of the same specimen.
//!
//! The search looks at the means of the residuals. Deviations that a law lacks differ between recordings too, but their means are
//! spread out. If zeros differ, all but a few of the means agree.

use mesh_damper_tables::channel::Channel;

use crate::faults::kind::{ChannelFault, ChannelFaultKind};
use crate::trajectory::Trajectory;

crate::numbers! {
    /// How a recording is recognized whose force has another zero than the other recordings.
    ZerosPolicy {
        /// The zeros of recordings are compared only if there are at least this many recordings.
        fewest: usize = 4, Derived("three that agree, and one that does not");
        /// The zero of a recording is wrong if its mean residual is farther from those of the others than this many times their range.
        stands_out: f64 = 5.0, Tuned("means drawn at random: see the tests in the same file");
        /// Wrong zeros are removed only if this reduces the RMS residual of the law below this fraction.
        needed: f64 = 0.75, Convention("the gain that a residual table needs to replace effects");
    }
}

/// The residual of a law for one recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOfOne {
    /// Its mean, kN.
    pub mean: f64,
    /// Variance about the mean, kN².
    pub variance: f64,
    /// RMS of the force, kN. With it every recording counts equally.
    pub scale: f64,
}

/// How far the zeros of some recordings lie from the zeros of the others, with the place of each in `left`. Empty if none differ,
/// or if the correction hardly reduces the residual of the law. `noise` is the possible error of a mean, kN.
pub fn odd_zeros(left: &[LeftOfOne], noise: f64) -> Vec<(usize, f64)> {
    if left.len() < ZerosPolicy::in_use().fewest {
        return Vec::new();
    }
    let mut order: Vec<usize> = (0..left.len()).collect();
    order.sort_by(|&a, &b| left[a].mean.total_cmp(&left[b].mean));
    // The few at one end: the others agree.
    let few = 1..=(left.len() - 1) / 2;
    let splits = few.flat_map(|few| [(few, left.len()), (0, left.len() - few)]);
    let outstanding = splits.map(|(start, end)| {
        let alike = &order[start..end];
        let mean = |place: &usize| left[*place].mean;
        let (low, high) = (mean(&alike[0]), mean(&alike[alike.len() - 1]));
        let away = match start {
            0 => mean(&order[end]) - high,
            _ => low - mean(&order[start - 1]),
        };
        (away / (high - low).max(noise), start, end)
    });
    let Some((stands_out, start, end)) = outstanding.max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Vec::new();
    };
    if stands_out.is_nan() || stands_out <= ZerosPolicy::in_use().stands_out {
        return Vec::new();
    }
    let alike = &order[start..end];
    let of_alike = alike.iter().map(|&place| left[place].mean).sum::<f64>() / alike.len() as f64;
    let odd: Vec<(usize, f64)> = order[..start]
        .iter()
        .chain(&order[end..])
        .map(|&place| (place, left[place].mean - of_alike))
        .collect();
    let mut without = left.to_vec();
    for &(place, change) in &odd {
        without[place].mean -= change;
    }
    let is_needed = scattered(&without) < ZerosPolicy::in_use().needed.powi(2) * scattered(left);
    if is_needed { odd } else { Vec::new() }
}

/// The residual about a common mean, which a law could have, as a fraction of the squared force.
fn scattered(left: &[LeftOfOne]) -> f64 {
    let weight = |one: &LeftOfOne| one.scale.powi(-2);
    let weights: f64 = left.iter().map(weight).sum();
    let common = left.iter().map(|one| weight(one) * one.mean).sum::<f64>() / weights;
    let each = left.iter();
    each.map(|one| weight(one) * (one.variance + (one.mean - common).powi(2)))
        .sum()
}

/// The message about a force whose zero lies `change` kN from that of the other recordings.
pub fn fault(change: f64, repaired: bool) -> ChannelFault {
    ChannelFault {
        channel: Channel::Force,
        kind: ChannelFaultKind::Zero { change, repaired },
    }
}

impl Trajectory {
    /// Moves back a force whose zero lies `change` kN from that of the other recordings.
    pub fn take_zero(&mut self, change: f64) {
        for force in &mut self.force {
            *force -= change;
        }
        self.faults.push(fault(change, true));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    fn left(means: &[f64], deviation: f64) -> Vec<LeftOfOne> {
        let each = means.iter();
        each.map(|&mean| LeftOfOne {
            mean,
            variance: deviation * deviation,
            scale: 1.0,
        })
        .collect()
    }

    #[test]
    fn the_few_that_lie_apart_are_odd() {
        let zeros = odd_zeros(&left(&[0.12, 0.13, 0.0, 0.125, 0.121], 0.02), 1e-4);
        let [(2, change)] = zeros[..] else {
            panic!("{zeros:?}");
        };
        assert!((change + 0.124).abs() < 1e-12);
        // Two that share another zero.
        let zeros = odd_zeros(&left(&[0.0, 0.3, 0.001, 0.301, 0.002], 0.02), 1e-4);
        let places: Vec<usize> = zeros.iter().map(|(place, _)| *place).collect();
        assert_eq!(places, [1, 3]);
    }

    #[test]
    fn none_is_odd_where_all_differ_or_little_is_gained() {
        let none = |means: &[f64], deviation| {
            assert_eq!(odd_zeros(&left(means, deviation), 1e-4), [], "{means:?}");
        };
        none(&[0.0, 0.1, 0.2, 0.3, 0.4], 0.01);
        none(&[0.0, 0.0, 0.0, 0.1], 0.3);
        none(&[0.0, 0.0, 0.1], 0.01);
        none(&[0.0, 0.0, 0.1, 0.1], 0.01);
        none(&[0.0; 4], 0.01);
        none(&[0.0, 0.0, 1e-5, 4e-4], 0.0);
        none(&[f64::NAN, 0.0, 0.0, 0.0, 1.0], 0.01);
    }

    /// Means of deviations that laws lack, as large as the scatter about them.
    #[test]
    fn means_drawn_at_random_are_seldom_odd() {
        let mut random = StdRng::seed_from_u64(1);
        let mut odd = 0;
        for _ in 0..1000 {
            let count = random.random_range(4..10);
            let means: Vec<f64> = (0..count).map(|_| random.random_range(-1.0..1.0)).collect();
            odd += usize::from(!odd_zeros(&left(&means, 1.0), 1e-3).is_empty());
        }
        assert!(odd < 10, "{odd} of 1000");
    }
}
