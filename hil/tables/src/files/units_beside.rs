//! Units that a file states beside its arrays: texts in a group called `units`, each with the name of an array.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::arrays::Array;

/// Names of a group whose texts are the units of the arrays beside it, or in groups beside it.
const UNITS: [&str; 3] = ["units", "unit", "einheiten"];
/// The most units that are kept of one array. Convention: a few programs may have written a file; more are no units.
const MOST: usize = 16;

/// Whether a group of this name may hold units.
pub(super) fn are_units(group: &str) -> bool {
    UNITS.iter().any(|word| group.eq_ignore_ascii_case(word))
}

/// The units that a file states beside its arrays, in its order.
#[derive(Clone, Debug, Default)]
pub(super) struct UnitsBeside {
    groups: Vec<Group>,
}

/// A group of units.
#[derive(Clone, Debug)]
struct Group {
    /// Its place; the units are those of the arrays below the group around it.
    path: Vec<String>,
    /// The names of arrays, each with its unit.
    units: Vec<(String, String)>,
}

impl UnitsBeside {
    /// Takes the `unit` of the arrays called `name` from the group of units at `path`.
    pub fn add(&mut self, path: &[String], name: &str, unit: &str) {
        let unit = unit.trim();
        if unit.is_empty() {
            return;
        }
        let units = (name.to_owned(), unit.to_owned());
        match self.groups.last_mut() {
            Some(group) if group.path == path => group.units.push(units),
            _ => self.groups.push(Group {
                path: path.to_vec(),
                units: vec![units],
            }),
        }
    }

    /// Gives each array that has no unit those that are stated nearest to it. Returns the texts that have no array, as comments with
    /// their place, whose parts are separated by `separator`: a unit under test is described in the same way.
    pub fn give<S>(self, arrays: &mut [Array<S>], separator: &str) -> Vec<String> {
        let mut units: HashMap<(&[String], &str), Vec<&str>> = HashMap::new();
        let mut depths: BTreeSet<usize> = BTreeSet::new();
        for group in &self.groups {
            depths.insert(group.around().len());
            for (name, unit) in &group.units {
                let of_it = units.entry((group.around(), name)).or_default();
                if of_it.len() < MOST && !of_it.contains(&unit.as_str()) {
                    of_it.push(unit);
                }
            }
        }
        let mut used: HashSet<(&[String], &str)> = HashSet::new();
        for Array { group, column, .. } in arrays {
            let name = column.name.as_str();
            let around = depths.iter().rev().filter_map(|&depth| group.get(..depth));
            let mut stated = around.filter_map(|group| units.get_key_value(&(group, name)));
            let nearest = stated.next();
            used.extend(nearest.into_iter().chain(stated).map(|(key, _)| *key));
            if let (None, Some((_, nearest))) = (&column.unit, nearest) {
                let mut nearest = nearest.iter().map(|unit| (*unit).to_owned());
                column.unit = nearest.next();
                column.other_units = nearest.collect();
            }
        }
        let mut spare = Vec::new();
        for group in &self.groups {
            let place = group.path.join(separator);
            let is_spare =
                |(name, _): &&(String, String)| !used.contains(&(group.around(), name.as_str()));
            let units = group.units.iter().filter(is_spare);
            spare.extend(units.map(|(name, unit)| format!("{place}{separator}{name}: {unit}")));
        }
        spare
    }
}

impl Group {
    /// The path of the group around it.
    fn around(&self) -> &[String] {
        self.path.split_last().map_or(&[], |(_, around)| around)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Column;

    fn group(path: &str) -> Vec<String> {
        let parts = path.split('/').filter(|part| !part.is_empty());
        parts.map(str::to_owned).collect()
    }

    fn array(path: &str, unit: Option<&str>) -> Array<()> {
        let (above, name) = path.rsplit_once('/').unwrap_or(("", path));
        Array {
            group: group(above),
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
        arrays: &mut [Array<()>],
    ) -> (Vec<String>, Vec<String>) {
        let mut units = UnitsBeside::default();
        for (above, name, unit) in stated {
            let mut path = group(above);
            path.push("units".into());
            units.add(&path, name, unit);
        }
        let comments = units.give(arrays, "/");
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
        let mut arrays = [
            array("force", None),
            array("run/force", None),
            array("run/inner/force", None),
            array("run/time", Some("ms")),
            array("other/time", None),
        ];
        let stated = [
            ("", "force", "N"),
            ("run", "force", "kN"),
            ("run", "force", " "),
            ("", "force", " N "),
            ("run", "force", "kip"),
            ("run", "time", "s"),
        ];
        let (units, comments) = given(&stated, &mut arrays);
        assert_eq!(units, ["N", "kN kip", "kN kip", "ms", ""]);
        assert!(comments.is_empty(), "{comments:?}");
    }

    #[test]
    fn a_text_without_an_array_is_a_comment() {
        let mut arrays = [array("run/force", None)];
        let stated = [
            ("run", "rig", "B"),
            ("other", "force", "N"),
            ("", "force", "kN"),
        ];
        let (units, comments) = given(&stated, &mut arrays);
        assert_eq!(units, ["kN"]);
        assert_eq!(comments, ["run/units/rig: B", "other/units/force: N"]);
    }

    #[test]
    fn no_array_keeps_all_units_of_a_file_of_nothing_else() {
        let mut units = UnitsBeside::default();
        for index in 0..1000 {
            units.add(&group("units"), "x", &index.to_string());
        }
        let mut arrays = [array("x", None)];
        assert!(units.give(&mut arrays, "/").is_empty());
        assert_eq!(arrays[0].column.other_units.len(), MOST - 1);
    }
}
