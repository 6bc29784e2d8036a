//! The conclusion from a search, in the terms of `trace.json`.

use mesh_damper_model::{Family, LawNode, Model};
use mesh_damper_recording::cycles::same_amplitude;
use mesh_damper_recording::extremes::least_and_largest;
use mesh_damper_recording::trajectory::Trajectory;

use super::adopt::{comparable, gains};
use super::relative_error::RelativeError;
use super::result::{Errors, Verdict};
use super::rule::Rule;
use super::select::{Candidate, Selection};
use crate::families::asymmetry;

mesh_damper_recording::numbers! {
    /// The verdict on the result of a search.
    VerdictPolicy {
        /// A law is noise-limited if its error is at most this many times the noise: the estimated motion has an error too. No effect is
        /// added to such a law.
        noise_limited: f64 = 1.5, Tuned("the blind trial");
        /// The limit of `noise_limited` for a law with more families of effects than `few`, because enough effects come near any force.
        noise_limited_by_many: f64 = 1.1, Tuned("the blind trial");
        /// A law with at most this many families of effects has few of them (see `noise_limited_by_many`).
        few: usize = 2, Tuned("the blind trial");
        /// Effects must reduce the error beyond the noise by at least this fraction in blocks that were not fitted, unless the law is
        /// noise-limited there.
        least_taken: f64 = 0.35, Tuned("the blind trial");
        /// Effects explain a recording if they leave at most this fraction of the law's error beyond the noise. An effect that is only
        /// similar leaves more: a dashpot leaves a fifth of a drag that grows with v².
        most_left: f64 = 0.12, Tuned("the blind trial");
        /// Effects explain a recording too if the error that they leave beyond the noise is at most this many times the noise: it does not
        /// show.
        unseen: f64 = 0.6, Tuned("the blind trial");
        /// A recording whose fastest cycle has a lower frequency than this may have its times in ms, Hz.
        slow: f64 = 0.05, Convention("in ms it would be 50 Hz, as fast as a rig goes");
        /// A warning is given if the error of the fit exceeds this many times the noise of the force and all of it may come from the
        /// estimated motion.
        hidden_by_motion: f64 = 3.0, Convention("twice the error of a noise-limited law");
    }
}

/// The error of a law over that of a perfect one, without the worst cycles; `None` without one whole cycle.
pub(super) struct OverNoise {
    /// On samples that were not held out.
    pub fitted: Option<f64>,
    /// On held-out samples.
    pub held_out: Option<f64>,
}

impl OverNoise {
    /// Whether the law describes the fitted samples but not the held-out ones: the error there is above that of a noise-limited
    /// law.
    pub fn fails_on_held_out(&self) -> bool {
        self.where_it_differs().is_some()
    }

    /// The errors on fitted and on held-out samples, if the law describes only the former.
    pub fn where_it_differs(&self) -> Option<[f64; 2]> {
        let [fitted, held_out] = [self.fitted, self.held_out].map(|left| left.unwrap_or(1.0));
        let differs = held_out > VerdictPolicy::in_use().noise_limited * fitted.max(1.0);
        differs.then_some([fitted, held_out])
    }

    /// The same for a model that explains the fitted samples without a residual table: its error there is `left` times the noise.
    pub fn differs_from_explained(&self, model: &Model, left: f64) -> Option<[f64; 2]> {
        let is_explained =
            model.correction.is_none() && left <= VerdictPolicy::in_use().noise_limited;
        self.where_it_differs().filter(|_| is_explained)
    }
}

/// Whether effects that change the errors on conditions held out in turn from `without` to `with` describe conditions other than those
/// they were fitted to.
pub(super) fn generalises(without: &[RelativeError], with: &[RelativeError]) -> bool {
    if !with.iter().all(RelativeError::is_run) {
        return false;
    }
    let [without, with] = comparable(without, with);
    let [all_without, all_with] = [&without, &with].map(|each| RelativeError::mean(each));
    let is_noise_limited =
        all_with.error <= VerdictPolicy::in_use().noise_limited.powi(2) * all_with.noise;
    let least = 1.0 - VerdictPolicy::in_use().least_taken;
    is_noise_limited
        || gains(&without, &with) && all_with.beyond_noise() <= least * all_without.beyond_noise()
}

/// Whether effects explain the error of the law alone beyond the noise, `alone`, if their error is `left` times the noise.
pub(super) fn accounts_for(alone: f64, left: f64) -> bool {
    left <= VerdictPolicy::in_use().unseen || left <= VerdictPolicy::in_use().most_left * alone
}

/// The verdict on the result of a search whose error is `left` times the noise, and the rule by which the result does not explain
/// the recordings. In the fit to all open samples the effects may vanish; then the law `is_alone`.
pub(super) fn conclude(
    selection: &Selection,
    is_alone: bool,
    left: f64,
) -> (Verdict, Option<Rule>) {
    let few = selection.found.families().len() <= VerdictPolicy::in_use().few;
    let explained = left
        <= if few {
            VerdictPolicy::in_use().noise_limited
        } else {
            VerdictPolicy::in_use().noise_limited_by_many
        };
    if is_alone {
        let verdict = if explained {
            Verdict::None
        } else {
            Verdict::Unlisted
        };
        return (verdict, None);
    }
    if !explained {
        (Verdict::Unlisted, Some(Rule::LeavesTooMuch))
    } else if rivals(selection).len() > 1 {
        (Verdict::Ambiguous, None)
    } else {
        (Verdict::Found, None)
    }
}

/// The candidates that did as well as the law found: the best first, then one for each other set of families that the validation
/// cycles do not distinguish from it.
pub(super) fn rivals(selection: &Selection) -> Vec<&Candidate> {
    let found = &selection.found;
    let families = found.families();
    let added = selection
        .candidates
        .iter()
        .filter(|candidate| candidate.added);
    let as_found = added.filter(|candidate| candidate.fitted.families() == families);
    // A law in which one term replaced another has fewer terms than there were steps.
    let last = as_found.map(|candidate| candidate.step).max();
    let last = last.unwrap_or(found.solution.found().count());
    let of_step = || {
        let all = selection.candidates.iter();
        let of_step = all.filter(|candidate| candidate.step == last);
        of_step.filter(|one| one.added || !(one.distinguishable || one.degenerate))
    };
    let is_as_found = |candidate: &&Candidate| candidate.fitted.families() == families;
    // One that was added and has a simpler one of this step in its place at the end is no rival of that.
    let is_listed = of_step().any(|candidate| is_as_found(&candidate));
    let mut known: Vec<Vec<Family>> = Vec::new();
    of_step()
        // A law that replaced others at a later step, or was refined, may be better than all candidates of that step.
        .filter(|candidate| {
            let is_replaced = candidate.added && is_listed;
            is_as_found(candidate) || !is_replaced && !found.score.beats(&candidate.fitted.score)
        })
        .filter(|candidate| {
            let families = candidate.fitted.families();
            let is_new = !known.contains(&families);
            known.push(families);
            is_new
        })
        .collect()
}

/// The variables that the added forces depend on: those of named effects, and `correction` for the residual table.
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

/// That the specimen may be even about another zero of the displacement, if `model` is uneven and that zero lies within the motion.
pub(super) fn zero_in_doubt(model: &Model, fitted: &[Trajectory]) -> Option<String> {
    let mut effects = model.effects.iter();
    let uneven = effects.find(|effect| effect.family == asymmetry::FORMS[0].family())?;
    // k3·(y − y₀)³ has the part −3·k3·y₀·y².
    let zero = -uneven.parameters.get("k2")? / (3.0 * model.law.last()?.k3);
    let has = |one: &Trajectory| {
        let (low, high) = least_and_largest(&one.motion.displacement);
        (low..=high).contains(&zero)
    };
    let recorded = zero + fitted.first()?.centre;
    fitted.iter().any(has).then(|| {
        format!(
            "a specimen that is symmetric about a displacement of {recorded:.3} mm has this asymmetry too: state where it is free with --zero"
        )
    })
}

/// Warnings for the reader. The error with the effects is `left` times that of a perfect law; `errors` are those of the law alone and
/// of the augmented law, `embedded` those of the latter in f32, and `noise_floor` is the noise of the force over its RMS.
pub(super) fn warnings<'t>(
    trajectories: impl Iterator<Item = &'t Trajectory>,
    model: &Model,
    left: f64,
    errors: (&Errors, &Errors),
    embedded: &Errors,
    over_noise: &OverNoise,
    noise_floor: f64,
) -> Vec<String> {
    let mut warnings = Vec::new();
    let (first, last) = (model.law.first(), model.law.last());
    let fastest = |trajectory: &Trajectory| {
        let cycles = trajectory.blocks.iter().map(|block| block.frequency);
        cycles.fold(0.0, f64::max)
    };
    let trajectories: Vec<&Trajectory> = trajectories.collect();
    // One unit serves all.
    let all_are_slow = (trajectories.iter()).all(|one| fastest(one) < VerdictPolicy::in_use().slow);
    for trajectory in trajectories {
        let faults = trajectory.faults.iter();
        warnings.extend(faults.map(|fault| format!("{}: {fault}", trajectory.name)));
        if !trajectory.noise_is_known {
            warnings.push(format!(
                "{}: the noise of the force is not known, and the noise given is an upper bound: neighbouring samples share their noise, as \
                 if the force was held, interpolated or filtered, or the force bends within a few samples",
                trajectory.name
            ));
        }
        let fastest = fastest(trajectory);
        if fastest > 0.0 && all_are_slow {
            warnings.push(format!(
                "{}: its fastest cycle takes {:.0} s: if its times are in ms, give --unit time=ms; every time and rate found is a thousand \
                 times too long otherwise",
                trajectory.name,
                1.0 / fastest
            ));
        }
        // A zero that was stated is no news.
        if trajectory.centre != 0.0 && trajectory.centre == trajectory.middle {
            warnings.push(format!(
                "{}: the displacement's zero lies {:.4} mm from the middle of the motion; the law uses the \
                 displacement from the middle",
                trajectory.name, trajectory.centre
            ));
        }
        if let (Some(first), Some(last)) = (first, last)
            && model.law.len() > 1
            && let Some(block) = trajectory.blocks.iter().find(|block| {
                let is_fitted = |node: &LawNode| same_amplitude(block.amplitude, node.amplitude);
                (block.amplitude < first.amplitude && !is_fitted(first))
                    || (block.amplitude > last.amplitude && !is_fitted(last))
            })
        {
            warnings.push(format!(
                "{}: a block of {:.3} mm lies outside the fitted amplitudes {:.3} … {:.3} mm; the coefficients of the nearest amplitude are used",
                trajectory.name, block.amplitude, first.amplitude, last.amplitude
            ));
        }
    }
    // The numbers of f32 reach from 1e-38 to 1e38, and those of a law in mm, kN and s lie far within.
    if embedded.nrmse_held_out > VerdictPolicy::in_use().noise_limited * errors.1.nrmse_held_out {
        warnings.push(format!(
            "the embedded law in f32 errs {:.3} % on the held-out data, that in f64 {:.3} %: a unit of time, displacement or force is \
             probably wrong; do not use it in firmware",
            100.0 * embedded.nrmse_held_out,
            100.0 * errors.1.nrmse_held_out
        ));
    }
    if !model.effects.is_empty() && errors.1.nrmse_held_out > errors.0.nrmse_held_out {
        warnings.push(format!(
            "on the held-out data, the error of the augmented law ({:.3} %) is larger than that of the law alone ({:.3} %): what was \
             fitted does not tell what happens there; fit conditions like those held out too",
            100.0 * errors.1.nrmse_held_out,
            100.0 * errors.0.nrmse_held_out
        ));
    }
    if let Some([fitted, held_out]) = over_noise.differs_from_explained(model, left) {
        warnings.push(format!(
            "the residual is {held_out:.1} times the noise on the held-out data, and {fitted:.1} times on the fitted data, both without the \
             worst cycles: fit more amplitudes and frequencies near those held out, and check that the held-out data is of the same specimen"
        ));
    }
    if model.correction.is_some() {
        let unexplained = if model.effects.is_empty() {
            "no family of effects explains the residual"
        } else {
            "the effects do not explain all of the residual"
        };
        warnings.push(format!(
            "{unexplained}: the model has a residual table for the rest; outside its range it keeps the values at its edge"
        ));
    } else if left > VerdictPolicy::in_use().noise_limited {
        warnings.push(format!(
            "the residual is {left:.1} times the noise of force and motion: the law lacks more than was found; see the residual in the \
             report, and record tests in which one quantity changes"
        ));
    } else if errors.1.nrmse_fitted > VerdictPolicy::in_use().hidden_by_motion * noise_floor {
        warnings.push(format!(
            "the error of the fit is {:.1} times the noise of the force, and the uncertainty of the estimated velocity can explain all of \
             it: an effect may be hidden; record at a higher rate, or with less noise of the displacement",
            errors.1.nrmse_fitted / noise_floor
        ));
    }
    warnings
}
