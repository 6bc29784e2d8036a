//! Values of JSON, in which lists of numbers, rows and records become columns while they are read, because a tree would take ten
//! times the memory of the text.

use std::fmt;

use serde::de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor};

use crate::files::arrays::MOST_COLUMNS;

/// The beginning of the error of a file that takes too much memory.
pub(super) const TOO_LARGE: &str = "too large";

/// A value.
#[derive(Debug)]
pub(super) enum Node {
    /// NaN of null.
    Number(f64),
    Text(String),
    /// A list of numbers.
    Column(Vec<f64>),
    Texts(Vec<String>),
    /// A list of lists of numbers, column by column.
    Rows(Vec<Vec<f64>>),
    /// A list of objects, column by column; `None` for values other than numbers.
    Records(Vec<(String, Option<Vec<f64>>)>),
    Object(Vec<(String, Node)>),
    /// A list of objects that each describe a channel with its name, and their other fields.
    Channels(Vec<(Channel, Fields)>),
    /// Anything that is not a column, such as a list of several kinds.
    Other,
}

/// The fields of an object.
pub(super) type Fields = Vec<(String, Node)>;

/// Fields of an object that describes one channel: its values, its name, its unit.
const VALUES: [&str; 4] = ["values", "data", "value", "samples"];
const LABEL: [&str; 4] = ["name", "label", "channel", "channelname"];
const UNIT: [&str; 2] = ["unit", "units"];

/// A channel that an object describes.
#[derive(Debug)]
pub(super) struct Channel {
    /// Its name, if the object states one.
    pub name: Option<String>,
    pub unit: Option<String>,
    pub values: Vec<f64>,
}

impl Channel {
    /// Takes the channel's fields from those of an object; `None`, and nothing taken, if it does not describe a channel, or not its
    /// name where that is `needed`.
    pub fn taken(fields: &mut Fields, needed: bool) -> Option<Self> {
        let place = |list: &[&str], is_it: fn(&Node) -> bool| {
            let is_of = |field: &str| list.contains(&field.to_lowercase().as_str());
            (fields.iter()).position(|(field, node)| is_it(node) && is_of(field))
        };
        let is_text = |node: &Node| matches!(node, Node::Text(text) if !text.is_empty());
        let is_list = |node: &Node| matches!(node, Node::Column(values) if !values.is_empty());
        let (name, unit) = (place(&LABEL, is_text), place(&UNIT, is_text));
        let values = place(&VALUES, is_list)?;
        if name.is_none() && (needed || unit.is_none()) {
            return None;
        }
        let mut taken = |place: usize| std::mem::replace(&mut fields[place].1, Node::Other);
        let mut text = |place: Option<usize>| match taken(place?) {
            Node::Text(text) => Some(text),
            _ => None,
        };
        let (name, unit) = (text(name), text(unit));
        let Node::Column(values) = taken(values) else {
            return None;
        };
        Some(Self { name, unit, values })
    }
}

/// Reads a value; its lists may have at most this many numbers.
#[derive(Clone, Copy)]
pub(super) struct Seed {
    pub most: usize,
}

/// A list while it is read.
pub(super) struct List {
    seed: Seed,
    node: Option<Node>,
    rows: usize,
}

impl List {
    pub fn new(seed: Seed) -> Self {
        Self {
            seed,
            node: None,
            rows: 0,
        }
    }

    /// Adds one more value; an error if the columns grow beyond the limit, for example if each row has its own names.
    pub fn push(&mut self, value: Node) -> Result<(), ()> {
        let rows = self.rows;
        self.rows += 1;
        let node = self.node.take();
        let node = match (node, value) {
            (None, Node::Number(value)) => Node::Column(vec![value]),
            (Some(Node::Column(mut values)), Node::Number(value)) => {
                values.push(value);
                Node::Column(values)
            }
            (None, Node::Text(text)) if !text.is_empty() => Node::Texts(vec![text]),
            (Some(Node::Texts(mut texts)), Node::Text(text)) => {
                // A longer list is not a list of column names.
                if texts.len() < MOST_COLUMNS {
                    texts.push(text);
                }
                Node::Texts(texts)
            }
            // A text without a letter is a number that is missing.
            (None, Node::Text(_)) => Node::Column(vec![f64::NAN]),
            (Some(Node::Column(mut values)), Node::Text(text)) if text.is_empty() => {
                values.push(f64::NAN);
                Node::Column(values)
            }
            (None, Node::Column(row)) => {
                Node::Rows(row.into_iter().map(|value| vec![value]).collect())
            }
            (Some(Node::Rows(mut columns)), Node::Column(row)) => {
                while columns.len() < row.len() {
                    columns.push(vec![f64::NAN; rows]);
                    self.check(columns.len())?;
                }
                let values = row.into_iter().map(Some).chain(std::iter::repeat(None));
                for (column, value) in columns.iter_mut().zip(values) {
                    column.push(value.unwrap_or(f64::NAN));
                }
                self.check(columns.len())?;
                Node::Rows(columns)
            }
            (None, Node::Object(mut fields)) => match Channel::taken(&mut fields, true) {
                Some(channel) => Node::Channels(vec![(channel, fields)]),
                None => self.record(Vec::new(), rows, fields)?,
            },
            (Some(Node::Channels(mut channels)), Node::Object(mut fields))
                if channels.len() < MOST_COLUMNS =>
            {
                match Channel::taken(&mut fields, true) {
                    Some(channel) => {
                        channels.push((channel, fields));
                        Node::Channels(channels)
                    }
                    None => Node::Other,
                }
            }
            (Some(Node::Records(columns)), Node::Object(fields)) => {
                self.record(columns, rows, fields)?
            }
            _ => Node::Other,
        };
        self.node = Some(node);
        Ok(())
    }

    fn record(
        &self,
        mut columns: Vec<(String, Option<Vec<f64>>)>,
        rows: usize,
        fields: Vec<(String, Node)>,
    ) -> Result<Node, ()> {
        for (place, (name, value)) in fields.into_iter().enumerate() {
            // Records almost always have their fields in the same order.
            let known = match columns.get(place) {
                Some((known, _)) if *known == name => Some(place),
                _ => columns.iter().position(|(known, _)| *known == name),
            };
            let index = known.unwrap_or_else(|| {
                columns.push((name, Some(vec![f64::NAN; rows])));
                columns.len() - 1
            });
            self.check(columns.len())?;
            let column = &mut columns[index].1;
            match (column, value) {
                (Some(values), Node::Number(value)) if values.len() == rows => values.push(value),
                (Some(_), Node::Number(_)) => {}
                (Some(values), Node::Text(text)) if text.is_empty() && values.len() == rows => {
                    values.push(f64::NAN);
                }
                (column, _) => *column = None,
            }
        }
        for values in columns.iter_mut().filter_map(|(_, values)| values.as_mut()) {
            if values.len() == rows {
                values.push(f64::NAN);
            }
        }
        Ok(Node::Records(columns))
    }

    fn check(&self, columns: usize) -> Result<(), ()> {
        let numbers = columns.saturating_mul(self.rows);
        let is_small = columns <= MOST_COLUMNS && numbers <= self.seed.most;
        is_small.then_some(()).ok_or(())
    }

    pub fn finish(self) -> Node {
        match self.node {
            // A list of objects without numbers is not a table.
            Some(node) => node,
            None => Node::Column(Vec::new()),
        }
    }
}

/// The field under which serde_json gives the text of a number, if any crate of a build requests numbers of arbitrary precision, as
/// defmt-decoder does.
const NUMBER: &str = "$serde_json::private::Number";

impl<'de> DeserializeSeed<'de> for Seed {
    type Value = Node;

    fn deserialize<D: de::Deserializer<'de>>(self, from: D) -> Result<Node, D::Error> {
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Seed {
    type Value = Node;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("a value")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Node, E> {
        Ok(Node::Number(f64::from(u8::from(value))))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Node, E> {
        Ok(Node::Number(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Node, E> {
        Ok(Node::Number(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Node, E> {
        Ok(Node::Number(value))
    }

    fn visit_unit<E>(self) -> Result<Node, E> {
        Ok(Node::Number(f64::NAN))
    }

    fn visit_str<E>(self, text: &str) -> Result<Node, E> {
        Ok(Node::Text(text.trim().to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<Node, A::Error> {
        let mut list = List::new(self);
        while let Some(value) = values.next_element_seed(self)? {
            list.push(value)
                .map_err(|()| de::Error::custom(TOO_LARGE))?;
        }
        Ok(list.finish())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Node, A::Error> {
        let mut object = Vec::new();
        // The column form of pandas: each value under the number of its row.
        let mut column = Some(Vec::new());
        while let Some(name) = fields.next_key::<String>()? {
            if name == NUMBER {
                let text = fields.next_value::<String>()?;
                return (text.parse().map(Node::Number)).map_err(de::Error::custom);
            }
            let value = fields.next_value_seed(self)?;
            match (&mut column, &value) {
                (Some(values), Node::Number(number)) if name.parse::<u64>().is_ok() => {
                    values.push(*number);
                    continue;
                }
                (Some(values), _) if values.is_empty() => column = None,
                // Not all are numbers of rows, so none of them are fields.
                (Some(_), _) => return skip(fields),
                (None, _) => {}
            }
            object.push((name, value));
            if object.len() > MOST_COLUMNS {
                return Err(de::Error::custom(TOO_LARGE));
            }
        }
        Ok(match column {
            Some(values) if !values.is_empty() => Node::Column(values),
            _ => Node::Object(object),
        })
    }
}

fn skip<'de, A: MapAccess<'de>>(mut fields: A) -> Result<Node, A::Error> {
    while fields
        .next_entry::<de::IgnoredAny, de::IgnoredAny>()?
        .is_some()
    {}
    Ok(Node::Other)
}
