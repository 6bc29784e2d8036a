//! Text and cells of the CSV files that the harness is given.

use std::io::Read as _;
use std::path::Path;

use crate::error::{InputError, Place, quoted};

/// The two bytes with which every gzip member begins (RFC 1952, 2.3.1).
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// The file's text, unzipped where it is gzip, without a byte order mark.
///
/// # Errors
/// The file and why it cannot be read: a folder, broken gzip, or no UTF-8, with its line.
pub fn read_text(path: &Path) -> Result<String, InputError> {
    text_of(path, read_bytes(path)?)
}

/// The file's bytes.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, InputError> {
    let io = |error| InputError::io(path, "read", &error);
    if std::fs::metadata(path).map_err(io)?.is_dir() {
        return Err(InputError::new(
            path.display().to_string(),
            "is a directory",
            "name a file in it",
        ));
    }
    std::fs::read(path).map_err(io)
}

/// The text in a file's bytes, unzipped where it is gzip, without a byte order mark.
pub(crate) fn text_of(path: &Path, mut bytes: Vec<u8>) -> Result<String, InputError> {
    let named_gzip = path.extension().is_some_and(|extension| extension == "gz");
    if bytes.starts_with(&GZIP_MAGIC) || (named_gzip && !bytes.is_empty()) {
        let mut unzipped = Vec::new();
        flate2::read::MultiGzDecoder::new(bytes.as_slice())
            .read_to_end(&mut unzipped)
            .map_err(|error| {
                InputError::new(
                    path.display().to_string(),
                    format!("not valid gzip: {error}"),
                    "copy the file again, or unpack it and name the CSV",
                )
            })?;
        bytes = unzipped;
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count() as u64;
        InputError::new(
            path.display().to_string(),
            "not UTF-8 text",
            "save the file as UTF-8 CSV",
        )
        .at(Place::Line(line))
    })?;
    Ok(match text.strip_prefix('\u{feff}') {
        Some(text) => text.to_owned(),
        None => text,
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
