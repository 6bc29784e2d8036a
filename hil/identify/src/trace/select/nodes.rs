//! Eq 13 has coefficients at the amplitudes of the blocks: these nodes, and the error between them.

use std::sync::Arc;

use mesh_damper_model::predict::predict;
use mesh_damper_recording::cycles::{FoundBlock, levels, same_amplitude};
use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::strides;

use super::super::fitted::Fitted;
use super::super::split::{Role, Roles};
use super::{Search, Selection};
use crate::base_law::BaseLaw;
use crate::problem::Problem;
use crate::rows::{Purpose, Rows};
use crate::shape::Extent;
use crate::solution::Solution;
use crate::term::Term;

/// How well a law with coefficients at the amplitudes `nodes` predicts an amplitude that it was not fitted to. Each inner node in
/// turn is left out; returns the root of the summed squared error there, kN, or infinity if the crate refuses a law that was fitted so.
/// Samples that `roles` hold out are not used.
pub fn error_between(
    trajectories: &[Trajectory],
    roles: &Roles,
    nodes: &[f64],
    left_out: &[f64],
    (found, law): (&Solution, BaseLaw),
) -> f64 {
    let extent = Extent::of(trajectories);
    let is_open = |which, sample| roles.is_open(which, sample);
    let strides = Arc::new(strides(trajectories, Purpose::Search.rows(), is_open));
    let mut error = 0.0;
    for &amplitude in left_out {
        let is_left_out = |which: usize, sample: usize| {
            let trajectory: &Trajectory = &trajectories[which];
            same_amplitude(trajectory.amplitude[sample], amplitude)
        };
        let others = nodes
            .iter()
            .copied()
            .filter(|&node| node != amplitude)
            .collect();
        let is_fitted = |which, sample| roles.is_open(which, sample) && !is_left_out(which, sample);
        let rows = Rows::along(
            &strides,
            trajectories,
            law,
            others,
            Purpose::Search,
            is_fitted,
        );
        let model = Problem::new(&rows, &extent, &found.terms())
            .solve_near(found)
            .model();
        for (which, trajectory) in trajectories.iter().enumerate() {
            let Ok(predicted) = predict(&model, trajectory) else {
                return f64::INFINITY;
            };
            error += (0..trajectory.len())
                .filter(|&sample| roles.is_open(which, sample) && is_left_out(which, sample))
                .map(|sample| (predicted[sample] - trajectory.force[sample]).powi(2))
                .sum::<f64>();
        }
    }
    error.sqrt()
}

impl Search<'_> {
    /// Whether one set of coefficients that changes with the temperature predicts as well as `each`, which has one for each amplitude:
    /// the temperature then changed along with the amplitude. `law` has the same effects with one set, fitted by this search.
    pub fn warms_along(&self, each: &Selection, law: &Fitted) -> bool {
        let terms = self.terms.iter().copied();
        let warm: Vec<Term> = terms
            .filter(|term| term.form.family().depends_on_temperature())
            .collect();
        if warm.is_empty() {
            return false;
        }
        let warmed = self.beside(law, &warm, warm.len()).into_iter();
        let mut warmed = warmed.map(|(_, law, _)| law);
        warmed.any(|law| law.is_admissible() && !each.found.score.beats(&law.score))
    }
}

/// The levels of amplitude in mm of the fitted blocks. What is fitted of a block must move as far as its amplitude, or as the
/// block does if it grows to it: a part near zero, as the first cycle left out leaves it, does not determine k3 there.
pub fn amplitude_nodes(trajectories: &[Trajectory], roles: &Roles) -> Vec<f64> {
    let reaches = |which: usize, block: &FoundBlock| {
        let trajectory = &trajectories[which];
        let is_fitted = |&sample: &usize| {
            roles.of(which, sample) == Role::Fit && trajectory.is_comparable(sample)
        };
        let moved = |(low, high): (f64, f64)| high - low;
        let displacement = |sample: usize| trajectory.motion.displacement[sample];
        let all = block.samples.clone();
        let fitted = all.clone().filter(is_fitted).map(displacement);
        let [fitted, all] = [
            moved(least_and_largest(fitted)),
            moved(least_and_largest(all.map(displacement))),
        ];
        let least = all.min(2.0 * block.amplitude);
        fitted > least || same_amplitude(fitted, least)
    };
    let each = trajectories.iter().enumerate();
    levels(each.flat_map(|(which, trajectory)| {
        let fitted = trajectory.blocks.iter();
        let fitted = fitted.filter(move |block| reaches(which, block));
        fitted.map(|block| block.amplitude)
    }))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use mesh_damper_recording::Recording;

    use super::super::super::progress::Progress;
    use super::super::super::sought::Sought;
    use super::*;

    /// Blocks of three amplitudes at these temperatures, of a spring that loses 1 % per K.
    fn warmed(temperatures: [f64; 3]) -> Trajectory {
        const TICK: f64 = 2e-3;
        let at = |n: usize| {
            let sine = (TAU * 5.0 * TICK * n as f64).sin();
            ([0.1, 0.2, 0.4][n / 2000] * sine, temperatures[n / 2000])
        };
        let noise = |n: usize| 1e-3 * (n as f64 * 1.234_567).sin() * (n as f64 * 0.789).cos();
        let displacement: Vec<f64> = (0..6000).map(|n| at(n).0).collect();
        let force = (0..6000).map(|n| 2.0 * (1.2 - 0.01 * at(n).1) * at(n).0 + noise(n));
        let temperature = (0..6000).map(|n| at(n).1).collect();
        let (force, temperature) = (force.collect(), Some(temperature));
        Trajectory::new("warms", TICK, &displacement, force, None, temperature)
    }

    #[test]
    fn a_temperature_that_rises_with_the_amplitude_may_be_what_coefficients_over_it_show() {
        let sought = Sought::default();
        let warms_along = |temperatures: [f64; 3], seen: [f64; 3]| {
            let mut trajectories = [warmed(temperatures)];
            trajectories[0].temperature = warmed(seen).temperature;
            let mut roles = Roles::all_fit(&trajectories);
            roles.keep_apart(&trajectories, Role::Validation);
            let nodes = amplitude_nodes(&trajectories, &roles);
            let for_all = Search::new(&trajectories, &roles, vec![0.0], &sought);
            let each = for_all.with_nodes(nodes);
            let each = each.run(None, Progress::of(&|_| ())).unwrap();
            let weighted = for_all.beside_left(each.left.clone());
            let law = weighted.refit(&each.found.solution).unwrap();
            weighted.warms_along(&each, &law)
        };
        assert!(warms_along([20.0, 24.0, 30.0], [20.0, 24.0, 30.0]));
        assert!(!warms_along([20.0, 24.0, 30.0], [20.0, 35.0, 21.0]));
    }

    #[test]
    fn an_amplitude_of_which_only_a_part_is_fitted_has_no_coefficients() {
        let sine = |amplitude: f64| {
            (0..1000).map(move |n| amplitude * (TAU * 5.0 * f64::from(n) / 500.0).sin())
        };
        let displacement: Vec<f64> = sine(0.1).chain(sine(0.2)).collect();
        let force = displacement.iter().map(|y| 2.0 * y).collect();
        let time = (0..displacement.len()).map(|n| n as f64 / 500.0).collect();
        let recording = Recording::new("test", time, displacement, force).unwrap();
        let mut trajectories = [Trajectory::of(&recording).unwrap()];
        let nodes = |trajectories: &[Trajectory]| {
            let nodes = amplitude_nodes(trajectories, &Roles::all_fit(trajectories));
            nodes
                .into_iter()
                .map(|node| (10.0 * node).round() as i32)
                .collect::<Vec<_>>()
        };
        assert_eq!(nodes(&trajectories), [1, 2]);
        // What is left of the first block is near zero.
        trajectories[0].unsettled.push(0..985);
        assert_eq!(nodes(&trajectories), [2]);
    }
}
