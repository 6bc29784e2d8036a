//! What is done when no listed effect explains a recording: a correction that needs no name.

use rayon::prelude::*;

use super::left_out::{Fit, Judged, LeftOut, Picked};
use crate::identify::correction;
use crate::model::{Model, ModelError};
use crate::recording::trajectory::Trajectory;

/// A law is taken in the place of a simpler one if its error is at most this part of the other's.
const BETTER: f64 = 0.95;
/// The same for effects beside a table, which could stand in for most of them, and for a table in the place of effects, whose
/// force is known where no table was fitted.
const NEEDED: f64 = 0.75;

/// The law for recordings that no listed effect explains.
pub(super) struct Mended {
    /// Which of the laws it is made of.
    pub law: usize,
    /// With its correction, if it has one.
    pub model: Model,
    /// What the correction depends on, by the names of `trace.json`.
    pub depends_on: Vec<&'static str>,
}

/// One of `laws`, the simplest first, alone or with a correction. Taken is what predicts best the blocks that are left out of its
/// fit, and of laws alone what also fits well; it is fitted to all that may be.
pub(super) fn mended(
    trajectories: &[Trajectory],
    left_out: &LeftOut,
    laws: &[Fit],
) -> Result<Mended, ModelError> {
    let open: Picked = &|which, sample| left_out.is_open(which, sample);
    let plain: Vec<Model> = laws
        .par_iter()
        .map(|law| law(open))
        .collect::<Result<_, _>>()?;
    let alone = laws.par_iter().zip(&plain);
    let alone = alone.map(|(law, plain)| left_out.judged(law, plain));
    let alone: Vec<Judged> = alone.collect::<Result<_, _>>()?;
    let law = clearly_best(alone.iter().map(Judged::both));
    let mut best = (alone[law], law, plain[law].clone(), None);
    let corrected = laws.par_iter().zip(&plain).map(|(law, plain)| {
        let is_seen = |with: &Model, without: &Model| left_out.is_seen_within_blocks(with, without);
        let found = correction::fit(trajectories, plain, open, is_seen)?;
        let Some((model, choice)) = found else {
            return Ok(None);
        };
        let refit =
            |picked: Picked| correction::refit(&choice, trajectories, &law(picked)?, picked);
        let judged = left_out.judged(&refit, &model)?;
        Ok(Some((judged, model, choice)))
    });
    let corrected: Vec<_> = corrected.collect::<Result<_, ModelError>>()?;
    for (number, corrected) in corrected.into_iter().enumerate() {
        let Some((judged, model, choice)) = corrected else {
            continue;
        };
        let named = !model.effects.is_empty() || !best.2.effects.is_empty();
        let outside = judged.outside / best.0.outside;
        // What says no less of the blocks left out may also win by what it says of the others.
        let either = outside.min(judged.both() / best.0.both());
        if outside < BETTER && (!named || either < NEEDED) {
            best = (judged, number, model, Some(choice));
        }
    }
    let (_, law, model, choice) = best;
    let depends_on = match choice {
        Some(choice) => correction::depends_on(&choice, trajectories, &plain[law], open)?,
        None if left_out.wanders(&model)? => vec!["time"],
        None => Vec::new(),
    };
    Ok(Mended {
        law,
        model,
        depends_on,
    })
}

/// Which of some laws, the one that is preferred first, has the least of these errors: a later one where it is clearly less.
pub(super) fn clearly_best(errors: impl Iterator<Item = f64>) -> usize {
    let mut best = (0, f64::INFINITY);
    for (number, error) in errors.enumerate() {
        if error < BETTER * best.1 {
            best = (number, error);
        }
    }
    best.0
}
