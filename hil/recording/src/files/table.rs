//! What a file holds, whatever its format: tables of columns.

use super::super::rows::{RowLines, TextRows};

/// Columns of equally many samples, taken at the same times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// The sheet's or group's name; empty where a file is one table that has none.
    pub name: String,
    /// Its columns, in the file's order.
    pub columns: Vec<Column>,
    /// Number of samples, where the file says it before they are read.
    pub rows: Option<u64>,
    /// Times of the samples, where the file gives them without a column of times.
    pub clock: Option<Clock>,
    /// What was found out about the file and could have been otherwise, in words: `the separator is a semicolon`.
    pub guesses: Vec<String>,
    /// What the file holds and is not read, in words: `the structure "setup"`.
    pub skipped: Vec<String>,
    /// The line of a text in which the names stand, counted from 1; where it has none, the line in which its numbers begin.
    pub header_line: Option<u64>,
    /// Whether the file gives no names: its columns are called `column 1` and on.
    pub is_nameless: bool,
}

/// Equal steps of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time of the first sample, s.
    pub start: f64,
    /// Time from one sample to the next, s.
    pub step: f64,
}

/// A column before it is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// As the file has it, blanks around it taken off.
    pub name: String,
    /// Where the file says the unit beside the name: in a row of its own, or an attribute. As it is written there.
    pub unit: Option<String>,
    /// Whether its values are numbers, as far as that was looked at.
    pub is_numeric: bool,
    /// What the file says it is: the master channel of MDF, an axis of time.
    pub is_time: bool,
    /// Whether its values are dates or times of day, given as seconds from the first: a column of seconds is taken for the times before it.
    pub is_stamp: bool,
    /// A cell of a column that is not numeric, as it is written there: the first that is no number.
    pub words: Option<String>,
    /// Its first values; NaN for a cell without a number. At most [`Column::FIRST`].
    pub first: Vec<f64>,
}

impl Column {
    /// Values that a look at a column takes. Convention: enough to see a rate, and little enough to hold for 1e5 columns.
    pub const FIRST: usize = 64;
}

/// A column to be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Its place in the table, counted from 0.
    pub column: usize,
    /// Whether a cell that holds neither a number nor nothing is an error; else the column comes back as none.
    pub must_be_numeric: bool,
}

/// The values of some columns.
#[derive(Clone, Debug, Default)]
pub struct Values {
    /// One for each column that was wanted, all of one length, NaN for a cell without a number; none for a column that is not
    /// numeric and need not be.
    pub columns: Vec<Option<Vec<f64>>>,
    /// Comments of the file.
    pub comments: Vec<String>,
    /// What was found out only while it was read, in words: `2 rows of words at the end, from line 812 on, are left out`.
    pub notes: Vec<String>,
    /// The lines of a text that the samples stand in.
    pub(crate) lines: RowLines,
    /// A last row that may have been cut was left out.
    pub(crate) is_cut: bool,
    /// The cells as they are written, where a text of our own format is to be written again cell by cell.
    pub(crate) cells: Option<(csv::StringRecord, TextRows)>,
}
