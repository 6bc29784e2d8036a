//! The noise of a measured force, from samples that were measured.
//!
//! Sixth differences of neighbouring samples show white noise. If a logger held the force for some rows, interpolated it from a slower
//! rate, or a filter smoothed it, neighbours share their noise, and the differences are too small. Differences over longer strides then
//! grow until the samples are independent. The estimate at that stride is an upper bound, because part of the force itself is in it.

use std::ops::Range;

use nalgebra::{Cholesky, SMatrix, SVector};

use crate::motion::MotionEstimate;
use crate::noise::{noise_of_runs, rms};

crate::numbers! {
    /// Whether neighbouring samples of the force have noise of their own.
    NoiseFloorPolicy {
        /// Neighbours share their noise if the estimate grows by more than this factor when the stride doubles.
        grows: f64 = 1.6, Derived("noise that grows as 1/f, which a measured force may have, grows by √2, and a walk by 2");
        /// The estimate shows the force itself, not its noise, if it grows by more than this factor when the stride doubles.
        signal: f64 = 16.0, Derived("the sixth difference of a smooth signal grows by 2⁶ = 64; this is between that and noise behind a filter");
        /// An estimate of more than this part of what the motion leaves of the force is of the force itself.
        itself: f64 = 0.5, Convention("a quarter of its power; noise that is more of it shows between neighbours");
        /// The longest stride, samples.
        longest: usize = 16, Convention("a force that is 16 times slower than its rows is another recording");
        /// A block of fewer samples to the cycle than this, times the stride, shows no noise at that stride.
        samples: f64 = 12.0, Convention("then a sixth difference of the third harmonic is no longer small");
        /// A stride shows the noise if at least this many samples are left.
        fewest: usize = 100, Derived("their estimate is then within 15 % of the noise, so that 1.6 is four deviations");
    }
}

/// Functions of the motion that make up most of any specimen's force.
const FUNCTIONS: usize = 9;

/// The noise of a force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoiseFloor {
    /// Its standard deviation, in the unit of the force.
    pub deviation: f64,
    /// Whether the samples show it; otherwise it is an upper bound.
    pub is_known: bool,
    /// Whether it bounds the noise: the estimate stopped growing before it was of the force itself.
    pub is_bounded: bool,
}

impl NoiseFloor {
    /// Of the samples of `force` in `runs` that were `measured`, under a `motion` of these `blocks`: samples, and how many there are to a
    /// cycle.
    pub fn of(
        force: &[f64],
        motion: &MotionEstimate,
        (runs, measured): (&[Range<usize>], &[bool]),
        blocks: &[(Range<usize>, f64)],
    ) -> Self {
        let NoiseFloorPolicy {
            grows,
            signal,
            itself,
            longest,
            samples,
            fewest,
        } = *NoiseFloorPolicy::in_use();
        let runs: Vec<Range<usize>> = runs
            .iter()
            .flat_map(|run| measured_in(run, measured))
            .collect();
        let seen = noise_of_runs(force, &runs);
        let left = beside_motion(force, motion, measured);
        // Where samples were held or left out, no two neighbours may be left. Between them the force was interpolated, which is smooth.
        let all: Vec<Range<usize>> = match runs.iter().any(|run| run.len() > 2 * longest) {
            true => runs,
            false => std::iter::once(0..force.len()).collect(),
        };
        let at = |stride: usize, runs: &[Range<usize>]| {
            let parts = runs
                .iter()
                .map(|run| run.clone().step_by(stride).map(|index| left[index]));
            let parts: Vec<Vec<f64>> = parts.map(Iterator::collect).collect();
            let mut end = 0;
            let runs: Vec<Range<usize>> = (parts.iter())
                .map(|part| {
                    end += part.len();
                    end - part.len()..end
                })
                .collect();
            noise_of_runs(&parts.concat(), &runs)
        };
        // The motion is slow enough there.
        let showing = |stride: usize| -> Vec<Range<usize>> {
            let slow = (blocks.iter()).filter(|(_, cycle)| *cycle >= samples * stride as f64);
            let parts = slow.flat_map(|(block, _)| {
                let within =
                    |run: &Range<usize>| run.start.max(block.start)..run.end.min(block.end);
                all.iter().map(within)
            });
            parts.filter(|part| !part.is_empty()).collect()
        };
        let (mut stride, mut deviation) = (1, at(1, &all));
        while 2 * stride <= longest {
            let slow = showing(2 * stride);
            let count: usize = slow.iter().map(|run| run.len() / (2 * stride)).sum();
            let [this, next] = [stride, 2 * stride].map(|stride| at(stride, &slow));
            // Equal neighbours have no noise at all.
            let is_none = this <= 1e-6 * next;
            if count < fewest || next <= grows * this || (next >= signal * this && !is_none) {
                break;
            }
            (stride, deviation) = (2 * stride, next);
        }
        let of_measured = left.iter().zip(measured).filter(|(_, measured)| **measured);
        let of_measured = of_measured.map(|(left, _)| *left);
        let has_neighbours = seen > 0.0 || deviation == 0.0;
        let is_known = stride == 1 && has_neighbours;
        Self {
            deviation: if is_known { seen } else { deviation.max(seen) },
            is_known,
            is_bounded: is_known || 2 * stride <= longest && deviation <= itself * rms(of_measured),
        }
    }
}

/// The parts of a run that were measured without a break.
fn measured_in(run: &Range<usize>, measured: &[bool]) -> Vec<Range<usize>> {
    let mut parts = Vec::new();
    let mut start = run.start;
    for part in measured[run.clone()].split(|measured| !measured) {
        if !part.is_empty() {
            parts.push(start..start + part.len());
        }
        start += part.len() + 1;
    }
    parts
}

/// The force without the part that is a function of the present motion, by least squares over the measured samples.
fn beside_motion(force: &[f64], motion: &MotionEstimate, measured: &[bool]) -> Vec<f64> {
    let largest = |values: &[f64]| values.iter().fold(f64::MIN_POSITIVE, |a, v| v.abs().max(a));
    let [y_max, v_max, a_max] =
        [&motion.displacement, &motion.velocity, &motion.acceleration].map(|all| largest(all));
    let row = |index: usize| {
        let y = motion.displacement[index] / y_max;
        let v = motion.velocity[index] / v_max;
        let a = motion.acceleration[index] / a_max;
        let dry = |alpha: f64| v.signum() * v.abs().powf(alpha);
        SVector::from([1.0, y, y * y, y.powi(3), v, dry(0.15), dry(0.5), a, y * v])
    };
    let mut gram = SMatrix::<f64, FUNCTIONS, FUNCTIONS>::identity() * (1e-9 * force.len() as f64);
    let mut right = SVector::<f64, FUNCTIONS>::zeros();
    for index in (0..force.len()).filter(|&index| measured[index]) {
        let row = row(index);
        gram.syger(1.0, &row, &row, 1.0);
        right += row * force[index];
    }
    let Some(factor) = Cholesky::new(gram) else {
        return force.to_vec();
    };
    let terms = factor.solve(&right);
    let left = force.iter().enumerate();
    left.map(|(index, force)| force - row(index).dot(&terms))
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution as _, Normal};

    use super::*;
    use crate::trajectory::Trajectory;

    const TICK: f64 = 2e-3;
    const NOISE: f64 = 0.004;

    /// Blocks of a spring with friction at frequencies that a seed draws, and the noise of its force.
    fn recording(seed: u64) -> (Vec<f64>, Vec<f64>) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let normal = Normal::new(0.0, NOISE).unwrap();
        let (mut displacement, mut force) = (Vec::new(), Vec::new());
        for _ in 0..4 {
            let frequency = random.random_range(0.5..4.0);
            let mut slip = 0.0;
            let mut before = 0.0;
            for index in 0..1500 {
                let y = 0.2 * (TAU * frequency * TICK * f64::from(index)).sin();
                slip = f64::clamp(slip + y - before, -0.03, 0.03);
                before = y;
                displacement.push(y + 1e-4 * normal.sample(&mut random) / NOISE);
                force.push(2.0 * y + 3.0 * slip + normal.sample(&mut random));
            }
        }
        (displacement, force)
    }

    fn floor(displacement: &[f64], force: Vec<f64>, measured: &[bool]) -> NoiseFloor {
        let trajectory = Trajectory::new("test", TICK, displacement, force.clone(), None, None);
        let all = 0..force.len();
        NoiseFloor::of(
            &force,
            &trajectory.motion,
            (std::slice::from_ref(&all), measured),
            &[(all.clone(), 125.0)],
        )
    }

    #[test]
    fn noise_of_measured_samples_is_known_whatever_stands_between_them() {
        for seed in 0..6 {
            let (y, mut force) = recording(seed);
            let all = vec![true; y.len()];
            let whole = floor(&y, force.clone(), &all);
            assert!(
                whole.is_known && (whole.deviation / NOISE - 1.0).abs() < 0.15,
                "{whole:?}"
            );
            // A gap of more than half of the recording, bridged by a line.
            let gap = 1000 + 100 * seed as usize..5000;
            let mut measured = all;
            for index in gap.clone() {
                let part = (index - gap.start) as f64 / gap.len() as f64;
                force[index] = force[gap.start] + part * (force[gap.end] - force[gap.start]);
                measured[index] = false;
            }
            let bridged = floor(&y, force, &measured);
            assert!(
                bridged.is_known && (bridged.deviation / NOISE - 1.0).abs() < 0.15,
                "{bridged:?}"
            );
        }
    }

    #[test]
    fn noise_that_neighbours_share_is_bounded_from_above() {
        // A value held for longer leaves too few that were measured within a cycle: the bound is then far above.
        for seed in 0..5 {
            let (y, force) = recording(seed);
            let rows = 2 + seed as usize;
            let all = vec![true; y.len()];
            // Values that repeat are no measurement.
            let new: Vec<bool> = (0..y.len()).map(|index| index % rows == 0).collect();
            let held = (0..force.len())
                .map(|index| force[index / rows * rows])
                .collect();
            let line = |index: usize| {
                let from = index / rows * rows;
                let to = (from + rows).min(force.len() - 1);
                force[from] + (index - from) as f64 / rows as f64 * (force[to] - force[from])
            };
            let interpolated = (0..force.len()).map(line).collect();
            // A low-pass of second order at a twelfth of the rate.
            let mut state = [0.0; 2];
            let pole = 1.0 - (-TAU / 12.0_f64).exp();
            let filtered = force.iter().map(|force| {
                state[0] += pole * (force - state[0]);
                state[1] += pole * (state[0] - state[1]);
                state[1]
            });
            for (what, force, measured, least) in [
                ("held", held, &new, 0.8),
                ("interpolated", interpolated, &all, 0.5),
                ("filtered", filtered.collect(), &all, 0.25),
            ] {
                let found = floor(&y, force, measured);
                let times = found.deviation / NOISE;
                assert!(!found.is_known, "{what}, {rows} rows: {times}");
                assert!(
                    (least..3.0).contains(&times),
                    "{what}, {rows} rows: {times}"
                );
            }
        }
    }
}
