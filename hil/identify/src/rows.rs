//! The samples of a fit.

use std::ops::Range;
use std::sync::Arc;

use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::Stride;

use super::base_law::BaseLaw;
use super::known_forces::KnownForces;
use super::tolerance::certainty_beside;

/// What a fit is for: how exact it has to be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// One of many in a search for effects.
    Search,
    /// Without one block or condition.
    InTurn,
    /// The result.
    Result,
}

impl Purpose {
    /// Such a fit uses at most about this many samples. Convention: a fit of a search takes a second then, all of those in turn take a few,
    /// and the result has a minute at 1 kHz.
    pub const fn rows(self) -> usize {
        match self {
            Self::Search => 4_000,
            Self::InTurn => 8_000,
            Self::Result => 60_000,
        }
    }
}

/// The samples of a fit, from several trajectories.
#[derive(Clone)]
pub struct Rows<'a> {
    pub(super) trajectories: &'a [Trajectory],
    /// Trajectory and sample of each row.
    pub(super) origin: Vec<(usize, usize)>,
    /// The samples of each trajectory at which effects are computed.
    pub(crate) strides: Arc<Vec<Vec<Stride>>>,
    /// What they are for.
    pub(super) purpose: Purpose,
    /// As recorded.
    pub(super) motion: RowMotion,
    pub(super) force: Vec<f64>,
    /// What the best law so far [leaves](Trajectory::left_beyond_tolerance) of each recording, kN².
    left: Vec<f64>,
    /// Square root of a row's weight. Every recording counts equally, whatever its length and strength, and each sample by its
    /// [`certainty`](super::tolerance::certainty).
    pub(super) weight: Vec<f64>,
    /// Amplitudes of the law's nodes, mm.
    pub(super) nodes: Vec<f64>,
    /// The base law.
    pub(super) law: BaseLaw,
    /// Forces of effects that see the motion as recorded.
    pub(super) known_forces: Arc<KnownForces>,
}

/// The inputs of eq 13 at each row.
#[derive(Clone, Debug, Default)]
pub(super) struct RowMotion {
    /// mm
    pub displacement: Vec<f64>,
    /// ln |v|
    pub log_speed: Vec<f64>,
    /// sgn v
    pub direction: Vec<f64>,
    /// Since the test began.
    pub cycles: Vec<f64>,
    /// °C
    pub temperature: Vec<f64>,
    /// The law's node at the row.
    pub node: Vec<usize>,
}

impl RowMotion {
    fn gather(trajectories: &[Trajectory], origin: &[(usize, usize)], nodes: &[f64]) -> Self {
        let mut rows = Self::default();
        for &(which, sample) in origin {
            let trajectory = &trajectories[which];
            let velocity = trajectory.motion.velocity[sample];
            rows.displacement
                .push(trajectory.motion.displacement[sample]);
            // The law has no force at rest: a motion below the smallest float counts as rest.
            rows.log_speed
                .push(velocity.abs().max(f64::MIN_POSITIVE).ln());
            rows.direction.push(if velocity == 0.0 {
                0.0
            } else {
                velocity.signum()
            });
            rows.cycles.push(trajectory.cycles[sample]);
            rows.temperature.push(trajectory.temperature_at(sample));
            rows.node.push(nearest(nodes, trajectory.amplitude[sample]));
        }
        rows
    }
}

impl<'a> Rows<'a> {
    /// Amplitudes in mm at which eq 13 has separate coefficients.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// Gathers the samples that `included(trajectory, sample)` picks, and keeps every n-th so that there are at most about `most`.
    /// `nodes` are the amplitudes in mm at which `law` has separate coefficients; each sample belongs to the nearest.
    ///
    /// Samples that are not [telling](Trajectory::is_telling) are left out: they would distort the fit.
    pub fn gather(
        trajectories: &'a [Trajectory],
        law: BaseLaw,
        nodes: Vec<f64>,
        most: usize,
        included: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let each = trajectories.iter().map(|one| Stride::each(one.len()));
        let strides = Arc::new(each.collect());
        Self::visited(&strides, trajectories, law, nodes, most, included)
    }

    /// The same from the samples that `strides` over each trajectory visit, for a fit that takes less time.
    pub(crate) fn along(
        strides: &Arc<Vec<Vec<Stride>>>,
        trajectories: &'a [Trajectory],
        law: BaseLaw,
        nodes: Vec<f64>,
        purpose: Purpose,
        included: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let most = purpose.rows();
        Self {
            purpose,
            ..Self::visited(strides, trajectories, law, nodes, most, included)
        }
    }

    fn visited(
        strides: &Arc<Vec<Vec<Stride>>>,
        trajectories: &'a [Trajectory],
        law: BaseLaw,
        nodes: Vec<f64>,
        most: usize,
        included: impl Fn(usize, usize) -> bool,
    ) -> Self {
        // With the number of samples that each stands for.
        let mut visited: Vec<((usize, usize), usize)> = Vec::new();
        for (which, (trajectory, strides)) in trajectories.iter().zip(strides.iter()).enumerate() {
            let telling = strides
                .iter()
                .flat_map(Stride::counted)
                .filter(|&(sample, _)| included(which, sample) && trajectory.is_telling(sample));
            visited.extend(telling.map(|(sample, count)| ((which, sample), count)));
        }
        let (origin, steps) = thinned(&visited, most);
        let force: Vec<f64> = origin
            .iter()
            .map(|&(which, sample)| trajectories[which].force[sample])
            .collect();

        let mut power = vec![0.0; trajectories.len()];
        for ((&(which, _), force), &step) in origin.iter().zip(&force).zip(&steps) {
            power[which] += step as f64 * force * force;
        }
        let mut weight: Vec<f64> = origin
            .iter()
            .zip(&steps)
            .map(|(&(which, _), &step)| {
                if power[which] > 0.0 {
                    (step as f64 / power[which]).sqrt()
                } else {
                    0.0
                }
            })
            .collect();
        let left: Vec<f64> = trajectories.iter().map(|one| one.unexplained).collect();
        weigh(&mut weight, &origin, |which, sample| {
            certainty_beside(left[which], &trajectories[which], sample)
        });
        Self {
            trajectories,
            strides: strides.clone(),
            purpose: Purpose::Result,
            motion: RowMotion::gather(trajectories, &origin, &nodes),
            origin,
            force,
            left,
            weight,
            nodes,
            law,
            known_forces: Arc::default(),
        }
    }

    /// The same without the nodes that no row belongs to: they would get no coefficients instead of those of the nearest node.
    #[must_use]
    pub fn with_nodes_seen(self) -> Self {
        let seen = |number: &usize| self.motion.node.contains(number);
        let nodes: Vec<f64> = (0..self.nodes.len())
            .filter(seen)
            .map(|number| self.nodes[number])
            .collect();
        if nodes.len() == self.nodes.len() {
            return self;
        }
        self.with_nodes(nodes)
    }

    /// The same rows with coefficients of eq 13 at other amplitudes, mm.
    #[must_use]
    pub fn with_nodes(&self, nodes: Vec<f64>) -> Self {
        Self {
            motion: RowMotion::gather(self.trajectories, &self.origin, &nodes),
            nodes,
            ..self.clone()
        }
    }

    /// What the law that the weights are for leaves of each recording, kN².
    pub fn left(&self) -> &[f64] {
        &self.left
    }

    /// The same rows weighed for a law that leaves another variance of each recording, kN².
    #[must_use]
    pub fn beside(&self, left: Vec<f64>) -> Self {
        let mut rows = self.clone();
        let before = std::mem::replace(&mut rows.left, left);
        let certainty = |left: &[f64], which: usize, sample: usize| {
            certainty_beside(left[which], &self.trajectories[which], sample)
        };
        weigh(&mut rows.weight, &self.origin, |which, sample| {
            certainty(&rows.left, which, sample) / certainty(&before, which, sample)
        });
        rows
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.force.len()
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.force.is_empty()
    }

    /// Displacement mm, velocity mm/s and force kN of the rows of one node.
    pub fn channels(&self, node: usize) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let of_node = (0..self.len()).filter(|&index| self.motion.node[index] == node);
        let rows = of_node.map(|index| {
            let velocity = self.motion.direction[index] * self.motion.log_speed[index].exp();
            (self.motion.displacement[index], velocity, self.force[index])
        });
        rows.collect()
    }

    /// The inputs of eq 13 at the rows when the motion is that of `moved` instead of the recorded one.
    pub(super) fn motion_in(&self, moved: &[Trajectory]) -> RowMotion {
        RowMotion::gather(moved, &self.origin, &self.nodes)
    }

    /// The same at these samples of one trajectory.
    pub(super) fn motion_at(&self, moved: &Trajectory, samples: Range<usize>) -> RowMotion {
        let origin: Vec<(usize, usize)> = samples.map(|sample| (0, sample)).collect();
        RowMotion::gather(std::slice::from_ref(moved), &origin, &self.nodes)
    }

    /// Whether a channel shows averages.
    pub(super) fn are_averaged(&self) -> bool {
        let mut each = self.trajectories.iter();
        each.any(|trajectory| trajectory.average.is_some())
    }

    /// The readings of the channels at the rows, for a force known at every sample of every trajectory.
    pub(super) fn shown(&self, per_trajectory: Vec<Vec<f64>>) -> Vec<f64> {
        let shown = self.trajectories.iter().zip(per_trajectory);
        let shown: Vec<Vec<f64>> = shown
            .map(|(trajectory, force)| trajectory.shown(force))
            .collect();
        self.pick(&shown)
    }

    /// The rate of change per s at the rows, of values at every sample of every trajectory.
    pub(super) fn rate_of(&self, per_trajectory: &[Vec<f64>]) -> Vec<f64> {
        let rate = |&(which, sample): &(usize, usize)| {
            let (values, tick) = (&per_trajectory[which], self.trajectories[which].tick);
            let (before, after) = (sample.saturating_sub(1), (sample + 1).min(values.len() - 1));
            (values[after] - values[before]) / ((after - before) as f64 * tick)
        };
        self.origin.iter().map(rate).collect()
    }

    /// The values at the rows, from values at every sample of every trajectory.
    pub(super) fn pick(&self, per_trajectory: &[Vec<f64>]) -> Vec<f64> {
        self.origin
            .iter()
            .map(|&(which, sample)| per_trajectory[which][sample])
            .collect()
    }
}

/// At most about `most` rows of those `visited`, at equal distances in time where the steps to them are shorter, each with the number of
/// samples that it then stands for.
fn thinned(visited: &[((usize, usize), usize)], most: usize) -> (Vec<(usize, usize)>, Vec<usize>) {
    let samples: usize = visited.iter().map(|(_, count)| count).sum();
    let every = samples.div_ceil(most).max(1);
    let (mut origin, mut steps): (Vec<(usize, usize)>, Vec<usize>) = Default::default();
    for of_one in visited.chunk_by(|(a, _), (b, _)| a.0 == b.0) {
        // Samples of the recording before this row, and before the next one that is kept.
        let (mut before, mut next) = (0, 0);
        for &(row, count) in of_one {
            if before >= next {
                origin.push(row);
                steps.push(0);
                next = before - before % every + every;
            }
            if let Some(stands_for) = steps.last_mut() {
                *stands_for += count;
            }
            before += count;
        }
    }
    (origin, steps)
}

/// Multiplies the squares of weights by `factor`, then all so that they are 1 on average and residuals stay in kN.
fn weigh(weight: &mut [f64], origin: &[(usize, usize)], factor: impl Fn(usize, usize) -> f64) {
    for (weight, &(which, sample)) in weight.iter_mut().zip(origin) {
        *weight *= factor(which, sample).sqrt();
    }
    let mean_square = weight.iter().map(|w| w * w).sum::<f64>() / origin.len().max(1) as f64;
    let each = weight.iter_mut();
    each.for_each(|weight| *weight /= mean_square.sqrt());
}

fn nearest(nodes: &[f64], amplitude: f64) -> usize {
    (0..nodes.len())
        .min_by(|&a, &b| {
            (nodes[a] - amplitude)
                .abs()
                .total_cmp(&(nodes[b] - amplitude).abs())
        })
        .unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use mesh_damper_recording::trajectory::strides::strides;

    use super::*;

    /// Steps of 16 samples, then of one.
    fn slow_then_fast() -> Vec<((usize, usize), usize)> {
        let slow = (0..100).map(|n| ((0, 16 * n), 16));
        slow.chain((1600..3200).map(|n| ((0, n), 1))).collect()
    }

    #[test]
    fn rows_are_thinned_by_time_and_none_is_lost() {
        let visited = slow_then_fast();
        let samples: usize = visited.iter().map(|(_, count)| count).sum();
        for most in [3200, 400, 200, 100, 7] {
            let (origin, steps) = thinned(&visited, most);
            assert_eq!(steps.iter().sum::<usize>(), samples, "{most}");
            let every = samples.div_ceil(most).max(16);
            let slow = origin.iter().filter(|(_, sample)| *sample < 1600).count();
            assert_eq!(slow, 1600_usize.div_ceil(every), "{most}");
            assert!(origin.len() <= most);
            let longest = steps.iter().max().unwrap();
            assert!(*longest < every + 16, "{most}: {longest}");
        }
        let two = [0, 1]
            .into_iter()
            .flat_map(|which| (0..5).map(move |n| ((which, n), 1)));
        let (origin, steps) = thinned(&two.collect::<Vec<_>>(), 4);
        assert_eq!(origin, [(0, 0), (0, 3), (1, 0), (1, 3)]);
        assert_eq!(steps, [3, 2, 3, 2], "each recording keeps its samples");
    }

    /// A slow and a fast sine of equal length, each sample of which counts the same along strides.
    #[test]
    fn along_strides_each_stretch_of_time_has_its_weight() {
        const TICK: f64 = 5e-4;
        let displacement: Vec<f64> = (0..32_000)
            .map(|n| {
                let hertz = if n < 16_000 { 0.5 } else { 25.0 };
                0.5 * (TAU * hertz * TICK * f64::from(n)).sin()
            })
            .collect();
        let force = displacement.clone();
        let trajectory = Trajectory::new("two", TICK, &displacement, force, None, None);
        let trajectories = [trajectory];
        let along = Arc::new(strides(&trajectories, 1000, |_, _| true));
        let fast = |stride: &Stride| stride.samples.start >= 16_000 && stride.step == 1;
        assert!(along[0].iter().any(fast) && along[0].iter().any(|stride| stride.step == 32));
        let rows = Rows::along(
            &along,
            &trajectories,
            BaseLaw::Mixed,
            vec![0.5],
            Purpose::Search,
            |_, _| true,
        );
        let weight = |is_slow: bool| -> f64 {
            let rows = rows.origin.iter().zip(&rows.weight);
            let some = rows.filter(|((_, sample), _)| (*sample < 16_000) == is_slow);
            some.map(|(_, weight)| weight * weight).sum()
        };
        assert!((weight(true) / weight(false) - 1.0).abs() < 0.02);
    }

    #[test]
    fn weights_beside_another_law_are_those_of_rows_gathered_for_it() {
        let noise = |n: i32, seed: f64| 2e-3 * (seed * f64::from(n)).sin();
        let moved = |n: i32| (0.01 * f64::from(n)).sin() + noise(n, 1.1e3);
        let displacement: Vec<f64> = (0..4000).map(moved).collect();
        let force = (0..4000).map(|n| (0.01 * f64::from(n)).sin() + noise(n, 1.3e3));
        let force = force.collect();
        let mut trajectory = Trajectory::new("sine", 1e-3, &displacement, force, None, None);
        // Steep where it turns.
        trajectory.carry_motion_error(|_, v, _| v.signum() * v.abs().powf(0.2));
        let gathered = |trajectories: &[Trajectory], left: Option<f64>| {
            let rows = Rows::gather(trajectories, BaseLaw::Mixed, vec![1.0], 500, |_, _| true);
            let rows = left.map_or(rows.clone(), |left| rows.beside(vec![left]));
            rows.weight
        };
        let mut lacks = trajectory.clone();
        lacks.unexplained = 0.3;
        let (before, after) = (
            gathered(&[trajectory.clone()], None),
            gathered(&[lacks], None),
        );
        assert!(
            before
                .iter()
                .zip(&after)
                .any(|(a, b)| (a / b - 1.0).abs() > 0.01)
        );
        let beside = gathered(&[trajectory], Some(0.3));
        for (beside, after) in beside.iter().zip(&after) {
            assert!((beside / after - 1.0).abs() < 1e-12, "{beside} {after}");
        }
    }
}
