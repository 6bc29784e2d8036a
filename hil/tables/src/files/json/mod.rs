//! JSON: an object of arrays, an array of objects, `columns` and `data` as in pandas, an object on each line, or objects that each
//! describe a channel.

mod node;

use std::rc::Rc;

use mesh_damper_output::error::InputError;
use serde::de::{DeserializeSeed as _, IgnoredAny};
use serde_json::Deserializer;

use super::arrays::{Array, Located, arranged, name_of};
use super::beside::Beside;
use super::groups::{Group, Groups};
use super::guard::damaged;
use super::number::shown;
use super::opened::Opened;
use super::units_beside::{UnitsBeside, are_units};
use super::unread::is_json;
use super::{Column, Format, Reading, Source, Tables};
use crate::budget::{Budget, of_list, of_text};
use node::{Channel, Fields, List, Node, Reader, Seed};

const NAME: &str = "JSON";

/// JSON, or JSON lines.
pub(super) struct Json;

impl Format for Json {
    fn name(&self) -> &'static str {
        NAME
    }

    fn endings(&self) -> &'static [&'static str] {
        &["json", "jsonl", "ndjson"]
    }

    fn recognizes(&self, head: &[u8]) -> bool {
        is_json(head)
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        reading: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (name, budget) = (source.name(), source.budget());
        let mut bytes = source.bytes()?;
        let read = bytes.len() as u64;
        if bytes.starts_with(b"\xef\xbb\xbf") {
            bytes.drain(..3);
        }
        bare_words(&mut bytes);
        let root = parsed(&name, &bytes, &budget)?;
        drop(bytes);
        budget.release(read);
        let made = root.bytes();
        let mut found = Found::new(Groups::new(Rc::clone(&budget)));
        found.take(Group::FILE, None, root)?;
        let Found {
            groups,
            mut arrays,
            skipped,
            mut comments,
            mut beside,
            units,
            kept,
        } = found;
        // All but the values that the arrays took.
        budget.release(made - kept);
        comments.extend(units.give(&groups, &mut arrays, "/")?);
        beside.heed(reading);
        let mut copied = |values: &Values| {
            budget.hold(of_list::<f64>(values.len()), "its times")?;
            Ok(values.to_vec())
        };
        let (mut tables, mut sources) = arranged(&groups, arrays, beside, &mut copied)?;
        let Some(table) = tables.first_mut() else {
            return Err(no_columns(name, &skipped));
        };
        table.skipped.extend(skipped);
        let charged = Rc::clone(&budget);
        let read = move |table: usize, column: usize| {
            let columns: &mut Vec<Values> = &mut sources[table];
            let values = std::mem::take(&mut columns[column]);
            if Rc::strong_count(&values) > 1 {
                budget.hold(of_list::<f64>(values.len()), "the values of its columns")?;
            }
            Ok(Some(Rc::unwrap_or_clone(values)))
        };
        Ok(Box::new(Opened::new(
            NAME, charged, name, tables, comments, read,
        )?))
    }
}

/// The values of a column, which the tables of several runs may share.
type Values = Rc<Vec<f64>>;

impl Located for Values {
    fn key(&self) -> [usize; 4] {
        [self.as_ptr().addr(), 0, 0, 0]
    }
}

/// Most parts of a file that a message lists. Convention: one line of a terminal, or two.
const LISTED: usize = 8;

/// Error of a file with none of the shapes that are read.
fn no_columns(name: String, skipped: &[String]) -> InputError {
    let listed: Vec<&str> = skipped.iter().take(LISTED).map(String::as_str).collect();
    let more = if skipped.len() > LISTED { ", …" } else { "" };
    let parts = if listed.is_empty() {
        String::new()
    } else {
        format!("; not read: {}{more}", listed.join(", "))
    };
    InputError::new(
        name,
        format!("holds no columns of numbers in a shape that is read{parts}"),
        "write one list for each column, {\"time_s\": [0, 0.01], \"force_kN\": [1, 2]}, one object for each sample, [{\"time_s\": 0, \"force_kN\": 1}], or one object for each channel, [{\"name\": \"force\", \"unit\": \"kN\", \"values\": [1, 2]}]",
    )
}

/// The value of a file, or the list of those on its lines.
fn parsed(name: &str, bytes: &[u8], budget: &Budget) -> Result<Node, InputError> {
    let mut from = Deserializer::from_slice(bytes);
    let reader = Reader::new(budget);
    let broken = |error: serde_json::Error| {
        let refused = reader.refused.take();
        refused.unwrap_or_else(|| damaged(NAME, name, error))
    };
    let first = Seed(&reader).deserialize(&mut from).map_err(broken)?;
    if from.end().is_ok() {
        return Ok(first);
    }
    let mut list = List::new(budget);
    list.push(first)?;
    // Where each value ends; the first is known.
    let mut values = Deserializer::from_slice(bytes).into_iter::<IgnoredAny>();
    values.next();
    let mut begin = values.byte_offset();
    while let Some(value) = values.next() {
        value.map_err(broken)?;
        let end = values.byte_offset();
        let mut from = Deserializer::from_slice(&bytes[begin..end]);
        list.push(Seed(&reader).deserialize(&mut from).map_err(broken)?)?;
        begin = end;
    }
    list.finish()
}

/// Python writes `NaN` and `Infinity`, which are not JSON: they become a missing number.
fn bare_words(bytes: &mut [u8]) {
    let mut is_text = false;
    let mut at = 0;
    while at < bytes.len() {
        match bytes[at] {
            b'\\' if is_text => at += 1,
            b'"' => is_text = !is_text,
            b'N' | b'I' | b'-' if !is_text => {
                let words = [&b"NaN"[..], b"Infinity", b"-Infinity"];
                if let Some(word) = words.into_iter().find(|word| bytes[at..].starts_with(word)) {
                    let place = &mut bytes[at..at + word.len()];
                    place.fill(b' ');
                    place[..2].fill(b'"');
                    at += word.len() - 1;
                }
            }
            _ => {}
        }
        at += 1;
    }
}

/// Findings in a file.
struct Found {
    groups: Groups,
    arrays: Vec<Array<Values>>,
    skipped: Vec<String>,
    comments: Vec<String>,
    beside: Beside,
    units: UnitsBeside,
    /// Bytes of the values that the arrays took.
    kept: u64,
}

impl Found {
    fn new(groups: Groups) -> Self {
        Self {
            groups,
            arrays: Vec::new(),
            skipped: Vec::new(),
            comments: Vec::new(),
            beside: Beside::default(),
            units: UnitsBeside::default(),
            kept: 0,
        }
    }

    /// The group called `name` in another, or that itself: the file has no name.
    fn within(&mut self, group: Group, name: Option<&str>) -> Result<Group, InputError> {
        match name {
            Some(name) => self.groups.inside(group, name),
            None => Ok(group),
        }
    }

    fn label(&self, group: Group, name: Option<&str>, part: &str) -> Result<String, InputError> {
        self.groups.label([Group::FILE, group], name, "/", part)
    }

    fn skip(&mut self, what: String) -> Result<(), InputError> {
        (self.groups.budget()).hold(of_text(what.len()), "what it has that is not read")?;
        self.skipped.push(what);
        Ok(())
    }

    /// Takes a value called `name` in a group; the file's value has no name.
    fn take(&mut self, group: Group, name: Option<&str>, node: Node) -> Result<(), InputError> {
        let plain = name.unwrap_or("value");
        let unread = "what it has that is not read";
        match node {
            Node::Object(fields) => return self.object(group, name, fields),
            Node::Channels(channels) => {
                let group = self.within(group, name)?;
                for (channel, fields) in channels {
                    let name = channel.name.unwrap_or_default();
                    self.array(group, &*name, channel.unit, channel.values)?;
                    self.object(group, Some(&name), fields)?;
                }
            }
            Node::Column(values) => self.array(group, plain, None, values)?,
            Node::Rows(columns) => {
                let count = columns.len() as u64;
                for (index, values) in columns.into_iter().enumerate() {
                    self.array(group, name_of(plain, index as u64, count), None, values)?;
                }
            }
            Node::Records(records) => {
                let group = self.within(group, name)?;
                for (name, values) in records.into_columns() {
                    match values {
                        Some(values) => self.array(group, &*name, None, values)?,
                        None => self.skip(format!("{name} (not one number in each object)"))?,
                    }
                }
            }
            Node::Number(value) => {
                let label = self.label(group, name, unread)?;
                let of = format!("the number {label}");
                let budget = self.groups.budget();
                if !(self.beside).number(group, plain, &of, value, budget)? {
                    self.skip([&of, " = ", &*shown(value)].concat())?;
                }
            }
            Node::Text(text) if !text.is_empty() => {
                let label = self.label(group, name, "its comments")?;
                (self.groups.budget()).hold(of_text(text.len()), "its comments")?;
                self.comments.push([&label, ": ", &*text].concat());
            }
            Node::Texts(_) => {
                let label = self.label(group, name, unread)?;
                self.skip(format!("{label} (texts)"))?;
            }
            Node::Text(_) | Node::Other => {}
        }
        Ok(())
    }

    fn object(
        &mut self,
        group: Group,
        name: Option<&str>,
        mut fields: Fields,
    ) -> Result<(), InputError> {
        if let Some(name) = name
            && let Some(channel) = Channel::taken(&mut fields, false)
        {
            let of = channel.name.as_deref().unwrap_or(name);
            self.array(group, of, channel.unit, channel.values)?;
        }
        let mut taken = |wanted: &str| {
            let place = fields.iter().position(|(name, _)| name == wanted)?;
            Some(fields.remove(place).1)
        };
        // The form that pandas calls split.
        let columns = taken("columns");
        let data = taken("data");
        let is_split = matches!((&columns, &data), (Some(Node::Texts(names)), Some(Node::Rows(values))) if names.len() == values.len());
        if is_split {
            taken("index");
        }
        let is_empty = |(_, node): &(String, Node)| matches!(node, Node::Other);
        if columns.is_none() && data.is_none() && fields.iter().all(is_empty) {
            return Ok(());
        }
        let own = name;
        let group = self.within(group, own)?;
        match (columns, data) {
            (Some(Node::Texts(names)), Some(Node::Rows(values))) if is_split => {
                for (name, values) in names.into_iter().zip(values) {
                    self.array(group, name, None, values)?;
                }
            }
            (columns, data) => {
                let both = [("columns", columns), ("data", data)];
                let both = both
                    .into_iter()
                    .filter_map(|(name, node)| Some((name.to_owned(), node?)));
                fields.extend(both);
            }
        }
        // In pandas a schema describes the columns of `data`.
        if fields.iter().any(|(name, _)| name == "data") {
            fields.retain(|(name, _)| name != "schema");
        }
        for (name, node) in fields {
            match node {
                Node::Object(fields) if is_of_units(&name, &fields) => {
                    let group = self.groups.inside(group, &name)?;
                    self.units(group, fields)?;
                }
                node => self.take(group, Some(&name), node)?,
            }
        }
        Ok(())
    }

    /// Takes the units of the arrays beside a group of units.
    fn units(&mut self, group: Group, fields: Fields) -> Result<(), InputError> {
        for (of, node) in fields {
            match node {
                Node::Text(unit) => self.units.add(&self.groups, group, &of, &unit)?,
                // An array without a unit has null.
                Node::Number(number) if number.is_nan() => {}
                other => self.take(group, Some(&of), other)?,
            }
        }
        Ok(())
    }

    fn array(
        &mut self,
        group: Group,
        name: impl Into<String>,
        unit: Option<String>,
        values: Vec<f64>,
    ) -> Result<(), InputError> {
        if values.is_empty() {
            return Ok(());
        }
        let budget = self.groups.budget();
        let array = Array {
            group,
            column: Column {
                name: name.into(),
                unit,
                is_numeric: true,
                first: values.iter().take(Column::FIRST).copied().collect(),
                ..Column::default()
            },
            rows: values.len() as u64,
            clock: None,
            source: Rc::new(values),
        };
        budget.hold(of_list::<()>(0), "its arrays")?;
        self.kept += of_list::<f64>(array.source.len());
        array.add_to(&mut self.arrays, budget)
    }
}

/// Whether an object of this name may hold the units of the arrays beside it: one of numbers and words called `units`.
fn is_of_units(name: &str, fields: &Fields) -> bool {
    let is_plain =
        |(_, node): &(String, Node)| matches!(node, Node::Text(_) | Node::Number(_) | Node::Other);
    are_units(name) && fields.iter().all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Table;
    use crate::read_limit::ReadLimit;

    #[test]
    fn words_that_are_no_json_are_missing_numbers() {
        let budget = Budget::new("a.json", ReadLimit::default());
        let mut text = br#"{"NaN": [1, NaN, -Infinity, "Infinity"]}"#.to_vec();
        bare_words(&mut text);
        let node = parsed("a.json", &text, &budget).unwrap();
        let Node::Object(fields) = node else {
            panic!("{node:?}")
        };
        assert_eq!(fields[0].0, "NaN");
        // A word among numbers makes the column a text.
        assert!(matches!(fields[0].1, Node::Other), "{fields:?}");
        let mut text = b"[1, NaN, -Infinity]".to_vec();
        bare_words(&mut text);
        let node = parsed("a.json", &text, &budget).unwrap();
        let Node::Column(values) = node else {
            panic!("{node:?}")
        };
        assert!(values[0] == 1.0 && values[1].is_nan() && values[2].is_nan());
    }

    /// The columns of a text in JSON, each as `name in unit`, and its first guess.
    fn columns(text: &str) -> Result<(Vec<String>, Table), String> {
        let source = Source::of("a.json".as_ref(), text.as_bytes(), ReadLimit::default()).unwrap();
        let file = Json.open(source, &Reading::default());
        let table = file.map_err(|error| error.to_string())?.tables()[0].clone();
        let named = table.columns.iter().map(|column| match &column.unit {
            Some(unit) => format!("{} in {unit}", column.name),
            None => column.name.clone(),
        });
        Ok((named.collect(), table))
    }

    #[test]
    fn an_object_may_describe_a_channel() {
        for text in [
            r#"{"time": {"unit": "s", "values": [0, 1]}, "force": {"unit": "N", "values": [2, 3]}}"#,
            r#"{"time": {"units": "s", "data": [0, 1]}, "force": {"unit": "N", "data": [2, 3], "sensor": "a"}}"#,
            r#"[{"name": "time", "unit": "s", "values": [0, 1]}, {"name": "force", "unit": "N", "values": [2, 3]}]"#,
            r#"{"run": 4, "channels": [{"channel": "time", "unit": "s", "data": [0, 1]}, {"unit": "N", "data": [2, 3], "name": "force"}]}"#,
            r#"{"a": {"Label": "time", "Unit": "s", "Values": [0, 1]}, "force": {"unit": "N", "data": [2, 3]}}"#,
        ] {
            let (columns, table) = columns(text).unwrap();
            assert_eq!(columns, ["time in s", "force in N"], "{text}");
            assert_eq!(table.columns[1].first, [2.0, 3.0], "{text}");
        }
        // Without a unit or a name it is a group as before.
        let text = r#"{"a": {"values": [0, 1]}, "b": {"values": [2, 3]}}"#;
        assert_eq!(columns(text).unwrap().0, ["a/values", "b/values"]);
    }

    #[test]
    fn units_beside_the_arrays_are_theirs_and_two_that_differ_are_both_kept() {
        let text = r#"{"time": [0, 1], "force": [2, 3],
            "units": {"time": "s", "force": "kN", "place": null, "count": 2, "rig": "B"}}"#;
        let (found, table) = columns(text).unwrap();
        assert_eq!(found, ["time in s", "force in kN"]);
        assert!(
            table
                .columns
                .iter()
                .all(|column| column.other_units.is_empty())
        );
        // A number that is no unit is not lost.
        let said = |of: &String| of == "the number units/count = 2";
        assert!(table.skipped.iter().any(said), "{:?}", table.skipped);

        let text = r#"{"time": [0, 1], "force": [2, 3], "units": {"force": "N"}, "Unit": {"time": "s", "force": ""}, "UNITS": {"force": "Newton"}, "UNIT": {"force": "kN"}}"#;
        let (found, table) = columns(text).unwrap();
        assert_eq!(found, ["time in s", "force in N"]);
        assert_eq!(table.columns[1].other_units, ["Newton", "kN"]);
        assert!(table.columns[0].other_units.is_empty());
    }

    #[test]
    fn a_rate_in_a_description_beside_the_columns_is_used() {
        let text = r#"{"meta": {"operator": "x", "fs": 200}, "data": {"disp_mm": [0, 1], "force_N": [2, 3]}}"#;
        let (_, table) = columns(text).unwrap();
        assert_eq!(table.clock.map(|clock| clock.step), Some(0.005));
        let said = "the times are computed from the number meta/fs = 200 Hz";
        assert!(table.guesses[0].contains(said), "{:?}", table.guesses);
        // What another group describes is not known; it is mentioned.
        let (_, table) = columns(&text.replace("meta", "generator")).unwrap();
        assert_eq!(table.clock, None);
        assert_eq!(table.skipped, ["the number generator/fs = 200 Hz"]);
    }

    #[test]
    fn a_shape_that_is_not_read_is_refused_with_those_that_are() {
        for (text, part) in [
            (
                r#"[{"unit": "s", "values": [0, 1]}, {"unit": "N", "values": [2, 3]}]"#,
                "values",
            ),
            (
                r#"[{"name": "time", "values": [0, 1]}, {"id": 4, "values": [2, 3]}]"#,
                "",
            ),
            (r#"{"a": "b"}"#, ""),
        ] {
            let message = columns(text).unwrap_err();
            for said in [
                "in a shape that is read",
                part,
                "one object for each channel",
                "\"values\": [1, 2]",
            ] {
                assert!(message.contains(said), "{message}");
            }
        }
    }

    #[test]
    fn a_section_of_a_text_is_no_json() {
        for text in ["[Header]\n", "[ Data ]", "{\\rtf1", "time_s,", ""] {
            assert!(!Json.recognizes(text.as_bytes()), "{text}");
        }
        for text in ["[1, 2]", "\u{feff} {\"a\": 1}", "[{\"a\"", "[[1"] {
            assert!(Json.recognizes(text.as_bytes()), "{text}");
        }
    }
}
