//! A table as Parquet.

use std::sync::Arc;

use arrow_array::builder::{ListBuilder, StringBuilder};
use arrow_array::{ArrayRef, BooleanArray, Float64Array, RecordBatch, StringArray, UInt64Array};
use mesh_damper_output::error::InputError;
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;

use super::{Table, Values};

impl Table {
    /// The table as Parquet, compressed with Snappy.
    ///
    /// # Errors
    /// Parquet cannot hold the table; this never happens for tables of a batch.
    pub fn to_parquet(&self) -> Result<Vec<u8>, InputError> {
        let failed = |error: &dyn std::fmt::Display| {
            let problem = format!("not to be written as Parquet: {error}");
            InputError::new("the batch's table", problem, "report this")
        };
        let columns = self.0.iter().map(|column| {
            let may_miss = !matches!(column.values, Values::Texts(_));
            (column.name, column.values.array(), may_miss)
        });
        let batch =
            RecordBatch::try_from_iter_with_nullable(columns).map_err(|error| failed(&error))?;
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .build();
        let mut bytes = Vec::new();
        ArrowWriter::try_new(&mut bytes, batch.schema(), Some(properties))
            .and_then(|mut writer| {
                writer.write(&batch)?;
                writer.close()
            })
            .map_err(|error| failed(&error))?;
        Ok(bytes)
    }
}

impl Values {
    fn array(&self) -> ArrayRef {
        match self {
            Self::Text(values) => Arc::new(StringArray::from(values.clone())),
            Self::Texts(values) => {
                let mut builder = ListBuilder::new(StringBuilder::new());
                for texts in values {
                    builder.append_value(texts.iter().map(Some));
                }
                Arc::new(builder.finish())
            }
            Self::Real(values) => Arc::new(Float64Array::from(values.clone())),
            Self::Count(values) => Arc::new(UInt64Array::from(values.clone())),
            Self::Flag(values) => Arc::new(BooleanArray::from(values.clone())),
        }
    }
}
