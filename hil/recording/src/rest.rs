//! Rests: where a recorded displacement stands still.
//!
//! The noise at a standstill gives a velocity with a sign, which friction takes for a direction: at a thousandth of the largest
//! speed |v|^0.3 is an eighth of its value there. So the velocity is exactly 0 where the displacement is known to stand still.

use std::ops::Range;

use super::motion::leaves_only_noise;
use super::polynomial::left_by_polynomial;

crate::numbers! {
    /// Where the displacement stands still.
    RestPolicy {
        /// A rest of the displacement has at least this many samples.
        shortest: usize = 32, Derived("their mean is known to a sixth of the noise, so that a motion as small as the noise shows");
        /// A rest ends where the mean of the last `shortest` samples differs from that of all before by more than this many standard
        /// deviations. It is a turn of the motion if the squared residuals of one cubic exceed those of noise by at most this many standard
        /// deviations.
        same: f64 = 5.0, Derived("noise alone exceeds it once in two million times, and it is tested at every sample");
    }
}

/// Runs of samples in which the displacement stands still except for noise of deviation `noise`, in order.
///
/// Within the noise a turn stands still for a while too. There one cubic describes the run and as much again about it.
pub(super) fn find_rests(samples: &[f64], noise: f64) -> Vec<Range<usize>> {
    let shortest = RestPolicy::in_use().shortest;
    // Rounding errors are not white: at a turn the error may be half a step for a long time.
    let noise = noise + 0.5 * step_of(samples);
    let mut rests = Vec::new();
    let mut from = 0;
    while from + shortest <= samples.len() {
        let seed = from..from + shortest;
        if !stands_still(&samples[seed.clone()], noise) {
            from += shortest / 4;
            continue;
        }
        let after = extended(samples[from..].iter(), noise);
        let before = extended(samples[..seed.end].iter().rev(), noise);
        let first = rests.last().map_or(0, |rest: &Range<usize>| rest.end);
        let rest = (seed.end - before).max(first)..from + after;
        let is_long = rest.len() >= shortest;
        if is_long && !is_turn(samples, &rest, noise) {
            rests.push(rest);
        }
        from += after.max(shortest / 4);
    }
    rests
}

/// The smallest difference of two neighbours that differ: the step of a converter, and almost 0 without one.
fn step_of(samples: &[f64]) -> f64 {
    let differences = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let step = differences
        .filter(|difference| *difference > 0.0)
        .fold(f64::INFINITY, f64::min);
    if step.is_finite() { step } else { 0.0 }
}

/// Whether the residual of a constant is no more than noise.
fn stands_still(samples: &[f64], noise: f64) -> bool {
    let error = left_by_polynomial(samples, 0);
    leaves_only_noise(error, samples.len() as f64 - 1.0, noise)
}

/// Number of samples, from the first on, that stand still.
fn extended<'s>(samples: impl Iterator<Item = &'s f64>, noise: f64) -> usize {
    let RestPolicy { shortest, same } = *RestPolicy::in_use();
    let mut recent = std::collections::VecDeque::with_capacity(shortest);
    // Sums for the samples before the recent ones, and for these.
    let (mut sum, mut count, mut recent_sum) = (0.0, 0.0, 0.0);
    let mut taken = 0;
    for sample in samples {
        if recent.len() == shortest {
            let oldest = recent.pop_front().unwrap_or_default();
            recent_sum -= oldest;
            sum += oldest;
            count += 1.0;
        }
        recent.push_back(*sample);
        recent_sum += sample;
        taken += 1;
        if count > 0.0 {
            let recent_count = shortest as f64;
            let change = recent_sum / recent_count - sum / count;
            let deviation = noise * (1.0 / recent_count + 1.0 / count).sqrt();
            if change.abs() > same * deviation {
                // The motion begins among the recent ones.
                return departure(recent.make_contiguous(), sum / count) + taken - shortest;
            }
        }
    }
    taken
}

/// Number of `samples` that stand still at `level` before they move off on a quadratic.
fn departure(samples: &[f64], level: f64) -> usize {
    let left = |at: usize| -> f64 {
        let before: f64 = samples[..at].iter().map(|y| (y - level).powi(2)).sum();
        let (mut gram, mut right, mut all) = ([0.0; 3], [0.0; 2], 0.0);
        for (index, y) in samples[at..].iter().enumerate() {
            let (t, y) = (index as f64, y - level);
            gram[0] += t * t;
            gram[1] += t.powi(3);
            gram[2] += t.powi(4);
            right[0] += t * y;
            right[1] += t * t * y;
            all += y * y;
        }
        let determinant = gram[0] * gram[2] - gram[1] * gram[1];
        if determinant <= 0.0 {
            return before + all;
        }
        let slope = (right[0] * gram[2] - right[1] * gram[1]) / determinant;
        let bend = (right[1] * gram[0] - right[0] * gram[1]) / determinant;
        before + all - slope * right[0] - bend * right[1]
    };
    (0..samples.len())
        .min_by(|&a, &b| left(a).total_cmp(&left(b)))
        .unwrap_or(0)
}

/// Whether one cubic describes a rest and half as much to either side.
fn is_turn(samples: &[f64], rest: &Range<usize>, noise: f64) -> bool {
    let more = rest.len() / 2;
    let around = rest.start.saturating_sub(more)..(rest.end + more).min(samples.len());
    let error = left_by_polynomial(&samples[around.clone()], 3);
    let freedom = around.len() as f64 - 4.0;
    let noise_squares =
        noise * noise * (freedom + RestPolicy::in_use().same * (2.0 * freedom).sqrt());
    around != *rest && error <= noise_squares
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand::rngs::StdRng;
    use rand_distr::{Distribution, Normal};

    use super::*;

    const NOISE: f64 = 1e-4;

    fn noisy(count: usize, seed: u64, displacement: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(seed);
        let noise = Normal::new(0.0, NOISE).unwrap();
        let samples = (0..count).map(|index| displacement(index as f64));
        samples.map(|y| y + noise.sample(&mut random)).collect()
    }

    /// Noise at this turn is 4.4 of its deviations above the mean of noise.
    #[test]
    fn an_unlikely_turn_is_no_standstill() {
        let sine = noisy(4000, 6040597495397802227, |index| {
            0.1 * (TAU * index / 5858.145514347705 + 0.2653984200002955).sin()
        });
        assert_eq!(find_rests(&sine, NOISE), vec![]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Between two ramps, with a jump of the velocity or without, to a few samples: as many as move by less than the noise.
        #[test]
        fn a_standstill_is_found(length in 80..2000_usize, ramp in 20..400_usize, smooth: bool, seed: u64) {
            let (start, end) = (ramp as f64, (ramp + length) as f64);
            let way = |part: f64| if smooth { 0.5 - 0.5 * (0.5 * TAU * part).cos() } else { part };
            let at = |index: f64| {
                if index < start {
                    0.1 * way(index / start)
                } else if index <= end {
                    0.1
                } else {
                    0.1 - 0.1 * way((index - end) / start)
                }
            };
            let found = find_rests(&noisy(length + 2 * ramp, seed, at), NOISE);
            prop_assert_eq!(found.len(), 1, "{:?}", found);
            // A smooth ramp moves by 3 deviations of the noise within this many samples: a sample that moves by more is not counted
            // as still.
            let near = 4.0 + (12.0 * NOISE / 0.1).sqrt() * start * 2.0 / TAU;
            let rest = &found[0];
            let beyond = [start - rest.start as f64, rest.end as f64 - end];
            prop_assert!(beyond.iter().all(|beyond| *beyond <= near), "{:?} of {} {}", rest, start, end);
            let missed = length - rest.len().min(length);
            prop_assert!(missed <= 2 * RestPolicy::in_use().shortest, "{:?} of {} {}", rest, start, end);
        }

        /// A sine does not stand still at its turns, however slow, nor does a motion at constant speed.
        #[test]
        fn a_turn_is_no_standstill(period in 40.0..20_000.0_f64, phase in 0.0..TAU, seed: u64) {
            let sine = noisy(4000, seed, |index| 0.1 * (TAU * index / period + phase).sin());
            prop_assert_eq!(find_rests(&sine, NOISE), vec![]);
        }

        /// Nor does a slow sine in the steps of a converter, each of which lasts for many samples.
        #[test]
        fn a_step_of_a_converter_is_no_standstill(period in 2000.0..20_000.0_f64, step in 1e-4..1e-3_f64, noise in 0.0..3.0_f64, seed: u64) {
            let sine = noisy(6000, seed, |index| 0.1 * (TAU * index / period).sin());
            let clean = |index: usize| 0.1 * (TAU * index as f64 / period).sin();
            let sine = sine.iter().enumerate().map(|(index, y)| clean(index) + noise * (y - clean(index)));
            let stepped: Vec<f64> = sine.map(|y| (y / step).round() * step).collect();
            let seen = crate::noise::noise_deviation(&stepped);
            prop_assert_eq!(find_rests(&stepped, seen), vec![]);
        }

        #[test]
        fn a_constant_speed_is_no_standstill(speed in 1e-6..1e-2_f64, seed: u64) {
            prop_assert_eq!(find_rests(&noisy(4000, seed, |index| speed * index), NOISE), vec![]);
        }
    }
}
