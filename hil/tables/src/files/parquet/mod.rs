//! Parquet, whose columns are read as Arrow arrays.

mod arrow;
mod depth;
mod leaf;

use bytes::Bytes;
use mesh_damper_output::error::InputError;
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{ArrowReaderMetadata, ParquetRecordBatchReaderBuilder};
use parquet::errors::ParquetError;

use super::guard::{damaged, guarded};
use super::opened::Opened;
use super::{Format, Reading, Source, Tables};
use crate::read_limit::ReadLimit;
use leaf::{Gathered, Leaf};

pub(super) use arrow::Arrow;

const NAME: &str = "Parquet";
/// Rows decoded at a time. Convention: some columns of these fit into a processor's cache.
const BATCH: usize = 8192;

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
        let (name, limit) = (source.name(), source.limit());
        let bytes = Bytes::from(source.bytes()?);
        guarded(NAME, &name, || open(&name, bytes, limit))
    }
}

fn open<'a>(
    name: &str,
    bytes: Bytes,
    limit: ReadLimit,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    let refused = |error: &ParquetError| refused(name, error);
    if depth::depth(&bytes).is_some_and(|depth| depth > depth::DEEPEST) {
        let why = format!(
            "its fields are nested more than {} levels deep",
            depth::DEEPEST
        );
        return Err(damaged(NAME, name, why));
    }
    let metadata = ArrowReaderMetadata::load(&bytes, Default::default());
    let metadata = metadata.map_err(|error| refused(&error))?;
    let file = metadata.metadata().file_metadata();
    let rows = u64::try_from(file.num_rows()).unwrap_or_default();
    if rows.saturating_mul(8) > limit.file() {
        return Err(limit.exceeded(name));
    }
    let (table, leaves) = leaf::table(metadata.schema(), Some(rows));
    let said = file.key_value_metadata().into_iter().flatten();
    let comments =
        leaf::comments(said.filter_map(|each| Some((each.key.as_str(), each.value.as_deref()?))));
    let owned = name.to_owned();
    let read = move |_: usize, column: usize| {
        guarded(NAME, &owned, || {
            values(&owned, &bytes, &metadata, &leaves[column], rows)
        })
    };
    Ok(Box::new(Opened::new(
        name.to_owned(),
        vec![table],
        comments,
        read,
    )?))
}

/// The values of one column, which is decoded alone.
fn values(
    name: &str,
    bytes: &Bytes,
    metadata: &ArrowReaderMetadata,
    leaf: &Leaf,
    rows: u64,
) -> Result<Option<Vec<f64>>, InputError> {
    let schema = metadata.metadata().file_metadata().schema_descr();
    let mask = ProjectionMask::roots(schema, leaf.fields.first().copied());
    let batches =
        ParquetRecordBatchReaderBuilder::new_with_metadata(bytes.clone(), metadata.clone())
            .with_projection(mask)
            .with_batch_size(BATCH)
            .build()
            .map_err(|error| refused(name, &error))?;
    // The batches contain only this one column.
    let mut leaf = leaf.clone();
    leaf.fields[0] = 0;
    let mut gathered = Gathered::default();
    for batch in batches {
        let batch = batch.map_err(|error| refused(name, &error.into()))?;
        if gathered.append(&batch, &leaf).is_none() {
            return Ok(None);
        }
    }
    if gathered.values.len() as u64 != rows {
        let why = format!("{} values of {rows}", gathered.values.len());
        return Err(damaged(NAME, name, why));
    }
    Ok(Some(gathered.values))
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
