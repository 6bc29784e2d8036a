//! The pages of a column, examined before the decoder believes what they state about their size.

use std::io::{self, Read as _};

use mesh_damper_output::error::InputError;
use parquet::basic::{Compression, Type};
use parquet::file::metadata::ColumnChunkMetaData;

use super::NAME;
use super::thrift::{STRUCTURE, Thrift};
use crate::budget::Budget;
use crate::files::guard::damaged;
use crate::files::unpack::RATIO;
use crate::room::Room;

/// Bytes held for a value of a dictionary.
const OF_VALUE: u64 = 16;
/// Steps of work for a page, and bytes that are unpacked in a step.
const STEPS: u64 = 64;
const UNPACKED: u64 = 4;
/// The encodings in which a page's count of values is believed before its values are there.
const DELTA_LENGTH_BYTE_ARRAY: u64 = 6;
const DELTA_BYTE_ARRAY: u64 = 7;
const PART: &str = "the pages of a column";

/// What the header of a page states.
#[derive(Default)]
struct Page {
    unpacked: u64,
    packed: u64,
    values: u64,
    encoding: u64,
    is_dictionary: bool,
}

impl Page {
    fn of(thrift: &mut Thrift) -> Option<Self> {
        let mut page = Self::default();
        let mut field = 0;
        while let Some((kind, number)) = thrift.field(field)? {
            field = number;
            match (field, kind) {
                (2, 4..=6) => page.unpacked = thrift.count()?,
                (3, 4..=6) => page.packed = thrift.count()?,
                (5, STRUCTURE) => page.inner(thrift, 2)?,
                (7, STRUCTURE) => {
                    page.is_dictionary = true;
                    page.inner(thrift, 2)?;
                }
                (8, STRUCTURE) => page.inner(thrift, 4)?,
                (2 | 3 | 5 | 7 | 8, _) => return None,
                _ => thrift.skip(kind)?,
            }
        }
        Some(page)
    }

    /// The part of the header about pages of one kind, in which a field tells the encoding.
    fn inner(&mut self, thrift: &mut Thrift, encoding: i16) -> Option<()> {
        let mut field = 0;
        while let Some((kind, number)) = thrift.field(field)? {
            field = number;
            match (field, kind) {
                (1, 4..=6) => self.values = thrift.count()?,
                (field, 4..=6) if field == encoding => self.encoding = thrift.count()?,
                (1, _) => return None,
                _ => thrift.skip(kind)?,
            }
        }
        Some(())
    }
}

/// Charges for the pages of a column in a group of rows. `room` holds the largest of all.
///
/// # Errors
/// A damaged page, one that hil does not read, or a budget that has no room for it.
pub(super) fn examine(
    name: &str,
    file: &[u8],
    chunk: &ColumnChunkMetaData,
    room: &mut Room,
) -> Result<(), InputError> {
    let budget = room.budget();
    let cut = || damaged(NAME, name, "a page is cut");
    let (from, length) = chunk.byte_range();
    let range = || {
        let from = usize::try_from(from).ok()?;
        let end = from.checked_add(usize::try_from(length).ok()?)?;
        file.get(from..end)
    };
    let mut rest = range().ok_or_else(cut)?;
    let expected = u64::try_from(chunk.num_values()).unwrap_or(0);
    let (mut values, mut largest, mut of_dictionary) = (0_u64, 0, 0);
    while values < expected && !rest.is_empty() {
        let mut thrift = Thrift::of(rest);
        let page = Page::of(&mut thrift).ok_or_else(cut)?;
        let body = &rest[rest.len() - thrift.left()..];
        let packed = usize::try_from(page.packed).ok();
        let (body, behind) = packed
            .and_then(|size| body.split_at_checked(size))
            .ok_or_else(cut)?;
        rest = behind;
        budget.work(STEPS + page.unpacked / UNPACKED, PART)?;
        if matches!(chunk.compression(), Compression::GZIP(_)) {
            bounded(name, body, page.unpacked, budget)?;
        }
        if page.is_dictionary {
            if page.values > page.unpacked {
                return Err(damaged(
                    NAME,
                    name,
                    "a dictionary states more values than it has bytes",
                ));
            }
            of_dictionary = page.unpacked + OF_VALUE * page.values;
        } else {
            values = values.saturating_add(page.values);
            largest = largest.max(page.unpacked);
            let is_believed = matches!(page.encoding, DELTA_LENGTH_BYTE_ARRAY | DELTA_BYTE_ARRAY);
            if is_believed && chunk.column_type() == Type::FIXED_LEN_BYTE_ARRAY {
                return Err(InputError::new(
                    name,
                    "uses a part of Parquet that hil does not read: delta encoding of numbers that are no integers",
                    "write it again without column_encoding",
                ));
            }
        }
        room.at_least(largest + of_dictionary, PART)?;
    }
    Ok(())
}

/// Refuses a page of gzip that unpacks to more than it states, which its decoder would follow.
fn bounded(name: &str, packed: &[u8], stated: u64, budget: &Budget) -> Result<(), InputError> {
    // What fits into the budget in any case need not be counted.
    let most = (RATIO * packed.len()) as u64;
    if Room::of(budget).more(most, PART).is_ok() {
        return Ok(());
    }
    let mut unpacked = flate2::read::MultiGzDecoder::new(packed).take(stated.saturating_add(1));
    let size = io::copy(&mut unpacked, &mut io::sink());
    let size = size.map_err(|error| damaged(NAME, name, error))?;
    match size > stated {
        true => Err(damaged(NAME, name, "a page unpacks to more than it states")),
        false => Ok(()),
    }
}
