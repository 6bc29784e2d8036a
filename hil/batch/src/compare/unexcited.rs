//! Effects that not all models have, and that the common motion does not show.

use mesh_damper_model::{Family, Model, ModelError};
use mesh_damper_output::error::InputError;
use serde::Serialize;

use super::chance::{Chance, differences, mean_square};
use super::run::{Held, Run};
use super::{ComparePolicy, EffectChange, Moment};

/// An effect that appeared or vanished, but that the common conditions of the models do not excite.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Undecided {
    /// The family's name.
    pub family: String,
    /// The model, counted from 0, with which the effect appeared or vanished.
    pub model: usize,
    /// The test that would show whether the specimen changed, as a sentence.
    pub would_show: String,
}

/// Whether the effect of a `change` is undecided; `chance` is that of the two models on the run.
pub(super) fn of(
    change: &EffectChange,
    moments: &[Moment],
    run: &Run,
    chance: Chance,
    numbers: &ComparePolicy,
) -> Result<Option<Undecided>, InputError> {
    let (with, without) = match change.appeared {
        true => (&moments[change.model], &moments[change.model - 1]),
        false => (&moments[change.model - 1], &moments[change.model]),
    };
    let refused = |error: ModelError| mesh_damper_model::file::model_error(&with.name, &error);
    let model = with.model.model();
    let Some(family) = Family::named(&change.family) else {
        return Ok(None);
    };
    let mut alone = model.clone();
    alone.effects.retain(|effect| effect.family != family);
    let shown = |under: Option<Held>| -> Result<f64, ModelError> {
        let force = |model: &Model| match &under {
            Some(held) => run.held(model, 0.0, held),
            None => run.force(model, 0.0),
        };
        Ok(mean_square(&differences(&force(&model)?, &force(&alone)?)))
    };
    let here = shown(None).map_err(refused)?;
    let is_lost = chance.exceeds(here).is_none_or(|p| p > numbers.level);
    let mut elsewhere = 0.0_f64;
    for held in own_ends(with, &family, run) {
        elsewhere = elsewhere.max(shown(Some(held)).map_err(refused)?);
    }
    if !is_lost && here >= numbers.excited.powi(2) * elsewhere {
        return Ok(None);
    }
    Ok(Some(Undecided {
        family: change.family.clone(),
        model: change.model,
        would_show: would_show(&family, with, without),
    }))
}

/// The ends of the conditions of the model that has the effect, as far as its force depends on them.
fn own_ends(moment: &Moment, family: &Family, run: &Run) -> Vec<Held> {
    let Some(conditions) = moment.conditions() else {
        return Vec::new();
    };
    let middle = run.middle();
    let mut ends = Vec::new();
    if let Some(range) = conditions
        .temperature
        .filter(|_| family.depends_on_temperature())
    {
        ends.extend(range.map(|temperature| middle.at_temperature(temperature)));
    }
    if family.depends_on_cycles() {
        let cycles = conditions.cycles;
        ends.extend(cycles.map(|cycles| middle.after_cycles(cycles)));
    }
    ends
}

fn would_show(family: &Family, with: &Moment, without: &Moment) -> String {
    let conditions = with.conditions();
    let temperature = conditions.and_then(|conditions| conditions.temperature);
    let under = match (temperature, conditions) {
        (Some([low, high]), _) if family.depends_on_temperature() => {
            format!("at {low:.1} to {high:.1} °C")
        }
        (_, Some(conditions)) if family.depends_on_cycles() => {
            format!("over {:.0} cycles", conditions.cycles[1])
        }
        _ => {
            let range = with.model.fitted_range();
            let [low, high] = range.displacement.map(|end| end + with.zero());
            let [slow, fast] = range.velocity.map(f64::abs);
            format!(
                "between {low:.3} and {high:.3} mm, to {:.3} mm/s",
                slow.max(fast)
            )
        }
    };
    format!(
        "a recording of the specimen in its state at {} {under}, the conditions of {}",
        without.name, with.name
    )
}
