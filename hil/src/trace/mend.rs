//! What is done when no listed effect explains a recording: a correction that needs no name.

use super::score::Jury;
use super::split::{Role, Roles};
use crate::identify::correction;
use crate::model::{Model, ModelError};
use crate::predict::{nrmse, predict};
use crate::recording::cycles::Block;
use crate::recording::trajectory::Trajectory;

/// With fewer blocks none can be left out.
const FEWEST_BLOCKS: usize = 4;

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
    if trial.nrmse() >= score(found)?.nrmse()
        || !predicts_new_blocks(trajectories, roles, model, found)?
    {
        return Ok(None);
    }
    correction::fit(trajectories, model, |which, sample| {
        roles.of(which, sample) != Role::HeldOut
    })
}

/// Whether `model` with a correction fitted to everything but a block predicts that block better than `found` does, which
/// was fitted to it too: a table may know the conditions that it was fitted to and no others.
fn predicts_new_blocks(
    trajectories: &[Trajectory],
    roles: &Roles,
    model: &Model,
    found: &Model,
) -> Result<bool, ModelError> {
    let mut blocks: Vec<(usize, &Block)> = trajectories
        .iter()
        .enumerate()
        .flat_map(|(which, trajectory)| trajectory.blocks.iter().map(move |block| (which, block)))
        .filter(|(which, block)| {
            let fitted = |sample| roles.of(*which, sample) != Role::HeldOut;
            block.cycles.len() > 1 && block.samples.clone().any(fitted)
        })
        .collect();
    if blocks.len() < FEWEST_BLOCKS {
        return Ok(true);
    }
    blocks.sort_by(|a, b| {
        let key = |block: &Block| (block.amplitude, block.frequency);
        key(a.1)
            .0
            .total_cmp(&key(b.1).0)
            .then(key(a.1).1.total_cmp(&key(b.1).1))
    });
    let (mut corrected, mut known) = (0.0, 0.0);
    for quarter in 1..4 {
        let (which, block) = blocks[quarter * blocks.len() / 4];
        let others = |trajectory: usize, sample: usize| {
            roles.of(trajectory, sample) != Role::HeldOut
                && !(trajectory == which && block.samples.contains(&sample))
        };
        let Some(trial) = correction::fit(trajectories, model, others)? else {
            return Ok(false);
        };
        let trajectory = &trajectories[which];
        let error = |model: &Model| {
            let predicted = predict(model, trajectory)?;
            Ok::<_, ModelError>(nrmse(&predicted, &trajectory.force, |sample| {
                block.samples.contains(&sample) && trajectory.is_telling(sample)
            }))
        };
        corrected += error(&trial)?.powi(2);
        known += error(found)?.powi(2);
    }
    Ok(corrected < known)
}
