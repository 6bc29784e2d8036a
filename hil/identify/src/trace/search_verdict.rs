//! What follows from a search: whether its law explains the recordings.

use mesh_damper_model::predict::{NINETY_PERCENT, predict};
use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::trajectory::strides::Stride;
use rayon::prelude::*;

use super::adopt::clearly_best;
use super::closing::Closing;
use super::left_out::{LeftOut, Samples};
use super::relative_error::RelativeError;
use super::result::Verdict;
use super::rule::Rule;
use super::score::ValidationSamples;
use super::select::{self, Selection};
use super::split::Role;
use super::verdict::{accounts_for, conclude, generalises, rivals};
use super::witness::{Explainable, explainable};
use crate::solution::Solution;
use crate::tolerance::goal;

/// The conclusions about a search.
pub(super) struct Concluded {
    pub verdict: Verdict,
    /// Error of the result, as a multiple of the noise.
    pub left: f64,
    /// The reason why the result does not explain the recordings, if it does not.
    pub effects_rejected_by: Option<Rule>,
    /// How much of the result's residual can be predicted; `None` if more is missing.
    pub explainable: Option<Explainable>,
    /// The errors of the result on conditions left out of its fit; none if more is missing.
    pub in_turn: Vec<RelativeError>,
}

impl Closing<'_> {
    /// The conclusions about a search that ended in `solution`, from all open samples and from blocks that were left out.
    pub(super) fn verdict(
        &self,
        selection: &Selection,
        left_out: &LeftOut,
        [alone, solution]: [&Solution; 2],
    ) -> Result<Concluded, ModelError> {
        let of_validation = selection.found.score.nrmse() / selection.goal;
        let left_by_solution = left_out.left_by(&solution.model())?;
        let left = left_by_solution.in_most().unwrap_or(of_validation);
        let (verdict, effects_rejected_by) = conclude(selection, solution.is_alone(), left);
        let unlisted = |effects_rejected_by| Concluded {
            verdict: Verdict::Unlisted,
            left,
            effects_rejected_by,
            explainable: None,
            in_turn: Vec::new(),
        };
        if verdict == Verdict::Unlisted {
            return Ok(unlisted(effects_rejected_by));
        }
        let explainable = self.witness(left_out, &solution.model())?;
        if explainable.is_some_and(|one| one.counts()) {
            let rule = (!solution.is_alone()).then_some(Rule::Predictable);
            return Ok(unlisted(rule));
        }
        let explained = |in_turn| Concluded {
            verdict,
            left,
            effects_rejected_by,
            explainable,
            in_turn,
        };
        let in_turn = |law| match left_out.are_motions() {
            true => left_out.in_turn(Samples::Telling, &|picked| {
                Ok(self.refit_model(&self.rows[0], law, picked))
            }),
            false => vec![self.on_validation(law)],
        };
        if solution.is_alone() {
            return Ok(explained(in_turn(solution)));
        }
        let left_by_alone = left_out.left_by(&alone.model())?;
        let accounts = match (
            left_by_alone.beyond_noise(),
            left_by_solution.beyond_noise(),
        ) {
            (Some(alone), Some(left)) => accounts_for(alone, left),
            _ => true,
        };
        if !accounts {
            return Ok(unlisted(Some(Rule::AccountsForTooLittle)));
        }
        let of_solution = in_turn(solution);
        Ok(match generalises(&in_turn(alone), &of_solution) {
            true => explained(of_solution),
            false => unlisted(Some(Rule::UnknownElsewhere)),
        })
    }

    /// The error of a law on the validation cycles when it is fitted to the others: with too few motions, leaving one out would ask for
    /// what the recordings do not show.
    fn on_validation(&self, law: &Solution) -> RelativeError {
        let model = self.refit_model(&self.rows[0], law, &|which, sample| {
            self.validation.of(which, sample) == Role::Fit
        });
        let all = self.trajectories;
        let each: Vec<Vec<Stride>> = all.iter().map(|one| Stride::each(one.len())).collect();
        let samples = ValidationSamples::of(all, &each, self.validation, Role::Validation);
        let predicted = all.iter().map(|trajectory| predict(&model, trajectory));
        // Without those samples the fit may have a law that the crate refuses.
        let Ok(predicted) = predicted.collect::<Result<Vec<_>, ModelError>>() else {
            return RelativeError::NONE;
        };
        let error = samples.score(&predicted).nrmse().powi(2);
        RelativeError {
            error,
            noise: goal(samples.noise()).powi(2),
            most: NINETY_PERCENT.powi(2) * error,
        }
    }

    /// How much of the residual of `model` can be predicted; `None` if all conditions are one motion, whose residual repeats by itself.
    pub(super) fn witness(
        &self,
        left_out: &LeftOut,
        model: &Model,
    ) -> Result<Option<Explainable>, ModelError> {
        if !left_out.differ() {
            return Ok(None);
        }
        let residual = self.trajectories.iter().map(|trajectory| {
            let predicted = predict(model, trajectory)?.into_iter();
            let residual = predicted.zip(&trajectory.force);
            Ok(residual
                .map(|(predicted, force)| force - predicted)
                .collect())
        });
        let residual = residual.collect::<Result<Vec<_>, ModelError>>()?;
        Ok(explainable(self.trajectories, left_out, &residual))
    }

    /// The search's result, or another law that the validation cycles do not distinguish from it and that has clearly smaller errors
    /// over all blocks with equal weights. The validation cycles come mostly from the blocks with the largest force.
    pub(super) fn preferred(
        &self,
        selection: &Selection,
        left_out: &LeftOut,
        found: Solution,
    ) -> Result<Solution, ModelError> {
        let mut others = rivals(selection);
        let is_found =
            |best: &&select::Candidate| best.fitted.families() == selection.found.families();
        // If terms were dropped since, these rivals may belong to another law.
        if !others.first().is_some_and(is_found) {
            return Ok(found);
        }
        let others = others.split_off(1).into_par_iter();
        let others = others.map(|rival| self.fit_there(&self.rows[0], &rival.fitted.solution));
        let mut laws: Vec<Solution> = others.collect();
        laws.insert(0, found);
        let left = laws.iter().map(|law| left_out.inside(&law.model()));
        let left: Vec<f64> = left.collect::<Result<_, _>>()?;
        Ok(laws.swap_remove(clearly_best(left.into_iter())))
    }
}
