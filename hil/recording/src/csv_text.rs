//! Text and cells of the CSV files that the harness is given.

use std::collections::HashMap;
use std::io::{self, Read};
use std::path::Path;

use crate::error::{InputError, Place, quoted};
use crate::read_limit::{ReadLimit, open, read_lines};

/// The two bytes with which every gzip member begins (RFC 1952, 2.3.1).
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
/// What some programs write before the text.
const BYTE_ORDER_MARK: char = '\u{feff}';

/// The text of a file, unzipped where it is gzip, without a byte order mark.
///
/// # Errors
/// The file and why it cannot be read: a folder, broken gzip, beyond `limit`, or no UTF-8, with its line.
pub fn read_text(path: &Path, limit: ReadLimit) -> Result<String, InputError> {
    text_of(path, open(path)?, limit)
}

/// The text that `source` gives, unzipped where it is gzip, without a byte order mark; `path` is what errors call it.
pub(crate) fn text_of(
    path: &Path,
    mut source: impl Read,
    limit: ReadLimit,
) -> Result<String, InputError> {
    let name = path.display().to_string();
    let unreadable = |error: &io::Error| InputError::io(path, "read", error);
    let mut head = Vec::new();
    (source.by_ref().take(GZIP_MAGIC.len() as u64))
        .read_to_end(&mut head)
        .map_err(|error| unreadable(&error))?;
    let named_gzip = path.extension().is_some_and(|extension| extension == "gz");
    let is_gzip = head == GZIP_MAGIC || (named_gzip && !head.is_empty());
    let whole = head.as_slice().chain(source);
    let bytes = if is_gzip {
        let unzipped = flate2::read::MultiGzDecoder::new(whole);
        read_lines(&name, unzipped, limit, |error| {
            // What is wrong with the gzip has no number of the operating system.
            if error.raw_os_error().is_some() {
                return unreadable(error);
            }
            InputError::new(
                &name,
                format!("not valid gzip: {error}"),
                "copy the file again, or unpack it and name the CSV",
            )
        })?
    } else {
        read_lines(&name, whole, limit, unreadable)?
    };
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count() as u64;
        InputError::new(&name, "not UTF-8 text", "save the file as UTF-8 CSV").at(Place::Line(line))
    })?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.drain(..BYTE_ORDER_MARK.len_utf8());
    }
    Ok(text)
}

/// Whether the record that `reader` read last, of this `text`, has no line end: its last cell may have been cut.
pub fn is_cut(text: &str, reader: &csv::Reader<&[u8]>) -> bool {
    !text.ends_with(['\n', '\r']) && reader.position().byte() == text.len() as u64
}

/// The first name in a header that stands there twice, with both of its columns, counted from 0.
pub fn doubled(header: &csv::StringRecord) -> Option<(&str, usize, usize)> {
    let mut known = HashMap::with_capacity(header.len());
    (header.iter().enumerate()).find_map(|(index, name)| {
        let first = *known.entry(name).or_insert(index);
        (first != index).then_some((name, first, index))
    })
}

/// The finite number in a cell.
///
/// # Errors
/// What is wrong with it, and how to mend it.
pub fn number(cell: &str) -> Result<f64, (String, &'static str)> {
    const MEND: &str = "remove the row or mend the value";
    if cell.is_empty() {
        return Err(("the cell is empty".into(), MEND));
    }
    let value: f64 = cell.parse().map_err(|_| {
        (
            format!("{} is not a number", quoted(cell)),
            "write a decimal number with a point, such as -0.125 or 1e-3",
        )
    })?;
    if value.is_nan() {
        return Err((format!("{} is not a number", quoted(cell)), MEND));
    }
    if value.is_infinite() {
        return Err((format!("{} is not finite", quoted(cell)), MEND));
    }
    Ok(value)
}

/// Whether a cell says that there is no number.
pub(crate) fn is_blank(cell: &str) -> bool {
    cell.is_empty() || cell.parse().is_ok_and(f64::is_nan)
}

/// What the CSV reader could not read, with its line.
pub fn broken_csv(file: &str, error: &csv::Error) -> InputError {
    let broken = InputError::new(
        file,
        format!("not readable as CSV: {error}"),
        "write comma-separated rows",
    );
    match error.position() {
        Some(position) => broken.at(Place::Line(position.line())),
        None => broken,
    }
}
