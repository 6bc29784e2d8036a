//! The arrays in the variables of a MAT file, however deep in structures and cells.

use std::borrow::Cow;
use std::fmt::Write as _;
use std::rc::Rc;

use mesh_damper_output::error::InputError;

use super::element::{Bytes, Numbers};
use super::value::{Fields, Value, Values};
use crate::budget::{Budget, of_text};
use crate::files::Column;
use crate::files::DEEPEST;
use crate::files::arrays::{Array, Located, name_of};
use crate::files::beside::Beside;
use crate::files::groups::{Group, Groups};
use crate::files::number::shown;
use crate::files::refused::Refused;
use crate::files::units_beside::{UnitsBeside, are_units};

/// Fields of a structure that name its data: dSPACE, Simulink and time series as structures.
const DATA: [&str; 4] = ["data", "values", "value", "signal"];
const LABEL: [&str; 3] = ["name", "label", "channelname"];
const UNIT: [&str; 4] = ["unit", "units", "unity", "yunit"];

/// Sizes of an array that is not read in a message. Convention: more than anybody's arrays have.
const SIZES: usize = 8;

/// Parts of a file in messages.
const UNREAD: &str = "what it has that is not read";
const COMMENTS: &str = "its comments";

/// Values of a column: every `step`th of some numbers.
#[derive(Clone, Debug)]
pub(in crate::files) struct Strided {
    numbers: Numbers,
    first: usize,
    step: usize,
    pub count: usize,
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

impl Located for Strided {
    fn key(&self) -> [usize; 4] {
        let [at, kind] = self.numbers.key();
        [at, kind, self.first, self.step]
    }
}

/// Findings in a file.
#[derive(Debug)]
pub(in crate::files) struct Tree {
    pub groups: Groups,
    pub arrays: Vec<Array<Strided>>,
    /// Texts, as `name: text`; of a variable `comments`, its lines.
    pub comments: Vec<String>,
    pub skipped: Vec<String>,
    pub guesses: Vec<String>,
    pub beside: Beside,
    units: UnitsBeside,
}

type Done = Result<(), Refused>;

impl Tree {
    /// Nothing yet; what is found is charged to `budget`.
    pub fn new(budget: Rc<Budget>) -> Self {
        Self {
            groups: Groups::new(budget),
            arrays: Vec::new(),
            comments: Vec::new(),
            skipped: Vec::new(),
            guesses: Vec::new(),
            beside: Beside::default(),
            units: UnitsBeside::default(),
        }
    }

    fn budget(&self) -> &Rc<Budget> {
        self.groups.budget()
    }

    /// At the end of the file, gives the arrays the units that it states for them.
    pub fn finish(&mut self) -> Result<(), InputError> {
        let units = std::mem::take(&mut self.units);
        let spare = units.give(&self.groups, &mut self.arrays, ".")?;
        self.comments.extend(spare);
        Ok(())
    }

    /// Adds one variable.
    pub fn variable(&mut self, matrix: Bytes) -> Done {
        let budget = Rc::clone(self.budget());
        let mut values = Values::new(&budget);
        let (name, value) = values.variable(matrix, DEEPEST)?;
        self.take(Group::FILE, &name, value)
    }

    /// Adds a value called `name` in a group.
    pub fn take(&mut self, group: Group, name: &str, value: Value) -> Done {
        match value {
            Value::Numbers(dimensions, numbers) => {
                self.numbers(group, &Labelled::plain(name), &dimensions, &numbers)
            }
            Value::Text(text) => self.text(group, name, &text),
            Value::Cell(values) => {
                let part = "the names of its cells";
                self.budget().work(of_text(name.len()), part)?;
                self.cells(group, &mut name.to_owned(), values)
            }
            Value::Structure(elements) => {
                let several = elements.len() > 1;
                for (index, fields) in elements.into_iter().enumerate() {
                    let name = match several {
                        true => Cow::Owned(format!("{name}({})", index + 1)),
                        false => Cow::Borrowed(name),
                    };
                    self.structure(group, &name, fields)?;
                }
                Ok(())
            }
            Value::Other(what) => {
                let path = self.path(group, name, UNREAD)?;
                self.skip(format!("{path} ({what})"), what.len())
            }
        }
    }

    /// Adds the values of a cell, each with its number behind the cell's name.
    fn cells(&mut self, group: Group, name: &mut String, values: Vec<Value>) -> Done {
        let length = name.len();
        for (index, value) in values.into_iter().enumerate() {
            // Writing to a text does not fail.
            let _ = write!(name, "{{{}}}", index + 1);
            match value {
                Value::Cell(values) => self.cells(group, name, values)?,
                value => self.take(group, name, value)?,
            }
            name.truncate(length);
        }
        Ok(())
    }

    fn structure(&mut self, group: Group, name: &str, fields: Fields) -> Done {
        let is_of =
            |field: &str, list: &[&str]| list.iter().any(|each| field.eq_ignore_ascii_case(each));
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
                **field == *axis
                    && matches!(value, Value::Structure(elements)
                    if elements.iter().flatten().any(|(field, _)| **field == *"Data"))
            })
        }) == [true, true];
        let inner = self.groups.inside(group, name)?;
        let mut labelled: Option<(Group, Labelled)> = None;
        for (field, value) in fields {
            match value {
                // The data of a channel with its own name: its position is that of its structure.
                Value::Numbers(dimensions, numbers)
                    if is_of(&field, &DATA) && (label.is_some() || unit.is_some()) =>
                {
                    let (group, labelled) = match &labelled {
                        Some(known) => known,
                        None => {
                            let label = label.as_deref().unwrap_or(name);
                            let named = self.labelled(group, label, unit.as_deref())?;
                            labelled.insert(named)
                        }
                    };
                    self.numbers(*group, labelled, &dimensions, &numbers)?;
                }
                Value::Structure(elements) if has_axis && *field == *"X" => {
                    self.axis(inner, elements)?;
                }
                Value::Text(_) if is_of(&field, &LABEL) || is_of(&field, &UNIT) => {}
                value => self.take(inner, &field, value)?,
            }
        }
        Ok(())
    }

    /// The group and the name in a channel's label. The last part of `Model Root/Rig/Force` is the name, the others are its groups.
    fn labelled(
        &mut self,
        group: Group,
        label: &str,
        unit: Option<&str>,
    ) -> Result<(Group, Labelled), Refused> {
        let (above, name) = label.rsplit_once('/').unwrap_or(("", label));
        let mut group = group;
        let parts = above.splitn(DEEPEST, '/');
        for part in parts
            .map(|part| part.trim_matches('/'))
            .filter(|part| !part.is_empty())
        {
            group = self.groups.inside(group, part)?;
        }
        let labelled = Labelled {
            name: name.to_owned(),
            unit: unit.map(str::to_owned),
            is_time: false,
        };
        Ok((group, labelled))
    }

    /// The times of dSPACE.
    fn axis(&mut self, group: Group, elements: Vec<Fields>) -> Done {
        for (field, value) in elements.into_iter().flatten() {
            if let (Value::Numbers(dimensions, numbers), "Data") = (value, &*field) {
                let labelled = Labelled {
                    name: "X".into(),
                    unit: Some("s".into()),
                    is_time: true,
                };
                // It is the only guess.
                if self.guesses.is_empty() {
                    let said = "X of the structure is read as its times in s, as dSPACE writes it";
                    self.guesses.push(said.into());
                }
                self.numbers(group, &labelled, &dimensions, &numbers)?;
            }
        }
        Ok(())
    }

    fn numbers(
        &mut self,
        group: Group,
        labelled: &Labelled,
        dimensions: &[usize],
        numbers: &Numbers,
    ) -> Done {
        let count = (dimensions.iter()).try_fold(1_usize, |all, &size| all.checked_mul(size));
        if count != Some(numbers.len()) {
            let why = "a variable has not as many numbers as its dimensions say";
            return Err(why.into());
        }
        let name = &labelled.name;
        let mut long = dimensions.iter().copied().filter(|&size| size != 1);
        let long = [long.next(), long.next(), long.next()];
        let (rows, columns, steps) = match long {
            [None, ..] => return self.number(group, name, numbers.get(0)),
            [Some(rows), None, _] => (rows, 1, [1, 0]),
            // There are more samples than channels. Columns lie one after the other.
            [Some(rows), Some(columns), None] if rows >= columns => (rows, columns, [1, rows]),
            [Some(columns), Some(rows), None] => (rows, columns, [columns, 1]),
            [Some(_), Some(_), Some(_)] => (0, 0, [0, 0]),
        };
        if rows == 0 {
            let path = self.path(group, name, UNREAD)?;
            let sizes = dimensions.iter().take(SIZES).map(usize::to_string);
            let more = (dimensions.len() > SIZES).then(|| "…".to_owned());
            let sizes = sizes.chain(more).collect::<Vec<String>>().join("×");
            return self.skip(format!("{path} ({sizes})"), sizes.len());
        }
        for column in 0..columns {
            let values = Strided {
                numbers: numbers.clone(),
                first: column * steps[1],
                step: steps[0],
                count: rows,
            };
            let array = Array {
                group,
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
            };
            array.add_to(&mut self.arrays, self.groups.budget())?;
        }
        Ok(())
    }

    /// Adds a single number, which may say something about the arrays beside it.
    fn number(&mut self, group: Group, name: &str, value: f64) -> Done {
        let path = self.path(group, name, UNREAD)?;
        let of = format!("the number {path}");
        if (self.beside).number(group, name, &of, value, self.groups.budget())? {
            return Ok(());
        }
        let said = [&of, " = ", &*shown(value)].concat();
        let length = said.len();
        self.skip(said, length)
    }

    fn text(&mut self, group: Group, name: &str, text: &str) -> Done {
        if text.trim().is_empty() {
            return Ok(());
        }
        if group != Group::FILE && are_units(self.groups.name(group)) {
            return Ok(self.units.add(&self.groups, group, name, text)?);
        }
        let is_ours = group == Group::FILE && name == "comments";
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty()) {
            self.budget().hold(of_text(line.len()), COMMENTS)?;
            let line = if is_ours {
                line.to_owned()
            } else {
                [&self.path(group, name, COMMENTS)?, ": ", line].concat()
            };
            self.comments.push(line);
        }
        Ok(())
    }

    /// Notes what is not read. Its path is charged already, `more` bytes are not.
    fn skip(&mut self, what: String, more: usize) -> Done {
        self.budget().hold(of_text(more), UNREAD)?;
        self.skipped.push(what);
        Ok(())
    }

    fn path(&self, group: Group, name: &str, part: &str) -> Result<String, InputError> {
        (self.groups).label([Group::FILE, group], Some(name), ".", part)
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
