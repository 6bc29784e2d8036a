//! The file formats of recordings: one source file per format, behind one trait.
//!
//! First a format lists the columns of a file, before any is assigned to a channel. Then [`columns`] assigns them.
//! Then the format reads the wanted ones. Thus no format depends on forces and displacements, and no rule about names depends on
//! formats.

#[cfg(feature = "formats")]
mod about;
#[cfg(feature = "formats")]
mod arrays;
#[cfg(feature = "formats")]
mod beside;
#[cfg(feature = "formats")]
mod groups;
#[cfg(feature = "formats")]
mod guard;
#[cfg(feature = "formats")]
mod hdf5;
#[cfg(feature = "formats")]
mod json;
#[cfg(feature = "formats")]
mod mat;
#[cfg(feature = "formats")]
mod mdf;
mod memory;
mod names;
mod needs;
#[cfg(feature = "formats")]
mod number;
#[cfg(feature = "formats")]
mod opened;
#[cfg(feature = "formats")]
mod packed;
#[cfg(feature = "formats")]
mod parquet;
#[cfg(feature = "formats")]
mod refused;
#[cfg(feature = "formats")]
mod runs;
#[cfg(feature = "formats")]
mod same_times;
mod source;
pub mod table;
#[cfg(feature = "formats")]
mod tdms;
mod text;
#[cfg(feature = "formats")]
mod units_beside;
#[cfg(feature = "formats")]
mod unpack;
mod unread;
#[cfg(feature = "formats")]
mod xlsx;

use std::path::Path;

pub use memory::{GivenColumn, in_memory};
pub use needs::{Needs, Unmarked};
pub use source::Source;
pub use table::{Column, Table, Values, Wanted};

use crate::columns;
use crate::read_limit::ReadLimit;
use mesh_damper_output::error::InputError;

/// A file format.
pub trait Format: Sync {
    /// Its name in messages: `MDF4`.
    fn name(&self) -> &'static str;

    /// The usual endings of a file's name, in lower case and without a point.
    fn endings(&self) -> &'static [&'static str];

    /// Whether a file that begins with `head`, its first [`Source::HEAD`] bytes or all of it, has this format. The content decides,
    /// not the name.
    fn recognizes(&self, head: &[u8]) -> bool;

    /// The contents of the file. `reading` has the user's settings.
    ///
    /// # Errors
    /// The file and its error, in terms of the format: its separator, sheet or group.
    fn open<'a>(
        &self,
        source: Source<'a>,
        reading: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError>;
}

/// An opened file: its tables, and the values of one of them.
pub trait Tables {
    /// The tables in the file, with their columns. There is at least one.
    fn tables(&self) -> &[Table];

    /// The values of the `wanted` columns of table `table`, in their order. Only text has cells that can be `kept`.
    ///
    /// # Errors
    /// An error in the values, with line or column.
    fn read(
        self: Box<Self>,
        table: usize,
        wanted: &[Wanted],
        kept: Kept,
    ) -> Result<Values, InputError>;

    /// Shows `look` the values of each of the `wanted` columns of table `table`, none of which occurs twice, and keeps none of them.
    ///
    /// # Errors
    /// As [`Tables::read`].
    fn look(
        self: Box<Self>,
        table: usize,
        wanted: &[Wanted],
        look: &mut dyn FnMut(usize, &[f64]),
    ) -> Result<Values, InputError> {
        let mut values = self.read(table, wanted, Kept::Channels)?;
        let columns = std::mem::take(&mut values.columns);
        for (wanted, column) in wanted.iter().zip(columns) {
            if let Some(column) = column {
                look(wanted.column, &column);
            }
        }
        Ok(values)
    }
}

/// The parts of a file to keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// Its channels.
    Channels,
    /// Its channels, and all cells as written, so that they can be written again.
    Cells,
}

/// The formats, in the order in which they are tried. Text is the last, because it is the default.
pub const FORMATS: &[&dyn Format] = &[
    #[cfg(feature = "formats")]
    &mdf::Mdf,
    #[cfg(feature = "formats")]
    &mat::Mat,
    #[cfg(feature = "formats")]
    &hdf5::Hdf5,
    #[cfg(feature = "formats")]
    &parquet::Parquet,
    #[cfg(feature = "formats")]
    &parquet::Arrow,
    #[cfg(feature = "formats")]
    &tdms::Tdms,
    #[cfg(feature = "formats")]
    &xlsx::Xlsx,
    #[cfg(feature = "formats")]
    &json::Json,
    &unread::Unread,
    &text::Text,
];

/// The user's settings for a file, in place of guesses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// Limit of the file's size.
    pub limit: ReadLimit,
    /// The column of a quantity, by its name in the file: for a channel, or for a control input.
    pub channels: Vec<(String, String)>,
    /// The unit of a quantity's column.
    pub units: Vec<(String, String)>,
    /// Samples per second, if no column has the times. Hz
    pub rate: Option<f64>,
    /// The sheet, group or table, if a file has several that match.
    pub table: Option<String>,
    /// The decimal sign of numbers in text, if it is ambiguous: `.` or `,`.
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

/// The deepest nesting of what a file nests: groups, structures, conversions, indexes. Each level takes room of the stack, which no
/// budget counts. Convention: deeper than any program writes, and within the stack of a thread.
#[cfg(feature = "formats")]
const DEEPEST: usize = 64;

/// The work on columns in messages.
const NAMES: &str = "finding what the names of its columns mean";

/// Opens a file of any format.
///
/// # Errors
/// An error of the file system, or an error that the format finds.
pub fn open(
    path: &Path,
    reading: &Reading,
) -> Result<(&'static dyn Format, Box<dyn Tables>), InputError> {
    opened(Source::file(path, reading.limit)?, reading)
}

/// [`open`] for any source of bytes.
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
    let budget = source.budget();
    let file = format.open(source, reading)?;
    // Whoever chooses among them or shows them holds as much once more.
    let said = file.tables().iter().map(Table::bytes_said).sum();
    budget.hold(said, "what is said of its columns")?;
    let columns = file.tables().iter().flat_map(|table| &table.columns);
    budget.work(columns::steps(columns), NAMES)?;
    Ok((format, file))
}
