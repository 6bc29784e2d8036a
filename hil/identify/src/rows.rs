//! The samples of a fit.

use std::ops::Range;
use std::sync::Arc;

use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::Stride;

use super::base_law::BaseLaw;
use super::known_forces::KnownForces;
use super::tolerance::certainty_beside;

/// A fit in the search for effects, or for a residual table, uses at most about this many samples. Convention: a fit then takes a
/// second.
pub(crate) const SEARCH_ROWS: usize = 4_000;

/// The samples of a fit, from several trajectories.
#[derive(Clone)]
pub struct Rows<'a> {
    pub(super) trajectories: &'a [Trajectory],
    /// Trajectory and sample of each row.
    pub(super) origin: Vec<(usize, usize)>,
    /// The samples of each trajectory at which effects are computed.
    pub(crate) strides: Arc<Vec<Vec<Stride>>>,
    /// Whether those are not all of them.
    pub(super) are_coarse: bool,
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
        Self {
            are_coarse: false,
            ..Self::along(&strides, trajectories, law, nodes, most, included)
        }
    }

    /// The same from the samples that `strides` over each trajectory visit, for a fit that takes less time.
    pub(crate) fn along(
        strides: &Arc<Vec<Vec<Stride>>>,
        trajectories: &'a [Trajectory],
        law: BaseLaw,
        nodes: Vec<f64>,
        most: usize,
        included: impl Fn(usize, usize) -> bool,
    ) -> Self {
        // With the number of samples that each stands for.
        let mut origin: Vec<((usize, usize), usize)> = Vec::new();
        for (which, (trajectory, strides)) in trajectories.iter().zip(strides.iter()).enumerate() {
            let telling = strides
                .iter()
                .flat_map(Stride::counted)
                .filter(|&(sample, _)| included(which, sample) && trajectory.is_telling(sample));
            origin.extend(telling.map(|(sample, count)| ((which, sample), count)));
        }
        let every = origin.len().div_ceil(most).max(1);
        let (origin, steps): (Vec<(usize, usize)>, Vec<usize>) =
            origin.into_iter().step_by(every).unzip();
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
            are_coarse: true,
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

    /// The values at the rows, from values at every sample of every trajectory.
    pub(super) fn pick(&self, per_trajectory: &[Vec<f64>]) -> Vec<f64> {
        self.origin
            .iter()
            .map(|&(which, sample)| per_trajectory[which][sample])
            .collect()
    }
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
