//! The motion of steady cycles, from all the samples of several half cycles at once.
//!
//! Where a sine goes on, a sum of harmonics fits it down to the noise over several half cycles, and gives velocities
//! many times more accurate than a local cubic. It is used where it leaves no more than the noise; a start, a ramp and
//! whatever is no sine keep the local estimate.

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::{Cholesky, SMatrix, SVector};

use super::cycles::Cycles;
use super::motion::{Motion, leaves_only_noise};

/// 1, t; cos, sin, t·cos, t·sin of the period; cos, sin of the second and third harmonic. The terms with t take up a slow
/// change of amplitude and an error of the period.
const TERMS: usize = 10;

type Basis = SVector<f64, TERMS>;

impl Motion {
    /// Replaces the local estimate by that of harmonics, half cycle by half cycle, where the samples of `displacement` (mm,
    /// every `tick` s) follow them down to the noise.
    pub fn refine_steady(&mut self, displacement: &[f64], tick: f64, cycles: &Cycles) {
        for block in &cycles.blocks {
            let halves: Vec<Range<usize>> = block
                .cycles
                .iter()
                .flat_map(|cycle| {
                    let middle = (cycle.start + cycle.end) / 2;
                    [cycle.start..middle, middle..cycle.end]
                })
                .collect();
            for index in 0..halves.len() {
                let own = &halves[index];
                let best = windows_around(index, halves.len())
                    .filter_map(|window| {
                        let samples = halves[window.start].start..halves[window.end - 1].end;
                        let crosses = self
                            .kinks
                            .iter()
                            .any(|k| samples.start < *k && *k < samples.end);
                        (!crosses).then_some(samples)
                    })
                    .filter_map(|samples| {
                        Harmonics::fit(displacement, samples, tick * block.frequency)
                    })
                    .filter(|fit| fit.leaves_only_noise(displacement, own, self.noise))
                    .max_by_key(|fit| fit.samples.len());
                if let Some(fit) = best {
                    self.take(&fit, own, tick);
                }
            }
        }
    }

    fn take(&mut self, fit: &Harmonics, own: &Range<usize>, tick: f64) {
        let deviation = self.noise * fit.slope_deviation() / tick;
        for index in own.clone() {
            let [value, slope, curvature] = fit.at(index);
            self.displacement[index] = value;
            self.velocity[index] = slope / tick;
            self.acceleration[index] = curvature / (tick * tick);
            self.velocity_deviation[index] = deviation;
        }
    }
}

/// Runs of four half cycles that hold the half cycle `index`: centred, after it and before it.
fn windows_around(index: usize, count: usize) -> impl Iterator<Item = Range<usize>> {
    let centred = index.saturating_sub(2)..(index + 3).min(count);
    let after = index..(index + 4).min(count);
    let before = index.saturating_sub(3)..index + 1;
    [centred, after, before]
        .into_iter()
        .filter(|window| window.len() >= 3)
}

/// A sum of harmonics over a run of samples.
struct Harmonics {
    samples: Range<usize>,
    /// rad per sample
    step: f64,
    coefficients: Basis,
}

impl Harmonics {
    /// Least squares over `samples`; `frequency` in cycles per sample. `None` where the samples are too few.
    fn fit(displacement: &[f64], samples: Range<usize>, frequency: f64) -> Option<Self> {
        let mut fit = Self {
            samples,
            step: TAU * frequency,
            coefficients: Basis::zeros(),
        };
        if fit.samples.len() < 2 * TERMS {
            return None;
        }
        let mut gram = SMatrix::<f64, TERMS, TERMS>::zeros();
        let mut right = Basis::zeros();
        for index in fit.samples.clone() {
            let [row, _, _] = fit.basis(index);
            gram.syger(1.0, &row, &row, 1.0);
            right.axpy(displacement[index], &row, 1.0);
        }
        fit.coefficients = Cholesky::new(gram)?.solve(&right);
        Some(fit)
    }

    /// The basis functions and their first two derivatives per sample.
    fn basis(&self, index: usize) -> [Basis; 3] {
        let length = 0.5 * self.samples.len() as f64;
        let along = index as f64 - self.samples.start as f64 - length;
        let (t, dt) = (along / length, 1.0 / length);
        let w = self.step;
        let (sin, cos) = (w * along).sin_cos();
        let (sin2, cos2) = (2.0 * sin * cos, cos * cos - sin * sin);
        let (sin3, cos3) = (sin2 * cos + cos2 * sin, cos2 * cos - sin2 * sin);
        let w2 = w * w;
        [
            Basis::from([1.0, t, cos, sin, t * cos, t * sin, cos2, sin2, cos3, sin3]),
            Basis::from([
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
            Basis::from([
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

    /// Value, slope and curvature, per sample.
    fn at(&self, index: usize) -> [f64; 3] {
        self.basis(index).map(|row| row.dot(&self.coefficients))
    }

    /// Whether noise alone is left, of all samples and of those in `own`.
    fn leaves_only_noise(&self, displacement: &[f64], own: &Range<usize>, noise: f64) -> bool {
        let error = |range: Range<usize>| -> f64 {
            range
                .map(|index| (self.at(index)[0] - displacement[index]).powi(2))
                .sum()
        };
        leaves_only_noise(error(own.clone()), own.len() as f64, noise)
            && leaves_only_noise(
                error(self.samples.clone()),
                (self.samples.len() - TERMS) as f64,
                noise,
            )
    }

    /// Deviation of the slope per sample for noise of deviation 1: two coefficients of a sine over n samples have the
    /// variance 2/n each, those with t three times that.
    fn slope_deviation(&self) -> f64 {
        self.step * (8.0 / self.samples.len() as f64).sqrt()
    }
}
