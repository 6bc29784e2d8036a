//! The result of a fit.

use mesh_damper_model::predict::{predict, predict_along, run};
use mesh_damper_model::{Family, LawNode, Model, ModelError};
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::trajectory::strides::Stride;

use super::families::Form;
use super::term::{Term, TermValue, added_effects};

/// The result of a fit.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Eq 13 at each node.
    pub law: Vec<LawNode>,
    /// The added terms.
    pub terms: Vec<TermValue>,
    /// Exponents of the nodes, then the searched parameters of the terms: the sizes of terms that scale eq 13, and logarithms of
    /// shapes.
    pub(super) search: Vec<f64>,
    /// Sum of the squared weighted errors, kN².
    pub squares: f64,
}

impl Solution {
    /// The model that the crate runs.
    pub fn model(&self) -> Model {
        Model {
            law: self.law.clone(),
            effects: added_effects(&self.terms),
            correction: None,
            controls: Vec::new(),
        }
    }

    /// Its force on each of `trajectories`, kN. It is computed each time: the forces of all laws that were tried would take more
    /// memory than the recordings.
    ///
    /// # Errors
    /// A law that the crate refuses.
    pub fn predicted(&self, trajectories: &[Trajectory]) -> Result<Vec<Vec<f64>>, ModelError> {
        let model = self.model();
        let each = trajectories.iter();
        each.map(|trajectory| predict(&model, trajectory)).collect()
    }

    /// The same at the samples that `strides` over each trajectory visit, at least.
    ///
    /// # Errors
    /// As [`predicted`](Self::predicted).
    pub fn predicted_along(
        &self,
        trajectories: &[Trajectory],
        strides: &[Vec<Stride>],
    ) -> Result<Vec<Vec<f64>>, ModelError> {
        let mut terms = self.terms.iter().map(|value| value.term.form);
        let counts_ticks = terms.any(Form::counts_ticks);
        let model = self.model();
        let each = trajectories.iter().zip(strides);
        let each = each.map(|(trajectory, strides)| {
            if counts_ticks || trajectory.average.is_some() {
                return predict(&model, trajectory);
            }
            predict_along(&model, trajectory, strides)
        });
        each.collect()
    }

    /// The added terms, whatever their values.
    pub fn terms(&self) -> Vec<Term> {
        self.terms.iter().map(|value| value.term).collect()
    }

    /// The solution without one of its terms, while the other parameters stay unchanged.
    #[must_use]
    pub fn without(&self, index: usize) -> Self {
        let mut rest = self.clone();
        let before: usize = self.terms[..index]
            .iter()
            .map(|value| value.term.form.searched())
            .sum();
        let from = self.law.len() + before;
        rest.search
            .drain(from..from + self.terms[index].term.form.searched());
        rest.terms.remove(index);
        rest
    }

    /// The solution without the terms of one family that were not known before.
    #[must_use]
    pub fn without_family(&self, family: Family) -> Self {
        let mut rest = self.clone();
        let of_family =
            |value: &TermValue| !value.term.is_known && value.term.form.family() == family;
        while let Some(index) = rest.terms.iter().position(of_family) {
            rest = rest.without(index);
        }
        rest
    }

    /// The terms that were not known before.
    pub fn found(&self) -> impl Iterator<Item = &TermValue> {
        self.terms.iter().filter(|value| !value.term.is_known)
    }

    /// Whether it has no such term.
    pub fn is_alone(&self) -> bool {
        self.found().next().is_none()
    }

    /// The families of these terms, each once.
    pub fn families(&self) -> Vec<Family> {
        let mut families: Vec<Family> = Vec::new();
        for value in self.found() {
            let family = value.term.form.family();
            if !families.contains(&family) {
                families.push(family);
            }
        }
        families
    }

    /// k1, k3 and c of every node, then the sizes of the terms that add a force.
    pub(super) fn linear(&self) -> Vec<f64> {
        let law = self.law.iter().flat_map(|node| [node.k1, node.k3, node.c]);
        let added = self
            .terms
            .iter()
            .filter(|value| value.term.fitted_sizes() > 0);
        law.chain(added.flat_map(|value| value.sizes.iter().copied()))
            .collect()
    }

    /// The deflection of the spring in series, trajectory by trajectory. If there is no such spring yet, the deflection of one with
    /// 1 kN/mm under this law's force.
    pub(super) fn deflections(&self, trajectories: &[Trajectory]) -> Vec<Deflection> {
        let spring = self.terms.iter().find(|value| value.term.form.gives_way);
        let stiffness = spring.map_or(1.0, |value| value.shapes[0]);
        let model = self.model();
        trajectories
            .iter()
            .map(|trajectory| {
                let tick = trajectory.tick;
                let deflection = if spring.is_some() {
                    let seen = run(&model, trajectory, |_, state| state.behind_spring());
                    let seen = seen.unwrap_or_default();
                    let velocity = &trajectory.motion.velocity;
                    seen.into_iter()
                        .zip(velocity)
                        .map(|(seen, velocity)| {
                            let (deflection, inner) = seen.unwrap_or((0.0, *velocity));
                            (deflection, velocity - inner)
                        })
                        .collect()
                } else {
                    let force = run(&model, trajectory, |force, _| force);
                    with_rates(&force.unwrap_or_default(), tick)
                };
                Deflection {
                    stiffness,
                    deflection,
                }
            })
            .collect()
    }
}

/// The deflection of a spring in series.
#[derive(Clone, Debug)]
pub(super) struct Deflection {
    /// Stiffness of the spring, kN/mm.
    pub stiffness: f64,
    /// Deflection in mm and its rate in mm/s at every sample; empty if the crate refuses the law.
    pub deflection: Vec<(f64, f64)>,
}

fn with_rates(values: &[f64], tick: f64) -> Vec<(f64, f64)> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|index| {
            let (before, after) = (index.saturating_sub(1), (index + 1).min(last));
            let span = (after - before).max(1) as f64 * tick;
            (values[index], (values[after] - values[before]) / span)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use mesh_damper_recording::trajectory::strides::strides;

    use super::*;

    /// A spring in series holds deflections of earlier ticks, and a delay counts them.
    #[test]
    fn a_law_that_counts_ticks_is_run_at_every_sample() {
        let moved =
            |n: i32| 0.2 * (TAU * f64::from(n) / if n < 4000 { 1000.0 } else { 50.0 }).sin();
        let displacement: Vec<f64> = (0..5000).map(moved).collect();
        let force = displacement.clone();
        let trajectory = Trajectory::new("two", 1e-3, &displacement, force, None, None);
        let all = [trajectory];
        let few = strides(&all, 1, |_, _| true);
        let law = |form: &str, shapes: &[f64], sizes: &[f64]| Solution {
            law: vec![LawNode {
                amplitude: 0.0,
                k1: 2.0,
                k3: 1.0,
                c: 0.05,
                alpha: 0.5,
            }],
            terms: vec![TermValue {
                term: Term::sought(Form::named(form).unwrap(), 0.0),
                sizes: sizes.to_vec(),
                shapes: shapes.to_vec(),
            }],
            search: Vec::new(),
            squares: 0.0,
        };
        for (form, shapes, sizes) in [
            ("compliance", &[5.0][..], &[][..]),
            ("delay", &[2.5e-3], &[]),
            ("force_filter", &[30.0], &[]),
            ("periodic", &[7.0], &[0.1, 0.05]),
        ] {
            let law = law(form, shapes, sizes);
            let along = law.predicted_along(&all, &few).unwrap();
            assert_eq!(along, law.predicted(&all).unwrap(), "{form}");
        }
        let slides = law("jenkins", &[0.05], &[1.0]);
        let along = slides.predicted_along(&all, &few).unwrap();
        assert_ne!(along, slides.predicted(&all).unwrap());
    }
}
