//! What a trace is to seek, and beside what.

use mesh_damper_model::Family;

use crate::base_law::BaseLaw;
use crate::known_terms::KnownTerm;

/// Families of effects that a trace may find, and the law beside which they are sought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sought {
    /// Only these; all where there is none.
    pub families: Vec<Family>,
    /// And none of these.
    pub exclude: Vec<Family>,
    /// What the law is without effects.
    pub law: BaseLaw,
    /// The control inputs that the known effects see, by their places.
    pub controls: Vec<String>,
    /// Effects that are known: they stay in the law, and their parameters are fitted with its own.
    pub known: Vec<KnownTerm>,
}

impl Sought {
    /// Whether it has that family.
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
