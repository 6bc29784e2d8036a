//! The effects that a trace may look for, and the base law.

use mesh_damper::effects::Inertia;
use mesh_damper_model::Family;
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::{InputError, Place};
use mesh_damper_recording::rig::{DisplacementZero, RigFacts};

use crate::base_law::BaseLaw;
use crate::families::inertia;
use crate::known_terms::{KnownTerm, known_terms};
use crate::term::Term;

/// Families of effects that a trace may find, and the base law to which they are added.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sought {
    /// Only these; all families if empty.
    pub families: Vec<Family>,
    /// None of these.
    pub exclude: Vec<Family>,
    /// The law without effects.
    pub law: BaseLaw,
    /// The control inputs that the known effects depend on, by index.
    pub controls: Vec<String>,
    /// Known effects: they stay in the law, and their parameters are fitted together with the law's.
    pub known: Vec<KnownTerm>,
    /// Facts about the rig. Its mass is a known effect; see [`Sought::on_rig`].
    pub rig: RigFacts,
    /// Whether effects or a residual table are written even if conditions that were left out do not show that they predict better than the
    /// law alone.
    pub adopt: bool,
}

impl Sought {
    /// All families, on a rig whose displacement reads 0 where the specimen is free.
    pub fn at_recorded_zero() -> Self {
        Self {
            rig: RigFacts {
                zero: Some(DisplacementZero::None),
                ..RigFacts::default()
            },
            ..Self::default()
        }
    }

    /// All families, in addition to the effects of a model, with the control inputs of these. Errors call the model `name`.
    ///
    /// # Errors
    /// The model has a residual table, which would cover for missing effects, or an effect with parameters that no fit can have.
    pub fn beside(model: &ModelFile, name: &str) -> Result<Self, InputError> {
        let model = model.model();
        let refused = |field: &str, problem: &str, remedy: &str| {
            InputError::new(name, problem, remedy).at(Place::Field(field.to_owned()))
        };
        if model.correction.is_some() {
            return Err(refused(
                "correction",
                "is a residual table, which stands in for the effects sought",
                "give a model without it",
            ));
        }
        let effects = model.effects.iter().enumerate().map(|(index, effect)| {
            known_terms(effect).ok_or_else(|| {
                refused(
                    &format!("effects[{index}]"),
                    "has parameters that a trace does not fit",
                    "give the effect as `hil trace` writes it, or leave it out",
                )
            })
        });
        let effects: Vec<Vec<KnownTerm>> = effects.collect::<Result<_, _>>()?;
        let controls = model.controls.into_iter().map(|control| control.name);
        Ok(Self {
            known: effects.concat(),
            controls: controls.collect(),
            ..Self::default()
        })
    }

    /// The same on a rig with these facts. Its mass stays in the law with the stated size.
    ///
    /// # Errors
    /// A mass or a delay that is not finite, a mass beyond the crate's range, or one beside that of a known model.
    pub fn on_rig(mut self, rig: RigFacts) -> Result<Self, InputError> {
        let refused = |field: &str, problem: String, remedy: &str| {
            InputError::new("the rig", problem, remedy).at(Place::Field(field.to_owned()))
        };
        if let Some(delay) = rig.force_delay.filter(|delay| !delay.is_finite()) {
            let problem = format!("a delay of {delay} s is no time");
            return Err(refused("force_delay", problem, "give it in seconds"));
        }
        if let Some(mass) = rig.fixture_mass {
            if let Err(error) = Inertia::new(mass) {
                return Err(refused(
                    "fixture_mass",
                    error.to_string(),
                    "give the mass between specimen and load cell in kg",
                ));
            }
            let form = inertia::FORMS[0];
            if self.known.iter().any(|known| known.term.form == form) {
                return Err(refused(
                    "fixture_mass",
                    "the model of known effects has a mass too".into(),
                    "state the mass once: leave it out of the model, or leave this out",
                ));
            }
            let term = Term {
                form,
                reference: 0.0,
                is_known: true,
                held: Some(mass),
            };
            let shapes = Vec::new();
            self.known.push(KnownTerm { term, shapes });
        }
        self.rig = rig;
        Ok(self)
    }

    /// Whether it permits that family.
    pub fn has(&self, family: Family) -> bool {
        let is_meant = self.families.is_empty() || self.families.contains(&family);
        is_meant && !self.exclude.contains(&family)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_has_all_but_what_is_ruled_out() {
        let named = |names: &[&str]| -> Vec<Family> {
            let each = names.iter();
            each.map(|name| Family::named(name).unwrap()).collect()
        };
        assert!(Family::all().all(|family| Sought::default().has(family)));
        let some = Sought {
            families: named(&["stick_slip", "viscous"]),
            exclude: named(&["viscous"]),
            ..Sought::default()
        };
        let has: Vec<Family> = Family::all().filter(|&family| some.has(family)).collect();
        assert_eq!(has, named(&["stick_slip"]));
    }
}
