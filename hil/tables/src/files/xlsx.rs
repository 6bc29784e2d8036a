//! Workbooks of Excel; each sheet is a table.
//!
//! A sheet is converted to a text of its rows. The same code thus determines for both where the table begins, which rows are names
//! and units, what follows it and which numbers are texts.

use std::collections::BTreeMap;
use std::io::{Cursor, Read as _};
use std::path::Path;

use calamine::{
    DataRef, ExcelDateTime, ExcelDateTimeType, Reader as _, Xlsx as Workbook, XlsxError,
};
use mesh_damper_output::error::InputError;

use super::guard::{damaged, guarded};
use super::text;
use super::unread::is_npz;
use super::{Format, Kept, Reading, Source, Table, Tables, Values, Wanted};
use crate::read_limit::ReadLimit;

const NAME: &str = "Excel";
/// Largest numbers of rows and columns in Excel's sheets.
const MOST_ROWS: u32 = 1 << 20;
const MOST_COLUMNS: usize = 1 << 14;
/// Placeholder for the decimal sign of a number until the sign of the numbers stored as texts is known.
const DECIMAL: char = '\u{1}';
/// Number of such texts from which the decimal sign of a column is determined. Convention: more than any head of a text has.
const MOST_TEXTS: usize = 4096;

/// Excel's workbooks since 2007.
pub(super) struct Xlsx;

impl Format for Xlsx {
    fn name(&self) -> &'static str {
        NAME
    }

    fn endings(&self) -> &'static [&'static str] {
        &["xlsx", "xlsm"]
    }

    fn recognizes(&self, head: &[u8]) -> bool {
        // Any ZIP archive begins like this; one that is not a workbook is rejected when opened.
        head.starts_with(b"PK\x03\x04") && !is_npz(head)
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        reading: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (path, name) = (source.path().to_owned(), source.name());
        let limit = source.limit();
        let bytes = source.bytes()?;
        guarded(NAME, &name, || open(&path, &bytes, limit, reading))
    }
}

fn open<'a>(
    path: &Path,
    bytes: &[u8],
    limit: ReadLimit,
    reading: &Reading,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    let name = path.display().to_string();
    unpacks_within(&name, bytes, limit)?;
    let broken = |error: XlsxError| damaged(NAME, &name, error);
    let mut book: Workbook<_> = Workbook::new(Cursor::new(bytes)).map_err(broken)?;
    let mut sheets = Sheets::default();
    let mut refused: Option<InputError> = None;
    let mut skipped = Vec::new();
    let mut unread = Vec::new();
    let mut left = limit.file();
    let names = book.sheet_names();
    let several = names.len() > 1;
    for sheet in names {
        let mut cells = match book.worksheet_cells_reader(&sheet) {
            Ok(cells) => cells,
            // A sheet of a chart has no cells.
            Err(XlsxError::NotAWorksheet(_)) => continue,
            Err(error) => return Err(broken(error)),
        };
        let mut rows = Rows::default();
        while let Some(cell) = cells.next_cell().map_err(broken)? {
            let (row, column) = cell.get_position();
            if !rows.take(row, column as usize, cell.get_value()) {
                return Err(damaged(NAME, &name, "its cells are in no order"));
            }
            if rows.text.len() as u64 > left {
                return Err(limit.exceeded(&name));
            }
        }
        if !rows.has_numbers() {
            skipped.push(format!("sheet {sheet}, which has no columns of numbers"));
            continue;
        }
        left = (left.checked_sub(rows.size())).ok_or_else(|| limit.exceeded(&name))?;
        match rows.opened(path, reading) {
            Ok((mut table, opened)) => {
                table.name.clone_from(&sheet);
                sheets.tables.push(table);
                sheets.opened.push(opened);
            }
            Err(error) => {
                let what = format!("({}; {})", error.problem, error.remedy);
                skipped.push(format!("sheet {sheet} {what}"));
                unread.push(format!("sheet {sheet} is not read {what}"));
                let is_named = |table: &String| table.eq_ignore_ascii_case(&sheet);
                let error = error.in_table(Some(&sheet));
                match &reading.table {
                    Some(table) if is_named(table) => return Err(error),
                    // With an answer it may be the sheet that is meant.
                    None if error.answer().is_some() => {
                        let mut error = error;
                        if several {
                            error
                                .remedy
                                .push_str(", or name another sheet with --table");
                        }
                        return Err(error);
                    }
                    _ => refused = refused.or(Some(error)),
                }
            }
        }
    }
    if reading.table.is_none() {
        Table::note_in_all(&mut sheets.tables, &unread);
    }
    match (sheets.tables.first_mut(), refused) {
        (Some(table), _) => table.skipped.extend(skipped),
        (None, Some(error)) => return Err(error),
        (None, None) => {
            return Err(InputError::new(
                name,
                format!(
                    "holds no columns of numbers; not read: {}",
                    skipped.join(", ")
                ),
                "check that it is the right file",
            ));
        }
    }
    Ok(Box::new(sheets))
}

/// The sheets of a workbook that contain a table.
#[derive(Default)]
struct Sheets<'a> {
    tables: Vec<Table>,
    opened: Vec<Box<dyn Tables + 'a>>,
}

impl Tables for Sheets<'_> {
    fn tables(&self) -> &[Table] {
        &self.tables
    }

    fn read(
        mut self: Box<Self>,
        table: usize,
        wanted: &[Wanted],
        _: Kept,
    ) -> Result<Values, InputError> {
        let sheet = self.opened.swap_remove(table);
        sheet.read(0, wanted, Kept::Channels)
    }
}

/// Rejects a file that unpacks to more than the limit, because the workbook's reader holds its texts completely.
fn unpacks_within(name: &str, bytes: &[u8], limit: ReadLimit) -> Result<(), InputError> {
    let broken = |error: &dyn std::fmt::Display| damaged(NAME, name, error);
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| broken(&error))?;
    if archive.index_for_name("xl/workbook.xml").is_none() {
        return Err(InputError::new(
            name,
            "is a ZIP archive, not an Excel workbook",
            "unpack it and name a file of it",
        ));
    }
    let mut left = limit.file();
    for index in 0..archive.len() {
        let file = archive.by_index(index).map_err(|error| broken(&error))?;
        let mut packed = file.take(left.saturating_add(1));
        let size = std::io::copy(&mut packed, &mut std::io::sink());
        let size = size.map_err(|error| broken(&error))?;
        left = left.checked_sub(size).ok_or_else(|| limit.exceeded(name))?;
    }
    Ok(())
}

/// Kinds of the cells in a column.
#[derive(Default)]
struct Counted {
    numbers: usize,
    /// Numbers stored as texts, each with its row, counted from 1; only some of many.
    texts: Vec<(u64, String)>,
    of_texts: usize,
}

/// A sheet during reading: its rows as lines of cells separated by tabs.
#[derive(Default)]
struct Rows {
    text: String,
    /// For each finished row, its number of bytes and of cells.
    ended: Vec<(usize, usize)>,
    /// Beginning of the current row, and its number of cells.
    begin: usize,
    cells: usize,
    columns: BTreeMap<usize, Counted>,
}

impl Rows {
    /// Adds a cell; returns whether it comes after those before, within a sheet.
    fn take(&mut self, row: u32, column: usize, value: &DataRef<'_>) -> bool {
        let is_behind = (self.ended.len(), self.cells) <= (row as usize, column);
        if !is_behind || row >= MOST_ROWS || column >= MOST_COLUMNS {
            return false;
        }
        while self.ended.len() < row as usize {
            self.end();
        }
        let mut is_number = true;
        let cell = match value {
            DataRef::Int(value) => written(*value as f64),
            DataRef::Float(value) => written(*value),
            DataRef::Bool(value) => u8::from(*value).to_string(),
            DataRef::DateTime(date) => stamp(days(date)),
            DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
                is_number = false;
                cleaned(text)
            }
            DataRef::SharedString(text) => {
                is_number = false;
                cleaned(text)
            }
            // An error, such as a division by zero, is not a number.
            _ => return true,
        };
        if cell.is_empty() {
            return true;
        }
        let counted = self.columns.entry(column).or_default();
        if is_number {
            counted.numbers += 1;
        } else if text::is_number(&cell) {
            counted.of_texts += 1;
            if counted.texts.len() < MOST_TEXTS {
                counted.texts.push((u64::from(row) + 1, cell.clone()));
            }
        }
        let tabs = (column + 1).saturating_sub(self.cells.max(1));
        self.text.extend(std::iter::repeat_n('\t', tabs));
        self.text.push_str(&cell);
        self.cells = column + 1;
        true
    }

    /// Ends a row.
    fn end(&mut self) {
        self.ended.push((self.text.len() - self.begin, self.cells));
        self.begin = self.text.len();
        self.cells = 0;
    }

    fn has_numbers(&self) -> bool {
        (self.columns.values()).any(|column| column.numbers + column.of_texts > 0)
    }

    /// Number of bytes of the lines when each has as many cells as the longest.
    fn size(&self) -> u64 {
        let widest = self.columns.keys().next_back().map_or(0, |last| last + 1);
        let rows = self.ended.len() as u64 + 1;
        let added = (widest as u64 + 1).saturating_mul(rows);
        added.saturating_add(self.text.len() as u64)
    }

    /// The decimal sign of numbers stored as texts; `None` if no column has any.
    fn decimal(&self, file: &str) -> Result<Option<char>, InputError> {
        let of_texts = self.columns.values();
        let of_texts = of_texts.filter(|column| column.of_texts > column.numbers);
        let cells: Vec<(u64, &str)> = of_texts
            .flat_map(|column| column.texts.iter())
            .map(|(row, cell)| (*row, cell.as_str()))
            .collect();
        match cells[..] {
            [] => Ok(None),
            _ => text::decimal_of(file, &cells).map(Some),
        }
    }

    /// The sheet's table, found as in a text.
    fn opened<'a>(
        mut self,
        path: &Path,
        reading: &Reading,
    ) -> Result<(Table, Box<dyn Tables + 'a>), InputError> {
        self.end();
        let of_texts = match reading.decimal {
            Some(_) => None,
            None => self.decimal(&path.display().to_string())?,
        };
        let decimal = reading.decimal.or(of_texts).unwrap_or('.');
        let reading = Reading {
            decimal: Some(decimal),
            ..reading.clone()
        };
        let first = self.columns.keys().next().copied().unwrap_or_default();
        let widest = self.columns.keys().next_back().map_or(0, |last| last + 1);
        let mut lines = String::with_capacity(self.size() as usize);
        let mut at = 0;
        for (bytes, cells) in self.ended {
            // Empty columns before the first one with contents are dropped.
            let line = &self.text[at..at + bytes];
            at += bytes;
            if cells > 0 {
                lines.extend(
                    line[first..]
                        .chars()
                        .map(|c| if c == DECIMAL { decimal } else { c }),
                );
                lines.extend(std::iter::repeat_n('\t', widest - cells));
            }
            lines.push('\n');
        }
        drop(self.text);
        let opened = text::of_sheet(path, lines.into_bytes(), &reading)?;
        let mut table = opened.tables().first().cloned().unwrap_or_default();
        if let Some(decimal) = of_texts {
            let sign = if decimal == ',' { "comma" } else { "point" };
            table.guesses.push(format!(
                "numbers stored as text are read with a decimal {sign}"
            ));
        }
        Ok((table, opened))
    }
}

/// A number to its last bit.
fn written(value: f64) -> String {
    let size = value.abs();
    let text = if size != 0.0 && !(1e-5..1e15).contains(&size) {
        format!("{value:e}")
    } else {
        value.to_string()
    };
    text.replace('.', &DECIMAL.to_string())
}

/// A text in one line, without characters that would quote or separate cells.
fn cleaned(text: &str) -> String {
    let text = text.replace(|c: char| c.is_control(), " ");
    text.trim().trim_start_matches('"').trim().to_owned()
}

/// Days after 30 December 1899; a workbook of old Macintoshes counts from 1904 on.
fn days(date: &ExcelDateTime) -> f64 {
    let kind = if date.is_duration() {
        ExcelDateTimeType::TimeDelta
    } else {
        ExcelDateTimeType::DateTime
    };
    let of_1904 = ExcelDateTime::new(date.as_f64(), kind, true);
    date.as_f64() + if *date == of_1904 { 1462.0 } else { 0.0 }
}

/// Days after 30 December 1899 as a date and a time of day.
fn stamp(days: f64) -> String {
    const NANOSECONDS: f64 = 86_400e9;
    // To the days since 1 March of the year 0 used below.
    const BEFORE: i64 = 693_899;
    if !(-6e5..3e6).contains(&days) {
        return written(days * 86_400.0);
    }
    let mut day = days.floor();
    let mut nanoseconds = ((days - day) * NANOSECONDS).round();
    if nanoseconds >= NANOSECONDS {
        (day, nanoseconds) = (day + 1.0, 0.0);
    }
    let (day, nanoseconds) = (day as i64 + BEFORE, nanoseconds as u64);
    // Years that begin in March: the leap day is their last.
    let era = day.div_euclid(146_097);
    let of_era = day.rem_euclid(146_097);
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let date = of_year - (153 * month + 2) / 5 + 1;
    let (year, month) = (era * 400 + year + month / 10, (month + 2) % 12 + 1);
    let seconds = nanoseconds / 1_000_000_000;
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    let (seconds, fraction) = (seconds % 60, nanoseconds % 1_000_000_000);
    format!("{year:04}-{month:02}-{date:02} {hours:02}:{minutes:02}:{seconds:02}.{fraction:09}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_those_of_the_calendar() {
        for (days, is) in [
            (0.0, "1899-12-30 00:00:00.000000000"),
            (61.0, "1900-03-01 00:00:00.000000000"),
            (36_585.0, "2000-02-29 00:00:00.000000000"),
            (45_352.5, "2024-03-01 12:00:00.000000000"),
            (45_351.999_999_999_999, "2024-03-01 00:00:00.000000000"),
            (46_022.25, "2025-12-31 06:00:00.000000000"),
        ] {
            assert_eq!(stamp(days), is);
        }
    }
}
