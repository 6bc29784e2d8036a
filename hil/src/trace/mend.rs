//! What is done when no listed effect explains a recording: a correction that needs no name, and on what the force depends.

use super::score::Jury;
use super::split::{Role, Roles};
use crate::identify::correction;
use crate::model::{Model, ModelError};
use crate::predict::predict;
use crate::recording::trajectory::Trajectory;

/// `baseline` or `found` with a correction: the latter only where the judging cycles are predicted clearly better with its
/// effects beside the table than by the table alone. `None` where no table predicts better than `found` does without one.
///
/// The form is judged by the roles `judging`; the fit that is returned leaves out only what `roles` hold out.
pub(super) fn mended(
    trajectories: &[Trajectory],
    [judging, roles]: [&Roles; 2],
    [baseline, found]: [&Model; 2],
) -> Result<Option<Model>, ModelError> {
    let jury = Jury::of(trajectories, judging, Role::Judge);
    let score = |model: &Model| {
        let predicted = trajectories
            .iter()
            .map(|trajectory| predict(model, trajectory))
            .collect::<Result<Vec<_>, _>>()?;
        Ok::<_, ModelError>(jury.score(&predicted))
    };
    let corrected = |model: &Model| {
        correction::fit(trajectories, model, |which, sample| {
            judging.of(which, sample) == Role::Fit
        })
    };
    let mut best = None;
    for model in [baseline, found] {
        if best.is_some() && model.effects.is_empty() {
            continue;
        }
        if let Some(trial) = corrected(model)? {
            let trial = score(&trial)?;
            if best.as_ref().is_none_or(|(_, other)| trial.beats(other)) {
                best = Some((model, trial));
            }
        }
    }
    let Some((model, trial)) = best else {
        return Ok(None);
    };
    if trial.nrmse() >= score(found)?.nrmse() {
        return Ok(None);
    }
    correction::fit(trajectories, model, |which, sample| {
        roles.of(which, sample) != Role::HeldOut
    })
}
