//! Decimation that keeps peaks: it keeps the samples of every bucket at which a channel is smallest or largest.
//!
//! The samples that remain are unchanged, with their own times and all their channels. So no peak is lost, nothing moves in time,
//! and force over displacement stays the measured loop. A bucket leaves at most two samples per channel, however long it is.

use crate::values::Sample;

/// Channels of a sample.
const CHANNELS: usize = 3;
/// Most samples that remain of a bucket: the smallest and the largest of each channel.
pub const MOST_KEPT: usize = 2 * CHANNELS;

fn channels(sample: &Sample) -> [f32; CHANNELS] {
    [sample.displacement, sample.force, sample.law_force]
}

/// Decimates samples as they arrive.
#[derive(Clone, Debug)]
pub struct Decimator {
    length: usize,
    bucket: Vec<Sample>,
}

impl Decimator {
    /// With buckets of `length` samples. A length of 0 counts as 1, which keeps everything.
    pub fn new(length: usize) -> Self {
        let length = length.max(1);
        Self {
            length,
            bucket: Vec::with_capacity(length),
        }
    }

    /// Samples in a bucket.
    pub fn length(&self) -> usize {
        self.length
    }

    /// Adds one sample. If the bucket is full, returns the samples that remain of it.
    pub fn push(&mut self, sample: &Sample) -> Kept {
        self.bucket.push(*sample);
        if self.bucket.len() < self.length {
            return Kept::default();
        }
        self.flush()
    }

    /// The samples that remain of an incomplete bucket.
    pub fn flush(&mut self) -> Kept {
        let kept = Kept::of(&self.bucket);
        self.bucket.clear();
        kept
    }
}

/// The samples that remain of one bucket, in the order of time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kept {
    samples: [Sample; MOST_KEPT],
    count: usize,
}

impl Kept {
    /// For `bucket`. NaN is neither the smallest nor the largest value; for a channel with no other value, the first sample is
    /// kept.
    pub fn of(bucket: &[Sample]) -> Self {
        let mut places = [0; MOST_KEPT];
        for channel in 0..CHANNELS {
            let value = |place: usize| channels(&bucket[place])[channel];
            let mut least = 0;
            let mut most = 0;
            for place in 0..bucket.len() {
                if value(place) < value(least) || value(least).is_nan() {
                    least = place;
                }
                if value(place) > value(most) || value(most).is_nan() {
                    most = place;
                }
            }
            let is_number = !bucket.is_empty() && !value(least).is_nan();
            places[2 * channel] = if is_number { least } else { 0 };
            places[2 * channel + 1] = if is_number { most } else { 0 };
        }
        places.sort_unstable();
        let mut kept = Self::default();
        let mut last = None;
        for place in places {
            if let Some(sample) = bucket.get(place)
                && last != Some(place)
            {
                kept.samples[kept.count] = *sample;
                kept.count += 1;
                last = Some(place);
            }
        }
        kept
    }

    /// The samples.
    pub fn samples(&self) -> &[Sample] {
        &self.samples[..self.count]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn sampled(values: &[[f32; CHANNELS]]) -> Vec<Sample> {
        let sample =
            |(tick, &[displacement, force, law_force]): (usize, &[f32; CHANNELS])| Sample {
                time: tick as f64 * 1e-4,
                displacement,
                force,
                law_force,
            };
        values.iter().enumerate().map(sample).collect()
    }

    fn decimated(samples: &[Sample], length: usize) -> Vec<Sample> {
        let mut decimator = Decimator::new(length);
        let mut kept: Vec<Sample> = Vec::new();
        for sample in samples {
            kept.extend(decimator.push(sample).samples());
        }
        kept.extend(decimator.flush().samples());
        kept
    }

    /// Smallest and largest value of a channel, ignoring NaN.
    fn extremes(samples: &[Sample], channel: usize) -> Option<(f32, f32)> {
        let values = samples.iter().map(|sample| channels(sample)[channel]);
        values
            .filter(|value| !value.is_nan())
            .fold(None, |so_far, value| {
                let (least, most) = so_far.unwrap_or((value, value));
                Some((least.min(value), most.max(value)))
            })
    }

    fn values() -> impl Strategy<Value = Vec<[f32; CHANNELS]>> {
        let value = prop_oneof![
            8 => -10.0..10.0_f32,
            1 => Just(f32::NAN),
            1 => prop_oneof![Just(f32::INFINITY), Just(f32::NEG_INFINITY), Just(0.0), Just(-0.0)],
        ];
        prop::collection::vec([value.clone(), value.clone(), value], 0..400)
    }

    proptest! {
        /// For every bucket and every channel, the smallest and the largest value remain.
        #[test]
        fn the_extremes_of_every_bucket_are_kept(values in values(), length in 1_usize..60) {
            let samples = sampled(&values);
            let kept = decimated(&samples, length);
            for bucket in samples.chunks(length) {
                let within = |sample: &&Sample| {
                    (bucket[0].time..=bucket[bucket.len() - 1].time).contains(&sample.time)
                };
                let kept: Vec<Sample> = kept.iter().filter(within).copied().collect();
                for channel in 0..CHANNELS {
                    prop_assert_eq!(extremes(bucket, channel), extremes(&kept, channel));
                }
            }
        }

        /// The remaining samples were measured: each has its own time, and its channels belong together. Time rises.
        #[test]
        fn what_is_kept_has_not_moved(values in values(), length in 1_usize..60) {
            let samples = sampled(&values);
            let kept = decimated(&samples, length);
            prop_assert!(kept.windows(2).all(|pair| pair[0].time < pair[1].time));
            for sample in &kept {
                let bits = |sample: &Sample| channels(sample).map(f32::to_bits);
                let place = samples.iter().position(|given| given.time == sample.time);
                prop_assert_eq!(place.map(|place| bits(&samples[place])), Some(bits(sample)));
            }
        }

        /// However long it is, a bucket leaves at least one sample and at most two per channel.
        #[test]
        fn the_rate_is_bounded(values in values(), length in 1_usize..60) {
            let samples = sampled(&values);
            let buckets = samples.len().div_ceil(length);
            let kept = decimated(&samples, length);
            prop_assert!(kept.len() <= MOST_KEPT * buckets);
            prop_assert!(kept.len() >= buckets);
        }
    }

    #[test]
    fn short_buckets_keep_everything() {
        let samples = sampled(&[[0.0, 1.0, 2.0], [1.0, 1.0, 2.0], [3.0, 0.0, 0.0]]);
        assert_eq!(decimated(&samples, 1), samples);
        assert_eq!(decimated(&samples, 2), samples);
    }
}
