//! The witness: how much of a law's residual a general regressor predicts from the motion's history, on conditions that it was not fitted
//! to. It names nothing; it says that something is left to be named.
//!
//! Random features of the history (Rahimi and Recht 2008) with weights by ridge regression: displacement, velocity and acceleration,
//! play operators, which remember the largest turns, displacements a while ago, the last two turning points and the control inputs. The
//! equations of a condition are subtracted from those of all, so that a fold needs no second pass over the data.

use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_recording::trajectory::Trajectory;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::left_out::LeftOut;
use crate::correction::cholesky::Cholesky;
use crate::tolerance::certainty;

mesh_damper_recording::numbers! {
    /// When a residual counts as predictable.
    WitnessPolicy {
        /// A witness counts if it predicts at least this part of the residual's variance.
        least: f64 = 0.1, Convention("a residual smaller by a twentieth is of no use");
        /// The probability that a residual without any regularity counts.
        level: f64 = 0.01, Convention("one in a hundred");
    }
}

/// Samples that the regressor is fitted to. Convention: its equations then take a fraction of a second.
const MOST_ROWS: usize = 12_000;
/// Random features. Convention: more hardly predict more, on any recording tried.
const RANDOM: usize = 200;
/// Play operators, from a hundredth of the largest displacement to all of it.
const PLAYS: usize = 12;
/// Displacements a while ago, from two samples to half of the longest period.
const LAGS: usize = 5;
/// Ridge penalties relative to the mean square of a feature, of which the one that predicts best counts.
const PENALTIES: [f64; 5] = [1e-4, 1e-3, 1e-2, 1e-1, 1.0];
/// Seed of the random features: any.
const SEED: u64 = 1;

/// How much of the residual of a law can be predicted from the motion's history.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Explainable {
    /// Part of the residual's variance that is predicted on conditions left out, without what the error of the estimated motion
    /// explains; the mean over the conditions. At most 1; below 0 if nothing is predicted.
    pub share: f64,
    /// Lower bound of the share: in 99 of 100 cases the share is larger.
    pub low: f64,
    /// Conditions that were left out, one after the other.
    pub conditions: usize,
}

impl Explainable {
    /// The share from which it counts, if it is beyond chance.
    pub fn least() -> f64 {
        WitnessPolicy::in_use().least
    }

    /// Whether a part is predicted that matters, beyond chance.
    pub fn counts(&self) -> bool {
        self.low > 0.0 && self.share >= Self::least()
    }
}

/// One sample in the regression.
struct Row {
    features: Vec<f64>,
    /// Residual over the recording's force, weighted by the certainty of the motion.
    residual: f64,
    /// Square of the part of it that the error of the motion explains.
    carried: f64,
    weight: f64,
    /// Its trajectory and its sample.
    place: (usize, usize),
}

/// How much of the residual, kN at every sample of `trajectories`, is predicted. `None` if there are fewer than three conditions.
pub(super) fn explainable(
    trajectories: &[Trajectory],
    left_out: &LeftOut,
    residual: &[Vec<f64>],
) -> Option<Explainable> {
    let conditions = left_out.inner_conditions();
    if conditions.len() < 3 {
        return None;
    }
    let history: Vec<History> = History::of(trajectories);
    let memory = history.first()?.longest;
    let rows = rows(trajectories, left_out, residual, &history);
    let width = rows.first()?.features.len() + RANDOM + 1;
    let matrix = expanded(&rows, width);
    let target = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.residual));
    let all = equations(&matrix, &target, |_| true);
    let mean_square = all.0.trace() / width as f64;
    let folds: Vec<Fold> = conditions
        .into_par_iter()
        .filter_map(|condition| {
            // The history of samples near by is that of the condition.
            let left = equations(&matrix, &target, |row| {
                let (which, sample) = rows[row].place;
                let margin = (memory / trajectories[which].tick) as usize;
                condition.is_within(which, sample, margin)
            });
            let (gram, right) = (&all.0 - left.0, &all.1 - left.1);
            let held = (0..rows.len()).filter(|&row| {
                let (which, sample) = rows[row].place;
                condition.contains(which, sample)
            });
            let held: Vec<usize> = held.collect();
            let energy: f64 = held.iter().map(|&row| target[row].powi(2)).sum();
            let carried = held.iter().map(|&row| rows[row].carried).sum();
            let errors = PENALTIES.map(|penalty| {
                let mut gram = gram.clone();
                for place in 0..width {
                    gram[(place, place)] += penalty * mean_square;
                }
                let mut weights = right.clone();
                let Some(factor) = Cholesky::new(gram) else {
                    return f64::INFINITY;
                };
                factor.solve(&mut weights);
                let error = |&row: &usize| (target[row] - matrix.row(row).tr_dot(&weights)).powi(2);
                held.iter().map(error).sum()
            });
            (energy > 0.0).then_some(Fold {
                energy,
                carried,
                errors,
            })
        })
        .collect();
    let count = folds.len() as f64;
    if count < 3.0 {
        return None;
    }
    let shares =
        |penalty: usize| -> Vec<f64> { folds.iter().map(|one| one.share(penalty)).collect() };
    let mean = |shares: &[f64]| shares.iter().sum::<f64>() / count;
    let best = (0..PENALTIES.len()).map(shares);
    let shares = best.max_by(|a, b| mean(a).total_cmp(&mean(b)))?;
    let share = mean(&shares);
    let variance = shares.iter().map(|one| (one - share).powi(2)).sum::<f64>() / (count - 1.0);
    let quantile = StudentsT::new(0.0, 1.0, count - 1.0).ok()?;
    let quantile = quantile.inverse_cdf(1.0 - WitnessPolicy::in_use().level);
    Some(Explainable {
        share,
        low: share - quantile * (variance / count).sqrt(),
        conditions: folds.len(),
    })
}

/// The squared residual of a condition, and what is left of it with each penalty.
struct Fold {
    energy: f64,
    carried: f64,
    errors: [f64; PENALTIES.len()],
}

impl Fold {
    /// What the error of the motion explains is no effect: it is a noisy displacement that the features see too. A regressor that is
    /// far off beyond its data says no more than that it failed.
    fn share(&self, penalty: usize) -> f64 {
        ((self.energy - self.errors[penalty] - self.carried) / self.energy).max(-1.0)
    }
}

/// XᵀX and Xᵀy over some rows.
fn equations(
    matrix: &DMatrix<f64>,
    target: &DVector<f64>,
    is_included: impl Fn(usize) -> bool,
) -> (DMatrix<f64>, DVector<f64>) {
    let some: Vec<usize> = (0..matrix.nrows())
        .filter(|&row| is_included(row))
        .collect();
    let part = matrix.select_rows(&some);
    let target = target.select_rows(&some);
    let turned = part.transpose();
    (&turned * &part, &turned * target)
}

/// The features with mean 0 and deviation 1, random functions of them, and a constant.
fn expanded(rows: &[Row], width: usize) -> DMatrix<f64> {
    let plain = width - RANDOM - 1;
    let count = rows.len() as f64;
    let scales: Vec<(f64, f64)> = (0..plain)
        .map(|place| {
            let values = || rows.iter().map(|row| row.features[place]);
            let mean = values().sum::<f64>() / count;
            let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
            (mean, variance.sqrt().max(f64::MIN_POSITIVE))
        })
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let size = 1.2 / (plain as f64).sqrt();
    let directions: Vec<(Vec<f64>, f64)> = (0..RANDOM)
        .map(|_| ((0..plain).map(|_| size * normal()).collect(), normal()))
        .collect();
    let each: Vec<Vec<f64>> = rows
        .par_iter()
        .map(|row| {
            let features = row.features.iter().zip(&scales);
            let mut all: Vec<f64> = features
                .map(|(value, (mean, deviation))| (value - mean) / deviation)
                .collect();
            let random = directions.iter().map(|(direction, offset)| {
                let along = direction.iter().zip(&all);
                (along.map(|(a, b)| a * b).sum::<f64>() + offset).tanh()
            });
            let random: Vec<f64> = random.collect();
            all.extend(random);
            all.push(1.0);
            all.iter_mut().for_each(|value| *value *= row.weight);
            all
        })
        .collect();
    DMatrix::from_fn(rows.len(), width, |row, place| each[row][place])
}

/// Evenly spread samples on which laws are compared.
fn rows(
    trajectories: &[Trajectory],
    left_out: &LeftOut,
    residual: &[Vec<f64>],
    history: &[History],
) -> Vec<Row> {
    let counts = |which: usize, sample: usize| {
        left_out.is_open(which, sample) && trajectories[which].is_telling(sample)
    };
    let places = || {
        let each = trajectories.iter().enumerate();
        each.flat_map(|(which, one)| (0..one.len()).map(move |sample| (which, sample)))
            .filter(|&(which, sample)| counts(which, sample))
    };
    let step = places().count().div_ceil(MOST_ROWS).max(1);
    places()
        .step_by(step)
        .map(|(which, sample)| {
            let trajectory = &trajectories[which];
            let weight = certainty(trajectory, sample).sqrt();
            let scale = weight / trajectory.force_rms;
            let carried = trajectory.carried.get(sample).copied().unwrap_or(0.0);
            Row {
                features: history[which].features(trajectory, sample),
                residual: scale * residual[which][sample],
                carried: scale * scale * carried,
                weight,
                place: (which, sample),
            }
        })
        .collect()
}

/// What a recording's motion was at each sample, and before it.
struct History {
    plays: Vec<Vec<f64>>,
    /// The last turning point and the one before, mm.
    turns: Vec<[f64; 2]>,
    /// Samples back in time.
    lags: Vec<usize>,
    /// The longest of them, s.
    longest: f64,
}

impl History {
    /// Of each trajectory, all with the same plays and lags.
    fn of(trajectories: &[Trajectory]) -> Vec<Self> {
        let each = trajectories.iter();
        let ranges = each.map(|one| least_and_largest(&one.motion.displacement));
        let size = ranges.fold(0.0_f64, |most, (low, high)| {
            most.max(low.abs()).max(high.abs())
        });
        let tick = trajectories
            .iter()
            .fold(0.0_f64, |most, one| most.max(one.tick));
        let blocks = trajectories.iter().flat_map(|one| &one.blocks);
        let slowest = blocks.fold(f64::INFINITY, |least, block| least.min(block.frequency));
        let duration = trajectories
            .iter()
            .fold(0.0_f64, |most, one| most.max(one.len() as f64 * one.tick));
        let longest = (0.5 / slowest).min(0.1 * duration).max(4.0 * tick);
        let between = |low: f64, high: f64, place: usize, count: usize| {
            low * (high / low).powf(place as f64 / (count - 1) as f64)
        };
        let of = |trajectory: &Trajectory| {
            let y = &trajectory.motion.displacement;
            let lags = (0..LAGS).map(|place| between(2.0 * tick, longest, place, LAGS));
            let plays = (0..PLAYS).map(|place| play(y, between(0.01, 1.0, place, PLAYS) * size));
            let plays: Vec<Vec<f64>> = plays.collect();
            Self {
                turns: turns(y, &plays[0], 0.01 * size),
                plays,
                lags: lags
                    .map(|lag| (lag / trajectory.tick).round() as usize)
                    .collect(),
                longest,
            }
        };
        trajectories.iter().map(of).collect()
    }

    fn features(&self, trajectory: &Trajectory, sample: usize) -> Vec<f64> {
        let motion = &trajectory.motion;
        let y = &motion.displacement;
        let now = [
            y[sample],
            motion.velocity[sample],
            motion.acceleration[sample],
        ];
        let plays = self.plays.iter().map(|play| play[sample]);
        let lags = self.lags.iter();
        let lags = lags.map(|&lag| y[sample] - y[sample.saturating_sub(lag)]);
        let [last, before] = self.turns[sample];
        let controls = trajectory.controls.iter();
        let controls = controls.map(|control| control.values[sample]);
        now.into_iter()
            .chain(plays)
            .chain(lags)
            .chain([y[sample] - last, last - before])
            .chain(controls)
            .collect()
    }
}

/// A play operator of this radius in mm: what a slider's spring is stretched by.
fn play(y: &[f64], radius: f64) -> Vec<f64> {
    let mut stretched = 0.0;
    let mut before = y.first().copied().unwrap_or_default();
    let each = y.iter().map(|&y| {
        stretched = f64::clamp(stretched + y - before, -radius, radius);
        before = y;
        stretched
    });
    each.collect()
}

/// The last turning point and the one before at each sample, mm. A turn counts once the motion has come back by two radii of `play`.
fn turns(y: &[f64], play: &[f64], radius: f64) -> Vec<[f64; 2]> {
    let start = y.first().copied().unwrap_or_default();
    let (mut last, mut before, mut way) = (start, start, 0.0);
    let each = y.iter().zip(play).map(|(&y, &stretched)| {
        // At its limit up to rounding.
        let limited = stretched.abs() >= 0.98 * radius;
        if limited && stretched.signum() != way {
            if way != 0.0 {
                (before, last) = (last, y);
            }
            way = stretched.signum();
        }
        [last, before]
    });
    each.collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::trace::split::Roles;
    use rand::RngExt;

    /// Twelve seconds of a motion of many lines at 500 Hz, with this noise of the displacement in mm.
    fn trajectory(seed: u64, noise: f64) -> Trajectory {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let lines: Vec<[f64; 3]> = (0..40)
            .map(|_| {
                let frequency = random.random_range(0.3..6.0);
                [
                    0.3 / (1.0 + frequency),
                    frequency,
                    random.random_range(0.0..TAU),
                ]
            })
            .collect();
        let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
        let displacement: Vec<f64> = (0..6000)
            .map(|sample| {
                let turn = TAU * f64::from(sample) / 500.0;
                let each = lines.iter();
                let y: f64 = each.map(|[a, f, phase]| a * (f * turn + phase).sin()).sum();
                y + noise * normal()
            })
            .collect();
        let force = displacement.iter().map(|y| 2.0 * y).collect();
        let mut trajectory = Trajectory::new("test", 2e-3, &displacement, force, None, None);
        // The residuals below are those of a perfect spring of 2 kN/mm.
        trajectory.carry_motion_error(|y, _, _| 2.0 * y);
        trajectory
    }

    fn share(trajectory: Trajectory, residual: impl Fn(&Trajectory) -> Vec<f64>) -> Explainable {
        let residual = [residual(&trajectory)];
        let trajectories = [trajectory];
        let roles = Roles::all_fit(&trajectories);
        let left_out = LeftOut::of(&trajectories, &roles);
        explainable(&trajectories, &left_out, &residual).expect("five stretches")
    }

    #[test]
    fn noise_is_not_explained_and_the_friction_beside_it_is() {
        for seed in 0..4 {
            let noise = |count: usize| {
                let mut random = ChaCha8Rng::seed_from_u64(seed + 100);
                let each = (0..count).map(move |_| StandardNormal.sample(&mut random));
                each.map(|draw: f64| 0.01 * draw)
            };
            let of_noise = share(trajectory(seed, 1e-5), |one| noise(one.len()).collect());
            assert!(!of_noise.counts(), "{of_noise:?}");
            // A slider of 0.02 kN and 0.03 mm: four fifths of the variance.
            let of_slider = share(trajectory(seed, 1e-5), |one| {
                let slider = play(&one.motion.displacement, 0.03).into_iter();
                slider
                    .zip(noise(one.len()))
                    .map(|(z, noise)| z / 0.03 * 0.02 + noise)
                    .collect()
            });
            assert!(of_slider.counts() && of_slider.share > 0.6, "{of_slider:?}");
        }
    }

    /// The features see the same noisy displacement that spoils the law's force.
    #[test]
    fn noise_of_the_displacement_is_not_explained() {
        for seed in 0..4 {
            let noisy = share(trajectory(seed, 4e-3), |one| {
                let pairs = one.force.iter().zip(&one.motion.displacement);
                pairs.map(|(force, y)| force - 2.0 * y).collect()
            });
            assert!(!noisy.counts(), "{noisy:?}");
        }
    }
}
