//! Columns as Parquet.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::file::properties::WriterProperties;

use super::Column;

/// A file that pandas, polars and DuckDB read: each column of floats, with its unit in the field's metadata, and the comments under the
/// file's key `comments`, a line each.
pub(super) fn write(comments: &[String], columns: &[Column<'_>]) -> Vec<u8> {
    let fields = columns.iter().map(|column| {
        let unit = column.unit.map(|unit| ("unit".to_owned(), unit.to_owned()));
        let metadata: HashMap<String, String> = unit.into_iter().collect();
        Field::new(column.name, DataType::Float64, true).with_metadata(metadata)
    });
    let comments = (!comments.is_empty()).then(|| ("comments".to_owned(), comments.join("\n")));
    let schema = Schema::new(fields.collect::<Vec<_>>())
        .with_metadata(comments.into_iter().collect::<HashMap<_, _>>());
    let schema = Arc::new(schema);
    // What is not measured is null. Bytes of floats that lie together compress best.
    let arrays = columns.iter().map(|column| {
        let values = column
            .values
            .iter()
            .map(|value| (!value.is_nan()).then_some(*value));
        Arc::new(Float64Array::from_iter(values)) as ArrayRef
    });
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_dictionary_enabled(false)
        .set_encoding(Encoding::BYTE_STREAM_SPLIT)
        .build();
    let batch = RecordBatch::try_new(schema.clone(), arrays.collect());
    // Writing to memory does not fail, and all columns have as many values.
    let written = batch.map_err(Into::into).and_then(|batch| {
        let mut writer = ArrowWriter::try_new(Vec::new(), schema, Some(properties))?;
        writer.write(&batch)?;
        writer.into_inner()
    });
    written.unwrap_or_default()
}
