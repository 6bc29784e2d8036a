//! The law for recordings that no family explains: possibly with a residual table.

use mesh_damper_model::{Model, ModelError};
use mesh_damper_recording::trajectory::Trajectory;
use rayon::prelude::*;

use super::left_out::{Fit, LeftOut, Picked};
use super::relative_error::BlockErrors;
use super::rule::Rule;
use super::wander::wanders;
use crate::correction;

mesh_damper_recording::numbers! {
    /// When a residual table takes the place of effects.
    UnexplainedPolicy {
        /// A law replaces a simpler one if its error beyond the noise is below this fraction of the other's.
        better: f64 = 0.95, Tuned("the blind trial");
        /// Where effects are named, a residual table is used only if it reduces the error beyond the noise below this fraction, on the
        /// blocks left out or on all blocks. A table could replace most effects, but their force is known also where no table was fitted.
        needed: f64 = 0.75, Tuned("the blind trial");
    }
}

/// The law for recordings that no family explains.
pub(super) struct UnexplainedLaw {
    /// Index of the law on which it is based.
    pub law: usize,
    /// How the residual table was made, if there is one.
    pub choice: Option<correction::Choice>,
    /// The variables that the residual table depends on, by their names in `trace.json`.
    pub depends_on: Vec<&'static str>,
    /// The reason for having no residual table.
    pub table_rejected_by: Option<Rule>,
}

/// One of `laws`, the simplest first, alone or with a residual table. The choice is the law that best predicts blocks left out of its
/// fit and also fits well. It is then fitted to all open samples.
pub(super) fn unexplained_law(
    trajectories: &[Trajectory],
    left_out: &LeftOut,
    laws: &[Fit],
) -> Result<UnexplainedLaw, ModelError> {
    let open: Picked = &|which, sample| left_out.is_open(which, sample);
    let plain: Vec<Model> = laws
        .par_iter()
        .map(|law| law(open))
        .collect::<Result<_, _>>()?;
    let alone = laws.par_iter().zip(&plain);
    let alone = alone.map(|(law, plain)| left_out.block_errors(law, plain));
    let alone: Vec<BlockErrors> = alone.collect::<Result<_, _>>()?;
    let law = clearly_best(alone.iter().map(BlockErrors::both));
    let mut best = (alone[law], law, plain[law].clone(), None);
    let corrected = laws.par_iter().zip(&plain).map(|(law, plain)| {
        let is_seen = |with: &Model, without: &Model| left_out.is_seen_within_blocks(with, without);
        let found = correction::fit(trajectories, plain, open, is_seen)?;
        let Some((model, choice)) = found else {
            return Ok(None);
        };
        let refit =
            |picked: Picked| correction::refit(&choice, trajectories, &law(picked)?, picked);
        let errors = left_out.block_errors(&refit, &model)?;
        Ok(Some((errors, model, choice)))
    });
    let corrected: Vec<_> = corrected.collect::<Result<_, ModelError>>()?;
    let table_rejected_by = if corrected.iter().all(Option::is_none) {
        Rule::TableWorthLittle
    } else {
        Rule::TableUnknownElsewhere
    };
    for (number, corrected) in corrected.into_iter().enumerate() {
        let Some((errors, model, choice)) = corrected else {
            continue;
        };
        let named = !model.effects.is_empty() || !best.2.effects.is_empty();
        if replaces(&errors, &best.0, named) {
            best = (errors, number, model, Some(choice));
        }
    }
    let (_, law, model, choice) = best;
    let table_rejected_by = choice.is_none().then_some(table_rejected_by);
    let depends_on = match &choice {
        Some(choice) => correction::depends_on(choice, trajectories, &plain[law], open)?,
        None if wanders(trajectories, open, &model)? => vec!["time"],
        None => Vec::new(),
    };
    Ok(UnexplainedLaw {
        law,
        choice,
        depends_on,
        table_rejected_by,
    })
}

/// Whether a law with a residual table replaces the `best` so far, if either has effects that are `named`. A law that predicts the
/// left-out blocks clearly better may then also win by its error over all blocks.
fn replaces(corrected: &BlockErrors, best: &BlockErrors, named: bool) -> bool {
    let outside = corrected.outside / best.outside;
    let all = corrected.both() / best.both();
    outside < UnexplainedPolicy::in_use().better
        && (!named || outside.min(all) < UnexplainedPolicy::in_use().needed)
}

/// Index of the law with the smallest of these errors, starting with the preferred one: a later one has to be clearly smaller.
pub(super) fn clearly_best(errors: impl Iterator<Item = f64>) -> usize {
    let mut best = (0, f64::INFINITY);
    for (number, error) in errors.enumerate() {
        if error < UnexplainedPolicy::in_use().better * best.1 {
            best = (number, error);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_in_the_place_of_a_name_says_more_of_what_was_left_out() {
        let best = BlockErrors {
            outside: 0.1,
            inside: 0.2,
        };
        let replaces = |outside: f64, inside: f64, named| {
            let corrected = BlockErrors {
                outside: outside * best.outside,
                inside: inside * best.inside,
            };
            replaces(&corrected, &best, named)
        };
        assert!(
            replaces(0.74, 2.0, true),
            "clearly more of what was left out"
        );
        assert!(
            replaces(0.94, 0.5, true),
            "more of it, and much more of the rest"
        );
        assert!(!replaces(0.94, 0.7, true));
        assert!(!replaces(0.96, 0.1, true), "no more of it");
        assert!(replaces(0.94, 1.5, false));
        assert!(!replaces(f64::NAN, 0.1, false));
    }
}
