//! The files that recordings come in: one file of code a format, behind one trait.
//!
//! A format says what columns a file has, before any is taken for a channel; [`columns`](crate::columns) says which is which; then the
//! format reads those that are wanted. So no format knows of forces and displacements, and no rule about names knows of formats.

mod arrays;
mod beside;
mod guard;
#[cfg(feature = "hdf5")]
mod hdf5;
mod json;
mod mat;
#[cfg(feature = "mdf")]
mod mdf;
mod memory;
mod names;
mod needs;
mod number;
mod opened;
#[cfg(feature = "parquet")]
mod parquet;
mod runs;
mod source;
pub mod table;
mod tdms;
mod text;
mod unread;
#[cfg(feature = "xlsx")]
mod xlsx;

use std::path::Path;

pub use memory::GivenColumn;
pub use needs::{Needs, Unmarked};
pub use source::Source;
pub use table::{Column, Table, Values, Wanted};

use crate::error::InputError;
use crate::read_limit::ReadLimit;

/// A file format.
pub trait Format: Sync {
    /// As messages call it: `MDF4`.
    fn name(&self) -> &'static str;

    /// The endings of a file's name that it usually has, in lower case and without a point.
    fn endings(&self) -> &'static [&'static str];

    /// Whether a file that begins with `head`, its first [`Source::HEAD`] bytes or all, is of this format. A file's content says what
    /// it is, not its name.
    fn recognizes(&self, head: &[u8]) -> bool;

    /// What the file holds. `reading` has what the user said about it.
    ///
    /// # Errors
    /// The file and what is wrong with it, in words of the format: its separator, sheet or group.
    fn open<'a>(
        &self,
        source: Source<'a>,
        reading: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError>;
}

/// A file that was opened: its tables, and the values of one of them.
pub trait Tables {
    /// The tables that are in the file, with their columns. There is at least one.
    fn tables(&self) -> &[Table];

    /// The values of the `wanted` columns of table `table`, in their order. Only text has cells that can be `kept`.
    ///
    /// # Errors
    /// What is wrong with the values, with line or column.
    fn read(
        self: Box<Self>,
        table: usize,
        wanted: &[Wanted],
        kept: Kept,
    ) -> Result<Values, InputError>;
}

/// What is kept of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Its channels.
    Channels,
    /// These, and all cells as they are written, so that they can be written again.
    Cells,
}

/// The formats, in the order in which they are asked whether a file is theirs. Text is the last: it is what nothing else is.
pub const FORMATS: &[&dyn Format] = &[
    #[cfg(feature = "mdf")]
    &mdf::Mdf,
    &mat::Mat,
    #[cfg(feature = "hdf5")]
    &hdf5::Hdf5,
    #[cfg(feature = "parquet")]
    &parquet::Parquet,
    #[cfg(feature = "parquet")]
    &parquet::Arrow,
    &tdms::Tdms,
    #[cfg(feature = "xlsx")]
    &xlsx::Xlsx,
    &json::Json,
    &unread::Unread,
    &text::Text,
];

/// What the user says about a file, in the place of what would be guessed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// How much of the file is read.
    pub limit: ReadLimit,
    /// The column of a quantity, by its name in the file: of a channel, or of a control input.
    pub channels: Vec<(String, String)>,
    /// The unit of a quantity's column.
    pub units: Vec<(String, String)>,
    /// Samples a second, where no column has the times. Hz
    pub rate: Option<f64>,
    /// The sheet, group or table, where a file has several that could be meant.
    pub table: Option<String>,
    /// The decimal sign of numbers in text, where it could be either: `.` or `,`.
    pub decimal: Option<char>,
}

impl From<ReadLimit> for Reading {
    fn from(limit: ReadLimit) -> Self {
        Self {
            limit,
            ..Self::default()
        }
    }
}

/// Opens a file of any format.
///
/// # Errors
/// What the file system says, and what the format finds wrong.
pub fn open(
    path: &Path,
    reading: &Reading,
) -> Result<(&'static dyn Format, Box<dyn Tables>), InputError> {
    opened(Source::file(path, reading.limit)?, reading)
}

/// [`open`] of any source of bytes.
///
/// # Errors
/// As [`open`].
pub fn opened<'a>(
    source: Source<'a>,
    reading: &Reading,
) -> Result<(&'static dyn Format, Box<dyn Tables + 'a>), InputError> {
    let is_it = |format: &&&dyn Format| format.recognizes(source.head());
    let format = *FORMATS
        .iter()
        .find(is_it)
        .unwrap_or(&FORMATS[FORMATS.len() - 1]);
    Ok((format, format.open(source, reading)?))
}
