//! The arrays in the variables of a MAT file, however deep in structures and cells.

use super::element::{Broken, Bytes, Element, Numbers};
use crate::files::Column;
use crate::files::arrays::{Array, MOST_COLUMNS, MOST_OF_ARRAY, name_of};
use crate::files::beside::Beside;
use crate::files::number::Kind;
use crate::files::units_beside::{UnitsBeside, are_units};

/// The deepest nesting of structures. Convention: deeper than any program writes, and within the stack.
const DEEPEST: usize = 32;
/// The most characters of texts that are kept. Convention: pages of notes.
const MOST_TEXT: usize = 1 << 16;

/// The most values that a file may have, those in structures and cells included. Convention: a structure for each cycle of a long
/// test, with some dozen fields.
const MOST_VALUES: usize = 1 << 20;

/// Fields of a structure that name its data: dSPACE, Simulink and time series as structures.
const DATA: [&str; 4] = ["data", "values", "value", "signal"];
const LABEL: [&str; 3] = ["name", "label", "channelname"];
const UNIT: [&str; 4] = ["unit", "units", "unity", "yunit"];

/// Values of a column: every `step`th of some numbers.
#[derive(Clone, Debug)]
pub(in crate::files) struct Strided {
    numbers: Numbers,
    first: usize,
    step: usize,
    count: usize,
}

impl Strided {
    pub fn all(&self) -> Vec<f64> {
        self.some(self.count)
    }

    fn some(&self, most: usize) -> Vec<f64> {
        (0..self.count.min(most))
            .map(|index| self.numbers.get(self.first + index * self.step))
            .collect()
    }
}

/// Findings in a file.
#[derive(Debug)]
pub(in crate::files) struct Tree {
    pub arrays: Vec<Array<Strided>>,
    /// Texts, as `name: text`; of a variable `comments`, its lines.
    pub comments: Vec<String>,
    pub skipped: Vec<String>,
    pub guesses: Vec<String>,
    pub beside: Beside,
    units: UnitsBeside,
    text: usize,
    left: usize,
}

/// A matrix's head: its class, its dimensions and its name.
struct Head {
    class: u8,
    is_complex: bool,
    dimensions: Vec<usize>,
    name: String,
}

/// A value of MATLAB.
pub(in crate::files) enum Value {
    Numbers(Vec<usize>, Numbers),
    Text(String),
    /// Elements, each with its fields.
    Structure(Vec<Vec<(String, Value)>>),
    Cell(Vec<Value>),
    /// A value that is not read, in words.
    Other(String),
}

impl Tree {
    pub fn new() -> Self {
        Self {
            arrays: Vec::new(),
            comments: Vec::new(),
            skipped: Vec::new(),
            guesses: Vec::new(),
            beside: Beside::default(),
            units: UnitsBeside::default(),
            text: 0,
            left: MOST_VALUES,
        }
    }

    /// At the end of the file, gives the arrays the units that it states for them.
    pub fn finish(&mut self) {
        let spare = std::mem::take(&mut self.units).give(&mut self.arrays, ".");
        self.comments.extend(spare);
    }

    /// Adds one variable.
    pub fn variable(&mut self, matrix: Bytes) -> Result<(), Broken> {
        let (name, value) = value(matrix, DEEPEST, &mut self.left)?;
        self.take(&[], &name, value)
    }

    /// Adds a value that is nested in structures.
    pub fn take(&mut self, group: &[String], name: &str, value: Value) -> Result<(), Broken> {
        match value {
            Value::Numbers(dimensions, numbers) => {
                self.numbers(group, Labelled::plain(name), &dimensions, &numbers)
            }
            Value::Text(text) => {
                self.text(group, name, &text);
                Ok(())
            }
            Value::Cell(values) => {
                for (index, value) in values.into_iter().enumerate() {
                    self.take(group, &format!("{name}{{{}}}", index + 1), value)?;
                }
                Ok(())
            }
            Value::Structure(elements) => {
                let several = elements.len() > 1;
                for (index, fields) in elements.into_iter().enumerate() {
                    let name = if several {
                        format!("{name}({})", index + 1)
                    } else {
                        name.to_owned()
                    };
                    self.structure(group, &name, fields)?;
                }
                Ok(())
            }
            Value::Other(what) => {
                self.skip(format!("{} ({what})", path(group, name)));
                Ok(())
            }
        }
    }

    fn structure(
        &mut self,
        group: &[String],
        name: &str,
        fields: Vec<(String, Value)>,
    ) -> Result<(), Broken> {
        let is_of = |field: &str, list: &[&str]| list.contains(&field.to_lowercase().as_str());
        let text = |list: &[&str]| {
            fields.iter().find_map(|(field, value)| match value {
                Value::Text(text) if is_of(field, list) && !text.trim().is_empty() => {
                    Some(text.trim().to_owned())
                }
                _ => None,
            })
        };
        let (label, unit) = (text(&LABEL), text(&UNIT));
        // dSPACE stores the times of the elements of Y in X, in seconds.
        let has_axis = ["X", "Y"].map(|axis| {
            (fields.iter()).any(|(field, value)| {
                field == axis
                    && matches!(value, Value::Structure(elements)
                    if elements.iter().flatten().any(|(field, _)| field == "Data"))
            })
        }) == [true, true];
        let mut inner = group.to_vec();
        inner.push(name.to_owned());
        for (field, value) in fields {
            match value {
                // The data of a channel with its own name: its position is that of its structure.
                Value::Numbers(dimensions, numbers)
                    if is_of(&field, &DATA) && (label.is_some() || unit.is_some()) =>
                {
                    // `Model Root/Rig/Force`: the last part is the name, the others are its groups.
                    let label = label.as_deref().unwrap_or(name);
                    let (above, name) = label.rsplit_once('/').unwrap_or(("", label));
                    let above = above.split('/').filter(|part| !part.is_empty());
                    let group = group.iter().cloned().chain(above.map(str::to_owned));
                    let labelled = Labelled {
                        name: name.to_owned(),
                        unit: unit.clone(),
                        is_time: false,
                    };
                    let group: Vec<String> = group.collect();
                    self.numbers(&group, labelled, &dimensions, &numbers)?;
                }
                Value::Structure(elements) if has_axis && field == "X" => {
                    self.axis(&inner, elements)?;
                }
                Value::Text(_) if is_of(&field, &LABEL) || is_of(&field, &UNIT) => {}
                value => self.take(&inner, &field, value)?,
            }
        }
        Ok(())
    }

    /// The times of dSPACE.
    fn axis(
        &mut self,
        group: &[String],
        elements: Vec<Vec<(String, Value)>>,
    ) -> Result<(), Broken> {
        for (field, value) in elements.into_iter().flatten() {
            if let (Value::Numbers(dimensions, numbers), "Data") = (value, field.as_str()) {
                let labelled = Labelled {
                    name: "X".into(),
                    unit: Some("s".into()),
                    is_time: true,
                };
                let said = "X of the structure is read as its times in s, as dSPACE writes it";
                if !self.guesses.iter().any(|each| each == said) {
                    self.guesses.push(said.into());
                }
                self.numbers(group, labelled, &dimensions, &numbers)?;
            }
        }
        Ok(())
    }

    fn numbers(
        &mut self,
        group: &[String],
        labelled: Labelled,
        dimensions: &[usize],
        numbers: &Numbers,
    ) -> Result<(), Broken> {
        let count = (dimensions.iter()).try_fold(1_usize, |all, &size| all.checked_mul(size));
        if count != Some(numbers.len()) {
            return Err(Broken(
                "a variable has not as many numbers as its dimensions say",
            ));
        }
        let long: Vec<usize> = dimensions
            .iter()
            .copied()
            .filter(|&size| size != 1)
            .collect();
        let name = &labelled.name;
        let (rows, columns, steps) = match long[..] {
            [] => {
                let value = numbers.get(0);
                let of = format!("the number {}", path(group, name));
                if !self.beside.number(group, name, &of, value) {
                    self.skip(format!("{of} = {value}"));
                }
                return Ok(());
            }
            [rows] => (rows, 1, [1, 0]),
            // There are more samples than channels. Columns lie one after the other.
            [rows, columns] if rows >= columns => (rows, columns, [1, rows]),
            [columns, rows] => (rows, columns, [columns, 1]),
            _ => {
                let sizes: Vec<String> = dimensions.iter().map(usize::to_string).collect();
                self.skip(format!("{} ({})", path(group, name), sizes.join("×")));
                return Ok(());
            }
        };
        if rows == 0 || columns as u64 > MOST_OF_ARRAY {
            self.skip(format!("{} ({rows}×{columns})", path(group, name)));
            return Ok(());
        }
        for column in 0..columns {
            let values = Strided {
                numbers: numbers.clone(),
                first: column * steps[1],
                step: steps[0],
                count: rows,
            };
            self.arrays.push(Array {
                group: group.to_vec(),
                column: Column {
                    name: name_of(name, column as u64, columns as u64),
                    unit: labelled.unit.clone(),
                    is_numeric: true,
                    is_time: labelled.is_time,
                    first: values.some(Column::FIRST),
                    ..Column::default()
                },
                rows: rows as u64,
                clock: None,
                source: values,
            });
        }
        if self.arrays.len() > MOST_COLUMNS {
            return Err(Broken("it has more arrays than any test has channels"));
        }
        Ok(())
    }

    fn text(&mut self, group: &[String], name: &str, text: &str) {
        self.text += text.len();
        if self.text > MOST_TEXT || text.trim().is_empty() {
            return;
        }
        if group.last().is_some_and(|name| are_units(name)) {
            self.units.add(group, name, text);
            return;
        }
        let is_ours = group.is_empty() && name == "comments";
        let name = path(group, name);
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
            let line = if is_ours {
                line.to_owned()
            } else {
                format!("{name}: {line}")
            };
            self.comments.push(line);
        }
    }

    fn skip(&mut self, what: String) {
        if self.skipped.len() < MOST_COLUMNS {
            self.skipped.push(what);
        }
    }
}

/// Statements about an array in addition to its values.
struct Labelled {
    name: String,
    unit: Option<String>,
    is_time: bool,
}

impl Labelled {
    fn plain(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            unit: None,
            is_time: false,
        }
    }
}

fn path(group: &[String], name: &str) -> String {
    let mut path = group.to_vec();
    path.push(name.to_owned());
    path.join(".")
}

/// A matrix's name and contents; `depth` is the remaining nesting, and `left` the remaining number of values.
fn value(mut bytes: Bytes, depth: usize, left: &mut usize) -> Result<(String, Value), Broken> {
    let deeper = depth.checked_sub(1);
    let deeper = deeper.ok_or(Broken("structures are nested too deeply"))?;
    *left = (left.checked_sub(1)).ok_or(Broken("it has more variables than any test"))?;
    if bytes.slice().is_empty() {
        return Ok((String::new(), Value::Other("empty".into())));
    }
    let head = head(&mut bytes)?;
    let count = (head.dimensions.iter()).try_fold(1_usize, |all, &size| all.checked_mul(size));
    let count = count.ok_or(Broken("the dimensions of a variable are invalid"))?;
    let value = match head.class {
        1 => {
            let mut cells = Vec::new();
            while cells.len() < count
                && let Some(matrix) = matrix(&mut bytes)?
            {
                cells.push(value(matrix, deeper, left)?.1);
            }
            Value::Cell(cells)
        }
        2 | 3 => {
            if head.class == 3 {
                // The class of the object.
                bytes.numbers()?;
            }
            Value::Structure(elements(&mut bytes, count, deeper, left)?)
        }
        4 => Value::Text(text(&mut bytes, &head.dimensions)?),
        6..=15 if head.is_complex => Value::Other("complex numbers".into()),
        6..=15 => Value::Numbers(head.dimensions, bytes.numbers()?),
        5 => Value::Other("a sparse matrix".into()),
        16 => Value::Other("a function".into()),
        17 => Value::Other(format!("an object of class {}", class(&mut bytes)?)),
        _ => Value::Other("of an unknown class".into()),
    };
    Ok((head.name, value))
}

fn head(bytes: &mut Bytes) -> Result<Head, Broken> {
    let flags = bytes.numbers()?.get(0) as u32;
    let class = flags as u8;
    // The layout of an object of a class is not documented: its name follows at once.
    let dimensions = if class == 17 {
        Vec::new()
    } else {
        let sizes = bytes.numbers()?;
        (0..sizes.len())
            .map(|index| sizes.get(index) as usize)
            .collect()
    };
    let name = bytes.numbers()?.text();
    Ok(Head {
        class,
        is_complex: flags & 0x800 != 0,
        dimensions,
        name,
    })
}

fn matrix(bytes: &mut Bytes) -> Result<Option<Bytes>, Broken> {
    match bytes.next()? {
        Some(Element::Matrix(matrix)) => Ok(Some(matrix)),
        Some(_) => Err(Broken(
            "a structure or cell holds something that is not a variable",
        )),
        None => Ok(None),
    }
}

fn elements(
    bytes: &mut Bytes,
    count: usize,
    depth: usize,
    left: &mut usize,
) -> Result<Vec<Vec<(String, Value)>>, Broken> {
    let length = bytes.numbers()?.get(0).max(1.0) as usize;
    let all = bytes.numbers()?;
    let names: Vec<String> = all
        .bytes
        .slice()
        .chunks(length)
        .map(|name| {
            let end = name
                .iter()
                .position(|&byte| byte == 0)
                .unwrap_or(name.len());
            String::from_utf8_lossy(&name[..end]).into_owned()
        })
        .collect();
    let mut elements = Vec::new();
    while elements.len() < count && !bytes.slice().is_empty() {
        let mut fields = Vec::new();
        for name in &names {
            let Some(matrix) = matrix(bytes)? else { break };
            fields.push((name.clone(), value(matrix, depth, left)?.1));
        }
        if fields.is_empty() {
            break;
        }
        elements.push(fields);
    }
    Ok(elements)
}

/// A text: its rows in MATLAB's layout, one line each.
fn text(bytes: &mut Bytes, dimensions: &[usize]) -> Result<String, Broken> {
    let text = match bytes.next()? {
        Some(Element::Numbers(numbers)) => numbers.text(),
        Some(Element::Other(16, bytes)) => String::from_utf8_lossy(bytes.slice()).into_owned(),
        Some(Element::Other(17, bytes)) => Numbers {
            kind: Kind::U16,
            bytes,
        }
        .text(),
        _ => return Ok(String::new()),
    };
    Ok(rows_of_text(&text, dimensions))
}

/// The rows of a text in MATLAB's layout: column after column.
pub(in crate::files) fn rows_of_text(text: &str, dimensions: &[usize]) -> String {
    let rows = dimensions.first().copied().unwrap_or(1);
    if rows <= 1 {
        return text.to_owned();
    }
    let characters: Vec<char> = text.chars().collect();
    let line = |row: usize| {
        characters
            .iter()
            .skip(row)
            .step_by(rows)
            .collect::<String>()
    };
    let lines: Vec<String> = (0..rows.min(characters.len())).map(line).collect();
    lines.join("\n")
}

/// The class of an object, after the name and the word `MCOS`.
fn class(bytes: &mut Bytes) -> Result<String, Broken> {
    bytes.numbers()?;
    Ok(bytes.numbers()?.text())
}
