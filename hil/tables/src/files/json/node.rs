//! Values of JSON, in which lists of numbers, rows and records become columns while they are read, because a tree would take ten
//! times the memory of the text.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::rc::Rc;

use mesh_damper_output::error::InputError;
use serde::de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor};

use crate::budget::{Budget, of_list, of_text};

/// The part of a file in messages.
const VALUES: &str = "its values";
const NAMES: &str = "its names and texts";

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
    /// A list of objects, column by column.
    Records(Records),
    Object(Vec<(String, Node)>),
    /// A list of objects that each describe a channel with its name, and their other fields.
    Channels(Vec<(Channel, Fields)>),
    /// Anything that is not a column, such as a list of several kinds.
    Other,
}

/// The fields of an object.
pub(super) type Fields = Vec<(String, Node)>;

/// Bytes that a field of an object takes beside its value.
fn of_field(name: &str) -> u64 {
    of_text(name.len()) + size_of::<Node>() as u64
}

fn of_fields(fields: &Fields) -> u64 {
    let each = fields.iter();
    of_list::<()>(0)
        + each
            .map(|(name, node)| of_field(name) + node.bytes())
            .sum::<u64>()
}

impl Node {
    /// Bytes that it takes, all in it included. They are charged when it is made.
    pub fn bytes(&self) -> u64 {
        let of_columns = |columns: &[Vec<f64>]| {
            let each = columns.iter().map(|values| of_list::<f64>(values.len()));
            of_list::<()>(0) + each.sum::<u64>()
        };
        match self {
            Self::Number(_) | Self::Other => 0,
            Self::Text(text) => of_text(text.len()),
            Self::Column(values) => of_list::<f64>(values.len()),
            Self::Texts(texts) => {
                let each = texts.iter().map(|text| of_text(text.len()));
                of_list::<()>(0) + each.sum::<u64>()
            }
            Self::Rows(columns) => of_columns(columns),
            Self::Records(records) => records.bytes(),
            Self::Object(fields) => of_fields(fields),
            Self::Channels(channels) => {
                let each = channels.iter();
                let each = each.map(|(channel, fields)| channel.bytes() + of_fields(fields));
                of_list::<()>(0) + each.sum::<u64>()
            }
        }
    }
}

/// Objects with the same fields, column by column.
#[derive(Debug, Default)]
pub(super) struct Records {
    columns: Vec<Field>,
    places: HashMap<Rc<str>, usize>,
}

/// A field of records.
#[derive(Debug)]
struct Field {
    name: Rc<str>,
    /// Those of the first records; the others have none. `None` for values other than numbers.
    values: Option<Vec<f64>>,
}

impl Records {
    /// Bytes that a column takes beside its values: its name, and its place in the list and in the map.
    fn of_name(name: &str) -> u64 {
        of_text(name.len()) + 2 * size_of::<Field>() as u64
    }

    fn bytes(&self) -> u64 {
        let of_values =
            |values: &Option<Vec<f64>>| of_list::<f64>(values.as_ref().map_or(0, Vec::len));
        let each = self.columns.iter();
        let each = each.map(|field| Self::of_name(&field.name) + of_values(&field.values));
        of_list::<()>(0) + each.sum::<u64>()
    }

    /// Adds the record after `rows` others.
    fn add(&mut self, rows: usize, fields: Fields, budget: &Budget) -> Result<(), InputError> {
        budget.release(of_fields(&fields));
        for (place, (name, value)) in fields.into_iter().enumerate() {
            // Records almost always have their fields in the same order.
            let known = match self.columns.get(place) {
                Some(field) if *field.name == *name => Some(place),
                _ => self.places.get(&*name).copied(),
            };
            let index = match known {
                Some(index) => index,
                None => {
                    budget.hold(Self::of_name(&name) + of_list::<f64>(0), NAMES)?;
                    let name: Rc<str> = name.into();
                    self.places.insert(Rc::clone(&name), self.columns.len());
                    self.columns.push(Field {
                        name,
                        values: Some(Vec::new()),
                    });
                    self.columns.len() - 1
                }
            };
            let column = &mut self.columns[index].values;
            let number = match value {
                Node::Number(value) => Some(value),
                Node::Text(text) if text.is_empty() => Some(f64::NAN),
                _ => None,
            };
            match (&mut *column, number) {
                // The first of several fields of one name counts.
                (Some(values), Some(number)) if values.len() <= rows => {
                    budget.hold(8 * (rows + 1 - values.len()) as u64, VALUES)?;
                    values.resize(rows, f64::NAN);
                    values.push(number);
                }
                (_, Some(_)) => {}
                (values, None) => {
                    let given_up = values.take().map_or(0, |values| 8 * values.len() as u64);
                    budget.release(given_up);
                }
            }
        }
        Ok(())
    }

    /// Gives each column a value for each of the records.
    fn fill(&mut self, rows: usize, budget: &Budget) -> Result<(), InputError> {
        for values in self
            .columns
            .iter_mut()
            .filter_map(|field| field.values.as_mut())
        {
            budget.hold(8 * (rows - values.len()) as u64, VALUES)?;
            values.resize(rows, f64::NAN);
        }
        Ok(())
    }

    /// The columns by their names; `None` for values other than numbers.
    pub fn into_columns(self) -> impl Iterator<Item = (Rc<str>, Option<Vec<f64>>)> {
        (self.columns.into_iter()).map(|field| (field.name, field.values))
    }
}

/// Fields of an object that describes one channel: its values, its name, its unit.
const DATA: [&str; 4] = ["values", "data", "value", "samples"];
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
    /// What it takes beside the texts and values, which were charged as fields of its object.
    const PLACE: u64 = size_of::<(Self, Fields)>() as u64;

    fn bytes(&self) -> u64 {
        let texts = self.name.iter().chain(&self.unit);
        let texts = texts.map(|text| of_text(text.len())).sum::<u64>();
        texts + of_list::<f64>(self.values.len()) + Self::PLACE
    }

    /// Takes the channel's fields from those of an object; `None`, and nothing taken, if it does not describe a channel, or not its
    /// name where that is `needed`.
    pub fn taken(fields: &mut Fields, needed: bool) -> Option<Self> {
        let place = |list: &[&str], is_it: fn(&Node) -> bool| {
            let is_of = |field: &str| list.iter().any(|each| field.eq_ignore_ascii_case(each));
            (fields.iter()).position(|(field, node)| is_it(node) && is_of(field))
        };
        let is_text = |node: &Node| matches!(node, Node::Text(text) if !text.is_empty());
        let is_list = |node: &Node| matches!(node, Node::Column(values) if !values.is_empty());
        let (name, unit) = (place(&LABEL, is_text), place(&UNIT, is_text));
        let values = place(&DATA, is_list)?;
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

/// Reads values, and charges what it makes of them.
pub(super) struct Reader<'b> {
    pub budget: &'b Budget,
    /// Why the file is refused, if it is: serde's errors hold texts alone.
    pub refused: RefCell<Option<InputError>>,
}

impl<'b> Reader<'b> {
    pub fn new(budget: &'b Budget) -> Self {
        Self {
            budget,
            refused: RefCell::new(None),
        }
    }

    /// The outcome of something in the form of serde's.
    fn told<T, E: de::Error>(&self, outcome: Result<T, InputError>) -> Result<T, E> {
        outcome.map_err(|error| {
            *self.refused.borrow_mut() = Some(error);
            E::custom("its budget is used up")
        })
    }

    fn hold<E: de::Error>(&self, bytes: u64, part: &str) -> Result<(), E> {
        self.told(self.budget.hold(bytes, part))
    }
}

/// Reads a value.
#[derive(Clone, Copy)]
pub(super) struct Seed<'r>(pub &'r Reader<'r>);

/// A list while it is read.
pub(super) struct List<'b> {
    budget: &'b Budget,
    node: Option<Node>,
    rows: usize,
}

impl<'b> List<'b> {
    pub fn new(budget: &'b Budget) -> Self {
        Self {
            budget,
            node: None,
            rows: 0,
        }
    }

    /// Adds one more value.
    ///
    /// # Errors
    /// A budget that is used up, for example if each row has its own names.
    pub fn push(&mut self, value: Node) -> Result<(), InputError> {
        let (rows, budget) = (self.rows, self.budget);
        self.rows += 1;
        let hold = |bytes: u64| budget.hold(bytes, VALUES);
        let node = match (self.node.take(), value) {
            (None, Node::Number(value)) => {
                hold(of_list::<f64>(1))?;
                Node::Column(vec![value])
            }
            (Some(Node::Column(mut values)), Node::Number(value)) => {
                hold(8)?;
                values.push(value);
                Node::Column(values)
            }
            (None, Node::Text(text)) if !text.is_empty() => {
                hold(of_list::<()>(0))?;
                Node::Texts(vec![text])
            }
            (Some(Node::Texts(mut texts)), Node::Text(text)) => {
                texts.push(text);
                Node::Texts(texts)
            }
            // A text without a letter is a number that is missing.
            (None, Node::Text(_)) => {
                budget.release(of_text(0));
                hold(of_list::<f64>(1))?;
                Node::Column(vec![f64::NAN])
            }
            (Some(Node::Column(mut values)), Node::Text(text)) if text.is_empty() => {
                budget.release(of_text(0));
                hold(8)?;
                values.push(f64::NAN);
                Node::Column(values)
            }
            (None, Node::Column(row)) => {
                let columns = of_list::<f64>(1).saturating_mul(row.len() as u64);
                hold(of_list::<()>(0) + columns)?;
                budget.release(of_list::<f64>(row.len()));
                Node::Rows(row.into_iter().map(|value| vec![value]).collect())
            }
            (Some(Node::Rows(mut columns)), Node::Column(row)) => {
                let new = row.len().saturating_sub(columns.len()) as u64;
                hold(new.saturating_mul(of_list::<f64>(rows)))?;
                columns.resize_with(columns.len().max(row.len()), || vec![f64::NAN; rows]);
                hold(8 * columns.len() as u64)?;
                budget.release(of_list::<f64>(row.len()));
                let values = row.into_iter().chain(std::iter::repeat(f64::NAN));
                for (column, value) in columns.iter_mut().zip(values) {
                    column.push(value);
                }
                Node::Rows(columns)
            }
            (None, Node::Object(mut fields)) => match Channel::taken(&mut fields, true) {
                Some(channel) => {
                    hold(of_list::<()>(0) + Channel::PLACE)?;
                    Node::Channels(vec![(channel, fields)])
                }
                None => {
                    hold(of_list::<()>(0))?;
                    let mut records = Records::default();
                    records.add(rows, fields, budget)?;
                    Node::Records(records)
                }
            },
            (Some(Node::Channels(mut channels)), Node::Object(mut fields)) => {
                match Channel::taken(&mut fields, true) {
                    Some(channel) => {
                        hold(Channel::PLACE)?;
                        channels.push((channel, fields));
                        Node::Channels(channels)
                    }
                    None => {
                        budget.release(Node::Channels(channels).bytes() + of_fields(&fields));
                        Node::Other
                    }
                }
            }
            (Some(Node::Records(mut records)), Node::Object(fields)) => {
                records.add(rows, fields, budget)?;
                Node::Records(records)
            }
            (node, value) => {
                budget.release(node.map_or(0, |node| node.bytes()) + value.bytes());
                Node::Other
            }
        };
        self.node = Some(node);
        Ok(())
    }

    /// The list as a whole.
    ///
    /// # Errors
    /// A budget that is used up.
    pub fn finish(self) -> Result<Node, InputError> {
        match self.node {
            // A list of objects without numbers is not a table.
            Some(Node::Records(mut records)) => {
                records.fill(self.rows, self.budget)?;
                Ok(Node::Records(records))
            }
            Some(node) => Ok(node),
            None => {
                self.budget.hold(of_list::<f64>(0), VALUES)?;
                Ok(Node::Column(Vec::new()))
            }
        }
    }
}

/// The field under which serde_json gives the text of a number, if any crate of a build requests numbers of arbitrary precision, as
/// defmt-decoder does.
const NUMBER: &str = "$serde_json::private::Number";

impl<'de> DeserializeSeed<'de> for Seed<'_> {
    type Value = Node;

    fn deserialize<D: de::Deserializer<'de>>(self, from: D) -> Result<Node, D::Error> {
        from.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Seed<'_> {
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

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Node, E> {
        let text = text.trim();
        self.0.hold(of_text(text.len()), NAMES)?;
        Ok(Node::Text(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut values: A) -> Result<Node, A::Error> {
        let mut list = List::new(self.0.budget);
        while let Some(value) = values.next_element_seed(self)? {
            self.0.told(list.push(value))?;
        }
        self.0.told(list.finish())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut fields: A) -> Result<Node, A::Error> {
        let mut object = Vec::new();
        // The column form of pandas: each value under the number of its row.
        let mut column = Some(Vec::new());
        self.0.hold(of_list::<()>(0), NAMES)?;
        while let Some(name) = fields.next_key::<String>()? {
            if name == NUMBER {
                self.0.budget.release(of_list::<()>(0));
                let text = fields.next_value::<String>()?;
                return (text.parse().map(Node::Number)).map_err(de::Error::custom);
            }
            let mut value = fields.next_value_seed(self)?;
            match (&mut column, &value) {
                (Some(values), Node::Number(number)) if name.parse::<u64>().is_ok() => {
                    self.0.hold(8, VALUES)?;
                    values.push(*number);
                    continue;
                }
                (Some(values), _) if values.is_empty() => column = None,
                // Not all are numbers of rows, so none of them are fields.
                (Some(values), _) => {
                    let given_up = of_list::<f64>(values.len()) + value.bytes();
                    self.0.budget.release(given_up);
                    return skip(fields);
                }
                (None, _) => {}
            }
            self.0.hold(of_field(&name), NAMES)?;
            if let Node::Object(fields) = &mut value {
                // It stays, with room for more fields than it has.
                fields.shrink_to_fit();
            }
            object.push((name, value));
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
