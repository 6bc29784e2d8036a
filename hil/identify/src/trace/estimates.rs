//! The description of a law in `trace.json`: its coefficients, its effects, and all candidates.

use mesh_damper_model::{Family, Model, ModelError, parameter_unit};
use rayon::prelude::*;

use super::closing::Closing;
use super::result::{Candidate, Estimate, FoundEffect, LawEstimate};
use super::rule::Rule;
use super::select::Selection;
use super::separating::Rivals;
use crate::rows::Rows;
use crate::solution::Solution;
use crate::term::effects_of;
use crate::uncertainty::{Interval, Uncertainty};

impl Closing<'_> {
    /// The effects of `solution` with their intervals, each with the held-out error without it; `with` is the error with all of
    /// them.
    pub(super) fn effects(
        &self,
        rows: &Rows,
        solution: &Solution,
        uncertainty: &Uncertainty,
        with: f64,
    ) -> Result<Vec<FoundEffect>, ModelError> {
        let estimate = |(name, interval): (&'static str, Interval)| {
            let unit = parameter_unit(name).unwrap_or_default().to_owned();
            let Interval { value, low, high } = interval;
            let estimate = Estimate {
                value,
                low,
                high,
                unit,
            };
            (name, estimate)
        };
        let terms = solution.terms.iter().zip(&uncertainty.terms);
        let terms = terms.filter(|(value, _)| !value.term.is_known);
        let estimates = terms.flat_map(|(value, uncertainty)| {
            let elements = uncertainty.elements(value).into_iter();
            elements.map(|parameters| {
                let parameters = parameters.into_iter().map(estimate).collect();
                (value.term.form, parameters)
            })
        });
        effects_of(estimates.collect())
            .into_iter()
            .map(|(family, parameters)| {
                Ok(FoundEffect {
                    family: family.name().to_owned(),
                    parameters,
                    nrmse_without: self.without(rows, solution, family)?,
                    nrmse_with: with,
                    unconfirmed_by: None,
                    rivals: Vec::new(),
                })
            })
            .collect()
    }

    /// The effects that the data cannot distinguish from the preferred one, each fitted in its place.
    pub(super) fn of_rivals(
        &self,
        rows: &Rows,
        rivals: &Rivals,
    ) -> Result<Vec<FoundEffect>, ModelError> {
        let mut effects = Vec::new();
        for (family, law) in rivals.laws.iter().skip(1) {
            let solution = self.fit_near(rows, law);
            let uncertainty = Uncertainty::of(rows, self.extent(), &solution);
            let with = self.held_out(&solution.model())?;
            let of_family = |effect: &FoundEffect| effect.family == family.name();
            effects.extend(
                self.effects(rows, &solution, &uncertainty, with)?
                    .into_iter()
                    .filter(of_family),
            );
        }
        Ok(effects)
    }

    /// All candidates. Of the added ones, `found` remains after the fit to all open samples.
    pub(super) fn candidates(
        &self,
        selection: &Selection,
        found: &Solution,
    ) -> Result<Vec<Candidate>, ModelError> {
        let left: Vec<Family> = found
            .terms
            .iter()
            .map(|value| value.term.form.family())
            .collect();
        selection
            .candidates
            .par_iter()
            .map(|candidate| {
                let model = candidate.fitted.solution.model();
                let vanishes = candidate.added && !left.contains(&candidate.family);
                let rule = candidate.rejected_by;
                Ok(Candidate {
                    family: candidate.family.name().to_owned(),
                    nrmse_held_out: self.held_out(&model)?,
                    distinguishable: candidate.distinguishable,
                    step: candidate.step,
                    added: candidate.added,
                    admissible: candidate.admissible,
                    rejected_by: rule.or(vanishes.then_some(Rule::Vanishes)),
                    nrmse_judged: candidate.fitted.score.nrmse(),
                })
            })
            .collect()
    }
}

/// Eq 13's coefficients with their intervals.
pub(super) fn law_estimates(model: &Model, uncertainty: &Uncertainty) -> Vec<LawEstimate> {
    model
        .law
        .iter()
        .zip(&uncertainty.law)
        .map(|(node, half)| {
            let estimate = |value: f64, half: f64, unit: &str| Estimate {
                value,
                low: value - half,
                high: value + half,
                unit: unit.to_owned(),
            };
            LawEstimate {
                amplitude: node.amplitude,
                k1: estimate(node.k1, half[0], "kN/mm"),
                k3: estimate(node.k3, half[1], "kN/mm^3"),
                c: estimate(node.c, half[2], "kN*(s/mm)^alpha"),
                alpha: estimate(node.alpha, half[3], "1"),
            }
        })
        .collect()
}
