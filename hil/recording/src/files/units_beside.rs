//! Units that a file states beside its arrays: texts in a group called `units`, each with the name of an array.

use std::collections::{HashMap, HashSet};

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
    stated: Vec<Stated>,
}

/// A text that is the unit of the arrays of a name below a group.
#[derive(Clone, Debug)]
struct Stated {
    group: Vec<String>,
    name: String,
    unit: String,
    /// Where it stands, for a comment: `units.force`.
    place: String,
}

impl UnitsBeside {
    /// Takes the `unit` of the arrays called `name` below `group`, from a `place` of the file.
    pub fn add(&mut self, group: &[String], name: &str, unit: &str, place: String) {
        let unit = unit.trim();
        if !unit.is_empty() {
            self.stated.push(Stated {
                group: group.to_vec(),
                name: name.to_owned(),
                unit: unit.to_owned(),
                place,
            });
        }
    }

    /// Gives each array that has no unit those that are stated nearest to it. Returns the texts that have no array, as comments: a
    /// unit under test is described in the same way.
    pub fn give<S>(self, arrays: &mut [Array<S>]) -> Vec<String> {
        if self.stated.is_empty() {
            return Vec::new();
        }
        let mut units: HashMap<(&[String], &str), Vec<&str>> = HashMap::new();
        for Stated {
            group, name, unit, ..
        } in &self.stated
        {
            let of_it = units.entry((group, name)).or_default();
            if of_it.len() < MOST && !of_it.contains(&unit.as_str()) {
                of_it.push(unit);
            }
        }
        let mut used: HashSet<(&[String], &str)> = HashSet::new();
        for Array { group, column, .. } in arrays {
            let name = column.name.as_str();
            let around = (0..=group.len()).rev().map(|length| &group[..length]);
            let mut stated = around.filter_map(|group| units.get_key_value(&(group, name)));
            let nearest = stated.next();
            used.extend(nearest.into_iter().chain(stated).map(|(key, _)| *key));
            if let (None, Some((_, nearest))) = (&column.unit, nearest) {
                let mut nearest = nearest.iter().map(|unit| (*unit).to_owned());
                column.unit = nearest.next();
                column.other_units = nearest.collect();
            }
        }
        let is_spare = |stated: &&Stated| !used.contains(&(&stated.group, stated.name.as_str()));
        let spare = self.stated.iter().filter(is_spare);
        spare
            .map(|stated| format!("{}: {}", stated.place, stated.unit))
            .collect()
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
            let place = format!("{above}/units/{name}");
            units.add(&group(above), name, unit, place);
        }
        let comments = units.give(arrays);
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
    fn a_file_of_nothing_but_units_takes_no_time_of_each_unit_for_each_array() {
        let mut units = UnitsBeside::default();
        for index in 0..100_000 {
            units.add(&[], "x", &index.to_string(), String::new());
        }
        let mut arrays: Vec<Array<()>> = (0..20_000).map(|_| array("x", None)).collect();
        assert!(units.give(&mut arrays).is_empty());
        assert!(
            arrays
                .iter()
                .all(|array| array.column.other_units.len() == MOST - 1)
        );
    }
}
