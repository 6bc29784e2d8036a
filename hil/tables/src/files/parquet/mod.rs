//! Parquet, whose columns are read as Arrow arrays.

mod arrow;
mod footer;
mod leaf;
mod pages;
mod pandas;
mod schema;
mod thrift;

use std::rc::Rc;
use std::sync::Arc;

use arrow_array::RecordBatch;
use bytes::Bytes;
use mesh_damper_output::error::InputError;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ParquetRecordBatchReaderBuilder};
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaDataReader;

use super::guard::{damaged, guarded};
use super::opened::Opened;
use super::packed::Packed;
use super::{Format, Reading, Source, Tables};
use crate::budget::Budget;
use crate::room::Room;
use leaf::{Gathered, Leaf};

pub(super) use arrow::Arrow;

const NAME: &str = "Parquet";
/// Bytes of values decoded at a time. Convention: some columns of these fit into a processor's cache.
const BATCH: usize = 1 << 16;
/// Bytes held for a byte of values that are decoded at a time: as Parquet has them, as Arrow has them, and whether they are missing.
const OF_BATCH: u64 = 4;
/// Steps of work for a group of rows.
const STEPS_OF_GROUP: u64 = 64;

/// Apache Parquet.
pub(super) struct Parquet;

impl Format for Parquet {
    fn name(&self) -> &'static str {
        NAME
    }

    fn endings(&self) -> &'static [&'static str] {
        &["parquet", "pq"]
    }

    fn recognizes(&self, head: &[u8]) -> bool {
        head.starts_with(b"PAR1")
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        _: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (name, budget) = (source.name(), source.budget());
        let bytes = Bytes::from(source.bytes()?);
        let packed = Packed::of(bytes.len(), budget);
        guarded(NAME, &name, || open(&name, bytes, packed))
    }
}

fn open<'a>(name: &str, bytes: Bytes, packed: Packed) -> Result<Box<dyn Tables + 'a>, InputError> {
    let refused = |error: &ParquetError| refused(name, error);
    let budget = packed.budget();
    if let Some(of_arrow) = footer::examine(name, &bytes, budget)? {
        examine_schema(name, of_arrow, budget)?;
    }
    let metadata = ParquetMetaDataReader::new().parse_and_finish(&bytes);
    let metadata = metadata.map_err(|error| refused(&error))?;
    let metadata = ArrowReaderMetadata::try_new(Arc::new(metadata), Default::default());
    let metadata = metadata.map_err(|error| refused(&error))?;
    let file = metadata.metadata().file_metadata();
    let rows = u64::try_from(file.num_rows()).unwrap_or_default();
    let (mut table, leaves) = leaf::table(metadata.schema(), Some(rows), budget)?;
    let said = file.key_value_metadata().into_iter().flatten();
    let said = said.filter_map(|each| Some((each.key.as_str(), each.value.as_deref()?)));
    let comments = leaf::comments(said, &mut table.skipped, budget)?;
    let fields = metadata.schema().fields().iter();
    let columns: usize = fields
        .map(|field| leaf::columns_of(field.data_type()))
        .sum();
    if columns != file.schema_descr().num_columns() {
        return Err(damaged(NAME, name, "its schemas have different columns"));
    }
    let (owned, shared) = (name.to_owned(), Rc::clone(budget));
    let mut lists = None;
    let read = move |_: usize, column: usize| {
        let column = Reader {
            name: &owned,
            bytes: &bytes,
            metadata: &metadata,
            leaf: &leaves[column],
            rows,
            packed: &packed,
        };
        Ok(column.values(&mut lists)?)
    };
    Ok(Box::new(Opened::new(
        NAME,
        shared,
        name.to_owned(),
        vec![table],
        comments,
        read,
    )?))
}

/// Charges for the schema of Arrow in a footer. What is no schema is left to the decoder, which believes none of it.
fn examine_schema(name: &str, text: &[u8], budget: &Budget) -> Result<(), InputError> {
    let mut room = Room::of(budget);
    room.more(text.len() as u64, "its schema")?;
    let Some(bytes) = schema::from_base_64(text) else {
        return Ok(());
    };
    // A mark and a length may stand before it.
    let bytes = match bytes.strip_prefix(&[0xff; 4]) {
        Some(rest) if rest.len() > 4 => &rest[4..],
        _ => &bytes,
    };
    let message = schema::message(bytes).map_err(|error| damaged(NAME, name, error))?;
    match message.header_as_schema() {
        Some(schema) => schema::charge(schema, budget).map(|_| ()),
        None => Ok(()),
    }
}

/// A column of lists as it was decoded last, with its number: its elements are read one after the other.
type Lists = Option<(usize, Vec<RecordBatch>)>;

/// A column that is read.
struct Reader<'r> {
    name: &'r str,
    bytes: &'r Bytes,
    metadata: &'r ArrowReaderMetadata,
    leaf: &'r Leaf,
    rows: u64,
    packed: &'r Packed,
}

impl Reader<'_> {
    /// Its values; `None` if they are not numbers.
    fn values(&self, lists: &mut Lists) -> Result<Option<Vec<f64>>, InputError> {
        // The batches contain only this column.
        let mut leaf = self.leaf.clone();
        leaf.fields.fill(0);
        let mut gathered = Gathered::of(self.packed);
        if leaf.width > 1 {
            if lists
                .as_ref()
                .is_none_or(|(number, _)| *number != leaf.number)
            {
                *lists = None;
                *lists = Some((leaf.number, self.lists()?));
            }
            for batch in lists.iter().flat_map(|(_, batches)| batches) {
                if gathered.append(batch, &leaf)?.is_none() {
                    return Ok(None);
                }
            }
        } else {
            let mut room = Room::of(self.packed.budget());
            for batch in self.batches(&mut room)? {
                if gathered.append(&batch?, &leaf)?.is_none() {
                    return Ok(None);
                }
            }
        }
        if gathered.values.len() as u64 != self.rows {
            let why = format!("{} values of {}", gathered.values.len(), self.rows);
            return Err(damaged(NAME, self.name, why));
        }
        Ok(Some(gathered.values))
    }

    /// All batches of a column of lists. They are held as long as the file.
    fn lists(&self) -> Result<Vec<RecordBatch>, InputError> {
        let budget = self.packed.budget();
        let mut room = Room::of(budget);
        let mut batches = Vec::new();
        for batch in self.batches(&mut room)? {
            let batch = batch?;
            budget.hold(batch.get_array_memory_size() as u64, "its lists")?;
            batches.push(batch);
        }
        Ok(batches)
    }

    /// Decodes the column alone. `room` holds what is decoded at a time.
    fn batches(
        &self,
        room: &mut Room,
    ) -> Result<impl Iterator<Item = Result<RecordBatch, InputError>>, InputError> {
        let (name, budget) = (self.name, room.budget());
        let metadata = self.metadata.metadata();
        let groups = metadata.row_groups();
        budget.work(STEPS_OF_GROUP * groups.len() as u64, "its groups of rows")?;
        for group in groups {
            pages::examine(name, self.bytes, group.column(self.leaf.number), room)?;
        }
        let schema = metadata.file_metadata().schema_descr();
        let size = schema.column(self.leaf.number).type_length();
        let size = usize::try_from(size).unwrap_or(0).max(size_of::<f64>());
        let of_row = size.saturating_mul(self.leaf.width);
        let rows = usize::try_from(self.rows).unwrap_or(usize::MAX);
        let rows = rows.min(BATCH / of_row).max(1);
        let at_a_time = rows.saturating_mul(of_row) as u64;
        room.more(OF_BATCH.saturating_mul(at_a_time), "its values")?;
        let mask = ProjectionMask::leaves(schema, [self.leaf.number]);
        let metadata = self.metadata.clone();
        let batches =
            ParquetRecordBatchReaderBuilder::new_with_metadata(self.bytes.clone(), metadata)
                .with_projection(mask)
                .with_batch_size(rows)
                .build()
                .map_err(|error| refused(name, &error))?;
        Ok(batches.map(move |batch| batch.map_err(|error| refused(name, &error.into()))))
    }
}

fn refused(name: &str, error: &ParquetError) -> InputError {
    let what = error.to_string();
    if matches!(error, ParquetError::NYI(_)) || what.contains("Disabled feature") {
        return InputError::new(
            name,
            format!("uses a part of Parquet that hil does not read: {what}"),
            "write it again with compression=\"zstd\" and without encryption",
        );
    }
    damaged(NAME, name, what)
}
