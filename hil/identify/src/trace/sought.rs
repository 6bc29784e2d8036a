//! What a trace is to seek.

use mesh_damper_model::Family;

/// Families of effects that a trace may find.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sought {
    /// Only these; all where there is none.
    pub families: Vec<Family>,
    /// And none of these.
    pub exclude: Vec<Family>,
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
        };
        let has: Vec<Family> = Family::all().filter(|&family| some.has(family)).collect();
        assert_eq!(has, named(&["stick_slip"]));
    }
}
