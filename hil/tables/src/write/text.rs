//! Columns as text: comment lines, a header, and a row for each sample.

use std::io::Write as _;

use super::{Unwritten, comment_line, decimal, guarded};

/// A table as text: comment lines, a header, and one row per value of the first column. Each of `columns` is a name with its
/// values, all of the same length.
pub(super) fn table(
    comments: &[String],
    columns: &[(&str, Vec<f64>)],
) -> Result<Vec<u8>, Unwritten> {
    let mut bytes = Vec::new();
    for comment in comments {
        bytes.extend(comment_line(comment).bytes());
    }
    let mut writer = csv::WriterBuilder::new()
        .comment(Some(b'#'))
        .from_writer(bytes);
    let mut write = |record: Vec<String>| writer.write_record(record).map_err(Unwritten::by);
    let names = columns.iter().map(|(name, _)| guarded(name).into_owned());
    write(names.collect())?;
    for row in 0..columns.first().map_or(0, |(_, values)| values.len()) {
        let cells = columns.iter().map(|(_, values)| values.get(row).copied());
        write(
            cells
                .map(|cell| decimal(cell.unwrap_or_default()))
                .collect(),
        )?;
    }
    writer.into_inner().map_err(Unwritten::by)
}

/// Bytes, gzipped.
pub(super) fn gzipped(text: &[u8]) -> Result<Vec<u8>, Unwritten> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    let written = encoder.write_all(text).and_then(|()| encoder.finish());
    written.map_err(Unwritten::by)
}
