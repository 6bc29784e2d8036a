//! Sinusoidal motion, estimated from all the samples of several half cycles at once.
//!
//! Where a sine continues over several half cycles, a sum of harmonics fits it down to the noise, and gives velocities many times
//! more accurate than a local cubic. So does a sine with a growing amplitude over the half cycle in which a block begins. Each is
//! used where its residual is only noise; elsewhere the local estimate stays.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Cholesky, SMatrix, SVector};

use super::cycles::{Cycles, FoundBlock};
use super::motion::{MotionEstimate, leaves_only_noise};

crate::numbers! {
    /// Which motion is a sine.
    HarmonicPolicy {
        /// A block counts as a sine only if it has more cycles than this.
        several: usize = 2, Derived("a cycle into the block, one within it and one out of it");
    }
}

impl MotionEstimate {
    /// Replaces the local estimate by that of sines, half cycle by half cycle, where the samples of `displacement` (mm, every
    /// `tick` s) follow them down to the noise. Returns those samples in blocks of several cycles; in a single cycle the fit does
    /// not prove a sine.
    pub fn refine_sines(
        &mut self,
        displacement: &[f64],
        tick: f64,
        cycles: &Cycles,
    ) -> Vec<Range<usize>> {
        let mut refined = Vec::new();
        for block in &cycles.blocks {
            let step = TAU * tick * block.frequency;
            let is_sine = block.cycles.len() > HarmonicPolicy::in_use().several;
            let halves = half_cycles(block, &self.kinks);
            for (index, own) in halves.iter().enumerate() {
                let steady = windows_around(index, halves.len())
                    .map(|window| halves[window.start].start..halves[window.end - 1].end)
                    .filter_map(|samples| Fit::of(displacement, Steady { samples, step }))
                    .filter(|fit| fit.leaves_only_noise(displacement, own, self.noise))
                    .max_by_key(|fit| fit.shape.samples.len());
                if let Some(fit) = steady {
                    self.take(&fit, own, tick);
                    refined.extend(is_sine.then(|| own.clone()));
                } else if index == 0 {
                    let ramp = Fit::of(
                        displacement,
                        Ramp {
                            samples: own.clone(),
                            step,
                        },
                    );
                    if let Some(fit) =
                        ramp.filter(|fit| fit.leaves_only_noise(displacement, own, self.noise))
                    {
                        // A start from rest is estimated better by its own function.
                        let own = own.start.max(self.start_from_rest)..own.end;
                        self.take(&fit, &own, tick);
                        refined.extend(is_sine.then_some(own));
                    }
                }
            }
        }
        refined
    }

    fn take<S: Waveform<N>, const N: usize>(
        &mut self,
        fit: &Fit<S, N>,
        own: &Range<usize>,
        tick: f64,
    ) {
        for index in own.clone() {
            let [value, slope, curvature] = fit.shape.basis(index);
            self.displacement[index] = value.dot(&fit.coefficients);
            self.velocity[index] = slope.dot(&fit.coefficients) / tick;
            self.acceleration[index] = curvature.dot(&fit.coefficients) / (tick * tick);
            let variance = slope.dot(&fit.factor.solve(&slope));
            self.velocity_deviation[index] = self.noise * variance.sqrt() / tick;
        }
    }
}

/// The half cycles of a block, the last one up to the block's end, none across a kink.
fn half_cycles(block: &FoundBlock, kinks: &[usize]) -> Vec<Range<usize>> {
    let mut halves: Vec<Range<usize>> = block
        .cycles
        .iter()
        .flat_map(|cycle| {
            let middle = (cycle.start + cycle.end) / 2;
            [cycle.start..middle, middle..cycle.end]
        })
        .collect();
    if let Some(last) = halves.last() {
        // A cycle without the crossing that would end it.
        let (mut start, length) = (last.end, last.len().max(1));
        while start < block.samples.end {
            let end = if block.samples.end - start < 2 * length {
                block.samples.end
            } else {
                start + length
            };
            halves.push(start..end);
            start = end;
        }
    }
    halves.retain(|half| {
        !kinks
            .iter()
            .any(|&kink| half.start < kink && kink < half.end)
    });
    halves
}

/// Runs of four half cycles that contain the half cycle `index`: centred, after it and before it.
fn windows_around(index: usize, count: usize) -> impl Iterator<Item = Range<usize>> {
    let centred = index.saturating_sub(2)..(index + 3).min(count);
    let after = index..(index + 4).min(count);
    let before = index.saturating_sub(3)..index + 1;
    [centred, after, before]
        .into_iter()
        .filter(|window| window.len() >= 3)
}

/// Basis functions over a run of samples.
trait Waveform<const N: usize> {
    fn samples(&self) -> &Range<usize>;

    /// The basis functions at a sample, and their first two derivatives per sample.
    fn basis(&self, index: usize) -> [SVector<f64, N>; 3];
}

/// 1, t; cos, sin, t·cos, t·sin of the period; cos, sin of the second and third harmonic. The terms with t describe a slow change
/// of amplitude and an error of the period.
struct Steady {
    samples: Range<usize>,
    /// rad per sample
    step: f64,
}

/// 1; cos, and sin times a cubic of t: the amplitude during the change from one block's to the next.
struct Ramp {
    samples: Range<usize>,
    /// rad per sample
    step: f64,
}

impl Waveform<10> for Steady {
    fn samples(&self) -> &Range<usize> {
        &self.samples
    }

    fn basis(&self, index: usize) -> [SVector<f64, 10>; 3] {
        let length = 0.5 * self.samples.len() as f64;
        let along = index as f64 - self.samples.start as f64 - length;
        let (t, dt) = (along / length, 1.0 / length);
        let w = self.step;
        let (sin, cos) = (w * along).sin_cos();
        let (sin2, cos2) = (2.0 * sin * cos, cos * cos - sin * sin);
        let (sin3, cos3) = (sin2 * cos + cos2 * sin, cos2 * cos - sin2 * sin);
        let w2 = w * w;
        [
            SVector::from([1.0, t, cos, sin, t * cos, t * sin, cos2, sin2, cos3, sin3]),
            SVector::from([
                0.0,
                dt,
                -w * sin,
                w * cos,
                dt * cos - t * w * sin,
                dt * sin + t * w * cos,
                -2.0 * w * sin2,
                2.0 * w * cos2,
                -3.0 * w * sin3,
                3.0 * w * cos3,
            ]),
            SVector::from([
                0.0,
                0.0,
                -w2 * cos,
                -w2 * sin,
                -2.0 * dt * w * sin - t * w2 * cos,
                2.0 * dt * w * cos - t * w2 * sin,
                -4.0 * w2 * cos2,
                -4.0 * w2 * sin2,
                -9.0 * w2 * cos3,
                -9.0 * w2 * sin3,
            ]),
        ]
    }
}

impl Waveform<6> for Ramp {
    fn samples(&self) -> &Range<usize> {
        &self.samples
    }

    fn basis(&self, index: usize) -> [SVector<f64, 6>; 3] {
        let along = (index - self.samples.start) as f64;
        let dt = 1.0 / self.samples.len() as f64;
        let t = along * dt;
        let w = self.step;
        let (sin, cos) = (w * along).sin_cos();
        // (p·sin)' = p'·sin + p·w·cos, (p·sin)'' = p''·sin + 2p'·w·cos − p·w²·sin, for p = 1, t, t², t³.
        let p = [1.0, t, t * t, t * t * t];
        let first = [0.0, dt, 2.0 * t * dt, 3.0 * t * t * dt];
        let second = [0.0, 0.0, 2.0 * dt * dt, 6.0 * t * dt * dt];
        let value = p.map(|p| p * sin);
        let slope: [f64; 4] = std::array::from_fn(|k| first[k] * sin + p[k] * w * cos);
        let curvature: [f64; 4] = std::array::from_fn(|k| {
            second[k] * sin + 2.0 * first[k] * w * cos - p[k] * w * w * sin
        });
        let row = |constant: f64, cosine: f64, sines: [f64; 4]| {
            SVector::from([constant, cosine, sines[0], sines[1], sines[2], sines[3]])
        };
        [
            row(1.0, cos, value),
            row(0.0, -w * sin, slope),
            row(0.0, -w * w * cos, curvature),
        ]
    }
}

/// Least squares of a function of this kind.
struct Fit<S, const N: usize> {
    shape: S,
    coefficients: SVector<f64, N>,
    factor: Cholesky<f64, nalgebra::Const<N>>,
}

impl<S: Waveform<N>, const N: usize> Fit<S, N> {
    /// `None` if there are too few samples.
    fn of(displacement: &[f64], shape: S) -> Option<Self> {
        if shape.samples().len() < 2 * N {
            return None;
        }
        let mut gram = SMatrix::<f64, N, N>::zeros();
        let mut right = SVector::<f64, N>::zeros();
        for index in shape.samples().clone() {
            let [row, _, _] = shape.basis(index);
            gram.syger(1.0, &row, &row, 1.0);
            right.axpy(displacement[index], &row, 1.0);
        }
        let factor = Cholesky::new(gram)?;
        Some(Self {
            shape,
            coefficients: factor.solve(&right),
            factor,
        })
    }

    /// Whether the residual is only noise, for all samples and for those in `own`.
    fn leaves_only_noise(&self, displacement: &[f64], own: &Range<usize>, noise: f64) -> bool {
        let error = |range: &Range<usize>| -> f64 {
            let value = |index: usize| self.shape.basis(index)[0].dot(&self.coefficients);
            range
                .clone()
                .map(|index| (value(index) - displacement[index]).powi(2))
                .sum()
        };
        let samples = self.shape.samples();
        leaves_only_noise(error(own), own.len() as f64, noise)
            && leaves_only_noise(error(samples), (samples.len() - N) as f64, noise)
    }
}
