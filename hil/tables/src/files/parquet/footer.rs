//! The footer of a Parquet file, examined before its decoder believes its counts and follows its fields by nested calls.

use mesh_damper_output::error::InputError;

use super::NAME;
use super::thrift::{BINARY, LIST, STRUCTURE, Thrift};
use crate::budget::Budget;
use crate::files::guard::damaged;

/// The deepest nesting of fields that is read. Convention: deeper than any table of measurements, and within any stack.
const DEEPEST: usize = 32;
/// Bytes held for a field, besides its name and those of the fields around it: it is kept as Parquet's and as Arrow's.
const OF_FIELD: u64 = 1024;
/// Bytes held for a column of a group of rows, and for an element of any other list.
const OF_CHUNK: u64 = 768;
const OF_ELEMENT: u64 = 64;
const PART: &str = "its footer";

/// Charges for what the decoder makes of the footer at the end of a file, and returns the schema of Arrow in it, as written.
///
/// # Errors
/// A damaged file, fields that are nested too deep, or a budget that has no room for the footer.
pub(super) fn examine<'f>(
    name: &str,
    file: &'f [u8],
    budget: &Budget,
) -> Result<Option<&'f [u8]>, InputError> {
    let cut = || damaged(NAME, name, "its footer is cut");
    let footer = footer(file).ok_or_else(cut)?;
    budget.work(4 * footer.len() as u64, PART)?;
    let mut thrift = Thrift::of(footer);
    let mut schema = Schema::default();
    let mut of_arrow = None;
    let mut field = 0;
    while let Some((kind, number)) = thrift.field(field).ok_or_else(cut)? {
        field = number;
        match (field, kind) {
            (2, LIST) => schema = Schema::of(name, &mut thrift, budget)?,
            (4, LIST) => {
                let (_, groups) = thrift.list().ok_or_else(cut)?;
                budget.hold(groups.saturating_mul(OF_ELEMENT * 4), PART)?;
                for _ in 0..groups {
                    // Memory for all columns is taken for each group of rows.
                    budget.hold(schema.columns.saturating_mul(OF_CHUNK), PART)?;
                    thrift.skip(STRUCTURE).ok_or_else(cut)?;
                }
            }
            (5, LIST) => {
                let (_, entries) = thrift.list().ok_or_else(cut)?;
                budget.hold(entries.saturating_mul(OF_ELEMENT), PART)?;
                for _ in 0..entries {
                    let (key, value) = entry(&mut thrift).ok_or_else(cut)?;
                    // They are kept in the footer and in the schema.
                    budget.hold(2 * (key.len() + value.len()) as u64, PART)?;
                    if key == b"ARROW:schema" {
                        of_arrow = Some(value);
                    }
                }
            }
            // The decoder takes these for lists whatever they are.
            (2 | 4 | 5, _) => return Err(cut()),
            _ => thrift.skip(kind).ok_or_else(cut)?,
        }
    }
    budget.hold(thrift.passed.saturating_mul(OF_ELEMENT), PART)?;
    Ok(of_arrow)
}

fn footer(file: &[u8]) -> Option<&[u8]> {
    let rest = file.strip_suffix(b"PAR1")?;
    let (rest, length) = rest.split_last_chunk::<4>()?;
    let length = u32::from_le_bytes(*length) as usize;
    rest.get(rest.len().checked_sub(length)?..)
}

/// A key and its value.
fn entry<'b>(thrift: &mut Thrift<'b>) -> Option<(&'b [u8], &'b [u8])> {
    let (mut key, mut value): (&[u8], &[u8]) = (b"", b"");
    let mut field = 0;
    while let Some((kind, number)) = thrift.field(field)? {
        field = number;
        match (field, kind) {
            (1, BINARY) => key = thrift.binary()?,
            (2, BINARY) => value = thrift.binary()?,
            (1 | 2, _) => return None,
            _ => thrift.skip(kind)?,
        }
    }
    Some((key, value))
}

/// The fields of a file.
#[derive(Default)]
struct Schema {
    /// Number of those without others in them.
    columns: u64,
}

impl Schema {
    /// Passes over the list of fields. Each stands before those in it.
    fn of(name: &str, thrift: &mut Thrift, budget: &Budget) -> Result<Self, InputError> {
        let cut = || damaged(NAME, name, "its schema is cut");
        let mut schema = Self::default();
        // For the fields around the next one: the number of fields still to come, and the length of their names.
        let mut open: Vec<(u64, u64)> = Vec::new();
        let (_, fields) = thrift.list().ok_or_else(cut)?;
        budget.hold(fields.saturating_mul(OF_FIELD), "its schema")?;
        for index in 0..fields {
            let (named, children) = Self::field(thrift).ok_or_else(cut)?;
            // Memory for the fields in it is taken before they are read.
            if children >= fields - index {
                return Err(damaged(NAME, name, "its schema lacks fields"));
            }
            while open.last().is_some_and(|(left, _)| *left == 0) {
                open.pop();
            }
            if let Some((left, _)) = open.last_mut() {
                *left -= 1;
            }
            let around = open.last().map_or(0, |(_, length)| *length);
            let length = around.saturating_add(named + size_of::<String>() as u64);
            if children > 0 {
                budget.hold(2 * named, "its schema")?;
                open.push((children, length));
            } else {
                // A column is known by all names that lead to it, in Parquet and in Arrow.
                budget.hold(length.saturating_mul(2), "the names of its columns")?;
                schema.columns += 1;
            }
            if open.len() > DEEPEST {
                let why = format!("its fields are nested more than {DEEPEST} levels deep");
                return Err(damaged(NAME, name, why));
            }
        }
        Ok(schema)
    }

    /// The length of a field's name, and the number of fields in it.
    fn field(thrift: &mut Thrift) -> Option<(u64, u64)> {
        let (mut named, mut children) = (0, 0);
        let mut field = 0;
        while let Some((kind, number)) = thrift.field(field)? {
            field = number;
            match (field, kind) {
                (4, BINARY) => named = thrift.binary()?.len() as u64,
                (5, 4..=6) => children = thrift.count()?,
                (4 | 5, _) => return None,
                _ => thrift.skip(kind)?,
            }
        }
        Some((named, children))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_limit::ReadLimit;

    /// The end of a file whose fields have a name and this number of children each.
    fn file(name: &str, children: impl Iterator<Item = u8>) -> Vec<u8> {
        let word = |mut number: usize| {
            let mut bytes = Vec::new();
            while number > 0x7f {
                bytes.push(number as u8 & 0x7f | 0x80);
                number >>= 7;
            }
            bytes.push(number as u8);
            bytes
        };
        let name = [word(name.len()), name.into()].concat();
        let fields: Vec<Vec<u8>> = children
            .map(|children| [&[0x48], &name[..], &[0x15, 2 * children, 0]].concat())
            .collect();
        let schema = [
            &[0x15, 4, 0x19, 0xfc][..],
            &word(fields.len()),
            &fields.concat(),
            &[0],
        ]
        .concat();
        let length = (schema.len() as u32).to_le_bytes();
        [b"PAR1", &schema[..], &length, b"PAR1"].concat()
    }

    fn examined(file: &[u8]) -> Result<u64, String> {
        let budget = Budget::new("a.parquet", ReadLimit::default());
        budget.read(file.len() as u64).unwrap();
        let examined = examine("a.parquet", file, &budget);
        examined.map_err(|error| error.to_string())?;
        Ok(budget.used().0)
    }

    #[test]
    fn fields_too_deep_are_seen_before_they_are_followed() {
        // Each is in the one before it.
        let nested = |deep: usize| file("a", (0..=deep).map(|index| u8::from(index < deep)));
        for deep in [1, 5, DEEPEST] {
            assert!(examined(&nested(deep)).is_ok(), "{deep}");
        }
        let refused = examined(&nested(10_000)).unwrap_err();
        assert!(refused.contains("32 levels"), "{refused}");
        assert!(examined(b"PAR1").is_err());
    }

    #[test]
    fn a_count_of_fields_that_do_not_come_is_not_believed() {
        let refused = examined(&file("a", [3, 0, 0].into_iter())).unwrap_err();
        assert!(refused.contains("lacks fields"), "{refused}");
    }

    #[test]
    fn a_name_is_charged_for_each_column_below_it() {
        let name = "n".repeat(1 << 10);
        let columns = |count: u8| {
            let children = [1, count].into_iter().chain((0..count).map(|_| 0));
            examined(&file(&name, children)).unwrap()
        };
        let each = (columns(60) - columns(10)) / 50;
        assert!(each > 6 << 10, "{each}");
        let long = "n".repeat(1 << 16);
        let children = [1, 60].into_iter().chain((0..60).map(|_| 0));
        assert!(examined(&file(&long, children)).is_ok());
        let children = (0..63).map(|_| 63).chain((0..63).map(|_| 0));
        let refused = examined(&file(&long, children));
        assert!(refused.is_err());
    }
}
