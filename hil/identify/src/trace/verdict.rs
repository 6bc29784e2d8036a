//! What is concluded from a search, in the words of `trace.json`.

use mesh_damper_model::{Family, Model};
use mesh_damper_recording::trajectory::Trajectory;

use super::left_out::RelativeError;
use super::result::{Errors, Verdict};
use super::select::{Candidate, Selection};

/// So many times the noise may a law leave that explains a recording: the estimated motion errs too.
const EXPLAINED: f64 = 1.5;
/// The same of a law with more than [`FEW`] families: enough of them come near anything.
const EXPLAINED_BY_MANY: f64 = 1.1;
const FEW: usize = 2;

/// Effects that are there take at least this part of the error beyond the noise in blocks that were not fitted.
const LEAST_TAKEN: f64 = 0.35;

/// Whether effects that bring the error in blocks left out of the fit from `without` to `with` say something of other
/// conditions than those they were fitted to.
pub(super) fn generalises(without: RelativeError, with: RelativeError) -> bool {
    with.error <= EXPLAINED.powi(2) * with.noise
        || with.beyond_noise() <= (1.0 - LEAST_TAKEN) * without.beyond_noise()
}

/// Effects that explain a recording leave of what the law alone leaves beyond the noise at most this part,
const MOST_LEFT: f64 = 0.12;
/// or nothing that shows beside so many times the noise. An effect that is like the one at work leaves more: a dashpot a
/// fifth of a drag that grows with v².
const UNSEEN: f64 = 0.6;

/// Whether effects explain what the law alone leaves beyond the noise, `alone`, and leave only `left` of it, over the noise.
pub(super) fn accounts_for(alone: f64, left: f64) -> bool {
    left <= UNSEEN || left <= MOST_LEFT * alone
}

/// The verdict on what a search found, of which so many times the noise is `left`.
pub(super) fn conclude(selection: &Selection, left: f64) -> Verdict {
    let few = selection.found.families().len() <= FEW;
    let explained = left <= if few { EXPLAINED } else { EXPLAINED_BY_MANY };
    if selection.found.solution.terms.is_empty() {
        return if explained {
            Verdict::None
        } else {
            Verdict::Unlisted
        };
    }
    if !explained {
        Verdict::Unlisted
    } else if rivals(selection).len() > 1 {
        Verdict::Ambiguous
    } else {
        Verdict::Found
    }
}

/// The candidates that did as well as the law found: the best first, then one for each other set of families that the
/// judging cycles do not tell from it.
pub(super) fn rivals(selection: &Selection) -> Vec<&Candidate> {
    let found = &selection.found;
    let last = found.solution.terms.len();
    let mut known: Vec<Vec<Family>> = Vec::new();
    selection
        .candidates
        .iter()
        .filter(|candidate| candidate.step == last)
        .filter(|candidate| candidate.added || !(candidate.distinguishable || candidate.degenerate))
        .filter(|candidate| {
            let families = candidate.fitted.families();
            let is_new = !known.contains(&families);
            known.push(families);
            is_new
        })
        .collect()
}

/// What the added forces depend on: those of named effects, and `correction` for what has no name.
pub(super) fn depends_on(model: &Model, correction: &[&'static str]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let of_effects = model
        .effects
        .iter()
        .flat_map(|effect| effect.family.depends_on());
    for name in of_effects.chain(correction.iter().copied()) {
        if !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    names
}

/// A law that explains what it was fitted to and leaves more than so many times the noise of what was held out knows the one and not
/// the other.
const ELSEWHERE: f64 = 2.0;

/// What a reader should know before trusting the result: `left` times the noise is what effects leave, `errors` are of the law
/// alone and with what was added, `held_to` is what a perfect law leaves of what was held out.
pub(super) fn warnings<'t>(
    trajectories: impl Iterator<Item = &'t Trajectory>,
    model: &Model,
    left: f64,
    errors: (&Errors, &Errors),
    held_to: f64,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let (first, last) = (model.law.first(), model.law.last());
    for trajectory in trajectories {
        let faults = trajectory.faults.iter();
        warnings.extend(faults.map(|fault| format!("{}: {fault}", trajectory.name)));
        if trajectory.centre != 0.0 {
            warnings.push(format!(
                "{}: the displacement's zero lies {:.4} mm from the middle of the motion; the law was given the \
                 displacement from the middle",
                trajectory.name, trajectory.centre
            ));
        }
        if let (Some(first), Some(last)) = (first, last)
            && model.law.len() > 1
            && let Some(block) = trajectory.blocks.iter().find(|block| {
                block.amplitude < 0.94 * first.amplitude || block.amplitude > 1.06 * last.amplitude
            })
        {
            warnings.push(format!(
                "{}: a block of {:.3} mm lies outside the fitted amplitudes {:.3} … {:.3} mm; the nearest one's coefficients are held",
                trajectory.name, block.amplitude, first.amplitude, last.amplitude
            ));
        }
    }
    if !model.effects.is_empty() && errors.1.nrmse_held_out > errors.0.nrmse_held_out {
        warnings.push(
            "on what was held out the law with what was added is no better than the law alone: don't use it there"
                .to_owned(),
        );
    }
    let elsewhere = errors.1.nrmse_held_out / held_to;
    if model.correction.is_none() && left <= EXPLAINED && elsewhere > ELSEWHERE {
        warnings.push(format!(
            "on what was held out the law leaves {elsewhere:.1} times the noise, which it does not where it was fitted: fit more \
             amplitudes and frequencies, about those held out"
        ));
    }
    if model.correction.is_some() {
        warnings.push(
            "no listed effect explains what the law lacks: a table stands in for it, which is held at its edges".to_owned(),
        );
    } else if left > EXPLAINED {
        warnings.push(format!(
            "what is left is {left:.1} times the noise of the force: more is missing from the law than was found"
        ));
    }
    warnings
}
