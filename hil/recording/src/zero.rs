//! A step of the load cell's zero: someone tared an amplifier or touched a cable.
//!
//! The search looks at the residual of a law. Deviations that the law lacks follow the motion back and forth, and change about as
//! fast in many places. A zero changes in one place and stays.

use std::ops::Range;

use mesh_damper_tables::channel::Channel;

use crate::faults::kind::{ChannelFault, ChannelFaultKind};
use crate::noise::noise_deviation;
use crate::trajectory::Trajectory;

crate::numbers! {
    /// How a step of the force's zero is recognized in the residual of a law. Means of the residual before and after each sample are
    /// compared.
    ZeroPolicy {
        /// At most this many steps of the zero are removed from one recording.
        most: usize = 4, Convention("a load cell that steps more often is broken");
        /// The zero stays at a level for at least this fraction of the recording.
        lasts: f64 = 0.05, Convention("a twentieth: a shorter change is an event");
        /// The shortest means of the residual that are compared cover this many samples.
        narrowest: usize = 16, Convention("the standard deviation of such a mean is a quarter of that of the noise");
        /// A step of the zero counts only if the smallest step exceeds the largest change of the mean residual elsewhere by more than this
        /// factor.
        stands_out: f64 = 2.0, Tuned("white noise, walks and effects that a law lacks: see the tests in the same file");
        /// Noise may change the mean of a few samples (see `narrowest`) beside a step by this many standard deviations.
        noises: f64 = 3.0, Convention("three deviations of a mean");
        /// The levels before and after a step of the zero differ by the step, to within this fraction of it.
        stays: f64 = 0.5, Convention("a half: the rest is the law's own residual there");
    }
}

/// A step of the zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZeroStep {
    /// The first sample after the step.
    pub sample: usize,
    /// Change of the zero, in the unit of the residual.
    pub change: f64,
}

/// The largest step in the residuals of several laws for the same force, taken from the law whose residual shows steps most
/// clearly. `None` if there is no step. After the force is moved back, a law fits better, and the next step shows.
pub fn zero_step(left: &[&[f64]]) -> Option<ZeroStep> {
    let mut best = (ZeroPolicy::in_use().stands_out, Vec::new());
    for left in left {
        let sums = Sums::of(left);
        let noise = noise_deviation(left);
        let lasts = (ZeroPolicy::in_use().lasts * left.len() as f64) as usize;
        let mut width = ZeroPolicy::in_use().narrowest;
        while width <= lasts {
            let (stands_out, steps) = sums.outstanding(width);
            if stands_out > best.0 && sums.stay(&steps, lasts, noise) {
                best = (stands_out, steps);
            }
            width *= 2;
        }
    }
    let steps = best.1.into_iter();
    steps.max_by(|a, b| a.change.abs().total_cmp(&b.change.abs()))
}

/// Sums of the first samples, by their number.
struct Sums(Vec<f64>);

impl Sums {
    fn of(samples: &[f64]) -> Self {
        let mut sum = 0.0;
        let sums = samples.iter().map(|sample| {
            sum += sample;
            sum
        });
        Self(std::iter::once(0.0).chain(sums).collect())
    }

    fn count(&self) -> usize {
        self.0.len() - 1
    }

    fn mean(&self, samples: Range<usize>) -> f64 {
        (self.0[samples.end] - self.0[samples.start]) / samples.len() as f64
    }

    /// The mean of the `width` samples after `place` minus the mean of those before it.
    fn change(&self, place: usize, width: usize) -> f64 {
        self.mean(place..place + width) - self.mean(place - width..place)
    }

    /// The changes of means over `width` samples that stand out most from the rest, in order, and the ratio of the smallest of them
    /// to the largest elsewhere.
    fn outstanding(&self, width: usize) -> (f64, Vec<ZeroStep>) {
        let places = width..=self.count() - width;
        let mut largest: Vec<ZeroStep> = Vec::new();
        for _ in 0..=ZeroPolicy::in_use().most {
            let is_new = |place: &usize| {
                largest
                    .iter()
                    .all(|step| step.sample.abs_diff(*place) > width)
            };
            let changes = places.clone().filter(is_new).map(|sample| ZeroStep {
                sample,
                change: self.change(sample, width),
            });
            let Some(next) = changes.max_by(|a, b| a.change.abs().total_cmp(&b.change.abs()))
            else {
                break;
            };
            largest.push(next);
        }
        let gaps = largest
            .windows(2)
            .map(|pair| (pair[0].change / pair[1].change).abs());
        // Without a residual, 0/0 is no gap.
        let gaps = gaps.enumerate().filter(|(_, gap)| !gap.is_nan());
        let widest = gaps.max_by(|a, b| a.1.total_cmp(&b.1));
        let (place, stands_out) = widest.unwrap_or_default();
        largest.truncate(place + 1);
        for step in &mut largest {
            step.sample = self.edge(step.sample, width);
        }
        largest.sort_by_key(|step| step.sample);
        (stands_out, largest)
    }

    /// Where two levels describe the samples within `width` of `place` best, then those within half of `width`, and so on.
    fn edge(&self, place: usize, width: usize) -> usize {
        let (mut place, mut width) = (place, width);
        while width >= ZeroPolicy::in_use().narrowest {
            let (start, end) = (place - width, place + width);
            // The reduction of the sum of squares by two means.
            let taken = |edge: usize| {
                let (before, after) = ((edge - start) as f64, (end - edge) as f64);
                let change = self.mean(edge..end) - self.mean(start..edge);
                change * change * before * after
            };
            let edges = start + width / 2..end - width / 2;
            let best = edges.max_by(|&a, &b| taken(a).total_cmp(&taken(b)));
            width /= 2;
            place = best.unwrap_or(place).clamp(width, self.count() - width);
        }
        place
    }

    /// Whether each level lasts, differs from the next one by the step between them, and begins at once. Deviations that the law
    /// lacks come gradually with the motion. `noise` is the deviation of white noise.
    fn stay(&self, steps: &[ZeroStep], lasts: usize, noise: f64) -> bool {
        let edges: Vec<usize> = std::iter::once(0)
            .chain(steps.iter().map(|step| step.sample))
            .chain([self.count()])
            .collect();
        let levels: Vec<Range<usize>> = edges.windows(2).map(|pair| pair[0]..pair[1]).collect();
        let of_levels = levels
            .windows(2)
            .map(|pair| self.mean(pair[1].clone()) - self.mean(pair[0].clone()));
        let narrow = ZeroPolicy::in_use().narrowest;
        // Deviation of the change of two means, minus half the change of two others on either side.
        let of_noise = ZeroPolicy::in_use().noises * noise * (5.0 / narrow as f64).sqrt();
        let at_once = |place: usize| {
            let beside = self.change(place - narrow, narrow) + self.change(place + narrow, narrow);
            self.change(place, narrow) - 0.5 * beside
        };
        let agrees = |change: f64, step: &ZeroStep, beside: f64| {
            (change - step.change).abs() < ZeroPolicy::in_use().stays * step.change.abs() + beside
        };
        levels
            .iter()
            .all(|level| level.len() >= lasts.max(2 * narrow))
            && of_levels.zip(steps).all(|(apart, step)| {
                agrees(apart, step, 0.0) && agrees(at_once(step.sample), step, of_noise)
            })
    }
}

impl Trajectory {
    /// Moves the force back from `sample` on, where its zero changed by `change` kN. An earlier step at the same sample is added
    /// to.
    pub fn take_zero_step(&mut self, sample: usize, change: f64) {
        for force in &mut self.force[sample..] {
            *force -= change;
        }
        let now = sample as f64 * self.tick;
        let about = ZeroPolicy::in_use().narrowest as f64 * self.tick;
        for fault in &mut self.faults {
            if let ChannelFaultKind::ZeroStep {
                time,
                change: before,
            } = &mut fault.kind
                && (*time - now).abs() < about
            {
                *before += change;
                return;
            }
        }
        self.faults.push(ChannelFault {
            channel: Channel::Force,
            kind: ChannelFaultKind::ZeroStep { time: now, change },
        });
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};

    const COUNT: usize = 20_000;

    /// Uniform noise with a deviation of 0.58.
    fn white(seed: u64) -> Vec<f64> {
        let mut random = StdRng::seed_from_u64(seed);
        (0..COUNT).map(|_| random.random_range(-1.0..1.0)).collect()
    }

    fn with(steps: &[(usize, f64)], mut samples: Vec<f64>) -> Vec<f64> {
        for &(start, change) in steps {
            samples[start..]
                .iter_mut()
                .for_each(|sample| *sample += change);
        }
        samples
    }

    /// In noise, and together with a force that a law lacks, which is larger than the step.
    #[test]
    fn the_largest_step_is_found_where_it_is() {
        let tone: Vec<f64> = (0..COUNT)
            .map(|index| 1.5 * (TAU * index as f64 / 130.0).sin())
            .collect();
        for steps in [
            &[(7001, 1.0)][..],
            &[(4000, -1.5), (16_000, 1.0)],
            &[(9000, 1.2), (2000, 1.0), (15_000, -1.0)],
        ] {
            for beside in [0.0, 1.0] {
                let noise = white(3);
                let samples = noise.iter().zip(&tone).map(|(a, b)| a + beside * b);
                let found = zero_step(&[&with(steps, samples.collect())]).unwrap();
                let (sample, change) = steps[0];
                // With a force that the law lacks: to half of its period.
                let near = if beside > 0.0 { 65 } else { 16 };
                assert!(found.sample.abs_diff(sample) < near, "{found:?}");
                assert!((found.change / change - 1.0).abs() < 0.3, "{found:?}");
            }
        }
    }

    /// Noise, a walk, a ramp, an event that ends, a spring that breaks.
    #[test]
    fn what_does_not_step_has_none() {
        let none = |samples: &[f64], what: &str| assert_eq!(zero_step(&[samples]), None, "{what}");
        for seed in 0..40 {
            let noise = white(seed);
            none(&noise, "noise");
            let mut sum = 0.0;
            let walk: Vec<f64> = noise
                .iter()
                .map(|x| {
                    sum += x;
                    sum
                })
                .collect();
            none(&walk, "walk");
            let ramp: Vec<f64> = noise
                .iter()
                .enumerate()
                .map(|(index, x)| x + 1e-3 * index as f64)
                .collect();
            none(&ramp, "ramp");
            none(&with(&[(8000, 4.0), (8200, -4.0)], noise.clone()), "event");
            let broken: Vec<f64> = noise
                .iter()
                .enumerate()
                .map(|(index, x)| {
                    x + if index > 9000 {
                        20.0 * (TAU * index as f64 / 900.0).cos()
                    } else {
                        0.0
                    }
                })
                .collect();
            none(&broken, "broken");
        }
    }
}
