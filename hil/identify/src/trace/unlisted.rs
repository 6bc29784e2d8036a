//! The law for recordings that no family explains: the one that predicts conditions outside its fit, or the law alone.

use mesh_damper_model::predict::{predict, predict_embedded};
use mesh_damper_model::{Model, ModelError};

use super::adopt::gains;
use super::closing::Closing;
use super::confirm::Confirmed;
use super::left_out::{Fit, LeftOut, Picked};
use super::relative_error::RelativeError;
use super::result::{OnTarget, Rejected};
use super::rule::Rule;
use super::unexplained::{clearly_best, unexplained_law};
use crate::correction::{Choice, refit};
use crate::rows::Rows;
use crate::solution::Solution;
use crate::trace::unexplained::UnexplainedPolicy;

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
    /// The confirmed effects, as far as they are known.
    pub graded: Option<Confirmed>,
}

impl Closing<'_> {
    /// From eq 13 `alone` and with the effects that were `found`. The adopted law is better on conditions held out in turn.
    pub(super) fn unlisted(
        &self,
        left_out: &LeftOut,
        alone: Solution,
        found: Solution,
        progress: &(dyn Fn(&str) + Sync),
    ) -> Result<Laws<'_>, ModelError> {
        progress("holding out each condition in turn");
        let in_turn = |rows: &Rows, law: &Solution, choice: Option<&Choice>| {
            left_out.in_turn(&|picked| {
                let law = self.refit_model(rows, law, picked);
                match choice {
                    Some(choice) => refit(choice, self.trajectories, &law, picked),
                    None => Ok(law),
                }
            })
        };
        let left = |errors: &[RelativeError]| RelativeError::mean(errors).beyond_noise();
        // One set of coefficients, or one for each amplitude: the choice is the form that predicts another condition better.
        let each = self.rows.iter();
        let errors: Vec<Vec<RelativeError>> = each
            .map(|rows| in_turn(rows, &alone, None))
            .collect::<Result<_, _>>()?;
        let best = clearly_best(errors.iter().map(|errors| left(errors)));
        let (rows, of_alone) = (&self.rows[best], &errors[best]);
        let alone = self.fit_near(rows, &alone);

        progress("fitting a residual table");
        let mut laws: Vec<(&Rows, &Solution)> =
            self.rows.iter().map(|rows| (rows, &alone)).collect();
        if !found.is_alone() {
            laws.push((rows, &found));
        }
        let fits: Vec<_> = laws
            .iter()
            .map(|&(rows, law)| move |picked: Picked| Ok(self.refit_model(rows, law, picked)))
            .collect();
        let fits: Vec<Fit> = fits.iter().map(|fit| fit as Fit).collect();
        let unexplained = unexplained_law(self.trajectories, left_out, &fits)?;
        let (of_law, law) = laws[unexplained.law];
        let kept = Laws {
            rows,
            model: alone.model(),
            solution: alone.clone(),
            residual_depends_on: unexplained.depends_on,
            table_rejected_by: unexplained.table_rejected_by,
            rejected: None,
            graded: None,
            alone: alone.clone(),
        };
        if law.is_alone() && unexplained.choice.is_none() {
            return Ok(kept);
        }
        let choice = unexplained.choice.as_ref();
        let of_ended = in_turn(of_law, law, choice)?;
        let named = laws.last().filter(|(_, law)| !law.is_alone());
        // A table chosen by its fit may predict new conditions less well than named effects do. To replace confirmed effects it has
        // to predict much better: their force is also known where no table was fitted, and a name explains the cause.
        if choice.is_some()
            && let Some(&(rows, named)) = named
        {
            let of_named = in_turn(rows, named, None)?;
            let part = left(&of_ended) / left(&of_named);
            let is_less = part * UnexplainedPolicy::in_use().better > 1.0;
            let may_be_confirmed = law.is_alone() && part > UnexplainedPolicy::in_use().needed;
            if gains(of_alone, &of_named) && (is_less || may_be_confirmed) {
                let solution = self.fit_there(rows, named);
                let mut laws = Laws {
                    rows,
                    model: solution.model(),
                    solution,
                    table_rejected_by: Some(Rule::TableUnknownElsewhere),
                    ..kept.clone()
                };
                self.grade(left_out, &mut laws)?;
                if is_less || laws.graded.as_ref().is_some_and(Confirmed::any) {
                    return Ok(laws);
                }
            }
        }
        let solution = self.fit_there(of_law, law);
        let model = match choice {
            Some(choice) => {
                let open: Picked = &|which, sample| left_out.is_open(which, sample);
                refit(choice, self.trajectories, &solution.model(), open)?
            }
            None => solution.model(),
        };
        if gains(of_alone, &of_ended) {
            return Ok(Laws {
                rows: of_law,
                solution,
                model,
                ..kept
            });
        }
        let without_table = choice.map(|_| Rule::TableUnknownElsewhere);
        Ok(Laws {
            rejected: Some(self.rejected(&model)?),
            table_rejected_by: without_table.or(kept.table_rejected_by),
            ..kept
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
