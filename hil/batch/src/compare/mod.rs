//! Compares models of one specimen over time and finds changes beyond their intervals.
//!
//! There are two comparisons. Parameters of the law or of an effect are compared if all models have the same effects: different
//! effects share the force differently, and then parameters differ although the specimen does not. The force of the models on one
//! motion is always compared, and decides: parameters that differ while the force does not have only shared it differently. The
//! motion is within the conditions in which all models were fitted. If an effect appeared that the motion does not show, the
//! comparison decides nothing. With more comparisons, more changes would appear by chance: the claims are corrected for that after
//! Holm (1979).

mod chance;
mod common;
mod force;
mod hidden;
mod holm;
mod moment;
mod parameters;
mod run;
mod unexcited;

use mesh_damper_output::error::InputError;
use serde::Serialize;

pub use common::CommonMotion;
pub use force::{ForceChange, Place};
pub use moment::Moment;
pub use parameters::{Bounds, ParameterChange};
pub use unexcited::Undecided;

mesh_damper_recording::numbers! {
    /// When a model of a specimen is another than before.
    ComparePolicy {
        /// The chance that something is claimed of a specimen that did not change.
        level: f64 = 0.05, Convention("one in twenty");
        /// The intervals of a trace are taken for this many times as wide: from recording to recording a little more differs than they say.
        widened: f64 = 1.2, Tuned("hil/batch/tests/batch/compared.rs, the first 400 specimens that do not change");
        /// Amplitudes of two laws are the same where they differ by no more than this part.
        same_amplitude: f64 = 0.1, Convention("blocks that are meant to be of one amplitude differ by the actuator's error");
        /// Amplitudes, and as many peak velocities, of the motion that all models are put through.
        steps: usize = 4, Convention("quarters of the range");
        /// Cycles of each.
        cycles: u32 = 3, Convention("the first settles what the law remembers");
        /// Samples to the shortest of its cycles.
        samples: f64 = 100.0, Convention("a law is run at 50 to 1000 samples a cycle");
        /// Temperatures that lie no farther apart than this are one, °C.
        same_temperature: f64 = 1.0, Convention("thermometers of a laboratory differ by as much");
        /// A zero that was taken off the displacement is off by this part of half the motion's range.
        zero_error: f64 = 0.01, Convention("as a motion of a hundredth of the largest counts for none");
        /// A force that is at least this many times another, or that part of it, is noted: a unit may be wrong.
        another_size: f64 = 30.0, Convention("between a specimen that failed and a unit that is wrong by a thousand");
        /// An effect is shown where its force is at least this part of what it is where it was found.
        excited: f64 = 0.5, Convention("a half");
    }
}

/// A family of effects that not all models have.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EffectChange {
    /// The family's name.
    pub family: String,
    /// The model, counted from 0, that differs from the one before.
    pub model: usize,
    /// Whether the effect appeared with this model; otherwise the model before it had the effect.
    pub appeared: bool,
}

/// One of the compared models.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Compared {
    /// The path of the model, as given.
    pub name: String,
    /// The model's time, in the unit of the given times; its index, counted from 0, if no times were given.
    pub time: f64,
    /// Families of the model's effects.
    pub effects: Vec<String>,
    /// NRMSE on held-out samples; null if the model's trace does not give it.
    pub nrmse_held_out: Option<f64>,
    /// Whether the model's trace gives the intervals of its parameters.
    pub has_intervals: bool,
}

/// The conclusion of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Conclusion {
    /// A change of the specimen is claimed.
    Changed,
    /// Not decided: an effect appeared or vanished, and the common motion does not excite it.
    UndecidedEffect,
    /// Not decided: the difference of a force to expect by chance is not known.
    UndecidedForce,
    /// All forces agree within their intervals.
    NoChange,
}

impl Conclusion {
    fn of(changed: bool, undecided: &[Undecided], forces: &[ForceChange]) -> Self {
        match changed {
            true => Self::Changed,
            false if !undecided.is_empty() => Self::UndecidedEffect,
            false if forces.iter().any(|one| one.p.is_none()) => Self::UndecidedForce,
            false => Self::NoChange,
        }
    }

    /// As a sentence, for a heading.
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::Changed => "The specimen changed.",
            Self::UndecidedEffect => {
                "Undecided: an effect differs, but the conditions shared by all models do not show it."
            }
            Self::UndecidedForce => {
                "Undecided: the uncertainty of the force is unknown for some models."
            }
            Self::NoChange => "No change beyond the intervals.",
        }
    }
}

/// The changes from model to model.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// The format of the document.
    pub format: &'static str,
    /// The version of the format.
    pub version: u64,
    /// The probability, 0…1, of any claimed change for an unchanged specimen.
    pub level: f64,
    /// The models in the order of time.
    pub models: Vec<Compared>,
    /// Whether a change of the force, and therefore of the specimen, is claimed.
    pub changed: bool,
    /// The conclusion about the specimen.
    pub conclusion: Conclusion,
    /// Effects that not all models have and that the common motion does not excite. They are undecided if no change is claimed.
    pub undecided: Vec<Undecided>,
    /// The common motion of the comparison.
    pub common_motion: CommonMotion,
    /// The force of every model except the first, compared with the force of the first.
    pub forces: Vec<ForceChange>,
    /// The parameters of all models.
    pub parameters: Vec<ParameterChange>,
    /// Effects that appeared or vanished.
    pub effects: Vec<EffectChange>,
    /// Comparisons that were not possible, each with its reason.
    pub notes: Vec<String>,
}

/// Compares models of one specimen.
///
/// # Errors
/// Fewer than two models; a model that the crate refuses; models with no common displacement, velocity, temperature, number of
/// cycles or value of a control input, or for which that range is unknown although a force depends on it.
pub fn compare(mut moments: Vec<Moment>) -> Result<Comparison, InputError> {
    if moments.len() < 2 {
        return Err(InputError::new(
            "the models",
            "there are fewer than two",
            "give models of one specimen from two or more times",
        ));
    }
    let numbers = ComparePolicy::default();
    moments.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut notes = Vec::new();
    for moment in moments.iter().filter(|moment| moment.trace.is_none()) {
        notes.push(format!(
            "{} has no trace.json in its folder: the intervals of its parameters are unknown, so no change is claimed for it",
            moment.name
        ));
    }
    let common_motion = CommonMotion::of(&moments, &numbers, &mut notes)?;
    let effects = effects(&moments);
    let found = force::changes(&moments, &common_motion, &effects, &numbers, &mut notes)?;
    let mut forces = found.changes;
    let mut parameters = parameters::changes(&moments, &found.hides, &numbers, &mut notes);
    let mut chances: Vec<(Option<f64>, &mut bool)> = forces
        .iter_mut()
        .map(|one| (one.p, &mut one.changed))
        .chain(parameters.iter_mut().map(|one| (one.p, &mut one.changed)))
        .collect();
    holm::mark(&mut chances, numbers.level);
    let changed = forces.iter().any(|one| one.changed);
    if !changed {
        // Parameters that differ while the force does not have only shared it differently.
        parameters.iter_mut().for_each(|one| one.changed = false);
    }
    Ok(Comparison {
        format: "mesh-damper comparison",
        version: 2,
        level: numbers.level,
        changed,
        conclusion: Conclusion::of(changed, &found.undecided, &forces),
        undecided: found.undecided,
        models: moments.iter().map(Moment::compared).collect(),
        common_motion,
        forces,
        parameters,
        effects,
        notes,
    })
}

fn effects(moments: &[Moment]) -> Vec<EffectChange> {
    let mut changes = Vec::new();
    for (before, pair) in moments.windows(2).enumerate() {
        let [old, new] = [&pair[0], &pair[1]].map(Moment::families);
        let appeared = new.iter().filter(|family| !old.contains(*family));
        let vanished = old.iter().filter(|family| !new.contains(*family));
        for (families, appeared) in [
            (appeared.collect::<Vec<_>>(), true),
            (vanished.collect(), false),
        ] {
            changes.extend(families.into_iter().map(|family| EffectChange {
                family: family.clone(),
                model: before + 1,
                appeared,
            }));
        }
    }
    changes
}
