//! The contents of a file in any format: tables of columns.

use crate::rows::{RowLines, TextRows};

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
    /// Adds notes about the whole file to each of its `tables`: any of them may be the one that is read.
    pub(super) fn note_in_all(tables: &mut [Self], notes: &[String]) {
        for table in tables {
            table.guesses.extend_from_slice(notes);
        }
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
