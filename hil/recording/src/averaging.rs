//! Channels that were smoothed by a moving average before they were written.
//!
//! A mean over w samples has no noise at the frequencies k/w: its gain there is sin(πfw)/(πfw) = 0. Notches at all multiples of one
//! frequency, in displacement and force alike, are taken for such a mean. They must not be gaps between the harmonics of a motion
//! with corners, which are lines that a median over frequency ignores. An averaged force no longer jumps at a reversal. A law can
//! be compared with it only if the law's force is averaged in the same way.
//!
//! A strong harmonic of the motion next to a notch hides it, and with it the average.

use std::ops::Range;

use super::cycles::median;
use super::noise::SIXTH_DIFFERENCE;
use super::spectrum::powers;
use crate::extremes::least_and_largest;

crate::numbers! {
    /// How a moving average that smoothed the channels is recognized: by notches at equal distances in their spectra.
    AveragingPolicy {
        /// A moving average shows at least this many notches in the spectrum.
        fewest_notches: usize = 2, Derived("a filter against mains hum has one notch");
        /// Half the width of a notch in the spectrum, as a fraction of the distance between two notches.
        notch: f64 = 0.06, Derived("there the gain of a moving average is below 1/15");
        /// The power beside a notch is taken between these two distances from its centre, as fractions of the distance between two notches.
        between: [f64; 2] = [0.25, 0.75], Derived("there the gain of a moving average is above half of its maximum between two notches");
        /// A notch of the spectrum extends over at least this many bins to either side of its centre.
        fewest_bins: f64 = 2.4, Tuned("the recordings of others");
        /// The mean over all notches of ln(power in the notch / power beside it) must be below this. Averaged recordings have −1.9 to −5.2;
        /// in others the deepest mean is above −0.9.
        deep: f64 = -1.4, Tuned("the recordings of others");
        /// In each single notch, ln(power in the notch / power beside it) must be below this.
        seen: f64 = -0.4, Tuned("the recordings of others");
        /// Distances between notches up to this many times the smallest distance found belong to the same average.
        near: f64 = 1.15, Tuned("the recordings of others");
        /// How fast a channel changes is judged over this fraction of the average.
        step: f64 = 0.125, Derived("short enough that a jump is whole within it, long enough that noise and counts of a converter are small");
        /// The range that was averaged is at most this many times the range of the average.
        wider: f64 = 2.0, Derived("an average over less than a fifth of the period takes 7 % of a sine; the rest is for peaks between samples");
        /// The distances between notches that are tried grow in steps of this fraction.
        finer: f64 = 0.002, Derived("moves the fifth notch by a twelfth of a notch width");
        /// The distances between notches that are tried grow in steps of at least this many bins of the spectrum.
        finest: f64 = 0.5, Derived("half of the resolution of a spectrum");
    }
}

/// At most this many notches of the spectrum are examined, from the lowest frequency upwards. Convention: higher notches lie in the
/// noise.
const MOST_NOTCHES: usize = 5;

/// A moving average, centred on each sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingAverage {
    /// Number of samples, 4 and more if it was found; a fraction of a sample counts in part.
    pub window: f64,
}

impl MovingAverage {
    /// The average that both channels went through, if they did.
    pub fn find(displacement: &[f64], force: &[f64]) -> Option<Self> {
        let channels = [displacement, force];
        let spectra = channels.map(Spectrum::of);
        let [Some(displacement), Some(force)] = spectra else {
            return None;
        };
        let bins = displacement.bins();
        let mut found: Vec<(f64, f64)> = Vec::new();
        let mut distance = AveragingPolicy::in_use().fewest_bins / AveragingPolicy::in_use().notch;
        while distance * AveragingPolicy::in_use().fewest_notches as f64 <= bins {
            let depths = [&displacement, &force].map(|spectrum| spectrum.depth(distance));
            if let [Some(one), Some(other)] = depths
                && displacement.has_notches(distance)
                && force.has_notches(distance)
            {
                found.push((distance, one.max(other)));
            }
            distance +=
                (AveragingPolicy::in_use().finer * distance).max(AveragingPolicy::in_use().finest);
        }
        // Every second notch of an average is a notch too, so the closest spacing counts.
        let (first, _) = *found.first()?;
        let same = found
            .iter()
            .take_while(|(distance, _)| *distance < AveragingPolicy::in_use().near * first);
        let (distance, _) = same.min_by(|a, b| a.1.total_cmp(&b.1))?;
        let found = Self {
            window: 2.0 * bins / distance,
        };
        let can_be = |channel: &[f64]| found.lets_pass(channel);
        (can_be(channels[0]) && can_be(channels[1])).then_some(found)
    }

    /// Whether a channel changes as slowly as an average does: over m samples by at most m/w of the range that was averaged. A motion
    /// with corners may have the notches of an average, but the force that jumps there has not gone through one.
    fn lets_pass(&self, channel: &[f64]) -> bool {
        let steps = ((self.window * AveragingPolicy::in_use().step) as usize).max(1);
        let (low, high) = least_and_largest(channel);
        let most = AveragingPolicy::in_use().wider * (high - low) * steps as f64 / self.window;
        let pairs = channel.iter().zip(channel.iter().skip(steps));
        pairs.fold(0.0_f64, |most, (a, b)| most.max((b - a).abs())) <= most
    }

    /// Gain for a sine of `frequency` cycles per sample, below the first notch: sin(πfw)/(w·sin πf).
    pub fn gain(&self, frequency: f64) -> f64 {
        let half_turn = std::f64::consts::PI * frequency;
        (half_turn * self.window).sin() / (self.window * half_turn.sin())
    }

    /// The deviation of averaged white noise, of which sixth differences show only `seen`
    /// ([`noise_beside_tones`](super::noise::noise_beside_tones)), because neighbours share most of their samples.
    pub fn noise(&self, seen: f64) -> f64 {
        let half = 0.5 * (self.window - 1.0);
        let end = [half.fract()];
        let taps = [&end[..], &vec![1.0; 2 * half as usize + 1], &end].concat();
        let mut differences = vec![0.0; taps.len() + SIXTH_DIFFERENCE.len() - 1];
        for (index, tap) in taps.iter().enumerate() {
            for (own, weight) in differences[index..].iter_mut().zip(SIXTH_DIFFERENCE) {
                *own += weight * tap;
            }
        }
        let squares = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        let shown = squares(&differences) / squares(&SIXTH_DIFFERENCE);
        seen * (squares(&taps) / shown).sqrt()
    }

    /// The average of `values` about each of them; at an end, of the values available.
    pub fn of(&self, values: &[f64]) -> Vec<f64> {
        let half = 0.5 * (self.window - 1.0);
        let (whole, part) = (half as usize, half.fract());
        let mut sums = Vec::with_capacity(values.len() + 1);
        let mut sum = 0.0;
        sums.push(sum);
        for value in values {
            sum += value;
            sums.push(sum);
        }
        let count = values.len();
        (0..count)
            .map(|index| {
                let (first, last) = (index.saturating_sub(whole), (index + whole).min(count - 1));
                let mut total = sums[last + 1] - sums[first];
                let mut weight = (last + 1 - first) as f64;
                let ends = [index.checked_sub(whole + 1), Some(index + whole + 1)];
                for value in ends.into_iter().flatten().filter_map(|end| values.get(end)) {
                    total += part * value;
                    weight += part;
                }
                total / weight
            })
            .collect()
    }
}

/// The logarithm of a channel's power per bin, and its sums.
struct Spectrum {
    logarithms: Vec<f64>,
    sums: Vec<f64>,
}

impl Spectrum {
    /// Spectrum of the channel's differences, which vary less over frequency than the channel; `None` if the channel is too short.
    fn of(channel: &[f64]) -> Option<Self> {
        let differences = channel.windows(2).map(|pair| pair[1] - pair[0]);
        let power = powers(differences.collect());
        if power.is_empty() {
            return None;
        }
        let logarithms: Vec<f64> = power
            .into_iter()
            .map(|power| power.max(f64::MIN_POSITIVE).ln())
            .collect();
        let mut sums = vec![0.0];
        sums.extend(logarithms.iter().scan(0.0, |sum, logarithm| {
            *sum += logarithm;
            Some(*sum)
        }));
        Some(Self { logarithms, sums })
    }

    /// Up to half the sampling rate.
    fn bins(&self) -> f64 {
        (self.sums.len() - 2) as f64
    }

    /// The bins between two positions, `None` beyond the last.
    fn range(&self, from: f64, to: f64) -> Option<Range<usize>> {
        let (from, to) = (from.ceil() as usize, to.floor().min(self.bins()) as usize);
        (from < to).then_some(from..to + 1)
    }

    /// The mean depth of the notches that are `distance` bins apart, `None` if one is not deep.
    fn depth(&self, distance: f64) -> Option<f64> {
        self.depth_by(distance, |bins| {
            (self.sums[bins.end] - self.sums[bins.start]) / bins.len() as f64
        })
    }

    /// Whether there are notches this many bins apart when lines are ignored.
    fn has_notches(&self, distance: f64) -> bool {
        // A range has two bins at least.
        let level =
            |bins: Range<usize>| median(self.logarithms[bins].iter().copied()).unwrap_or_default();
        self.depth_by(distance, level).is_some()
    }

    /// The same with `level` of the logarithms in a range of bins.
    fn depth_by(&self, distance: f64, level: impl Fn(Range<usize>) -> f64) -> Option<f64> {
        let notches =
            ((self.bins() + AveragingPolicy::in_use().notch * distance) / distance) as usize;
        let depths: Vec<f64> = (1..=notches.min(MOST_NOTCHES))
            .map(|notch| {
                let at = |place: f64| (notch as f64 + place) * distance;
                let within = |from: f64, to: f64| Some(level(self.range(at(from), at(to))?));
                let [near, far] = AveragingPolicy::in_use().between;
                let inside = within(
                    -AveragingPolicy::in_use().notch,
                    AveragingPolicy::in_use().notch,
                )?;
                let below = within(-far, -near)?;
                let above = (at(far) <= self.bins())
                    .then(|| within(near, far))
                    .flatten();
                Some(inside - above.map_or(below, |above| below.min(above)))
            })
            .collect::<Option<_>>()?;
        let mean = depths.iter().sum::<f64>() / depths.len() as f64;
        let is_average = depths.len() >= AveragingPolicy::in_use().fewest_notches
            && mean < AveragingPolicy::in_use().deep
            && depths
                .iter()
                .all(|depth| *depth < AveragingPolicy::in_use().seen);
        is_average.then_some(mean)
    }
}

#[cfg(test)]
mod tests {
    use super::super::noise::noise_deviation;
    use super::MovingAverage;
    use proptest::prelude::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    /// A tone with harmonics in noise.
    fn channel(count: usize, period: f64, noise: f64, seed: u64) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(seed);
        (0..count)
            .map(|index| {
                let turn = std::f64::consts::TAU * index as f64 / period;
                let harmonics = turn.sin() + 0.3 * (3.0 * turn).cos() + 0.1 * (5.0 * turn).sin();
                harmonics + noise * (random.random::<f64>() - 0.5)
            })
            .collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// The window is found to 2 %, and nothing is found without one. No harmonic is as fast as the first notch.
        #[test]
        fn a_window_is_found(window in 4.0..40.0_f64, period in 500.0..900.0_f64, noise in 1e-3..0.1_f64, seed: u64) {
            let raw = [0, 1].map(|which| channel(4000, period, noise, seed ^ which));
            prop_assert_eq!(MovingAverage::find(&raw[0], &raw[1]), None);
            let average = MovingAverage { window: window.round() };
            let [displacement, force] = raw.map(|channel| average.of(&channel));
            let found = MovingAverage::find(&displacement, &force);
            let found = found.expect("an average").window;
            prop_assert!((found / window.round() - 1.0).abs() < 0.02, "{} {}", found, window);
            // The mean of w uniform values of this width has a deviation of noise / sqrt(12 w). The sample's own deviation is no
            // oracle: 4000 samples contain only 100 means without common samples.
            let deviation = noise / (12.0 * average.window).sqrt();
            let averaged = average.of(&channel(4000, f64::INFINITY, noise, seed));
            let seen = average.noise(noise_deviation(&averaged));
            prop_assert!((seen / deviation - 1.0).abs() < 0.25, "{} {}", seen, deviation);
        }

        /// A mean of a constant is that constant, and of a line that line, except at the ends.
        #[test]
        fn an_average_keeps_lines(window in 2.0..30.0_f64, slope in -1.0..1.0_f64) {
            let line: Vec<f64> = (0..100).map(|index| 3.0 + slope * f64::from(index)).collect();
            let averaged = MovingAverage { window }.of(&line);
            for index in 16..84 {
                prop_assert!((averaged[index] - line[index]).abs() < 1e-9);
            }
            let constant = MovingAverage { window }.of(&[2.5; 40]);
            prop_assert!(constant.iter().all(|value| (value - 2.5).abs() < 1e-12));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Nor was the friction of a slow triangle, which turns within a few samples.
        #[test]
        fn friction_that_turns_at_once_was_not_averaged(period in 400..3000_i32, limit in 0.002..0.05_f64, cycles in 2..12_i32, seed: u64) {
            let mut random = StdRng::seed_from_u64(seed);
            let mut stretched = 0.0;
            let mut before = 0.0;
            let (displacement, force): (Vec<f64>, Vec<f64>) = (0..cycles * period)
                .map(|index| {
                    let turn = std::f64::consts::TAU * f64::from(index) / f64::from(period);
                    let y = turn.sin().asin();
                    stretched = f64::clamp(stretched + y - before, -limit, limit);
                    before = y;
                    let noise = 0.01 * (random.random::<f64>() - 0.5);
                    ((y * 1e4).round() * 1e-4, stretched / limit + 0.1 * y + noise)
                })
                .unzip();
            prop_assert_eq!(MovingAverage::find(&displacement, &force), None);
        }
    }

    /// A motion with corners or with odd harmonics was not averaged, although there is nothing between its harmonics.
    #[test]
    fn gaps_between_harmonics_are_no_notches() {
        let mut random = StdRng::seed_from_u64(5);
        for (period, third) in [
            (100.0, 0.0),
            (250.0, 0.0),
            (100.0, 0.01),
            (250.0, 0.01),
            (400.0, 0.01),
        ] {
            let mut channel = |phase: f64| -> Vec<f64> {
                let noisy = (0..8000).map(|index| {
                    let turn = std::f64::consts::TAU * (f64::from(index) / period + phase);
                    let shape = match third > 0.0 {
                        true => (0..20)
                            .map(|k| {
                                let odd = f64::from(2 * k + 1);
                                let part = if k == 0 { 1.0 } else { 3.0 * third / odd };
                                part * (odd * turn).sin()
                            })
                            .sum(),
                        false => turn.sin().asin(),
                    };
                    shape + 1e-3 * (random.random::<f64>() - 0.5)
                });
                noisy.collect()
            };
            let (displacement, force) = (channel(0.0), channel(0.1));
            assert_eq!(
                MovingAverage::find(&displacement, &force),
                None,
                "{period} {third}"
            );
        }
    }

    /// A notch at one frequency, as against the mains, is no average; nor is one in a single channel.
    #[test]
    fn one_notch_or_one_channel_is_no_average() {
        let [one, other] = [3, 4].map(|seed| channel(6000, 250.0, 0.02, seed));
        let average = MovingAverage { window: 20.0 };
        assert_eq!(MovingAverage::find(&average.of(&one), &other), None);
        assert_eq!(MovingAverage::find(&one, &average.of(&other)), None);
        // y(i) − 2·cos ω·y(i−1) + y(i−2) has no gain at ω.
        let notch = |channel: &[f64]| -> Vec<f64> {
            let beside = 2.0 * (std::f64::consts::TAU / 20.0).cos();
            channel
                .windows(3)
                .map(|y| y[2] - beside * y[1] + y[0])
                .collect()
        };
        assert_eq!(MovingAverage::find(&notch(&one), &notch(&other)), None);
    }
}
