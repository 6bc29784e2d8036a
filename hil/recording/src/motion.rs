//! The motion behind a noisy displacement record: smoothed displacement, velocity and acceleration.
//!
//! Differences would multiply the noise by the sampling rate, and the law is steep where the velocity passes through zero. So a
//! cubic is fitted around every sample. The length of its window is a compromise between the noise, which requires a long window,
//! and the curvature of the motion, which requires a short one. No window reaches across a kink, where the velocity jumps.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Matrix4, Vector4};

use super::cycles::Cycles;
use super::kinks::find_kinks;
use super::motion_error::MotionError;
use super::noise::noise_deviation;
use super::polynomial::{Cubic, fit_polynomial};
use super::rest::find_rests;
use crate::extremes::least_and_largest;

crate::numbers! {
    /// How velocity and acceleration are estimated.
    MotionPolicy {
        /// The cubic for a sample is fitted to at least this many samples on each side.
        shortest: usize = 4, Derived("nine samples leave five degrees of freedom with the four coefficients of a cubic");
        /// A velocity below this many of its standard deviations has no certain direction. It is set to 0 if it is small too (see
        /// `at_rest`).
        uncertain: f64 = 2.0, Tuned("the blind trial");
        /// A measured velocity is not used if its RMS difference from the estimated velocity exceeds this many times the error of the
        /// estimate.
        worse: f64 = 2.0, Derived("weighted by the inverse of its variance it would reduce the error by only a tenth");
        /// A speed above this fraction of the largest speed keeps its direction, even if that is uncertain (see `uncertain`).
        at_rest: f64 = 1e-3, Tuned("the blind trial");
        /// The window of a cubic reaches over at most this fraction of a period to each side.
        longest: f64 = 0.15, Tuned("the estimated motions");
        /// A start from rest is fitted over at most this fraction of the first period.
        start: f64 = 0.5, Derived("from rest to the first turn is a quarter of a period, and only half of the window is used");
        /// A fit leaves only noise if its sum of squares exceeds the expected sum by at most this many standard deviations.
        only_noise: f64 = 4.0, Derived("a normal variable exceeds it once in 30 000 times");
    }
}

/// Displacement, velocity and acceleration on a uniform time base.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionEstimate {
    /// Smoothed displacement, mm.
    pub displacement: Vec<f64>,
    /// Velocity, mm/s.
    pub velocity: Vec<f64>,
    /// Acceleration, mm/s².
    pub acceleration: Vec<f64>,
    /// Standard deviation of the velocity due to the displacement's noise, mm/s.
    pub velocity_deviation: Vec<f64>,
    /// Ranges of samples in which the displacement stands still, in order.
    pub rests: Vec<Range<usize>>,
    /// First samples after a jump of velocity, increasing.
    pub kinks: Vec<usize>,
    /// Standard deviation of the displacement's noise, mm.
    pub noise: f64,
    /// Number of samples in a start from rest; 0 if the recording begins in motion.
    pub start_from_rest: usize,
}

impl MotionEstimate {
    /// Sets velocities to 0 that cannot be distinguished from 0: a friction with unknown direction is then taken as none, rather
    /// than possibly with the wrong sign. A start from rest has one direction, however: before that direction is certain, the
    /// velocity grows linearly to the first certain one.
    pub(super) fn rest_at_reversals(&mut self) {
        let largest = self
            .velocity
            .iter()
            .fold(0.0_f64, |most, v| most.max(v.abs()));
        let started = self.certain_start();
        let (start, rest) = self.velocity.split_at_mut(started);
        let reached = rest.first().copied().unwrap_or_default();
        for (index, velocity) in start.iter_mut().enumerate() {
            *velocity = reached * index as f64 / started as f64;
        }
        for (velocity, deviation) in rest.iter_mut().zip(&self.velocity_deviation[started..]) {
            if velocity.abs()
                < (MotionPolicy::in_use().uncertain * deviation)
                    .min(MotionPolicy::in_use().at_rest * largest)
            {
                *velocity = 0.0;
            }
        }
    }

    /// Combines the estimate with a measured velocity in mm/s, each weighted by the inverse of its variance. If the measured one
    /// differs from the estimated one by more than twice the error of that, it is left out, because it was probably differentiated
    /// from the same displacement.
    pub(super) fn weigh_in(&mut self, measured: &[f64], error: &mut MotionError) {
        let mean = |squares: &mut dyn Iterator<Item = f64>| {
            squares.map(|x| x * x).sum::<f64>() / measured.len() as f64
        };
        let mut differs = self
            .velocity
            .iter()
            .zip(measured)
            .map(|(own, other)| own - other);
        let own = mean(&mut error.velocity.iter().copied());
        if mean(&mut differs) > MotionPolicy::in_use().worse.powi(2) * own {
            return;
        }
        let noise = noise_deviation(measured);
        for (index, measured) in measured.iter().enumerate() {
            let deviation = self.velocity_deviation[index];
            let both = deviation.hypot(noise);
            if both > 0.0 {
                let weight = (deviation / both).powi(2);
                self.velocity[index] += weight * (measured - self.velocity[index]);
                self.velocity_deviation[index] = deviation * noise / both;
                error.velocity[index] *= 1.0 - weight;
            }
        }
    }

    /// The first sample of a start from rest with a certain direction; 0 if there is none.
    fn certain_start(&self) -> usize {
        let start = self.start_from_rest;
        let Some(last) = start.checked_sub(1) else {
            return 0;
        };
        let way = self.velocity[last].signum();
        let is_certain = |&index: &usize| {
            way * self.velocity[index]
                > MotionPolicy::in_use().uncertain * self.velocity_deviation[index]
        };
        let certain = (0..start).rev().take_while(is_certain).last();
        certain.unwrap_or_default()
    }

    /// Estimates the motion from `displacement` in mm, sampled every `tick` s, whose dominant period around each sample
    /// is `period` s.
    ///
    /// # Panics
    /// If the two slices differ in length, or there are fewer than 8 samples.
    pub fn estimate(displacement: &[f64], tick: f64, period: &[f64]) -> Self {
        assert_eq!(displacement.len(), period.len());
        assert!(displacement.len() >= 8, "a motion needs 8 samples");
        let noise = noise_deviation(displacement);
        let kinks = find_kinks(displacement, tick, period, noise);
        let count = displacement.len();
        let mut motion = Self {
            displacement: Vec::with_capacity(count),
            velocity: Vec::with_capacity(count),
            acceleration: Vec::with_capacity(count),
            velocity_deviation: Vec::with_capacity(count),
            rests: find_rests(displacement, noise),
            kinks,
            noise,
            start_from_rest: 0,
        };
        let bounds = segment_bounds(&motion.kinks, count);
        let start_from_rest = StartFromRest::fit(
            displacement,
            (MotionPolicy::in_use().start * period[0] / tick) as usize,
            noise,
        );
        motion.start_from_rest = start_from_rest.as_ref().map_or(0, |start| start.length);
        let mut half = HalfWindow::new(tick, noise);
        for segment in bounds.windows(2) {
            let (start, end) = (segment[0], segment[1]);
            let amplitude = half_range(&displacement[start..end]);
            for index in start..end {
                // A crossing found in noise may be off by a sample, and so may the change of period.
                let period = period[index].min(period[(index + 2).min(end - 1)]);
                let half = half.best(period, amplitude);
                let cubic = match &start_from_rest {
                    Some(start) if index < start.length => start.at(index),
                    _ => fit_window(displacement, start..end, index, half, noise),
                };
                motion.displacement.push(cubic.value);
                motion.velocity.push(cubic.slope / tick);
                motion.acceleration.push(cubic.curvature / (tick * tick));
                motion
                    .velocity_deviation
                    .push(noise * cubic.slope_variance.sqrt() / tick);
            }
        }
        motion.stand_still(displacement);
        motion
    }

    /// [`MotionEstimate::estimate`] with the periods found in the displacement itself.
    ///
    /// # Panics
    /// If there are fewer than 8 samples.
    pub fn of(displacement: &[f64], tick: f64) -> Self {
        let cycles = Cycles::of(displacement, tick);
        let period = cycles.period_per_sample(displacement.len(), tick);
        Self::estimate(displacement, tick, &period)
    }

    /// Whether the displacement stands still at a sample.
    pub fn is_at_rest(&self, index: usize) -> bool {
        let after = self.rests.partition_point(|rest| rest.end <= index);
        self.rests
            .get(after)
            .is_some_and(|rest| rest.contains(&index))
    }

    /// Sets the velocity of rests to 0 and their displacement to its mean.
    fn stand_still(&mut self, displacement: &[f64]) {
        for rest in &self.rests {
            let count = rest.len() as f64;
            let mean = displacement[rest.clone()].iter().sum::<f64>() / count;
            self.displacement[rest.clone()].fill(mean);
            self.velocity[rest.clone()].fill(0.0);
            self.acceleration[rest.clone()].fill(0.0);
            self.velocity_deviation[rest.clone()].fill(0.0);
        }
    }
}

/// The best window for noise and curvature, stored per period and amplitude.
struct HalfWindow {
    tick: f64,
    noise: f64,
    last: Option<(f64, f64, usize)>,
}

impl HalfWindow {
    fn new(tick: f64, noise: f64) -> Self {
        Self {
            tick,
            noise,
            last: None,
        }
    }

    /// Half width in samples that minimizes variance + bias² of the slope of a sine with this period and amplitude.
    ///
    /// With n samples to each side and m = 2n+1, the slope of a cubic has the variance 75/(4 n³)·σ² per tick² (for large n:
    /// Savitzky–Golay, degree 3), and a sine of θ rad per tick loses (θn)⁴/280 of its slope.
    fn best(&mut self, period: f64, amplitude: f64) -> usize {
        if let Some((p, a, half)) = self.last
            && p == period
            && a == amplitude
        {
            return half;
        }
        let theta = TAU * self.tick / period;
        let longest = (MotionPolicy::in_use().longest * period / self.tick) as usize;
        let error = |half: usize| {
            let n = half as f64;
            let bias = amplitude * theta * (theta * n).powi(4) / 280.0;
            self.noise * self.noise * 75.0 / (4.0 * n.powi(3)) + bias * bias
        };
        let mut half = MotionPolicy::in_use().shortest;
        while half < longest && error(half + 1) < error(half) {
            half += 1;
        }
        self.last = Some((period, amplitude, half));
        half
    }
}

fn half_range(samples: &[f64]) -> f64 {
    let (low, high) = least_and_largest(samples);
    0.5 * (high - low)
}

/// 0, the kinks, `count`.
fn segment_bounds(kinks: &[usize], count: usize) -> Vec<usize> {
    let mut bounds = vec![0];
    bounds.extend(kinks.iter().copied().filter(|&k| k > 0 && k < count));
    bounds.push(count);
    bounds
}

/// A recording that begins at rest: y = a + b·t² + c·t³ + d·t⁴, whose slope is 0 at the first sample.
///
/// The velocity there is too small for a free cubic to detect in the noise, but not for the law's |v|^α.
struct StartFromRest {
    /// Number of samples for which it is valid.
    length: usize,
    /// a, b, c, d with time in units of the window.
    coefficients: Vector4<f64>,
    gram_inverse: Matrix4<f64>,
    window: f64,
}

impl StartFromRest {
    /// Fits the first `longest` samples, or fewer if the residual exceeds the noise; `None` if the motion does not begin at rest.
    fn fit(samples: &[f64], longest: usize, noise: f64) -> Option<Self> {
        let mut length = longest.min(samples.len());
        while length >= 4 * MotionPolicy::in_use().shortest {
            let window = length as f64;
            let mut gram = Matrix4::zeros();
            let mut right = Vector4::zeros();
            for (index, &sample) in samples[..length].iter().enumerate() {
                let [row, _, _] = Self::basis(index, window);
                gram += row * row.transpose();
                right += row * sample;
            }
            let gram_inverse = gram.try_inverse()?;
            let fit = Self {
                length: length / 2,
                coefficients: gram_inverse * right,
                gram_inverse,
                window,
            };
            let error: f64 = (0..length)
                .map(|index| {
                    (Self::basis(index, window)[0].dot(&fit.coefficients) - samples[index]).powi(2)
                })
                .sum();
            if leaves_only_noise(error, window - 4.0, noise) {
                return Some(fit);
            }
            length = length * 3 / 4;
        }
        None
    }

    /// 1, t², t³, t⁴ with their first two derivatives per sample.
    fn basis(index: usize, window: f64) -> [Vector4<f64>; 3] {
        let t = index as f64 / window;
        let d = 1.0 / window;
        [
            Vector4::new(1.0, t * t, t * t * t, t * t * t * t),
            Vector4::new(0.0, 2.0 * t, 3.0 * t * t, 4.0 * t * t * t) * d,
            Vector4::new(0.0, 2.0, 6.0 * t, 12.0 * t * t) * (d * d),
        ]
    }

    fn at(&self, index: usize) -> Cubic {
        let [value, slope, curvature] = Self::basis(index, self.window);
        Cubic {
            value: value.dot(&self.coefficients),
            slope: slope.dot(&self.coefficients),
            curvature: curvature.dot(&self.coefficients),
            slope_variance: slope.dot(&(self.gram_inverse * slope)),
            error: 0.0,
        }
    }
}

/// Fits a cubic to the 2·half+1 samples around `index` that lie in `segment`; at an end the window keeps its length and moves
/// inwards. While the residual clearly exceeds the noise, as after a start from rest or in a ramp of amplitude, the window is
/// shortened. A segment shorter than five samples gets a line.
fn fit_window(
    samples: &[f64],
    segment: Range<usize>,
    index: usize,
    half: usize,
    noise: f64,
) -> Cubic {
    let mut half = half;
    loop {
        let length = (2 * half + 1).min(segment.len());
        let low = index
            .saturating_sub(half)
            .max(segment.start)
            .min(segment.end - length);
        let degree = match length {
            0..=1 => 0,
            2..=4 => 1,
            _ => 3,
        };
        let cubic = fit_polynomial(
            &samples[low..low + length],
            index as f64 - low as f64,
            degree,
        );
        if half <= MotionPolicy::in_use().shortest
            || leaves_only_noise(cubic.error, length as f64 - 4.0, noise)
        {
            return cubic;
        }
        half = (half * 3 / 4).max(MotionPolicy::in_use().shortest);
    }
}

/// Whether a sum of squares is consistent with white noise of deviation `noise` with this many degrees of freedom.
pub(super) fn leaves_only_noise(error: f64, freedom: f64, noise: f64) -> bool {
    error <= noise * noise * (freedom + MotionPolicy::in_use().only_noise * (2.0 * freedom).sqrt())
}
