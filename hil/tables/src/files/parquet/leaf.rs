//! The columns of numbers in Arrow arrays of any type.

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
use arrow_schema::{DataType, Field, Schema, TimeUnit};

use crate::files::arrays::{MOST_COLUMNS, MOST_OF_ARRAY, name_of};
use crate::files::{Column, Table};

/// A column of numbers: the fields that lead to it, the outermost first, and its index in lists of one length.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    pub fields: Vec<usize>,
    element: usize,
}

/// The keys of a field's metadata that contain its unit.
const UNIT: [&str; 4] = ["unit", "units", "Unit", "Units"];
/// The longest text of metadata that is a comment. Convention: a page.
const LONGEST: usize = 1 << 12;

/// The table of a schema, and the leaf of each of its columns.
pub(super) fn table(schema: &Schema, rows: Option<u64>) -> (Table, Vec<Leaf>) {
    let mut found = Found {
        table: Table {
            rows,
            ..Table::default()
        },
        leaves: Vec::new(),
        units: units_of_pandas(schema),
    };
    for (index, field) in schema.fields().iter().enumerate() {
        found.field(&[], "", index, field);
    }
    (found.table, found.leaves)
}

struct Found {
    table: Table,
    leaves: Vec<Leaf>,
    units: Vec<(String, String)>,
}

impl Found {
    fn field(&mut self, above: &[usize], prefix: &str, index: usize, field: &Field) {
        let mut fields = above.to_vec();
        fields.push(index);
        let name = format!("{prefix}{}", field.name());
        if let DataType::Struct(inner) = field.data_type() {
            for (index, field) in inner.iter().enumerate() {
                self.field(&fields, &format!("{name}."), index, field);
            }
            return;
        }
        let (of, elements) = match field.data_type() {
            DataType::FixedSizeList(of, size) => {
                (of.data_type(), u64::try_from(*size).unwrap_or(0))
            }
            of => (of, 1),
        };
        let room = self.leaves.len() + elements as usize <= MOST_COLUMNS;
        if !is_numeric(of) || elements == 0 || elements > MOST_OF_ARRAY || !room {
            self.table
                .skipped
                .push(format!("column {name} ({})", field.data_type()));
            return;
        }
        let is_date = is_date(of);
        // pandas' name for an index without a name.
        let name = match name.strip_prefix("__index_level_") {
            Some(_) if is_date => "timestamp".to_owned(),
            _ => name,
        };
        if is_date {
            self.table.guesses.push(format!(
                "the dates of column {name} are taken as seconds after the first of them"
            ));
        }
        let said = UNIT
            .into_iter()
            .find_map(|key| field.metadata().get(key).cloned());
        let of_pandas = || {
            let known = self.units.iter().find(|(of, _)| *of == name);
            known.map(|(_, unit)| unit.clone())
        };
        let unit = if is_date || matches!(of, DataType::Duration(_)) {
            Some("s".to_owned())
        } else {
            said.or_else(of_pandas)
                .filter(|unit| !unit.trim().is_empty())
        };
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
            });
        }
    }
}

/// Statements of a file in addition to its columns, as lines `key: text`; those under `comments` unchanged.
pub(super) fn comments<'m>(metadata: impl Iterator<Item = (&'m str, &'m str)>) -> Vec<String> {
    let mut comments = Vec::new();
    for (key, text) in metadata {
        if key == "comments" {
            comments.extend(text.lines().map(|line| line.trim().to_owned()));
        } else if key != "pandas" && !key.starts_with("ARROW:") && text.len() <= LONGEST {
            comments.extend(text.lines().map(|line| format!("{key}: {}", line.trim())));
        }
    }
    comments.retain(|line| !line.is_empty());
    comments
}

/// pandas' storage of `DataFrame.attrs["units"]`.
fn units_of_pandas(schema: &Schema) -> Vec<(String, String)> {
    let said = schema.metadata().get("pandas");
    let parsed: Option<serde_json::Value> = said.and_then(|text| serde_json::from_str(text).ok());
    let units = parsed.as_ref().and_then(|said| {
        let attributes = said.get("attributes")?;
        (attributes.get("units").or_else(|| attributes.get("unit")))?.as_object()
    });
    let each = units.into_iter().flatten();
    each.filter_map(|(name, unit)| Some((name.clone(), unit.as_str()?.to_owned())))
        .collect()
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
#[derive(Debug, Default)]
pub(super) struct Gathered {
    pub values: Vec<f64>,
    /// The first date, from which others are counted.
    first: Option<i64>,
}

impl Gathered {
    /// Appends the values of a batch; `None` if they are not numbers.
    pub fn append(&mut self, batch: &RecordBatch, leaf: &Leaf) -> Option<()> {
        let (first, inner) = leaf.fields.split_first()?;
        let mut array: ArrayRef = batch.columns().get(*first)?.clone();
        let mut is_null = nulls(&array);
        for &field in inner {
            let inner = array.as_struct_opt()?.columns().get(field)?.clone();
            is_null = either(is_null, nulls(&inner));
            array = inner;
        }
        let rows = array.len();
        let (array, width) = match array.as_fixed_size_list_opt() {
            Some(lists) => {
                let width = usize::try_from(lists.value_length()).ok()?;
                (lists.values().clone(), width)
            }
            None => (array, 1),
        };
        let values = self.numbers(&array)?;
        for row in 0..rows {
            let missing = is_null.as_ref().is_some_and(|is_null| is_null[row]);
            let value = values.get(row * width + leaf.element).copied();
            let value = value.filter(|_| !missing).unwrap_or(f64::NAN);
            self.values.push(value);
        }
        Some(())
    }

    /// All values of an array, NaN for a null.
    fn numbers(&mut self, array: &ArrayRef) -> Option<Vec<f64>> {
        macro_rules! numbers {
            ($type:ty, $map:expr) => {{
                let values = array.as_primitive_opt::<$type>()?;
                values
                    .iter()
                    .map(|value| value.map_or(f64::NAN, $map))
                    .collect()
            }};
        }
        // Dates are subtracted as integers: since 1970 there have been more nanoseconds than a float can resolve.
        macro_rules! dates {
            ($type:ty, $step:expr) => {{
                let values = array.as_primitive_opt::<$type>()?;
                let each = values.iter().map(|value| {
                    let value = i64::from(value?);
                    let first = *self.first.get_or_insert(value);
                    Some(value.wrapping_sub(first) as f64 * $step)
                });
                each.map(|value| value.unwrap_or(f64::NAN)).collect()
            }};
        }
        const DAY: f64 = 86_400.0;
        Some(match array.data_type() {
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
            DataType::Boolean => {
                let values = array.as_boolean_opt()?;
                let each = values.iter();
                each.map(|value| value.map_or(f64::NAN, |is| f64::from(u8::from(is))))
                    .collect()
            }
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
                let dictionary = array.as_any_dictionary_opt()?;
                let values = self.numbers(dictionary.values())?;
                let keys = dictionary.normalized_keys();
                let at = |(row, key): (usize, &usize)| {
                    let value = values.get(*key).filter(|_| !array.is_null(row));
                    value.copied().unwrap_or(f64::NAN)
                };
                if values.is_empty() {
                    vec![f64::NAN; array.len()]
                } else {
                    keys.iter().enumerate().map(at).collect()
                }
            }
            _ => return None,
        })
    }
}

fn nulls(array: &ArrayRef) -> Option<Vec<bool>> {
    (array.null_count() > 0).then(|| (0..array.len()).map(|row| array.is_null(row)).collect())
}

fn either(a: Option<Vec<bool>>, b: Option<Vec<bool>>) -> Option<Vec<bool>> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.iter().zip(&b).map(|(a, b)| *a || *b).collect()),
        (a, b) => a.or(b),
    }
}
