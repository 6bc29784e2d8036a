//! Columns as Parquet.

use std::collections::HashMap;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding, ZstdLevel};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;

use super::{Column, Unwritten};

/// A file that pandas, polars and DuckDB read. Each column holds floats with the unit in the field's metadata. The comments are
/// under the file's key `comments`, one line each.
pub(super) fn write(comments: &[String], columns: &[Column<'_>]) -> Result<Vec<u8>, Unwritten> {
    let fields = columns.iter().map(|column| {
        let unit = column.unit.map(|unit| ("unit".to_owned(), unit.to_owned()));
        let metadata: HashMap<String, String> = unit.into_iter().collect();
        Field::new(column.name, DataType::Float64, true).with_metadata(metadata)
    });
    let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
    let comments = (!comments.is_empty()).then(|| comments.join("\n"));
    let comments = comments.map(|comments| vec![KeyValue::new("comments".to_owned(), comments)]);
    // A value that was not measured is null. Floats compress best when their bytes lie together.
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
        .set_key_value_metadata(comments)
        .build();
    let batch = RecordBatch::try_new(schema.clone(), arrays.collect());
    let written = batch.map_err(Into::into).and_then(|batch| {
        let mut writer = ArrowWriter::try_new(Vec::new(), schema, Some(properties))?;
        writer.write(&batch)?;
        writer.into_inner()
    });
    written.map_err(Unwritten::by)
}
