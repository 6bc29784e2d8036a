//! The samples that a fit is made to.

use super::solution::Solution;
use super::term::Term;
use crate::recording::trajectory::Trajectory;

/// The samples of a fit, gathered from several trajectories.
pub struct Rows<'a> {
    pub(super) trajectories: &'a [Trajectory],
    /// Trajectory and sample of each row.
    pub(super) origin: Vec<(usize, usize)>,
    pub(super) displacement: Vec<f64>,
    /// ln |v|
    pub(super) log_speed: Vec<f64>,
    pub(super) direction: Vec<f64>,
    pub(super) temperature: Vec<f64>,
    pub(super) force: Vec<f64>,
    pub(super) node: Vec<usize>,
    /// Square root of a row's weight: every recording counts the same, however long or strong it is.
    pub(super) weight: Vec<f64>,
    /// Amplitudes of the law's nodes, mm.
    pub(super) nodes: Vec<f64>,
}

impl<'a> Rows<'a> {
    /// Gathers the samples that `included(trajectory, sample)` picks. `nodes` are the amplitudes in mm at which eq 13 has
    /// coefficients of its own; each sample is of the nearest.
    ///
    /// Samples that are not [telling](Trajectory::is_telling) are left out: they would bend the fit.
    pub fn gather(
        trajectories: &'a [Trajectory],
        nodes: Vec<f64>,
        included: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let mut rows = Self {
            trajectories,
            origin: Vec::new(),
            displacement: Vec::new(),
            log_speed: Vec::new(),
            direction: Vec::new(),
            temperature: Vec::new(),
            force: Vec::new(),
            node: Vec::new(),
            weight: Vec::new(),
            nodes,
        };
        for (which, trajectory) in trajectories.iter().enumerate() {
            let first = rows.len();
            let motion = &trajectory.motion;
            for index in 0..trajectory.len() {
                if !trajectory.is_telling(index) || !included(which, index) {
                    continue;
                }
                rows.origin.push((which, index));
                rows.displacement.push(motion.displacement[index]);
                rows.log_speed.push(motion.velocity[index].abs().ln());
                rows.direction.push(motion.velocity[index].signum());
                rows.temperature.push(trajectory.temperature_at(index));
                rows.force.push(trajectory.force[index]);
                rows.node
                    .push(nearest(&rows.nodes, trajectory.amplitude[index]));
            }
            let power: f64 = rows.force[first..].iter().map(|force| force * force).sum();
            rows.weight.resize(
                rows.len(),
                if power > 0.0 {
                    power.sqrt().recip()
                } else {
                    0.0
                },
            );
        }
        // On average 1, so that residuals stay in kN.
        let mean_square = rows.weight.iter().map(|w| w * w).sum::<f64>() / rows.len().max(1) as f64;
        rows.weight
            .iter_mut()
            .for_each(|weight| *weight /= mean_square.sqrt());
        rows
    }

    /// Evenly picked rows, at most about `most` of them.
    #[must_use]
    pub fn thinned(mut self, most: usize) -> Self {
        let every = self.len().div_ceil(most).max(1);
        let pick = |index: usize| index.is_multiple_of(every);
        fn retain<T>(values: &mut Vec<T>, pick: impl Fn(usize) -> bool) {
            let mut index = 0;
            values.retain(|_| {
                index += 1;
                pick(index - 1)
            });
        }
        retain(&mut self.origin, pick);
        retain(&mut self.node, pick);
        for channel in [
            &mut self.displacement,
            &mut self.log_speed,
            &mut self.direction,
            &mut self.temperature,
            &mut self.force,
            &mut self.weight,
        ] {
            retain(channel, pick);
        }
        self
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.force.len()
    }

    /// No sample at all.
    pub fn is_empty(&self) -> bool {
        self.force.is_empty()
    }

    /// Displacement mm, velocity mm/s and force kN of the rows of one node.
    pub fn channels(&self, node: usize) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let of_node = (0..self.len()).filter(|&index| self.node[index] == node);
        let rows = of_node.map(|index| {
            let velocity = self.direction[index] * self.log_speed[index].exp();
            (self.displacement[index], velocity, self.force[index])
        });
        rows.collect()
    }

    /// y, y³ and |v|^α·sgn v at a row, times `scale`.
    pub(super) fn law_row(&self, index: usize, alpha: f64, scale: f64) -> [f64; 3] {
        let y = self.displacement[index];
        let damping = self.direction[index] * (alpha * self.log_speed[index]).exp();
        [scale * y, scale * y * y * y, scale * damping]
    }

    /// The force of `term` with size 1 at every row. The history that it depends on is that of the whole trajectories.
    pub(super) fn unit_force(&self, term: &Term, shape: f64) -> Vec<f64> {
        let per_trajectory: Vec<Vec<f64>> = self
            .trajectories
            .iter()
            .map(|trajectory| {
                // A shape at the end of its range may be refused at this tick; the term then has no force.
                term.unit_force(shape, trajectory)
                    .unwrap_or_else(|_| vec![0.0; trajectory.len()])
            })
            .collect();
        self.origin
            .iter()
            .map(|&(trajectory, sample)| per_trajectory[trajectory][sample])
            .collect()
    }

    /// Weighted difference of the force of `solution` from the measured one at every row, kN.
    pub(super) fn residuals(&self, solution: &Solution) -> Vec<f64> {
        let added: Vec<(f64, Vec<f64>)> = solution
            .terms
            .iter()
            .filter(|value| value.term.size_name().is_some())
            .map(|value| (value.size, self.unit_force(&value.term, value.shape)))
            .collect();
        (0..self.len())
            .map(|index| {
                let node = &solution.law[self.node[index]];
                let [y, y3, damping] = self.law_row(index, node.alpha, solution.scale(self, index));
                let law = node.k1 * y + node.k3 * y3 + node.c * damping;
                let effects: f64 = added.iter().map(|(size, unit)| size * unit[index]).sum();
                self.weight[index] * (law + effects - self.force[index])
            })
            .collect()
    }
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
