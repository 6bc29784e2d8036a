//! Limit of the size of a file: a few megabytes of gzip may unpack to more than the machine's memory.
//!
//! Reading stops at the first byte beyond a limit, so that a rejected file takes no more memory than an accepted one.

use std::fmt;
use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::str::FromStr;

use mesh_damper_output::error::InputError;

/// Part of a file's limit for a JSON file that is read as a whole: a model, a programme or a baseline. Convention: a model file has some
/// ten thousand bytes.
const PART: u64 = 64;
/// Units of a size, the largest first.
const UNITS: [(&str, u64); 7] = [
    ("GiB", 1 << 30),
    ("GB", 1_000_000_000),
    ("MiB", 1 << 20),
    ("MB", 1_000_000),
    ("KiB", 1 << 10),
    ("kB", 1_000),
    ("B", 1),
];

/// The largest number of bytes read from a file, unpacked if it is gzip.
///
/// A JSON file that is no recording may have a 64th of that. What is made of a recording is bounded by its budget.
///
/// ```
/// use mesh_damper_tables::read_limit::ReadLimit;
/// let limit: ReadLimit = "2GiB".parse()?;
/// assert_eq!(limit.file(), 2 << 30);
/// assert_eq!(limit.json(), 32 << 20);
/// # Ok::<(), mesh_damper_tables::read_limit::NoSize>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadLimit {
    file: u64,
}

impl Default for ReadLimit {
    /// Derived from memory: reading a recording takes about two bytes of memory for each byte of the file, and its budget allows six.
    /// This is 1 GiB, and at most 3. At 10 kHz and 40 bytes per row it is 22 minutes.
    fn default() -> Self {
        Self { file: 512 << 20 }
    }
}

impl ReadLimit {
    /// The option of the command line that sets the limit.
    pub const OPTION: &str = "--max-read";

    /// A limit of this many bytes per file.
    pub fn new(file: u64) -> Self {
        Self { file }
    }

    /// Bytes per file.
    pub fn file(self) -> u64 {
        self.file
    }

    /// Bytes for a JSON file that is no recording.
    pub fn json(self) -> u64 {
        self.file / PART
    }

    /// Error for a file that exceeds the limit.
    pub(crate) fn exceeded(self, name: &str) -> InputError {
        self.refused(name, format!("holds more than {self}, the limit of a file"))
    }

    pub(crate) fn refused(self, name: &str, problem: String) -> InputError {
        let more = Self::new(self.file.saturating_mul(2));
        InputError::new(
            name,
            problem,
            format!(
                "check that it is the right file, or raise the limit with {} {more}",
                Self::OPTION
            ),
        )
    }
}

impl fmt::Display for ReadLimit {
    /// In the form that [`ReadLimit::from_str`] reads.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_whole =
            |&&(_, bytes): &&(&str, u64)| self.file >= bytes && self.file.is_multiple_of(bytes);
        let (unit, bytes) = UNITS.iter().find(is_whole).copied().unwrap_or(("B", 1));
        write!(f, "{}{unit}", self.file / bytes)
    }
}

/// A text that is not a size.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("write a whole number of bytes with or without a unit, such as 800MB or 2GiB")]
pub struct NoSize;

impl FromStr for ReadLimit {
    type Err = NoSize;

    fn from_str(text: &str) -> Result<Self, NoSize> {
        let digits = text.bytes().take_while(u8::is_ascii_digit).count();
        let (number, unit) = text.split_at(digits);
        let unit = if unit.is_empty() { "B" } else { unit.trim() };
        let of_unit = |(name, _): &&(&str, u64)| name.eq_ignore_ascii_case(unit);
        let (_, bytes) = UNITS.iter().find(of_unit).ok_or(NoSize)?;
        let number: u64 = number.parse().map_err(|_| NoSize)?;
        number.checked_mul(*bytes).map(Self::new).ok_or(NoSize)
    }
}

/// The file, opened.
pub(crate) fn open(path: &Path) -> Result<File, InputError> {
    let io = |error| InputError::io(path, "read", &error);
    if std::fs::metadata(path).map_err(io)?.is_dir() {
        return Err(InputError::new(
            path.display().to_string(),
            "is a directory",
            "name a file in it",
        ));
    }
    File::open(path).map_err(io)
}

/// The bytes of a JSON file.
///
/// # Errors
/// An error of the file system, or a file beyond the limit.
pub fn read_json(path: &Path, limit: ReadLimit) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    open(path)?
        .take(limit.json().saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|error| InputError::io(path, "read", &error))?;
    if bytes.len() as u64 > limit.json() {
        let (most, option) = (ReadLimit::new(limit.json()), ReadLimit::OPTION);
        let problem =
            format!("holds more than {most}, the limit of a JSON file, 1/{PART} of {option}");
        return Err(limit.refused(&path.display().to_string(), problem));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_is_read_as_it_is_written() {
        for (text, bytes) in [
            ("0B", 0),
            ("17B", 17),
            ("3kB", 3_000),
            ("800MB", 800_000_000),
            ("512MiB", 512 << 20),
            ("8GiB", 8 << 30),
        ] {
            let limit: ReadLimit = text.parse().unwrap();
            assert_eq!(limit.file(), bytes);
            assert_eq!(limit.to_string(), text);
        }
        assert_eq!("1000".parse(), Ok(ReadLimit::new(1000)));
        assert_eq!("2 gib".parse(), Ok(ReadLimit::new(2 << 30)));
        for text in ["", "GiB", "-1", "1.5GiB", "1TB", "99999999999GiB"] {
            assert_eq!(text.parse::<ReadLimit>(), Err(NoSize), "{text}");
        }
    }
}
