//! The data sets of a file, however deep in groups.

use std::collections::HashSet;

use hdf5_reader::error::Error;
use hdf5_reader::group::Group;
use hdf5_reader::{Attribute, Dataset, Datatype, dtype_element_size};

use super::cells::{Cell, Place, cell};
use crate::files::Column;
use crate::files::arrays::{Array, MOST_COLUMNS, MOST_OF_ARRAY, name_of};
use crate::files::beside::Beside;

/// The deepest nesting of groups. Convention: deeper than any program writes, and within the stack.
const DEEPEST: usize = 64;
/// The longest text of an attribute that is a comment. Convention: a page.
const LONGEST: usize = 1 << 12;

/// Findings in a file.
#[derive(Default)]
pub(super) struct Walk {
    pub arrays: Vec<Array<Place>>,
    pub datasets: Vec<Dataset>,
    pub skipped: Vec<String>,
    pub comments: Vec<String>,
    pub beside: Beside,
    /// Groups visited, because links may form a circle.
    seen: HashSet<u64>,
}

impl Walk {
    /// Adds a group and its contents.
    pub fn group(&mut self, group: &Group, path: &[String]) -> Result<(), Error> {
        if !self.seen.insert(group.address()) {
            return Ok(());
        }
        if path.len() > DEEPEST || self.arrays.len() + self.seen.len() > MOST_COLUMNS {
            return Err(Error::ResourceLimit("too many groups".into()));
        }
        let key = |name: &str| {
            let mut path = path.to_vec();
            path.push(name.to_owned());
            path.join("/")
        };
        for attribute in group.attributes().unwrap_or_default() {
            if let Some(value) = number(&attribute) {
                let of = format!("attribute {}", key(&attribute.name));
                self.beside.number(path, &attribute.name, &of, value);
            }
            if let Ok(text) = attribute.read_string()
                && !text.trim().is_empty()
                && text.len() <= LONGEST
                && !attribute.name.chars().all(|c| c.is_uppercase() || c == '_')
            {
                let name = key(&attribute.name);
                let lines = text.lines().map(|line| format!("{name}: {}", line.trim()));
                self.comments.extend(lines);
            }
        }
        let (groups, datasets) = group.members()?;
        let labels = labels(&datasets);
        for dataset in datasets {
            let names = labels
                .iter()
                .find(|(values, _)| values == short(dataset.name()));
            let names = names.map(|(_, names)| names.clone());
            self.dataset(dataset, path, names.unwrap_or_default());
        }
        for group in groups {
            let mut path = path.to_vec();
            path.push(short(group.name()).to_owned());
            self.group(&group, &path)?;
        }
        Ok(())
    }

    /// Adds a data set; `names` are those of its columns, if the file has them.
    fn dataset(&mut self, dataset: Dataset, path: &[String], names: Vec<String>) {
        let name = short(dataset.name()).to_owned();
        let attributes = Stated::of(&dataset);
        let shape = dataset.shape().to_vec();
        let mut fields: Vec<(String, Cell, u64)> = Vec::new();
        match dataset.dtype() {
            Datatype::Compound { fields: of, .. } => {
                for field in of {
                    let (of, elements) = match &field.datatype {
                        Datatype::Array { base, dims } => (
                            &**base,
                            dims.iter()
                                .fold(1, |all: u64, &size| all.saturating_mul(size)),
                        ),
                        of => (of, 1),
                    };
                    match cell(of) {
                        Some(mut cell) if elements <= MOST_OF_ARRAY => {
                            cell.at = field.byte_offset as usize;
                            fields.push((field.name.clone(), cell, elements));
                        }
                        _ => self.skip(path, &format!("{name}.{}", field.name), of_type(of)),
                    }
                }
            }
            of => match cell(of) {
                Some(cell) => fields.push((String::new(), cell, 1)),
                None => return self.skip(path, &name, of_type(of)),
            },
        }
        let long: Vec<u64> = shape.iter().copied().filter(|&size| size != 1).collect();
        // Rows lie one after the other. There are more samples than channels.
        let (rows, columns, [step, next]) = match long[..] {
            [] => {
                let bytes = dataset.read_raw_bytes().unwrap_or_default();
                for (_, cell, _) in fields {
                    let value = cell.kind.read(&bytes, cell.at, cell.is_little);
                    let of = format!(
                        "the number {}",
                        [path, std::slice::from_ref(&name)].concat().join("/")
                    );
                    if !self.beside.number(path, &name, &of, value) {
                        self.skip(path, &name, &format!("the number {value}"));
                    }
                }
                return;
            }
            [rows] => (rows, 1, [1, 0]),
            [rows, columns] if rows >= columns => (rows, columns, [columns, 1]),
            [columns, rows] => (rows, columns, [1, rows]),
            _ => return self.skip(path, &name, &format!("{shape:?}")),
        };
        if rows == 0 || columns > MOST_OF_ARRAY {
            return self.skip(path, &name, &format!("{shape:?}"));
        }
        let is_compound = matches!(dataset.dtype(), Datatype::Compound { .. });
        let mut group = path.to_vec();
        if is_compound {
            group.push(name.clone());
        }
        let names = match attributes.names {
            Some(said) if names.is_empty() && said.len() as u64 == columns && columns > 1 => said,
            _ => names,
        };
        for (field, cell, elements) in fields {
            let base = if is_compound { &field } else { &name };
            let of_field = attributes.units.iter().find(|(of, _)| *of == field);
            let unit = of_field
                .map(|(_, unit)| unit.clone())
                .or_else(|| (!is_compound).then(|| attributes.unit.clone()).flatten());
            for column in 0..columns * elements {
                let (element, column_of) = (column % elements, column / elements);
                let named = names.get(column as usize).filter(|_| !is_compound);
                let name = named
                    .cloned()
                    .unwrap_or_else(|| name_of(base, column, columns * elements));
                let place = [&group[..], std::slice::from_ref(&name)].concat();
                if let Some((factor, offset)) = attributes.scale {
                    let said = format!(
                        "{base} is multiplied by {factor} and {offset} is added, as its attributes say"
                    );
                    self.beside.note(&place, said);
                }
                for (attribute, value) in &attributes.numbers {
                    let of = format!("attribute {attribute} of {base}");
                    self.beside.number(&place, attribute, &of, *value);
                }
                let mut cell = cell.clone();
                cell.at += element as usize * cell.kind.size();
                self.arrays.push(Array {
                    group: group.clone(),
                    column: Column {
                        name,
                        unit: unit.clone(),
                        is_numeric: true,
                        ..Column::default()
                    },
                    rows,
                    clock: None,
                    source: Place {
                        dataset: self.datasets.len(),
                        cell,
                        first: (column_of * next) as usize,
                        step: step as usize,
                        count: rows as usize,
                        scale: attributes.scale,
                        fill: attributes.fill,
                    },
                });
            }
        }
        self.datasets.push(dataset);
    }

    fn skip(&mut self, path: &[String], name: &str, what: &str) {
        let mut path = path.to_vec();
        path.push(name.to_owned());
        self.skipped.push(format!("{} ({what})", path.join("/")));
    }
}

/// Statements in a data set's attributes about its values.
#[derive(Default)]
struct Stated {
    unit: Option<String>,
    /// For the fields of its elements.
    units: Vec<(String, String)>,
    /// In netCDF's form: factor and offset.
    scale: Option<(f64, f64)>,
    fill: Option<f64>,
    /// Names of its columns.
    names: Option<Vec<String>>,
    /// Other numbers.
    numbers: Vec<(String, f64)>,
}

impl Stated {
    fn of(dataset: &Dataset) -> Self {
        let mut stated = Self::default();
        let text = |attribute: &Attribute| attribute.read_string().ok();
        let (mut factor, mut offset) = (None, None);
        for attribute in dataset.attributes() {
            let number = || number(&attribute).filter(|value| value.is_finite());
            match attribute.name.to_lowercase().as_str() {
                "unit" | "units" | "unit_string" | "ni_unitdescription" => {
                    stated.unit = text(&attribute).filter(|unit| !unit.trim().is_empty());
                }
                "scale_factor" => factor = number(),
                "add_offset" => offset = number(),
                "_fillvalue" | "missing_value" => stated.fill = attribute.read_as_f64().ok(),
                "columns" | "column_names" | "names" | "channels" | "channel_names" | "labels" => {
                    stated.names = attribute.read_strings().ok();
                }
                _ if number().is_some() => {
                    stated
                        .numbers
                        .extend(number().map(|value| (attribute.name.clone(), value)));
                }
                name => {
                    let field = name
                        .strip_prefix("unit_")
                        .or_else(|| name.strip_suffix("_unit"));
                    if let (Some(field), Some(unit)) = (field, text(&attribute)) {
                        stated.units.push((field.to_owned(), unit));
                    }
                }
            }
        }
        if factor.is_some() || offset.is_some() {
            stated.scale = Some((factor.unwrap_or(1.0), offset.unwrap_or(0.0)));
        }
        stated
    }
}

/// The number in an attribute; `None` for a text or for several numbers.
fn number(attribute: &Attribute) -> Option<f64> {
    let is_one = attribute.shape.iter().all(|&size| size == 1);
    is_one.then(|| attribute.read_as_f64().ok()).flatten()
}

/// The columns' names of data sets that store them next to them, as pandas stores `block0_items` next to `block0_values`.
fn labels(datasets: &[Dataset]) -> Vec<(String, Vec<String>)> {
    let of = |dataset: &Dataset| {
        let block = short(dataset.name()).strip_suffix("_items")?;
        Some((format!("{block}_values"), dataset.read_strings().ok()?))
    };
    datasets.iter().filter_map(of).collect()
}

/// The last part of a path.
pub(super) fn short(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

fn of_type(of: &Datatype) -> &'static str {
    match of {
        Datatype::String { .. } => "texts",
        Datatype::VarLen { .. } => "texts or lists of any length",
        Datatype::Reference { .. } => "references",
        Datatype::Compound { .. } => "structures",
        Datatype::Array { .. } => "arrays",
        _ if dtype_element_size(of).is_ok_and(|size| size > 8) => "numbers of more than 8 bytes",
        _ => "no numbers",
    }
}
