//! The motion behind a displacement with few samples per cycle: the best linear estimate from the samples around each.
//!
//! A cubic can follow a sine of ten samples and more per cycle. A record with fewer can be differentiated if the spectrum of its
//! motion is known, and it follows from the record: white noise is flat, so power above its floor is motion. With the motion's
//! power S(ω) its covariance is r(τ) = ∫ S cos ωτ, that of its velocity with it r′(τ), that of its acceleration r″(τ). The estimate
//! with the least variance from samples at tᵢ is Σ wᵢ·yᵢ with (R + σ²·1)·w = r(t − tᵢ), or r′ and r″ in its place, R = r(tᵢ − tⱼ)
//! (Wiener 1949).

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::motion::{MotionEstimate, leaves_only_noise};
use super::motion_error::{MotionError, as_noisy};
use super::spectrum::{density, floor};

crate::numbers! {
    /// How a motion with few samples per cycle is estimated: from the spectrum of the displacement.
    SmootherPolicy {
        /// The power of the motion is estimated in at most this many bins of frequency.
        bins: usize = 256, Derived("the covariance from them repeats after 512 samples, four times as far as it is used");
        /// The power in each bin is averaged over at least this many stretches of the recording.
        stretches: usize = 40,
            Derived("they overlap by halves, and the mean of twenty powers exceeds twice its expectation once in ten thousand times");
        /// A bin contains motion if its power exceeds this many times that of the noise.
        above: f64 = 2.0, Derived("chance raises the mean power of no bin in a thousand above that");
        /// The fastest motion has the frequency below which this fraction of the velocity's power lies.
        most_of_velocity: f64 = 0.99, Convention("a hundredth of the power is a tenth of the velocity");
        /// The estimate at a sample uses the samples within this many periods of the fastest motion to each side.
        periods: f64 = 4.0, Tuned("the estimated motions");
        /// The estimate at a sample uses at least and at most this many samples to each side.
        reach: [usize; 2] = [16, 64], Tuned("the estimated motions");
        /// With more samples than this per period of the fastest motion, the spectrum is not needed.
        fine: f64 = 64.0, Derived("the shortest window of a cubic, nine samples, then reduces the slope by 1e-4 (Savitzky–Golay)");
        /// Power with fewer samples per period than this is not motion.
        unmeasured: f64 = 3.5,
            Convention("no rig is sampled so coarsely; faster power above the noise floor is noise that a filter shaped");
        /// The spectrum is not used if more than this fraction of the velocity's power is not motion (see `unmeasured`).
        part_unmeasured: f64 = 1e-4, Convention("a hundredth of the velocity");
        /// The noise of the displacement is assumed to be at least this fraction of the displacement's standard deviation.
        quiet: f64 = 3e-6, Derived("with f64 numbers a covariance matrix can be factored down to some 1e-12 of its diagonal");
        /// In a recording without noise, a residual up to this fraction of the displacement's standard deviation counts as noise.
        exact: f64 = 1e-4, Derived("with some ten samples per cycle the corner of a triangle leaves a hundredth");
        /// The estimate is used at a sample only if the residual over this many samples to each side is only noise.
        about: usize = 16, Convention("the same number as `motion_error.about`");
        /// A corner of the motion shows in the residual over this many samples to each side.
        corner: usize = 4, Derived("the shortest window of a cubic");
        /// Corners count only if the squared residuals near all of them together exceed the average by more than this many standard
        /// deviations of those of noise.
        some_noise: f64 = 2.0, Convention("noise does so once in forty times, and then little is lost");
        /// The estimate from the spectrum is used only if its squared velocity error is below this fraction of that of the local estimate.
        better: f64 = 0.8, Tuned("the estimated motions");
    }
}

/// Weights for displacement, slope and curvature from the samples around one.
pub(super) struct Smoother {
    /// Samples to each side.
    reach: usize,
    /// r, r′ and r″ from τ = 0 on, per sample.
    covariance: [Vec<f64>; 3],
    /// Of R + σ²·1.
    factor: Cholesky<f64, Dyn>,
    /// Variances of displacement, slope and curvature.
    variances: [f64; 3],
    /// Mean of the displacement, mm.
    mean: f64,
    /// Deviation of the noise, mm.
    noise: f64,
    /// Deviation that the weights assume, mm: never 0.
    taken: f64,
}

/// A displacement smoothed, with its derivatives per sample.
pub(super) struct Smoothed {
    displacement: Vec<f64>,
    slope: Vec<f64>,
    curvature: Vec<f64>,
    /// Standard deviation of the slope.
    slope_deviation: Vec<f64>,
}

impl Smoother {
    /// For the motion in `displacement` in mm; `None` if there are enough samples for a cubic, or too few for a spectrum.
    pub(super) fn of(displacement: &[f64]) -> Option<Self> {
        let SmootherPolicy {
            bins,
            unmeasured,
            part_unmeasured,
            stretches,
            above,
            most_of_velocity,
            periods,
            reach: [least, most],
            fine,
            quiet,
            ..
        } = *SmootherPolicy::in_use();
        let count = displacement.len();
        let bins = bins.min(count / stretches);
        let most = most.min(bins / 4);
        if most < least {
            return None;
        }
        let mean = displacement.iter().sum::<f64>() / count as f64;
        let centred: Vec<f64> = displacement.iter().map(|y| y - mean).collect();
        let density = density(&centred, 2 * bins);
        let floor = floor(&density);
        let motion: Vec<f64> = (density[..bins].iter())
            .map(|&seen| {
                if seen > above * floor {
                    seen - floor
                } else {
                    0.0
                }
            })
            .collect();
        let turn = |bin: usize| bin as f64 / bins as f64 * PI;
        let of_velocity = |bin: usize| motion[bin] * turn(bin).powi(2);
        let whole: f64 = (0..bins).map(of_velocity).sum();
        let quickest = |bin: &usize| turn(*bin) * unmeasured > 2.0 * PI;
        let unmeasured: f64 = (0..bins).filter(quickest).map(of_velocity).sum();
        if unmeasured > part_unmeasured * whole {
            return None;
        }
        let mut below = 0.0;
        let fastest = (0..bins).find(|&bin| {
            below += of_velocity(bin);
            below >= most_of_velocity * whole
        })?;
        let period = 2.0 * PI / turn(fastest);
        if period > fine {
            return None;
        }
        let reach = ((periods * period) as usize).clamp(least, most);
        let covariance = [0, 1, 2].map(|derivative| {
            let at = |lag: usize| -> f64 {
                let of_bin = |(bin, power): (usize, &f64)| {
                    let (sin, cos) = (turn(bin) * lag as f64).sin_cos();
                    let wave = [cos, -turn(bin) * sin, -turn(bin).powi(2) * cos][derivative];
                    power * wave
                };
                motion.iter().enumerate().map(of_bin).sum::<f64>() / bins as f64
            };
            (0..=2 * reach).map(at).collect::<Vec<f64>>()
        });
        let variances = [0, 2, 4].map(|power| {
            let of_bin = |(bin, motion): (usize, &f64)| motion * turn(bin).powi(power);
            motion.iter().enumerate().map(of_bin).sum::<f64>() / bins as f64
        });
        let [r, ..] = &covariance;
        let variance = floor.max(quiet.powi(2) * r[0]);
        let length = 2 * reach + 1;
        let matrix = DMatrix::from_fn(length, length, |i, j| {
            r[i.abs_diff(j)] + if i == j { variance } else { 0.0 }
        });
        Some(Self {
            reach,
            factor: Cholesky::new(matrix)?,
            covariance,
            variances,
            mean,
            noise: floor.sqrt(),
            taken: variance.sqrt(),
        })
    }

    /// The weights of the window's samples for displacement, slope and curvature at its sample `at`, and the deviations of these.
    fn weights(&self, at: usize) -> ([DVector<f64>; 3], [f64; 3]) {
        let of = |derivative: usize| {
            DVector::from_fn(2 * self.reach + 1, |sample, _| {
                let value = self.covariance[derivative][at.abs_diff(sample)];
                // Of the three the middle one is odd.
                if derivative == 1 && sample > at {
                    -value
                } else {
                    value
                }
            })
        };
        let right = [0, 1, 2].map(of);
        let weights = [0, 1, 2].map(|derivative| self.factor.solve(&right[derivative]));
        let deviations = [0, 1, 2].map(|derivative| {
            let known = weights[derivative].dot(&right[derivative]);
            (self.variances[derivative] - known).max(0.0).sqrt()
        });
        (weights, deviations)
    }

    /// Ratio of the error of each of the three to the part due to noise: power of the motion below the noise in the band is not
    /// distinguished from it, and is missing from the estimate too.
    fn excess(&self) -> [f64; 3] {
        let (weights, deviations) = self.weights(self.reach);
        [0, 1, 2].map(|derivative| {
            let of_noise = self.taken * weights[derivative].norm();
            (deviations[derivative] / of_noise).max(1.0)
        })
    }

    /// `displacement` in mm, of a motion with this spectrum, smoothed.
    pub(super) fn smooth(&self, displacement: &[f64]) -> Smoothed {
        let count = displacement.len();
        let mut smoothed = Smoothed {
            displacement: Vec::with_capacity(count),
            slope: Vec::with_capacity(count),
            curvature: Vec::with_capacity(count),
            slope_deviation: Vec::with_capacity(count),
        };
        let reach = self.reach;
        let within = self.weights(reach);
        for index in 0..count {
            // At an end the window keeps its length.
            let low = index.saturating_sub(reach).min(count - 2 * reach - 1);
            let at_end;
            let (weights, [_, deviation, _]) = if index - low == reach {
                &within
            } else {
                at_end = self.weights(index - low);
                &at_end
            };
            let samples = &displacement[low..=low + 2 * reach];
            let [value, slope, curvature] = [0, 1, 2].map(|derivative| {
                let each = weights[derivative].iter().zip(samples);
                each.map(|(weight, y)| weight * (y - self.mean))
                    .sum::<f64>()
            });
            smoothed.displacement.push(self.mean + value);
            smoothed.slope.push(slope);
            smoothed.curvature.push(curvature);
            smoothed.slope_deviation.push(*deviation);
        }
        smoothed
    }
}

/// The samples at which a smoother is better than windows of cubics.
pub(super) struct Band {
    smoother: Smoother,
    holds: Vec<bool>,
}

impl Band {
    /// Where it is better in `displacement` in mm, without the samples whose motion is `known` better, and its result there. Two
    /// conditions must hold: its residual is only noise, and it estimates the motion found, with an equally noisy displacement,
    /// better than `estimate`, whose own estimate is `motion`. `None` if it is better nowhere.
    pub(super) fn find(
        displacement: &[f64],
        tick: f64,
        motion: &MotionEstimate,
        known: &[Range<usize>],
        estimate: impl Fn(&[f64]) -> MotionEstimate,
    ) -> Option<(Self, Smoothed)> {
        let smoother = Smoother::of(displacement)?;
        let smoothed = smoother.smooth(displacement);
        let left = left_by(displacement, &smoothed.displacement);
        let mut holds = smoother.leaves_only_noise(&left);
        holds[..motion.start_from_rest].fill(false);
        for kink in smoother.corners(displacement, motion, &left) {
            // No window may lie across a kink; at an end all windows use the same samples.
            let (reach, count) = (smoother.reach, displacement.len());
            let low = if kink <= 2 * reach { 0 } else { kink - reach };
            let high = if kink + 2 * reach >= count {
                count
            } else {
                kink + reach
            };
            holds[low..high].fill(false);
        }
        for better in motion.rests.iter().chain(known) {
            holds[better.clone()].fill(false);
        }
        if holds.iter().all(|holds| !holds) {
            return None;
        }
        let again = as_noisy(&smoothed.displacement, displacement, smoother.noise, |_| {
            true
        });
        let own = smoother.smooth(&again).slope;
        let other = estimate(&again).velocity;
        let (mut of_own, mut of_other) = (0.0, 0.0);
        for index in (0..holds.len()).filter(|&index| holds[index]) {
            let truth = smoothed.slope[index];
            of_own += (own[index] - truth).powi(2);
            of_other += (tick * other[index] - truth).powi(2);
        }
        let is_better = of_own < SmootherPolicy::in_use().better * of_other;
        is_better.then_some((Self { smoother, holds }, smoothed))
    }

    /// Whether it applies at a sample.
    pub(super) fn holds_at(&self, index: usize) -> bool {
        self.holds[index]
    }

    /// Scales the part of a motion's error due to noise to the whole error.
    pub(super) fn complete(&self, error: &mut MotionError) {
        let excess = self.smoother.excess();
        let channels = [
            &mut error.displacement,
            &mut error.velocity,
            &mut error.acceleration,
        ];
        for (channel, excess) in channels.into_iter().zip(excess) {
            let held = channel
                .iter_mut()
                .zip(&self.holds)
                .filter(|(_, holds)| **holds);
            held.for_each(|(error, _)| *error *= excess);
        }
    }

    /// Puts its estimate of `displacement` in mm, every `tick` s, into `motion` where it applies.
    pub(super) fn refine(&self, motion: &mut MotionEstimate, displacement: &[f64], tick: f64) {
        self.take(&self.smoother.smooth(displacement), motion, tick);
    }

    /// Puts `smoothed` into `motion` where it applies, with samples every `tick` s.
    pub(super) fn take(&self, smoothed: &Smoothed, motion: &mut MotionEstimate, tick: f64) {
        for index in (0..self.holds.len()).filter(|&index| self.holds[index]) {
            motion.displacement[index] = smoothed.displacement[index];
            motion.velocity[index] = smoothed.slope[index] / tick;
            motion.acceleration[index] = smoothed.curvature[index] / (tick * tick);
            motion.velocity_deviation[index] = smoothed.slope_deviation[index] / tick;
        }
        // If the residual of a smooth motion is only noise, there is no kink.
        motion
            .kinks
            .retain(|&kink| !(self.holds[kink] && self.holds[kink.saturating_sub(1)]));
        if 2 * self.holds.iter().filter(|&&holds| holds).count() > self.holds.len() {
            motion.noise = self.smoother.noise;
        }
    }
}

/// The residual of an estimate of a displacement.
fn left_by(displacement: &[f64], estimated: &[f64]) -> Vec<f64> {
    let pairs = displacement.iter().zip(estimated);
    pairs
        .map(|(recorded, estimated)| recorded - estimated)
        .collect()
}

impl Smoother {
    /// The samples about which the residual `left`, mm, is only noise.
    fn leaves_only_noise(&self, left: &[f64]) -> Vec<bool> {
        let SmootherPolicy { about, exact, .. } = *SmootherPolicy::in_use();
        let noise = self.noise.max(exact * self.variances[0].sqrt());
        let mut sums = vec![0.0];
        let mut sum = 0.0;
        for left in left {
            sum += left * left;
            sums.push(sum);
        }
        let is_noise = |index: usize| {
            let (low, high) = (
                index.saturating_sub(about),
                (index + about + 1).min(left.len()),
            );
            leaves_only_noise(sums[high] - sums[low], (high - low) as f64, noise)
        };
        (0..left.len()).map(is_noise).collect()
    }

    /// The kinks of `motion` that are corners: the residual of the cubics about them is only noise, and the residual of this
    /// estimate, `left`, mm, is larger about all of them together than elsewhere.
    fn corners(&self, displacement: &[f64], motion: &MotionEstimate, left: &[f64]) -> Vec<usize> {
        let SmootherPolicy {
            corner, some_noise, ..
        } = *SmootherPolicy::in_use();
        let explained = self.leaves_only_noise(&left_by(displacement, &motion.displacement));
        let mut kinks = motion.kinks.clone();
        kinks.retain(|&kink| explained[kink]);
        let (mut squares, mut count) = (0.0, 0.0);
        for &kink in &kinks {
            let (low, high) = (kink.saturating_sub(corner), (kink + corner).min(left.len()));
            squares += left[low..high].iter().map(|left| left * left).sum::<f64>();
            count += (high - low) as f64;
        }
        let mean = left.iter().map(|left| left * left).sum::<f64>() / left.len() as f64;
        if squares <= mean * (count + some_noise * (2.0 * count).sqrt()) {
            kinks.clear();
        }
        kinks
    }
}
