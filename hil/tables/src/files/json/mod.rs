//! JSON: an object of arrays, an array of objects, `columns` and `data` as in pandas, an object on each line, or objects that each
//! describe a channel.

mod node;

use mesh_damper_output::error::InputError;
use serde::de::DeserializeSeed as _;
use serde_json::Deserializer;

use super::arrays::{Array, MOST_COLUMNS, arranged, name_of};
use super::beside::Beside;
use super::guard::damaged;
use super::opened::Opened;
use super::units_beside::{UnitsBeside, are_units};
use super::unread::is_json;
use super::{Column, Format, Reading, Source, Tables};
use crate::read_limit::ReadLimit;
use node::{Channel, Fields, List, Node, Seed};

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
        let (name, limit) = (source.name(), source.limit());
        let mut bytes = source.bytes()?;
        if bytes.starts_with(b"\xef\xbb\xbf") {
            bytes.drain(..3);
        }
        bare_words(&mut bytes);
        let root = parsed(&name, &bytes, limit)?;
        drop(bytes);
        let mut found = Found::default();
        found.take(&[], root);
        let Found {
            mut arrays,
            skipped,
            mut comments,
            mut beside,
            units,
        } = found;
        comments.extend(units.give(&mut arrays, "/"));
        beside.heed(reading);
        let (mut tables, sources) =
            arranged(arrays, &beside, &mut |values: &Vec<f64>| Ok(values.clone()))?;
        let Some(table) = tables.first_mut() else {
            return Err(no_columns(name, &skipped));
        };
        table.skipped.extend(skipped);
        let read = move |table: usize, column: usize| {
            let columns: &Vec<Vec<f64>> = &sources[table];
            Ok(Some(columns[column].clone()))
        };
        Ok(Box::new(Opened::new(name, tables, comments, read)?))
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
fn parsed(name: &str, bytes: &[u8], limit: ReadLimit) -> Result<Node, InputError> {
    let mut reader = Deserializer::from_slice(bytes);
    let broken = |error: serde_json::Error| {
        if error.to_string().starts_with(node::TOO_LARGE) {
            limit.exceeded(name)
        } else {
            damaged(NAME, name, error)
        }
    };
    let seed = || Seed {
        most: usize::try_from(limit.file() / 8).unwrap_or(usize::MAX),
    };
    let first = seed().deserialize(&mut reader).map_err(broken)?;
    if reader.end().is_ok() {
        return Ok(first);
    }
    let mut list = List::new(seed());
    let too_large = |()| limit.exceeded(name);
    list.push(first).map_err(too_large)?;
    while reader.end().is_err() {
        let next = seed().deserialize(&mut reader).map_err(broken)?;
        list.push(next).map_err(too_large)?;
    }
    Ok(list.finish())
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
#[derive(Default)]
struct Found {
    arrays: Vec<Array<Vec<f64>>>,
    skipped: Vec<String>,
    comments: Vec<String>,
    beside: Beside,
    units: UnitsBeside,
}

impl Found {
    fn take(&mut self, path: &[String], node: Node) {
        let label = || path.join("/");
        let (group, name) = match path.split_last() {
            Some((name, group)) => (group, name.as_str()),
            None => (path, "value"),
        };
        match node {
            Node::Object(fields) => self.object(path, fields),
            Node::Channels(channels) => {
                for (channel, fields) in channels {
                    let mut inner = path.to_vec();
                    inner.extend(channel.name.clone());
                    self.channel(&inner, channel);
                    self.object(&inner, fields);
                }
            }
            Node::Column(values) => self.array(group, name.to_owned(), None, values),
            Node::Rows(columns) => {
                let count = columns.len() as u64;
                for (index, values) in columns.into_iter().enumerate() {
                    let name = name_of(name, index as u64, count);
                    self.array(group, name, None, values);
                }
            }
            Node::Records(columns) => {
                for (name, values) in columns {
                    match values {
                        Some(values) => self.array(path, name, None, values),
                        None => self
                            .skipped
                            .push(format!("{name} (not one number in each object)")),
                    }
                }
            }
            Node::Number(value) => {
                let of = format!("the number {}", label());
                if !self.beside.number(group, name, &of, value) {
                    self.skipped.push(format!("{of} = {value}"));
                }
            }
            Node::Text(text) if !text.is_empty() => {
                self.comments.push(format!("{}: {text}", label()));
            }
            Node::Texts(_) => self.skipped.push(format!("{} (texts)", label())),
            Node::Text(_) | Node::Other => {}
        }
    }

    fn object(&mut self, path: &[String], mut fields: Fields) {
        if !path.is_empty()
            && let Some(channel) = Channel::taken(&mut fields, false)
        {
            self.channel(path, channel);
        }
        let mut taken = |wanted: &str| {
            let place = fields.iter().position(|(name, _)| name == wanted)?;
            Some(fields.remove(place).1)
        };
        // The form that pandas calls split.
        let columns = taken("columns");
        let data = taken("data");
        match (columns, data) {
            (Some(Node::Texts(names)), Some(Node::Rows(values))) if names.len() == values.len() => {
                taken("index");
                for (name, values) in names.into_iter().zip(values) {
                    self.array(path, name, None, values);
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
            let mut inner = path.to_vec();
            inner.push(name);
            match node {
                Node::Object(fields) if is_of_units(&inner, &fields) => {
                    self.units(&inner, fields);
                }
                node => self.take(&inner, node),
            }
        }
    }

    /// Takes the units of the arrays beside the object at `path`.
    fn units(&mut self, path: &[String], fields: Fields) {
        for (of, node) in fields {
            match node {
                Node::Text(unit) => self.units.add(path, &of, &unit),
                // An array without a unit has null.
                Node::Number(number) if number.is_nan() => {}
                other => {
                    let mut inner = path.to_vec();
                    inner.push(of);
                    self.take(&inner, other);
                }
            }
        }
    }

    /// A channel that the object at `path` describes.
    fn channel(&mut self, path: &[String], channel: Channel) {
        if let Some((own, group)) = path.split_last() {
            let name = channel.name.unwrap_or_else(|| own.clone());
            self.array(group, name, channel.unit, channel.values);
        }
    }

    fn array(&mut self, group: &[String], name: String, unit: Option<String>, values: Vec<f64>) {
        if values.is_empty() || self.arrays.len() >= MOST_COLUMNS {
            return;
        }
        let first = values.iter().take(Column::FIRST).copied().collect();
        self.arrays.push(Array {
            group: group.to_vec(),
            column: Column {
                name,
                unit,
                is_numeric: true,
                first,
                ..Column::default()
            },
            rows: values.len() as u64,
            clock: None,
            source: values,
        });
    }
}

/// Whether the object at `path` may hold the units of the arrays beside it: one of numbers and words called `units`.
fn is_of_units(path: &[String], fields: &Fields) -> bool {
    let is_plain =
        |(_, node): &(String, Node)| matches!(node, Node::Text(_) | Node::Number(_) | Node::Other);
    path.last().is_some_and(|name| are_units(name)) && fields.iter().all(is_plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::Table;

    #[test]
    fn words_that_are_no_json_are_missing_numbers() {
        let mut text = br#"{"NaN": [1, NaN, -Infinity, "Infinity"]}"#.to_vec();
        bare_words(&mut text);
        let node = parsed("a.json", &text, ReadLimit::default()).unwrap();
        let Node::Object(fields) = node else {
            panic!("{node:?}")
        };
        assert_eq!(fields[0].0, "NaN");
        // A word among numbers makes the column a text.
        assert!(matches!(fields[0].1, Node::Other), "{fields:?}");
        let mut text = b"[1, NaN, -Infinity]".to_vec();
        bare_words(&mut text);
        let node = parsed("a.json", &text, ReadLimit::default()).unwrap();
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
