//! Units that a file states beside its arrays: texts in a group called `units`, each with the name of an array.

use std::collections::{HashMap, HashSet};

use mesh_damper_output::error::InputError;

use super::arrays::Array;
use super::groups::{Group, Groups};
use crate::budget::of_text;

/// Names of a group whose texts are the units of the arrays beside it, or in groups beside it.
const UNITS: [&str; 3] = ["units", "unit", "einheiten"];

/// Whether a group of this name may hold units.
pub(super) fn are_units(group: &str) -> bool {
    UNITS.iter().any(|word| group.eq_ignore_ascii_case(word))
}

/// The units that a file states beside its arrays, in its order.
#[derive(Clone, Debug, Default)]
pub(super) struct UnitsBeside {
    stated: Vec<Stated>,
}

/// The unit of arrays.
#[derive(Clone, Debug)]
struct Stated {
    /// The group of units in which it is stated. The arrays are those below the group around it.
    group: Group,
    /// Their name.
    name: String,
    unit: String,
}

impl UnitsBeside {
    /// Takes the `unit` of the arrays called `name` from a group of units.
    ///
    /// # Errors
    /// A budget that is used up.
    pub fn add(
        &mut self,
        groups: &Groups,
        group: Group,
        name: &str,
        unit: &str,
    ) -> Result<(), InputError> {
        let unit = unit.trim();
        if unit.is_empty() {
            return Ok(());
        }
        let bytes = COST + of_text(name.len()) + of_text(unit.len());
        groups.budget().hold(bytes, "the units beside its arrays")?;
        self.stated.push(Stated {
            group,
            name: name.to_owned(),
            unit: unit.to_owned(),
        });
        Ok(())
    }

    /// Gives each array that has no unit those that are stated nearest to it. Returns the texts that have no array, as comments with
    /// their place, whose parts are separated by `separator`: a unit under test is described in the same way.
    ///
    /// # Errors
    /// A budget that is used up.
    pub fn give<S>(
        self,
        groups: &Groups,
        arrays: &mut [Array<S>],
        separator: &str,
    ) -> Result<Vec<String>, InputError> {
        if self.stated.is_empty() {
            return Ok(Vec::new());
        }
        // By the name, then by the group around them.
        let mut units: HashMap<&str, HashMap<Group, Vec<&str>>> = HashMap::new();
        let mut seen = HashSet::new();
        let around = |group| groups.upward(group).nth(1).unwrap_or(Group::FILE);
        for Stated { group, name, unit } in &self.stated {
            let around = around(*group);
            let of_it = units.entry(name).or_default().entry(around).or_default();
            if seen.insert((around, name, unit)) {
                of_it.push(unit);
            }
        }
        let mut used: HashSet<(&str, Group)> = HashSet::new();
        for Array { group, column, .. } in arrays {
            let Some((&name, stated)) = units.get_key_value(column.name.as_str()) else {
                continue;
            };
            let mut nearest = None;
            for each in groups.upward(*group) {
                if let Some(units) = stated.get(&each) {
                    used.insert((name, each));
                    nearest = nearest.or(Some(units));
                }
            }
            if let (None, Some(nearest)) = (&column.unit, nearest) {
                let bytes = nearest.iter().map(|unit| of_text(unit.len())).sum();
                groups.budget().hold(bytes, "the units of its columns")?;
                let mut nearest = nearest.iter().map(|unit| (*unit).to_owned());
                column.unit = nearest.next();
                column.other_units = nearest.collect();
            }
        }
        let mut spare = Vec::new();
        for Stated { group, name, unit } in &self.stated {
            if !used.contains(&(name, around(*group))) {
                let part = "its comments";
                let place = groups.label([Group::FILE, *group], Some(name), separator, part)?;
                groups.budget().hold(of_text(unit.len()), part)?;
                spare.push(format!("{place}: {unit}"));
            }
        }
        Ok(spare)
    }
}

/// What a unit takes beside its texts while it is given to arrays: its places in the maps.
const COST: u64 = 128;

#[cfg(test)]
mod tests {
    use std::rc::Rc;

    use super::*;
    use crate::budget::Budget;
    use crate::files::Column;
    use crate::read_limit::ReadLimit;

    /// The file's groups, with room for what a test makes.
    fn groups() -> Groups {
        Groups::new(Rc::new(Budget::new("a.json", ReadLimit::new(1 << 20))))
    }

    fn group(groups: &mut Groups, path: &str) -> Group {
        let parts = path.split('/').filter(|part| !part.is_empty());
        parts.fold(Group::FILE, |above, name| {
            groups.inside(above, name).unwrap()
        })
    }

    fn array(groups: &mut Groups, path: &str, unit: Option<&str>) -> Array<()> {
        let (above, name) = path.rsplit_once('/').unwrap_or(("", path));
        Array {
            group: group(groups, above),
            column: Column {
                name: name.into(),
                unit: unit.map(str::to_owned),
                ..Column::default()
            },
            rows: 2,
            clock: None,
            source: (),
        }
    }

    /// The units of each array, and the comments.
    fn given(
        stated: &[(&str, &str, &str)],
        arrays: &[(&str, Option<&str>)],
    ) -> (Vec<String>, Vec<String>) {
        let mut groups = groups();
        let mut units = UnitsBeside::default();
        for (above, name, unit) in stated {
            let place = group(&mut groups, &format!("{above}/units"));
            units.add(&groups, place, name, unit).unwrap();
        }
        let mut arrays: Vec<Array<()>> = (arrays.iter())
            .map(|(path, unit)| array(&mut groups, path, *unit))
            .collect();
        let comments = units.give(&groups, &mut arrays, "/").unwrap();
        let of = |array: &Array<()>| {
            let first = array.column.unit.iter();
            let all: Vec<&str> = first
                .chain(&array.column.other_units)
                .map(String::as_str)
                .collect();
            all.join(" ")
        };
        (arrays.iter().map(of).collect(), comments)
    }

    #[test]
    fn the_nearest_units_count_and_all_that_differ_are_kept() {
        let arrays = [
            ("force", None),
            ("run/force", None),
            ("run/inner/force", None),
            ("run/time", Some("ms")),
            ("other/time", None),
        ];
        let stated = [
            ("", "force", "N"),
            ("run", "force", "kN"),
            ("run", "force", " "),
            ("", "force", " N "),
            ("run", "force", "kip"),
            ("run", "time", "s"),
        ];
        let (units, comments) = given(&stated, &arrays);
        assert_eq!(units, ["N", "kN kip", "kN kip", "ms", ""]);
        assert!(comments.is_empty(), "{comments:?}");
    }

    #[test]
    fn a_text_without_an_array_is_a_comment() {
        let stated = [
            ("run", "rig", "B"),
            ("other", "force", "N"),
            ("", "force", "kN"),
        ];
        let (units, comments) = given(&stated, &[("run/force", None)]);
        assert_eq!(units, ["kN"]);
        assert_eq!(comments, ["run/units/rig: B", "other/units/force: N"]);
    }

    #[test]
    fn all_units_of_many_arrays_are_charged_for_each() {
        let mut groups = groups();
        let mut units = UnitsBeside::default();
        let place = group(&mut groups, "units");
        for index in 0..100 {
            units.add(&groups, place, "x", &index.to_string()).unwrap();
        }
        let mut of = |count: usize| -> Result<Vec<Array<()>>, InputError> {
            let paths = (0..count).map(|run| format!("{run}/x"));
            let mut arrays: Vec<Array<()>> =
                paths.map(|path| array(&mut groups, &path, None)).collect();
            units.clone().give(&groups, &mut arrays, "/")?;
            Ok(arrays)
        };
        assert_eq!(of(1).unwrap()[0].column.other_units.len(), 99);
        let error = of(50).unwrap_err().to_string();
        assert!(error.contains("the units of its columns"), "{error}");
    }
}
