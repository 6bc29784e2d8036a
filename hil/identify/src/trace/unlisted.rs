//! The law for recordings that no family explains: the one that predicts conditions outside its fit, or the law alone.

use mesh_damper_model::predict::{predict, predict_embedded};
use mesh_damper_model::{Model, ModelError};
use rayon::prelude::*;

use super::adopt::{clearly_best, is_nowhere_far_worse, simplest_of_best};
use super::closing::Closing;
use super::confirm::Confirmed;
use super::left_out::{LeftOut, Picked, Samples};
use super::progress::Progress;
use super::relative_error::RelativeError;
use super::result::{OnTarget, Rejected};
use super::rule::Rule;
use super::wander::wanders;
use crate::correction::{self, Choice};
use crate::rows::Rows;
use crate::solution::Solution;

/// The laws at the end of a trace.
#[derive(Clone)]
pub(super) struct Laws<'c> {
    /// The rows to which `solution` was fitted.
    pub rows: &'c Rows<'c>,
    /// Eq 13.
    pub alone: Solution,
    /// With effects, if there are any.
    pub solution: Solution,
    /// The same with a residual table, if there is one.
    pub model: Model,
    /// The variables that the residual table depends on, by their names in `trace.json`.
    pub residual_depends_on: Vec<&'static str>,
    /// The reason for having no residual table.
    pub table_rejected_by: Option<Rule>,
    /// The law that was no better than eq 13 on conditions held out in turn.
    pub rejected: Option<Rejected>,
    /// Whether the model is written because the caller [insists](super::sought::Sought::adopt).
    pub is_insisted: bool,
    /// The confirmed effects, as far as they are known.
    pub graded: Option<Confirmed>,
    /// The errors of `model` on conditions left out of its fit, one after the other.
    pub in_turn: Vec<RelativeError>,
}

/// A law that may be written.
struct Candidate<'c, 'l> {
    rows: &'c Rows<'c>,
    law: &'l Solution,
    /// How its residual table was made, if it has one.
    choice: Option<Choice>,
    /// Its error on each condition that was held out in turn.
    errors: Vec<RelativeError>,
}

impl Closing<'_> {
    /// From eq 13 `alone` and with the effects that were `found`: the law that predicts conditions held out in turn best, with effects, with
    /// a residual table, with both or with neither.
    pub(super) fn unlisted(
        &self,
        left_out: &LeftOut,
        alone: Solution,
        found: Solution,
        progress: Progress,
    ) -> Result<Laws<'_>, ModelError> {
        progress.at(0.0, "holding out each condition in turn");
        let in_turn = |rows: &Rows, law: &Solution, choice: Option<&Choice>| {
            left_out.in_turn(Samples::All, &|picked| {
                let law = self.refit_model(rows, law, picked);
                match choice {
                    Some(choice) => correction::refit(choice, self.trajectories, &law, picked),
                    None => Ok(law),
                }
            })
        };
        // One set of coefficients, or one for each amplitude: the choice is the form that predicts another condition better.
        let each = self.rows.iter();
        let errors: Vec<Vec<RelativeError>> =
            each.map(|rows| in_turn(rows, &alone, None)).collect();
        let best = clearly_best(
            errors
                .iter()
                .map(|errors| RelativeError::geometric_mean(errors)),
        );
        let rows = &self.rows[best];
        let alone = self.fit_near(rows, &alone);
        let mut candidates = vec![Candidate {
            rows,
            law: &alone,
            choice: None,
            errors: errors[best].clone(),
        }];
        if !found.is_alone() {
            candidates.push(Candidate {
                rows,
                law: &found,
                choice: None,
                errors: in_turn(rows, &found, None),
            });
        }

        progress.at(0.4, "fitting a residual table");
        let open: Picked = &|which, sample| left_out.is_open(which, sample);
        let is_seen = |with: &Model, without: &Model| left_out.is_seen_within_blocks(with, without);
        // Names say more than a table: where both do equally well, the law with names is written.
        let named = candidates.get(1).map(|named| (named.rows, named.law));
        let forms = self.rows.iter().map(|rows| (rows, &alone));
        let laws: Vec<(&Rows, &Solution)> = named.into_iter().chain(forms).collect();
        let corrected = laws.par_iter().map(|&(rows, law)| {
            let plain = self.refit_model(rows, law, open);
            let choices = correction::fit(self.trajectories, &plain, open, is_seen)?;
            let each = choices.into_iter().map(|(_, choice)| {
                Ok(Candidate {
                    rows,
                    law,
                    errors: in_turn(rows, law, Some(&choice)),
                    choice: Some(choice),
                })
            });
            each.collect::<Result<Vec<_>, ModelError>>()
        });
        let corrected: Vec<Vec<Candidate>> = corrected.collect::<Result<_, _>>()?;
        candidates.extend(corrected.into_iter().flatten());
        let has_table = candidates.iter().any(|one| one.choice.is_some());
        let without_table = match has_table {
            true => Rule::TableUnknownElsewhere,
            false => Rule::TableWorthLittle,
        };
        let errors: Vec<&[RelativeError]> = candidates.iter().map(|c| &c.errors[..]).collect();
        let is_safe = |number: usize| {
            candidates[number].choice.is_none() || is_nowhere_far_worse(errors[0], errors[number])
        };
        let (chosen, best) = simplest_of_best(&errors, is_safe);
        let is_insisted = self.sought.adopt && chosen == 0 && best > 0;
        let chosen = if is_insisted { best } else { chosen };
        let laws = self.completed(left_out, &alone, &candidates[chosen])?;
        // What did best although it is no better than the law alone.
        let rejected = match chosen == 0 && best > 0 {
            true => {
                let best = self.completed(left_out, &alone, &candidates[best])?;
                Some(self.rejected(&best.model)?)
            }
            false => None,
        };
        let has_no_table = candidates[chosen].choice.is_none();
        Ok(Laws {
            is_insisted,
            table_rejected_by: has_no_table.then_some(without_table),
            rejected,
            ..laws
        })
    }

    /// A candidate fitted to all open samples, beside the law `alone`.
    fn completed<'c>(
        &self,
        left_out: &LeftOut,
        alone: &Solution,
        candidate: &Candidate<'c, '_>,
    ) -> Result<Laws<'c>, ModelError> {
        let open: Picked = &|which, sample| left_out.is_open(which, sample);
        let solution = self.fit_there(candidate.rows, candidate.law);
        let plain = solution.model();
        let all = self.trajectories;
        let (model, residual_depends_on) = match &candidate.choice {
            Some(choice) => (
                correction::refit(choice, all, &plain, open)?,
                correction::depends_on(choice, all, &plain, open)?,
            ),
            None if wanders(all, open, &plain)? => (plain, vec!["time"]),
            None => (plain, Vec::new()),
        };
        Ok(Laws {
            rows: candidate.rows,
            alone: alone.clone(),
            solution,
            model,
            residual_depends_on,
            table_rejected_by: None,
            rejected: None,
            is_insisted: false,
            graded: None,
            in_turn: candidate.errors.clone(),
        })
    }

    /// The errors of a law that is not adopted.
    fn rejected(&self, model: &Model) -> Result<Rejected, ModelError> {
        Ok(Rejected {
            augmented: self.evaluate(model, predict)?.1,
            on_target: OnTarget {
                nrmse_held_out: self.evaluate(model, predict_embedded)?.1.nrmse_held_out,
            },
        })
    }
}
