//! Families of effects, with their names in every file.

use std::fmt;

use mesh_damper::effects::DESCRIPTIONS;
use mesh_damper::effects::description::{Dependence, Description};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A family of effects: most families have one effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Family(
    /// Index of its first effect in [`DESCRIPTIONS`].
    usize,
);

impl Family {
    /// The family with this name.
    pub fn named(name: &str) -> Option<Self> {
        let first = DESCRIPTIONS.iter().position(|each| each.family == name);
        first.map(Self)
    }

    /// The family of an effect.
    ///
    /// # Panics
    /// Never for a description in the crate's list of effects.
    pub fn of(description: &Description) -> Self {
        Self::named(description.family).expect("the effect stands in the crate's list")
    }

    /// Every family, in the crate's order.
    pub fn all() -> impl Iterator<Item = Self> {
        let all = DESCRIPTIONS.iter().enumerate();
        all.filter(|(place, each)| Self::of(each) == Self(*place))
            .map(|(place, _)| Self(place))
    }

    /// Its first effect.
    pub fn first(self) -> &'static Description {
        &DESCRIPTIONS[self.0]
    }

    /// Its effects.
    pub fn effects(self) -> impl Iterator<Item = &'static Description> {
        DESCRIPTIONS
            .iter()
            .filter(move |each| each.family == self.name())
    }

    /// Its name in every file.
    pub fn name(self) -> &'static str {
        let Description { family, .. } = self.first();
        family
    }

    /// The quantities that the force of any of its effects depends on.
    pub fn depends_on(self) -> impl Iterator<Item = &'static str> {
        let mut names = Vec::new();
        for each in self.effects().flat_map(|effect| effect.depends_on) {
            if !names.contains(&each.name()) {
                names.push(each.name());
            }
        }
        names.into_iter()
    }

    /// Whether its force depends on a control input.
    pub fn depends_on_control(self) -> bool {
        let mut effects = self.effects();
        effects.any(|effect| effect.depends_on.contains(&Dependence::Control))
    }

    /// Whether its force changes with the number of cycles.
    pub fn depends_on_cycles(self) -> bool {
        let mut effects = self.effects();
        effects.any(|effect| effect.depends_on.contains(&Dependence::Cycle))
    }

    /// Whether its force changes with the temperature.
    pub fn depends_on_temperature(self) -> bool {
        self.effects().any(Description::depends_on_temperature)
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Serialize for Family {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for Family {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Family".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let names: Vec<&str> = Self::all().map(Self::name).collect();
        schemars::json_schema!({
            "type": "string",
            "description": "A family of effects, by its name.",
            "enum": names,
        })
    }
}

impl<'de> Deserialize<'de> for Family {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let name = String::deserialize(deserializer)?;
        Self::named(&name).ok_or_else(|| {
            let known: Vec<String> = Self::all().map(|each| format!("`{each}`")).collect();
            serde::de::Error::custom(format!(
                "unknown variant `{name}`, expected one of {}",
                known.join(", ")
            ))
        })
    }
}

/// The unit of an effect's parameter by its name, or `None` for a name that no effect has.
///
/// If an effect has several elements, the parameters of the second and later ones carry a number: `slip_limit_2`.
pub fn parameter_unit(name: &str) -> Option<&'static str> {
    let parameters = DESCRIPTIONS.iter().flat_map(|each| each.parameters);
    let base = base_name(name);
    parameters
        .filter(|parameter| parameter.name == base)
        .map(|parameter| parameter.unit)
        .next()
}

/// `slip_limit` of `slip_limit_2`.
pub fn base_name(name: &str) -> &str {
    name.rsplit_once('_')
        .filter(|(_, number)| number.bytes().all(|byte| byte.is_ascii_digit()))
        .map_or(name, |(base, _)| base)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// Code that reads a parameter by its name alone relies on one unit per name.
    #[test]
    fn a_name_has_one_unit() {
        for each in DESCRIPTIONS.iter().flat_map(|each| each.parameters) {
            assert_eq!(parameter_unit(each.name), Some(each.unit), "{}", each.name);
        }
    }

    #[test]
    fn every_family_is_found_by_its_name() {
        let names = DESCRIPTIONS.iter().map(|effect| effect.family);
        let distinct: BTreeSet<&str> = names.collect();
        assert_eq!(Family::all().count(), distinct.len());
        for family in Family::all() {
            assert_eq!(Family::named(family.name()), Some(family));
        }
        assert_eq!(Family::named("none"), None);
    }

    #[test]
    fn a_family_depends_on_all_that_its_effects_do() {
        for effect in DESCRIPTIONS {
            let of_family: Vec<&str> = Family::of(effect).depends_on().collect();
            for each in effect.depends_on {
                let times = of_family.iter().filter(|name| **name == each.name());
                assert_eq!(times.count(), 1, "{}: {of_family:?}", effect.name);
            }
        }
    }

    #[test]
    fn numbers_and_names_of_effects_are_distinct() {
        for (place, each) in DESCRIPTIONS.iter().enumerate() {
            for other in &DESCRIPTIONS[..place] {
                assert_ne!(each.number, other.number);
                assert_ne!(each.name, other.name);
            }
        }
    }
}
