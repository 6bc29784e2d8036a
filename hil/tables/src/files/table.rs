//! The contents of a file in any format: tables of columns.

use mesh_damper_output::error::InputError;

use crate::budget::{Budget, of_list, of_text};
use crate::rows::{RowLines, TextRows};

/// What an allocator adds to a text. Convention: its own size, and half of the 16 bytes to which it is rounded.
const ALLOCATED: u64 = 16;

/// Columns with the same number of samples, taken at the same times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The sheet's or group's name; empty if a file is a single table without a name.
    pub name: String,
    /// Its columns, in the file's order.
    pub columns: Vec<Column>,
    /// Number of samples, if the file states it before they are read.
    pub rows: Option<u64>,
    /// Times of the samples, if the file gives them without a column of times.
    pub clock: Option<Clock>,
    /// Times from one sample to the next that the file states beside the columns: the times may contradict them.
    pub stated_steps: Vec<StatedStep>,
    /// Uncertain findings about the file, in words: `the separator is a semicolon`.
    pub guesses: Vec<String>,
    /// Contents of the file that are not read, in words: `the structure "setup"`.
    pub skipped: Vec<String>,
    /// The line of a text with the names, counted from 1; without names, the line in which its numbers begin.
    pub header_line: Option<u64>,
    /// Whether the file has no names: its columns are then called `column 1` and so on.
    pub is_nameless: bool,
}

impl Table {
    /// Bytes that it takes in memory, at least.
    pub(super) fn size(&self) -> u64 {
        let texts = self.guesses.iter().chain(&self.skipped);
        let texts = texts.map(|text| size_of::<String>() + text.len());
        let of_column = |column: &Column| {
            let values = size_of_val(&column.first[..]);
            let unit = column.unit.as_ref().map_or(0, String::len);
            let words = column.words.as_ref().map_or(0, String::len);
            size_of::<Column>() + column.name.len() + unit + words + values
        };
        let sum: usize = texts.chain(self.columns.iter().map(of_column)).sum();
        sum as u64
    }

    /// Adds notes about the whole file to each of its `tables`: any of them may be the one that is read.
    ///
    /// # Errors
    /// A budget that is used up.
    #[cfg(feature = "formats")]
    pub(super) fn note_in_all(
        tables: &mut [Self],
        notes: &[String],
        budget: &Budget,
    ) -> Result<(), InputError> {
        let bytes: u64 = notes.iter().map(|note| of_text(note.len())).sum();
        budget.hold(
            bytes.saturating_mul(tables.len() as u64),
            "its notes, for each table",
        )?;
        for table in tables {
            table.guesses.extend_from_slice(notes);
        }
        Ok(())
    }

    /// Bytes that it takes to say what it holds: its names, units and notes, without the columns' values.
    pub(super) fn bytes_said(&self) -> u64 {
        let texts = self.guesses.iter().chain(&self.skipped);
        let steps = self.stated_steps.iter().map(|step| &step.taken);
        let texts = texts.chain(steps).map(|text| of_text(text.len()));
        let columns = self.columns.iter().map(Column::bytes_said);
        of_text(self.name.len()) + size_of::<Self>() as u64 + texts.chain(columns).sum::<u64>()
    }
}

/// Equal steps of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time of the first sample, s.
    pub start: f64,
    /// Time from one sample to the next, s.
    pub step: f64,
}

/// The time from one sample to the next that a file states beside the samples, as a step or as a rate.
#[derive(Clone, Debug, PartialEq)]
pub struct StatedStep {
    /// The step, s.
    pub step: f64,
    /// What states it, in words: `the number fs = 200 Hz`.
    pub taken: String,
}

/// A column before it is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// As in the file, without blanks around it.
    pub name: String,
    /// The unit if the file states it apart from the name, in a row of units or an attribute. As written there.
    pub unit: Option<String>,
    /// Other units that the file states in the same way, if it states several.
    pub other_units: Vec<String>,
    /// Whether its values are numbers, as far as they were examined.
    pub is_numeric: bool,
    /// Whether the file marks it as times: the master channel of MDF, an axis of time.
    pub is_time: bool,
    /// Whether its values are dates or times of day, given as seconds from the first. A column of seconds has precedence over it as
    /// the times.
    pub is_stamp: bool,
    /// A cell of a column that is not numeric, as written: the first that is not a number.
    pub words: Option<String>,
    /// Its first values; NaN for a cell without a number. At most [`Column::FIRST`].
    pub first: Vec<f64>,
}

impl Column {
    /// Number of values examined in a column. Convention: enough to see a rate, and few enough to hold for 1e5 columns.
    pub const FIRST: usize = 64;

    /// Bytes that it takes when it is held.
    pub(super) fn bytes(&self) -> u64 {
        self.bytes_said() + of_list::<f64>(self.first.len())
    }

    /// The same without its first values.
    fn bytes_said(&self) -> u64 {
        let texts = self.unit.iter().chain(&self.other_units).chain(&self.words);
        let texts = texts.chain([&self.name]).map(|text| text.len() as u64);
        // Its own place has room for each text but the further units.
        let more = self.other_units.iter().map(|_| of_text(0));
        size_of::<Self>() as u64 + texts.chain(more).sum::<u64>() + 3 * ALLOCATED
    }
}

/// A column to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Its index in the table, counted from 0.
    pub column: usize,
    /// Whether a cell that is neither a number nor empty is an error; otherwise the column is returned as `None`.
    pub must_be_numeric: bool,
}

/// The values of some columns.
#[derive(Clone, Debug, Default)]
pub struct Values {
    /// One for each wanted column, all of the same length, with NaN for a cell without a number; `None` for a column that is not
    /// numeric and need not be.
    pub columns: Vec<Option<Vec<f64>>>,
    /// Comments of the file.
    pub comments: Vec<String>,
    /// Findings made only during reading, in words: `2 rows of words at the end, from line 812 on, are left out`.
    pub notes: Vec<String>,
    /// The lines of a text that contain the samples.
    pub lines: RowLines,
    /// Whether a last row that may have been cut was left out.
    pub is_cut: bool,
    /// The cells as written, for a text of our own format that is to be written again cell by cell.
    pub cells: Option<(csv::StringRecord, TextRows)>,
}
