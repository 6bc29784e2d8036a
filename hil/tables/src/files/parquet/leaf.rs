//! The columns of numbers in Arrow arrays of any type.

use std::cell::Cell;
use std::collections::HashMap;

use arrow_array::cast::AsArray as _;
use arrow_array::types::{
    Date32Type, Date64Type, Decimal128Type, DurationMicrosecondType, DurationMillisecondType,
    DurationNanosecondType, DurationSecondType, Float16Type, Float32Type, Float64Type, Int8Type,
    Int16Type, Int32Type, Int64Type, Time32MillisecondType, Time32SecondType,
    Time64MicrosecondType, Time64NanosecondType, TimestampMicrosecondType,
    TimestampMillisecondType, TimestampNanosecondType, TimestampSecondType, UInt8Type, UInt16Type,
    UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_buffer::NullBuffer;
use arrow_schema::{DataType, Field, Schema, TimeUnit};
use mesh_damper_output::error::InputError;

use super::pandas;
use crate::budget::Budget;
use crate::files::arrays::MOST_OF_ARRAY;
use crate::files::names::name_of;
use crate::files::packed::Packed;
use crate::files::{Column, Table};
use crate::room::Room;

/// A column of numbers: the fields that lead to it, the outermost first, and its index in lists of one length.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    pub fields: Vec<usize>,
    element: usize,
    /// Length of the lists; 1 without lists.
    pub width: usize,
    /// Its number among the columns of the file, those included that are not read.
    pub number: usize,
}

/// The keys of a field's metadata that contain its unit.
const UNIT: [&str; 4] = ["unit", "units", "Unit", "Units"];
/// Bytes of a line of metadata up to which it is a comment, for people and not for a program. Convention: a page.
const PAGE: usize = 1 << 12;
/// Bytes held for a column, besides its texts.
const OF_COLUMN: u64 = 2 * (size_of::<Column>() + size_of::<Leaf>()) as u64;
/// Steps of work for a column of the schema.
const STEPS_OF_COLUMN: u64 = 64;

/// The table of a schema, and the leaf of each of its columns.
///
/// # Errors
/// The budget has no room for them.
pub(super) fn table(
    schema: &Schema,
    rows: Option<u64>,
    budget: &Budget,
) -> Result<(Table, Vec<Leaf>), InputError> {
    let mut room = Room::of(budget);
    let said = schema.metadata().get("pandas");
    let mut found = Found {
        table: Table {
            rows,
            ..Table::default()
        },
        leaves: Vec::new(),
        units: match said {
            Some(said) => pandas::units(said, &mut room)?,
            None => HashMap::new(),
        },
        passed: 0,
        budget,
    };
    for (index, field) in schema.fields().iter().enumerate() {
        found.field(&[], "", index, field)?;
    }
    Ok((found.table, found.leaves))
}

struct Found<'b> {
    table: Table,
    leaves: Vec<Leaf>,
    units: HashMap<String, String>,
    /// Number of columns of the file so far.
    passed: usize,
    budget: &'b Budget,
}

impl Found<'_> {
    fn field(
        &mut self,
        above: &[usize],
        prefix: &str,
        index: usize,
        field: &Field,
    ) -> Result<(), InputError> {
        const PART: &str = "its columns";
        let mut fields = above.to_vec();
        fields.push(index);
        let long = (prefix.len() + field.name().len()) as u64;
        self.budget.work(STEPS_OF_COLUMN + long, PART)?;
        let name = format!("{prefix}{}", field.name());
        if let DataType::Struct(inner) = field.data_type() {
            for (index, field) in inner.iter().enumerate() {
                self.field(&fields, &format!("{name}."), index, field)?;
            }
            return Ok(());
        }
        let number = self.passed;
        self.passed += columns_of(field.data_type());
        let (of, elements) = match field.data_type() {
            DataType::FixedSizeList(of, size) => {
                (of.data_type(), u64::try_from(*size).unwrap_or(0))
            }
            of => (of, 1),
        };
        if !is_numeric(of) || elements == 0 || elements > MOST_OF_ARRAY {
            let what = format!("column {name} ({})", field.data_type());
            self.budget
                .hold(what.len() as u64, "what it does not read")?;
            self.table.skipped.push(what);
            return Ok(());
        }
        let is_date = is_date(of);
        // pandas' name for an index without a name.
        let name = match name.strip_prefix("__index_level_") {
            Some(_) if is_date => "timestamp".to_owned(),
            _ => name,
        };
        if is_date {
            let note =
                format!("the dates of column {name} are taken as seconds after the first of them");
            self.budget
                .hold(note.len() as u64, "notes about its columns")?;
            self.table.guesses.push(note);
        }
        let said = UNIT
            .into_iter()
            .find_map(|key| field.metadata().get(key).cloned());
        let unit = if is_date || matches!(of, DataType::Duration(_)) {
            Some("s".to_owned())
        } else {
            said.or_else(|| self.units.get(&name).cloned())
                .filter(|unit| !unit.trim().is_empty())
        };
        let texts = name.len() + unit.as_ref().map_or(0, String::len);
        let of_each = OF_COLUMN + (2 * texts + size_of_val(&fields[..])) as u64;
        self.budget.hold(elements.saturating_mul(of_each), PART)?;
        for element in 0..elements {
            self.table.columns.push(Column {
                name: name_of(name.trim(), element, elements),
                unit: unit.clone(),
                is_numeric: true,
                is_stamp: is_date,
                ..Column::default()
            });
            self.leaves.push(Leaf {
                fields: fields.clone(),
                element: element as usize,
                width: elements as usize,
                number,
            });
        }
        Ok(())
    }
}

/// Number of columns in which Parquet stores values of this type.
pub(super) fn columns_of(of: &DataType) -> usize {
    match of {
        DataType::Struct(fields) => fields
            .iter()
            .map(|field| columns_of(field.data_type()))
            .sum(),
        DataType::List(of)
        | DataType::LargeList(of)
        | DataType::ListView(of)
        | DataType::LargeListView(of)
        | DataType::FixedSizeList(of, _)
        | DataType::Map(of, _) => columns_of(of.data_type()),
        _ => 1,
    }
}

/// Statements of a file in addition to its columns, as lines `key: text`; those under `comments` unchanged. What is too long to be one
/// is `skipped`.
///
/// # Errors
/// The budget has no room for them.
pub(super) fn comments<'m>(
    metadata: impl Iterator<Item = (&'m str, &'m str)>,
    skipped: &mut Vec<String>,
    budget: &Budget,
) -> Result<Vec<String>, InputError> {
    let mut comments = Vec::new();
    for (key, text) in metadata {
        if key == "pandas" || key.starts_with("ARROW:") {
            continue;
        }
        let is_bare = key == "comments";
        let key_of_it = if is_bare { "" } else { key };
        for line in text.lines().map(str::trim) {
            let long = key_of_it.len() + line.len();
            budget.hold((size_of::<String>() + long) as u64, "its comments")?;
            if is_bare && !line.is_empty() {
                comments.push(line.to_owned());
            } else if !is_bare && line.len() > PAGE {
                skipped.push(format!("the text {key:.100} of {} bytes", line.len()));
            } else if !is_bare {
                comments.push(format!("{key}: {line}"));
            }
        }
    }
    Ok(comments)
}

fn is_date(of: &DataType) -> bool {
    matches!(
        of,
        DataType::Timestamp(..)
            | DataType::Date32
            | DataType::Date64
            | DataType::Time32(_)
            | DataType::Time64(_)
    )
}

fn is_numeric(of: &DataType) -> bool {
    match of {
        DataType::Dictionary(_, of) => !matches!(**of, DataType::Dictionary(..)) && is_numeric(of),
        DataType::Boolean | DataType::Decimal128(..) | DataType::Duration(_) => true,
        of => of.is_integer() || of.is_floating() || is_date(of),
    }
}

/// The values of one column, batch after batch.
pub(super) struct Gathered<'p> {
    pub values: Vec<f64>,
    /// The first date, from which others are counted.
    first: Option<i64>,
    packed: &'p Packed,
}

/// Bytes that a value counts as when it is unpacked. Derived: a text of the same values has a digit and its end for each at least.
const OF_VALUE: u64 = 2;

/// The places of a column's values in an array.
enum Places {
    /// Every `step`th, from the first on.
    Strided {
        first: usize,
        step: usize,
        count: usize,
    },
    /// These; `None` for a missing one.
    Listed(Vec<Option<usize>>),
}

impl<'p> Gathered<'p> {
    pub fn of(packed: &'p Packed) -> Self {
        Self {
            values: Vec::new(),
            first: None,
            packed,
        }
    }

    /// Appends the values of a batch; `None` if they are not numbers. What a file states of their number is not believed: they are
    /// charged when they are there.
    ///
    /// # Errors
    /// The budget has no room for them.
    pub fn append(&mut self, batch: &RecordBatch, leaf: &Leaf) -> Result<Option<()>, InputError> {
        let mut room = Room::of(self.packed.budget());
        let Some((array, is_null)) = reached(batch, leaf) else {
            return Ok(None);
        };
        let rows = array.len();
        let budget = self.packed.budget();
        budget.unpacked(OF_VALUE * rows as u64)?;
        budget.work(2 * rows as u64, "its values")?;
        budget.reserve(&mut self.values, rows, "its values")?;
        let (array, step) = match array.as_fixed_size_list_opt() {
            Some(lists) => (lists.values().clone(), leaf.width),
            None => (array, 1),
        };
        let first = leaf.element;
        let places = match is_null {
            None => Places::Strided {
                first,
                step,
                count: rows,
            },
            Some(is_null) => {
                room.more(
                    (rows * size_of::<Option<usize>>()) as u64,
                    "its missing values",
                )?;
                let place = |row| is_null.is_valid(row).then_some(row * step + first);
                Places::Listed((0..rows).map(place).collect())
            }
        };
        self.numbers(&array, places, &mut room)
    }

    /// Appends the values of an array at these places, NaN for a null.
    fn numbers(
        &mut self,
        array: &ArrayRef,
        places: Places,
        room: &mut Room,
    ) -> Result<Option<()>, InputError> {
        macro_rules! append {
            ($array:expr, $value:expr) => {{
                let Some(array) = $array else {
                    return Ok(None);
                };
                let has_nulls = array.null_count() > 0;
                let value = $value;
                let mut append = |place: Option<usize>| {
                    let place = place.filter(|&at| at < array.len());
                    let place = place.filter(|&at| !has_nulls || array.is_valid(at));
                    let value = place.map_or(f64::NAN, |at| value(array.value(at)));
                    self.values.push(value);
                };
                match places {
                    Places::Strided { first, step, count } => {
                        (0..count).for_each(|row| append(Some(first + row * step)));
                    }
                    Places::Listed(places) => places.into_iter().for_each(append),
                }
            }};
        }
        macro_rules! numbers {
            ($type:ty, $map:expr) => {
                append!(array.as_primitive_opt::<$type>(), $map)
            };
        }
        // Dates are subtracted as integers: since 1970 there have been more nanoseconds than a float can resolve.
        macro_rules! dates {
            ($type:ty, $step:expr) => {{
                let first = Cell::new(self.first);
                append!(array.as_primitive_opt::<$type>(), |value| {
                    let value = i64::from(value);
                    let since = first.get().unwrap_or(value);
                    first.set(Some(since));
                    value.wrapping_sub(since) as f64 * $step
                });
                self.first = first.get();
            }};
        }
        const DAY: f64 = 86_400.0;
        match array.data_type() {
            DataType::Int8 => numbers!(Int8Type, f64::from),
            DataType::Int16 => numbers!(Int16Type, f64::from),
            DataType::Int32 => numbers!(Int32Type, f64::from),
            DataType::Int64 => numbers!(Int64Type, |value| value as f64),
            DataType::UInt8 => numbers!(UInt8Type, f64::from),
            DataType::UInt16 => numbers!(UInt16Type, f64::from),
            DataType::UInt32 => numbers!(UInt32Type, f64::from),
            DataType::UInt64 => numbers!(UInt64Type, |value| value as f64),
            DataType::Float16 => numbers!(Float16Type, f64::from),
            DataType::Float32 => numbers!(Float32Type, f64::from),
            DataType::Float64 => numbers!(Float64Type, |value| value),
            DataType::Decimal128(_, scale) => {
                let one = 10_f64.powi(i32::from(*scale));
                numbers!(Decimal128Type, |value| value as f64 / one)
            }
            DataType::Boolean => append!(array.as_boolean_opt(), |is| f64::from(u8::from(is))),
            DataType::Duration(unit) => match unit {
                TimeUnit::Second => numbers!(DurationSecondType, |value| value as f64),
                TimeUnit::Millisecond => {
                    numbers!(DurationMillisecondType, |value| value as f64 / 1e3)
                }
                TimeUnit::Microsecond => {
                    numbers!(DurationMicrosecondType, |value| value as f64 / 1e6)
                }
                TimeUnit::Nanosecond => {
                    numbers!(DurationNanosecondType, |value| value as f64 / 1e9)
                }
            },
            DataType::Timestamp(unit, _) => match unit {
                TimeUnit::Second => dates!(TimestampSecondType, 1.0),
                TimeUnit::Millisecond => dates!(TimestampMillisecondType, 1e-3),
                TimeUnit::Microsecond => dates!(TimestampMicrosecondType, 1e-6),
                TimeUnit::Nanosecond => dates!(TimestampNanosecondType, 1e-9),
            },
            DataType::Date32 => dates!(Date32Type, DAY),
            DataType::Date64 => dates!(Date64Type, 1e-3),
            DataType::Time32(TimeUnit::Second) => dates!(Time32SecondType, 1.0),
            DataType::Time32(_) => dates!(Time32MillisecondType, 1e-3),
            DataType::Time64(TimeUnit::Microsecond) => dates!(Time64MicrosecondType, 1e-6),
            DataType::Time64(_) => dates!(Time64NanosecondType, 1e-9),
            DataType::Dictionary(..) => {
                let Some(dictionary) = array.as_any_dictionary_opt() else {
                    return Ok(None);
                };
                let keys = array.len() * size_of::<usize>();
                let (count, of_place) = (array.len(), size_of::<Option<usize>>());
                room.more(
                    (keys + count * of_place) as u64,
                    "the keys of its dictionaries",
                )?;
                let values = dictionary.values();
                if values.is_empty() {
                    let count = match places {
                        Places::Strided { count, .. } => count,
                        Places::Listed(places) => places.len(),
                    };
                    self.values.extend(std::iter::repeat_n(f64::NAN, count));
                    return Ok(Some(()));
                }
                let keys = dictionary.normalized_keys();
                let key = |at: usize| keys.get(at).copied().filter(|_| array.is_valid(at));
                let places = match places {
                    Places::Strided { first, step, count } => {
                        (0..count).map(|row| key(first + row * step)).collect()
                    }
                    Places::Listed(places) => places.into_iter().map(|place| key(place?)).collect(),
                };
                return self.numbers(values, Places::Listed(places), room);
            }
            _ => return Ok(None),
        }
        Ok(Some(()))
    }
}

/// The array of a column in a batch, and which rows have a value in all fields around it, unless all have.
fn reached(batch: &RecordBatch, leaf: &Leaf) -> Option<(ArrayRef, Option<NullBuffer>)> {
    let (first, inner) = leaf.fields.split_first()?;
    let mut array: ArrayRef = batch.columns().get(*first)?.clone();
    let mut is_null = None;
    for &field in inner {
        is_null = NullBuffer::union(is_null.as_ref(), array.nulls());
        array = array.as_struct_opt()?.columns().get(field)?.clone();
    }
    // The rows of lists that are missing; those of other arrays are seen at their values.
    if array.as_fixed_size_list_opt().is_some() {
        is_null = NullBuffer::union(is_null.as_ref(), array.nulls());
    }
    Some((array, is_null))
}
