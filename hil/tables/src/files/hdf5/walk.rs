//! The data sets of a file, however deep in groups.

use std::collections::HashMap;
use std::rc::Rc;

use hdf5_reader::error::Error;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::{Attribute, Datatype};

use super::attributes::{Texts, held, number, text};
use super::cells::{Cell, Place as Cells, cell};
use super::data::{Data, is_dataset, is_of_group};
use super::file::File;
use super::links::Links;
use crate::budget::of_text;
use crate::columns::is_time;
use crate::files::Column;
use crate::files::DEEPEST;
use crate::files::arrays::{Array, MOST_OF_ARRAY, name_of};
use crate::files::beside::Beside;
use crate::files::groups::{Group as Place, Groups};
use crate::files::number::shown;
use crate::files::refused::Refused;
use crate::room::Room;

const PART: &str = "the names of its columns";
/// The most other names of a data set that are said. Convention: a line.
const ALSO: usize = 3;

/// Findings in a file.
pub(super) struct Found {
    pub groups: Groups,
    pub arrays: Vec<Array<Cells>>,
    pub data: Vec<Data>,
    pub skipped: Vec<String>,
    pub comments: Vec<String>,
    pub beside: Beside,
}

/// An object that a link led to.
enum Object {
    Group,
    Dataset {
        /// Its first name.
        name: Rc<str>,
        /// Its index, if it has columns.
        index: Option<usize>,
        /// Some of its other names, and how many it has.
        others: Vec<String>,
        count: usize,
    },
    Other,
}

/// A way through a file, which visits each object once: links may form a circle, and many may lead to one object.
pub(super) struct Walk<'f> {
    file: &'f File,
    links: Links<'f>,
    texts: Texts<'f>,
    found: Found,
    objects: HashMap<u64, Object>,
    /// Names of columns that lie in data sets, by the addresses of these.
    labels: HashMap<u64, Option<Rc<[String]>>>,
}

impl<'f> Walk<'f> {
    pub fn new(file: &'f File) -> Self {
        Self {
            file,
            links: Links::new(file),
            texts: Texts::new(file),
            found: Found {
                groups: Groups::new(Rc::clone(&file.budget)),
                arrays: Vec::new(),
                data: Vec::new(),
                skipped: Vec::new(),
                comments: Vec::new(),
                beside: Beside::default(),
            },
            objects: HashMap::from([(file.root, Object::Group)]),
            labels: HashMap::new(),
        }
    }

    /// All that the file has.
    pub fn all(mut self) -> Result<Found, Refused> {
        self.group(self.file.root, Place::FILE)?;
        let objects = std::mem::take(&mut self.objects);
        let mut also: Vec<(Rc<str>, Vec<String>, usize)> = Vec::new();
        for object in objects.into_values() {
            if let Object::Dataset {
                name,
                others,
                count,
                ..
            } = object
                && count > 0
            {
                also.push((name, others, count));
            }
        }
        also.sort();
        for (name, others, count) in also {
            let more = match count - others.len() {
                0 => String::new(),
                more => format!(" and {more} more names"),
            };
            let said = format!("{}{more} (the same as {name})", others.join(", "));
            self.keep(said.len())?;
            self.found.skipped.push(said);
        }
        Ok(self.found)
    }

    fn keep(&self, bytes: usize) -> Result<(), Refused> {
        Ok(self.file.budget.hold(of_text(bytes), PART)?)
    }

    /// The path of a member of a group, as messages have it; it is charged.
    fn path(&self, group: Place, name: &str) -> Result<String, Refused> {
        Ok((self.found.groups).label([Place::FILE, group], Some(name), "/", PART)?)
    }

    fn group(&mut self, address: u64, path: Place) -> Result<(), Refused> {
        if self.found.groups.depth(path) as usize > DEEPEST {
            let why = format!("groups are nested more than {DEEPEST} deep");
            return Err(Error::InvalidData(why).into());
        }
        let header = self.file.header(address)?;
        let (file, found) = (self.file, &mut self.found);
        let said = self.texts.attributes(header, |attribute| {
            file.budget.work(64, PART)?;
            let name =
                (found.groups).label([Place::FILE, path], Some(&attribute.name), "/", PART)?;
            if let Some(value) = number(&attribute) {
                let of = format!("attribute {name}");
                (found.beside).number(path, &attribute.name, &of, value, &file.budget)?;
            }
            if let Some(text) = text(&attribute)
                && !text.trim().is_empty()
                && !attribute.name.chars().all(|c| c.is_uppercase() || c == '_')
            {
                for line in text.lines() {
                    let line = line.trim();
                    (file.budget).hold(of_text(name.len() + 2 + line.len()), PART)?;
                    found.comments.push([&name, ": ", line].concat());
                }
            }
            Ok(())
        });
        match said {
            // The data of a group are of use without its attributes.
            Err(Refused::Damaged(_) | Refused::Unread(..)) => {}
            said => said?,
        }
        let mut inner = Vec::new();
        for (name, member) in self.links.members(address)? {
            if self.objects.contains_key(&member) {
                self.again(member, address, path, &name)?;
                continue;
            }
            self.keep(size_of::<(u64, Object)>())?;
            let header = self.file.header(member)?;
            let object = if is_dataset(&header) {
                let index = self.dataset(header, address, path, &name, None)?;
                Object::Dataset {
                    name: self.path(path, &name)?.into(),
                    index,
                    others: Vec::new(),
                    count: 0,
                }
            } else if is_group(&header) {
                inner.push((name, member));
                Object::Group
            } else {
                Object::Other
            };
            self.objects.insert(member, object);
        }
        for (name, member) in inner {
            let inside = self.found.groups.inside(path, &name)?;
            self.group(member, inside)?;
        }
        Ok(())
    }

    /// A further link to an object. A data set is one array, by its first name; but the times of several groups count in each of them.
    fn again(&mut self, address: u64, group: u64, path: Place, name: &str) -> Result<(), Refused> {
        let Some(Object::Dataset { index, .. }) = self.objects.get(&address) else {
            return Ok(());
        };
        let column = Column {
            name: name.to_owned(),
            is_numeric: true,
            ..Column::default()
        };
        if let (Some(index), true) = (*index, is_time(&column)) {
            let header = self.file.header(address)?;
            self.dataset(header, group, path, name, Some(index))?;
            return Ok(());
        }
        self.file.budget.work(64, PART)?;
        let said = self.path(path, name)?;
        let takes = of_text(said.len());
        match self.objects.get_mut(&address) {
            Some(Object::Dataset { others, count, .. }) => {
                *count += 1;
                match others.len() < ALSO {
                    true => others.push(said),
                    false => self.file.budget.release(takes),
                }
            }
            _ => self.file.budget.release(takes),
        }
        Ok(())
    }

    /// Adds a data set of a group, and returns its index if it has columns. It has one already if it was met before.
    fn dataset(
        &mut self,
        header: Vec<HdfMessage>,
        group: u64,
        path: Place,
        name: &str,
        known: Option<usize>,
    ) -> Result<Option<usize>, Refused> {
        let Some((mut data, of)) = Data::of(self.file, &header)? else {
            return Ok(None);
        };
        let mut stated = Stated::of(self, header)?;
        data.fill = data.fill.or(stated.fill_bytes.take());
        let is_compound = matches!(of, Datatype::Compound { .. });
        let fields = match self.fields(path, name, of)? {
            fields if fields.is_empty() => return Ok(None),
            fields => fields,
        };
        let long: Vec<u64> = data
            .shape
            .iter()
            .copied()
            .filter(|&size| size != 1)
            .collect();
        // Rows lie one after the other. There are more samples than channels.
        let (rows, columns, [step, next]) = match long[..] {
            [] => {
                self.single(path, name, &data, fields)?;
                return Ok(None);
            }
            [rows] => (rows, 1, [1, 0]),
            [rows, columns] if rows >= columns => (rows, columns, [columns, 1]),
            [columns, rows] => (rows, columns, [1, rows]),
            _ => (0, 0, [0, 0]),
        };
        if rows == 0 || columns > MOST_OF_ARRAY {
            self.skip(path, name, &format!("{:?}", data.shape))?;
            return Ok(None);
        }
        let (names, _room) = stated.names.take().unzip();
        let names = self.names(group, name, columns, names)?;
        let inside = match is_compound {
            true => self.found.groups.inside(path, name)?,
            false => path,
        };
        let index = known.unwrap_or(self.found.data.len());
        for Field {
            name: field,
            cell,
            elements,
        } in fields
        {
            let base = if is_compound { &field } else { name };
            let of_field = stated.units.get(&field);
            let unit = of_field.or_else(|| stated.unit.as_ref().filter(|_| !is_compound));
            if columns.saturating_mul(elements) > MOST_OF_ARRAY {
                self.skip(
                    path,
                    base,
                    &format!("{columns} columns of arrays of {elements}"),
                )?;
                continue;
            }
            for column in 0..columns * elements {
                let (element, column_of) = (column % elements, column / elements);
                let named = names.get(column_of as usize).filter(|_| !is_compound);
                let name = named
                    .cloned()
                    .unwrap_or_else(|| name_of(base, column, columns * elements));
                self.beside(inside, &name, base, &stated)?;
                let mut cell = cell.clone();
                cell.at += element as usize * cell.kind.size();
                let array = Array {
                    group: inside,
                    column: Column {
                        name,
                        unit: unit.cloned(),
                        is_numeric: true,
                        ..Column::default()
                    },
                    rows,
                    clock: None,
                    source: Cells {
                        dataset: index,
                        cell,
                        first: (column_of * next) as usize,
                        step: step as usize,
                        count: rows as usize,
                        scale: stated.scale,
                        fill: stated.fill,
                    },
                };
                array.add_to(&mut self.found.arrays, &self.file.budget)?;
            }
        }
        if known.is_none() {
            self.keep(data.held())?;
            self.found.data.push(data);
        }
        Ok(Some(index))
    }

    /// Statements about a column's values.
    fn beside(
        &mut self,
        group: Place,
        name: &str,
        base: &str,
        stated: &Stated<'_>,
    ) -> Result<(), Refused> {
        if stated.scale.is_none() && stated.numbers.is_empty() {
            return Ok(());
        }
        let at = self.found.groups.inside(group, name)?;
        if let Some((factor, offset)) = stated.scale {
            let (factor, offset) = (shown(factor), shown(offset));
            let said = format!(
                "{base} is multiplied by {factor} and {offset} is added, as its attributes say"
            );
            self.found.beside.note(at, said, &self.file.budget)?;
        }
        for (attribute, value) in &stated.numbers {
            let of = format!("attribute {attribute} of {base}");
            self.file.budget.work(64 + of.len() as u64, PART)?;
            (self.found.beside).number(at, attribute, &of, *value, &self.file.budget)?;
        }
        Ok(())
    }

    /// A data set of one element, whose numbers say something about the others.
    fn single(
        &mut self,
        path: Place,
        name: &str,
        data: &Data,
        fields: Vec<Field>,
    ) -> Result<(), Refused> {
        let raw = match data.raw(self.file) {
            Err(Refused::Damaged(_) | Refused::Unread(..)) => None,
            raw => Some(raw?),
        };
        let bytes = match &raw {
            Some(raw) => raw.bytes(self.file).unwrap_or_default(),
            None => &[],
        };
        let of = format!("the number {}", self.path(path, name)?);
        for Field { cell, .. } in fields {
            let value = cell.kind.read(bytes, cell.at, cell.is_little);
            if !(self.found.beside).number(path, name, &of, value, &self.file.budget)? {
                self.skip(path, name, &format!("the number {}", shown(value)))?;
            }
        }
        self.file.budget.release(raw.map_or(0, |raw| raw.held()));
        Ok(())
    }

    /// The numbers in an element of a data set; others are noted as skipped.
    fn fields(&mut self, path: Place, name: &str, of: Datatype) -> Result<Vec<Field>, Refused> {
        let mut fields = Vec::new();
        let Datatype::Compound { fields: all, .. } = of else {
            match cell(&of) {
                Some(cell) => fields.push(Field {
                    name: String::new(),
                    cell,
                    elements: 1,
                }),
                None => self.skip(path, name, of_type(&of))?,
            }
            return Ok(fields);
        };
        for field in all {
            let (of, elements) = match &field.datatype {
                Datatype::Array { base, dims } => {
                    let count = |all: u64, &size: &u64| all.saturating_mul(size);
                    (&**base, dims.iter().fold(1, count))
                }
                of => (of, 1),
            };
            match cell(of) {
                Some(mut cell) if elements <= MOST_OF_ARRAY => {
                    cell.at = field.byte_offset as usize;
                    fields.push(Field {
                        name: field.name,
                        cell,
                        elements,
                    });
                }
                _ => self.skip(path, &format!("{name}.{}", field.name), of_type(of))?,
            }
        }
        Ok(fields)
    }

    /// The names of a data set's columns, if the file has as many: in an attribute, or in a data set next to it, as pandas stores
    /// `block0_items` next to `block0_values`.
    fn names(
        &mut self,
        group: u64,
        name: &str,
        columns: u64,
        stated: Option<Vec<String>>,
    ) -> Result<Rc<[String]>, Refused> {
        if let Some(block) = name.strip_suffix("_values")
            && let Some(items) = self.links.member(group, &format!("{block}_items"))?
            && let Some(names) = self.labels(items, columns)?
        {
            return Ok(names);
        }
        let names = stated.filter(|names| names.len() as u64 == columns && columns > 1);
        Ok(names.unwrap_or_default().into())
    }

    fn labels(&mut self, address: u64, columns: u64) -> Result<Option<Rc<[String]>>, Refused> {
        let names = match self.labels.get(&address) {
            Some(names) => names.clone(),
            None => {
                let names = match self.read_labels(address) {
                    Err(Refused::Damaged(_) | Refused::Unread(..)) => None,
                    names => names?.map(Rc::from),
                };
                self.keep(2 * size_of::<(u64, Option<Rc<[String]>>)>())?;
                self.labels.insert(address, names.clone());
                names
            }
        };
        Ok(names.filter(|names| names.len() as u64 == columns))
    }

    fn read_labels(&self, address: u64) -> Result<Option<Vec<String>>, Refused> {
        let header = self.file.header(address)?;
        let found = Data::of(self.file, &header)?;
        let Some((data, of)) = found.filter(|(data, _)| data.count() <= MOST_OF_ARRAY) else {
            return Ok(None);
        };
        let raw = data.raw(self.file)?;
        let bytes = raw.bytes(self.file);
        let names = bytes.map(|bytes| self.texts.strings(&of, bytes, data.count()));
        self.file.budget.release(raw.held());
        names?.map(Some)
    }

    fn skip(&mut self, path: Place, name: &str, what: &str) -> Result<(), Refused> {
        let said = format!("{} ({what})", self.path(path, name)?);
        self.keep(what.len())?;
        self.found.skipped.push(said);
        Ok(())
    }
}

/// A number in each element of a data set, or several of the same type.
struct Field {
    /// Its name; empty if the element is the number.
    name: String,
    cell: Cell,
    elements: u64,
}

/// Statements in a data set's attributes about its values.
#[derive(Default)]
struct Stated<'f> {
    unit: Option<String>,
    /// For the fields of its elements.
    units: HashMap<String, String>,
    /// In netCDF's form: factor and offset.
    scale: Option<(f64, f64)>,
    fill: Option<f64>,
    fill_bytes: Option<Vec<u8>>,
    /// Names of its columns.
    names: Option<(Vec<String>, Room<'f>)>,
    /// Other numbers.
    numbers: Vec<(String, f64)>,
}

impl<'f> Stated<'f> {
    fn of(walk: &Walk<'f>, header: Vec<HdfMessage>) -> Result<Self, Refused> {
        let mut stated = Self::default();
        let (mut factor, mut offset) = (None, None);
        walk.texts.attributes(header, |attribute: Attribute| {
            walk.file
                .budget
                .work(64 + attribute.name.len() as u64, PART)?;
            let number = || number(&attribute).filter(|value| value.is_finite());
            match attribute.name.to_lowercase().as_str() {
                "unit" | "units" | "unit_string" | "ni_unitdescription" => {
                    stated.unit = text(&attribute).filter(|unit| !unit.trim().is_empty());
                }
                "scale_factor" => factor = number(),
                "add_offset" => offset = number(),
                "_fillvalue" | "missing_value" => {
                    stated.fill = attribute.read_as_f64().ok();
                    if attribute.name == "_FillValue"
                        && attribute.num_elements().is_ok_and(|count| count == 1)
                    {
                        stated.fill_bytes = Some(attribute.raw_data);
                    }
                }
                "columns" | "column_names" | "names" | "channels" | "channel_names" | "labels" => {
                    let names = attribute.read_strings().unwrap_or_default();
                    let mut room = Room::of(&walk.file.budget);
                    room.more(names.iter().map(|name| held(name.len())).sum(), PART)?;
                    stated.names = Some((names, room));
                }
                _ if number().is_some() => {
                    let number = number().map(|value| (attribute.name.clone(), value));
                    stated.numbers.extend(number);
                }
                name => {
                    let field = name
                        .strip_prefix("unit_")
                        .or_else(|| name.strip_suffix("_unit"));
                    if let (Some(field), Some(unit)) = (field, text(&attribute)) {
                        stated.units.entry(field.to_owned()).or_insert(unit);
                    }
                }
            }
            Ok(())
        })?;
        if factor.is_some() || offset.is_some() {
            stated.scale = Some((factor.unwrap_or(1.0), offset.unwrap_or(0.0)));
        }
        Ok(stated)
    }
}

/// Whether an object that is no data set is a group.
fn is_group(header: &[HdfMessage]) -> bool {
    let says_so = |message: &HdfMessage| {
        is_of_group(message)
            || matches!(
                message,
                HdfMessage::Attribute(_) | HdfMessage::AttributeInfo(_)
            )
    };
    header.iter().any(says_so)
}

fn of_type(of: &Datatype) -> &'static str {
    match of {
        Datatype::String { .. } => "texts",
        Datatype::VarLen { .. } => "texts or lists of any length",
        Datatype::Reference { .. } => "references",
        Datatype::Compound { .. } => "structures",
        Datatype::Array { .. } => "arrays",
        _ if hdf5_reader::dtype_element_size(of).is_ok_and(|size| size > 8) => {
            "numbers of more than 8 bytes"
        }
        _ => "no numbers",
    }
}
