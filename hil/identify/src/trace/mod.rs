//! From recordings to the effect that the law lacks, and to the law with that effect.
//!
//! The trace fits eq 13. It adds effects one at a time as long as they clearly improve the prediction of the validation cycles,
//! and drops effects that became unnecessary. Finally it fits the result again to everything except the held-out samples. It reports the
//! error on those only.

pub(crate) mod adopt;
pub(crate) mod aligned;
mod closing;
pub mod conclusion;
mod conditions;
pub(crate) mod confirm;
mod controlled;
pub(crate) mod early;
mod errors;
mod estimates;
mod fitted;
pub(crate) mod held_range;
mod left_in_cycles;
pub(crate) mod left_out;
mod operating;
mod progress;
mod relative_error;
pub(crate) mod remainder;
pub mod result;
pub mod rule;
mod ruled_out;
pub(crate) mod score;
mod search_verdict;
pub(crate) mod select;
pub(crate) mod separating;
mod sought;
pub(crate) mod split;
pub(crate) mod tones;
mod unlisted;
pub(crate) mod verdict;
pub(crate) mod wander;
mod within_blocks;
pub(crate) mod witness;

pub use sought::Sought;
pub use split::{Role, Roles};
pub use verdict::VerdictPolicy;

use mesh_damper_model::file::{FittedRange, ModelFile};
use mesh_damper_model::{Model, ModelError};
use mesh_damper_output::error::InputError;
use mesh_damper_recording::cycles::CyclesPolicy;
use mesh_damper_recording::faults::ShiftPolicy;
use mesh_damper_recording::motion::MotionEstimate;
use mesh_damper_recording::notes::shared;
use mesh_damper_recording::trajectory::Trajectory;
use mesh_damper_recording::zero::ZeroPolicy;
use mesh_damper_recording::{Recording, check_consistency, check_held_out};

use crate::base_law::BaseLaw;
use aligned::Aligned;
use closing::{Closed, Closing, brings_nothing_new};
use controlled::Controlled;
use fitted::Fitted;
use progress::Progress;
use result::{TraceResult, Verdict};
use select::{Search, Selection, amplitude_nodes, error_between};

mesh_damper_recording::numbers! {
    /// The steps of a trace.
    TracePolicy {
        /// An effect is dropped if its force is everywhere below this fraction of the largest force.
        nothing: f64 = 1e-7, Convention("rounding to 32 bits is 6e-8, so that the crate's force would not show it");
        /// In a search, samples get other weights if the law with another effect leaves less than this fraction of the variance that it left
        /// of a recording before.
        same_weights: f64 = 0.5, Convention("weights within a factor of two make the same choice");
    }
}

/// A force that was found early or late is moved again at most this many times. Convention: the second move completes the first.
const MOST_MOVES: usize = 2;

/// The reason why a trace could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// A recording was refused.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The crate refused a fitted law.
    #[error("the fitted law cannot be run: {0}; check the recording's units")]
    Model(#[from] ModelError),
}

/// A recording with the forces of the laws.
#[derive(Clone, Debug)]
pub struct Traced {
    /// The recording's motion and force.
    pub trajectory: Trajectory,
    /// The role of each sample.
    pub roles: Vec<Role>,
    /// Force of the mixed damping law alone, kN.
    pub before: Vec<f64>,
    /// Force with the effects that were found, kN.
    pub after: Vec<f64>,
}

/// The result of a trace.
#[derive(Clone, Debug)]
pub struct Trace {
    /// The contents of `trace.json`.
    pub result: TraceResult,
    /// Eq 13 alone.
    pub baseline: Model,
    /// Eq 13 with the effects that were found.
    pub model: Model,
    /// The fitted recordings, then the held-out ones.
    pub recordings: Vec<Traced>,
}

impl Trace {
    /// The contents of `model.json`: the model with the range of motion that it was fitted on.
    pub fn model_file(&self) -> ModelFile {
        let conditions = self.result.operating_conditions;
        ModelFile::new(self.model.clone(), self.fitted_range())
            .with_displacement_zero(conditions.map_or([0.0; 2], |one| one.displacement_zero))
            .with_elsewhere(self.result.elsewhere)
            .with_rig(self.result.rig)
    }

    /// The motion of all samples that are not held out.
    fn fitted_range(&self) -> FittedRange {
        let fitted = |channel: fn(&MotionEstimate) -> &Vec<f64>| {
            self.recordings.iter().flat_map(move |traced| {
                let values = channel(&traced.trajectory.motion);
                values
                    .iter()
                    .zip(&traced.roles)
                    .filter(|(_, role)| **role != Role::HeldOut)
                    .map(|(value, _)| value)
            })
        };
        let still = FittedRange {
            displacement: [0.0; 2],
            velocity: [0.0; 2],
        };
        FittedRange::of(
            fitted(|motion| &motion.displacement),
            fitted(|motion| &motion.velocity),
        )
        .unwrap_or(still)
    }
}

/// Traces `recordings`. The error is reported on `held_out` or, if there is none, on the last cycles of each block and one whole
/// block of `recordings`. `progress` receives a description of each step.
///
/// # Errors
/// The recordings contradict each other or cannot be used, or the crate refuses a law.
pub fn trace(
    recordings: &[Recording],
    held_out: &[Recording],
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Trace, TraceError> {
    trace_for(&Sought::default(), recordings, held_out, progress)
}

/// As [`trace`], with the restrictions in `sought`.
///
/// # Errors
/// As [`trace`].
pub fn trace_for(
    sought: &Sought,
    recordings: &[Recording],
    held_out: &[Recording],
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Trace, TraceError> {
    let repaired = |recordings| <[Recording]>::iter(recordings).map(Recording::repaired);
    let (recordings, held_out): (Vec<_>, Vec<_>) =
        (repaired(recordings).collect(), repaired(held_out).collect());
    // Including all control inputs: one motion under two currents has two forces.
    let [to_fit, to_hold] = [&recordings, &held_out].map(|each| {
        let each = each.iter().map(AsRef::as_ref);
        each.collect::<Vec<&Recording>>()
    });
    check_consistency(&to_fit)?;
    let of_others = check_held_out(&to_fit, &to_hold)?;
    let all = || to_fit.iter().chain(&to_hold);
    let names: Vec<String> = all().map(|each| each.name.clone()).collect();
    let shared = |notes: Vec<String>| shared(names.iter().map(String::as_str), notes);
    let guesses = shared(all().flat_map(|each| each.named_guesses()).collect());
    let controlled = Controlled::of(&recordings, &held_out, &sought.controls)?;
    let [fitted, held] = [recordings, held_out].map(|repaired| {
        let arranged = repaired.into_iter().map(|each| controlled.arranged(each));
        arranged.collect::<Vec<_>>()
    });
    let [recordings, held_out] = [&fitted, &held].map(|repaired| {
        repaired
            .iter()
            .map(AsRef::as_ref)
            .collect::<Vec<&Recording>>()
    });
    for recording in recordings.iter().chain(&held_out) {
        recording.check_force()?;
    }
    let progress = Progress::of(progress);
    progress.at(0.0, "estimating the motion");
    let mut aligned = Aligned::of(&recordings, &held_out, sought.rig)?;
    let mut closed = conclude_in_time(&mut aligned, sought, progress.within([0.1, 0.75]))?;
    // The first repair takes about as long again as all before; later ones less.
    let again = progress.within([0.5, 1.0]);
    let effects = |of: &Closed| of.model.effects.len();
    if (is_more_missing(&closed.result) || closed.model.effects.iter().any(early::stands_for_it))
        && !aligned.is_moved()
        && let Some(late) = early::found(&aligned.trajectories[0], &closed, sought)
    {
        aligned.move_all(late)?;
        again.at(0.0, "correcting a force that is early");
        let moved = conclude_in_time(&mut aligned, sought, again)?;
        let less = moved.result.augmented.nrmse_fitted
            < ShiftPolicy::in_use().better * closed.result.augmented.nrmse_fitted;
        let is_simpler = is_more_missing(&closed.result) || effects(&moved) < effects(&closed);
        if less || !is_more_missing(&moved.result) && is_simpler {
            closed = moved;
        } else {
            aligned.move_all(0.0)?;
        }
    }
    for _ in 0..ZeroPolicy::in_use().most {
        if closed.result.verdict == Verdict::None || !aligned.take_zero_steps(&closed)? {
            break;
        }
        again.at(0.0, "correcting zero steps of the force");
        closed = conclude(&mut aligned, sought, &closed.selection, again)?;
    }
    if is_more_missing(&closed.result) && aligned.take_zeros(&closed)? {
        again.at(0.0, "correcting zero offsets between recordings");
        closed = conclude(&mut aligned, sought, &closed.selection, again)?;
    }
    // What the motion predicts is no noise.
    let is_noise = !closed.result.explainable.is_some_and(|one| one.counts());
    if is_noise && is_more_missing(&closed.result) && aligned.take_pink_noise(&closed.forces) {
        again.at(0.0, "estimating noise that grows towards low frequencies");
        closed = conclude(&mut aligned, sought, &closed.selection, again)?;
    }
    aligned.say_odd_zeros(&mut closed)?;
    closed
        .result
        .warnings
        .extend_from_slice(&controlled.warnings);
    closed.result.guesses = guesses;
    controlled.name_in(&mut closed.model, &mut closed.result, &held);
    let trajectories = aligned.trajectories.into_iter().flatten();
    let mut trace = Trace {
        result: closed.result,
        baseline: closed.baseline,
        model: closed.model,
        recordings: trajectories
            .zip(closed.forces)
            .map(|(trajectory, forces)| Traced {
                trajectory,
                roles: forces.roles,
                before: forces.before,
                after: forces.after,
            })
            .collect(),
    };
    let outside = held_range::warnings(&trace);
    let warnings = of_others
        .into_iter()
        .chain(trace.result.warnings)
        .chain(outside);
    trace.result.warnings = shared(warnings.collect());
    Ok(trace)
}

/// Whether the error of the law with its effects is above the noise.
fn is_more_missing(result: &TraceResult) -> bool {
    result.verdict == Verdict::Unlisted || result.remainder.is_some()
}

/// With more amplitudes the law has one set of coefficients for all.
fn most_amplitudes() -> usize {
    CyclesPolicy::in_use().most_amplitudes
}

/// The part of a conclusion that its search takes. Convention: what closes it takes nearly as long.
const SEARCH: [f64; 2] = [0.0, 0.6];

/// The result of a search, with the roles of the samples that it used.
struct Searched {
    roles: Roles,
    validation: Roles,
    /// Whether eq 13 has other coefficients at each amplitude.
    over_amplitude: bool,
    selection: Selection,
}

/// Searches for missing effects and completes the trace. Forces that were found early or late are moved again by what the law shows.
fn conclude_in_time(
    aligned: &mut Aligned,
    sought: &Sought,
    progress: Progress,
) -> Result<Closed, TraceError> {
    let mut searched = search_in(aligned, sought, None, progress.within(SEARCH))?;
    for _ in 0..MOST_MOVES {
        let moved = aligned.trajectories[0].iter().map(|one| one.late != 0.0);
        let moved: Vec<bool> = moved.collect();
        if !moved.contains(&true) {
            break;
        }
        let found = &searched.selection.found.solution;
        let nodes = found.law.iter().map(|node| node.amplitude).collect();
        let [fitted, _] = &aligned.trajectories;
        let search = Search::new(fitted, &searched.validation, nodes, sought);
        let early = search.early_by(found, &moved);
        if !aligned.follow(early.unwrap_or_default())? {
            break;
        }
        let search = progress.within([0.4, SEARCH[1]]);
        search.at(0.0, "correcting time shifts of the force");
        searched = search_in(aligned, sought, Some(&searched.selection), search)?;
    }
    close(aligned, searched, sought, progress.within([SEARCH[1], 1.0]))
}

/// Searches again after a repair, `from` the law found before, and completes the trace.
fn conclude(
    aligned: &mut Aligned,
    sought: &Sought,
    from: &Selection,
    progress: Progress,
) -> Result<Closed, TraceError> {
    let searched = search_in(aligned, sought, Some(from), progress.within(SEARCH))?;
    close(aligned, searched, sought, progress.within([SEARCH[1], 1.0]))
}

fn search_in(
    aligned: &mut Aligned,
    sought: &Sought,
    from: Option<&Selection>,
    progress: Progress,
) -> Result<Searched, TraceError> {
    let [fitted, held] = &mut aligned.trajectories;
    if let Some(known) = held.iter().find(|held| brings_nothing_new(held, fitted)) {
        return Err(InputError::new(
            &known.name,
            "is held out, but only repeats fitted recordings",
            "hold out another recording, or none",
        )
        .into());
    }
    let mut roles = Roles::all_fit(fitted);
    if held.is_empty() {
        roles.keep_apart(fitted, Role::HeldOut);
        for (which, trajectory) in fitted.iter_mut().enumerate() {
            let runs = roles.open_runs(which);
            // One that is held out as a whole keeps its own size, like any held-out recording.
            if !runs.is_empty() {
                trajectory.size_force_by(&runs);
            }
        }
    }
    let mut validation = roles.clone();
    validation.keep_apart(fitted, Role::Validation);
    // Whatever the force consists of, eq 13 gives its approximate response to the motion.
    let rough = Search::new(fitted, &validation, vec![0.0], &Sought::default()).rough()?;
    for trajectory in fitted.iter_mut().chain(held.iter_mut()) {
        trajectory.carry_motion_error(|y, v, a| rough.force(y, v, a));
    }
    let predicted = fitted.iter().map(|one| rough.predicted(one)).collect();
    let left = unexplained(fitted, &validation, predicted);
    set_unexplained(fitted, &left);
    let (over_amplitude, selection) = search(fitted, &validation, sought, from, progress)?;
    set_unexplained(fitted, &selection.left);
    Ok(Searched {
        roles,
        validation,
        over_amplitude,
        selection,
    })
}

fn close(
    aligned: &Aligned,
    searched: Searched,
    sought: &Sought,
    progress: Progress,
) -> Result<Closed, TraceError> {
    progress.at(
        0.0,
        "fitting the effects found to all data that is not held out",
    );
    let [fitted, held] = &aligned.trajectories;
    let mut nodes = vec![vec![0.0]];
    let over = amplitude_nodes(fitted, &searched.roles);
    if sought.law != BaseLaw::None && (2..=most_amplitudes()).contains(&over.len()) {
        nodes.insert(usize::from(!searched.over_amplitude), over);
    }
    let roles = [&searched.validation, &searched.roles];
    let closing = Closing::new(fitted, roles, held, nodes, sought);
    Ok(closing.close(searched.selection, progress)?)
}

/// Variance that a law leaves of each recording beyond the tolerance, on the samples that the search fits. `predicted` is its force.
fn unexplained(fitted: &[Trajectory], roles: &Roles, predicted: Vec<Vec<f64>>) -> Vec<f64> {
    let each = fitted.iter().zip(predicted).enumerate();
    each.map(|(which, (trajectory, predicted))| {
        trajectory.left_beyond_tolerance(&predicted, |sample| roles.of(which, sample) == Role::Fit)
    })
    .collect()
}

fn set_unexplained(fitted: &mut [Trajectory], unexplained: &[f64]) {
    for (trajectory, unexplained) in fitted.iter_mut().zip(unexplained) {
        trajectory.unexplained = *unexplained;
    }
}

/// Searches with one set of coefficients for all amplitudes, and with one for each. Returns whether the latter is preferred, and
/// the search with the preferred form.
///
/// The latter is preferred if it predicts the validation cycles clearly better, and by a larger factor than it predicts amplitudes
/// between the nodes worse. Neither form was fitted to those.
fn search(
    fitted: &[Trajectory],
    validation: &Roles,
    sought: &Sought,
    from: Option<&Selection>,
    progress: Progress,
) -> Result<(bool, Selection), ModelError> {
    let nodes = amplitude_nodes(fitted, validation);
    let for_all = Search::new(fitted, validation, vec![0.0], sought);
    if sought.law == BaseLaw::None || nodes.len() < 2 || nodes.len() > most_amplitudes() {
        return Ok((false, for_all.run(from, progress)?));
    }
    let for_each = for_all.with_nodes(nodes.clone());
    let each = for_each.run(from, progress.within([0.0, 0.6]))?;
    // Two laws are compared by the same weights.
    let weighted = for_all.beside_left(each.left.clone());
    let same = weighted.refit(&each.found.solution);
    let is_as_good = |same: &Fitted| !each.found.score.beats(&same.score);
    if let Some(same) = same.as_ref().ok().filter(|same| is_as_good(same)) {
        // The same effects with fewer coefficients.
        let found = Selection {
            found: same.clone(),
            ..each
        };
        return Ok((false, found));
    }
    if for_each
        .beside_left(each.left.clone())
        .is_settled(&each.found)
    {
        let warms_along = same.is_ok_and(|law| weighted.warms_along(&each, &law));
        return Ok((
            true,
            Selection {
                warms_along,
                ..each
            },
        ));
    }
    let one = for_all.run(Some(&each), progress.within([0.6, 0.9]))?;
    let by_one = for_each.beside_left(one.left.clone());
    let by_one = by_one.reweighed(&each.found)?.score;
    if !by_one.beats(&one.found.score) {
        return Ok((false, one));
    }
    progress.at(0.9, "testing amplitudes between the fitted ones");
    let inner = &nodes[1..nodes.len() - 1];
    let between = |nodes: &[f64], found: &Selection| {
        let law = (&found.found.solution, sought.law);
        error_between(fitted, validation, nodes, inner, law)
    };
    let (between_of_each, between_of_one) = (between(&nodes, &each), between(&[0.0], &one));
    let gain = one.found.score.nrmse() / by_one.nrmse();
    let is_better = between_of_each.is_finite() && between_of_each <= gain * between_of_one;
    Ok(if is_better {
        (true, each)
    } else {
        (false, one)
    })
}
