//! The effects that a trace may look for, and the base law.

use mesh_damper_model::Family;
use mesh_damper_model::file::ModelFile;
use mesh_damper_output::error::{InputError, Place};

use crate::base_law::BaseLaw;
use crate::known_terms::{KnownTerm, known_terms};

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
}

impl Sought {
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
