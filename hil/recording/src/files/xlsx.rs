//! Workbooks of Excel, each of whose sheets is a table.

use std::collections::BTreeSet;
use std::io::{Cursor, Read as _};

use calamine::{DataRef, Reader as _, Xlsx as Workbook, XlsxError};

use super::arrays::MOST_COLUMNS;
use super::guard::{damaged, guarded};
use super::opened::Opened;
use super::text::{Named, header_of};
use super::{Column, Format, Reading, Source, Table, Tables};
use crate::error::InputError;
use crate::read_limit::ReadLimit;

const NAME: &str = "Excel";
/// Rows above the numbers in which names may stand. Convention: a page of what the test was.
const MOST_ABOVE: usize = 200;

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
        // Any ZIP archive begins so; those that are no workbooks say so when they are opened.
        head.starts_with(b"PK\x03\x04")
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        _: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (name, limit) = (source.name(), source.limit());
        let bytes = source.bytes()?;
        guarded(NAME, &name, || open(&name, &bytes, limit))
    }
}

fn open<'a>(
    name: &str,
    bytes: &[u8],
    limit: ReadLimit,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    unpacks_within(name, bytes, limit)?;
    let broken = |error: XlsxError| damaged(NAME, name, error);
    let mut book: Workbook<_> = Workbook::new(Cursor::new(bytes)).map_err(broken)?;
    let mut tables = Vec::new();
    let mut values = Vec::new();
    let mut skipped = Vec::new();
    let mut left = limit.file() / 8;
    for sheet in book.sheet_names() {
        let mut cells = match book.worksheet_cells_reader(&sheet) {
            Ok(cells) => cells,
            // A sheet of a chart has no cells.
            Err(XlsxError::NotAWorksheet(_)) => continue,
            Err(error) => return Err(broken(error)),
        };
        let mut rows = Rows::default();
        while let Some(cell) = cells.next_cell().map_err(broken)? {
            let (row, column) = cell.get_position();
            let kept = rows.take(row, column as usize, cell.get_value(), &mut left);
            kept.ok_or_else(|| limit.exceeded(name))?;
        }
        let is_within = rows.end(&mut left).is_some() && rows.padded() <= limit.file() / 8;
        if !is_within {
            return Err(limit.exceeded(name));
        }
        match rows.table(&sheet) {
            Some((table, columns)) => {
                tables.push(table);
                values.push(columns);
            }
            None => skipped.push(format!("sheet {sheet}, which has no columns of numbers")),
        }
    }
    if tables.is_empty() {
        tables.push(Table::default());
    }
    tables[0].skipped.extend(skipped);
    let read = move |table: usize, column: usize| Ok(Some(values[table][column].clone()));
    Ok(Box::new(Opened::new(
        name.to_owned(),
        tables,
        Vec::new(),
        read,
    )?))
}

/// Refuses what unpacks to more than may be read: the workbook's reader keeps its texts whole.
fn unpacks_within(name: &str, bytes: &[u8], limit: ReadLimit) -> Result<(), InputError> {
    let broken = |error: &dyn std::fmt::Display| damaged(NAME, name, error);
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| broken(&error))?;
    if archive.index_for_name("xl/workbook.xml").is_none() {
        return Err(InputError::new(
            name,
            "is a ZIP archive and no Excel workbook",
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

/// The texts of a row, each with its column.
type Texts = Vec<(usize, String)>;

/// A sheet while it is read.
#[derive(Default)]
struct Rows {
    /// Rows above the first that is numbers, each with its texts by column.
    above: Vec<Texts>,
    /// The row in which cells are.
    row: u32,
    now: Vec<(usize, Result<f64, String>)>,
    /// Columns of numbers, NaN for a cell without one, and whether each has a text among them.
    columns: Vec<(Vec<f64>, bool)>,
    /// Which row the first of these is.
    first: Option<u32>,
    /// Columns in which there are dates.
    dates: BTreeSet<usize>,
}

impl Rows {
    /// Takes in a cell; none where the sheet has more than may be read.
    fn take(&mut self, row: u32, column: usize, value: &DataRef<'_>, left: &mut u64) -> Option<()> {
        if row != self.row {
            self.end(left)?;
            self.row = row;
        }
        let cell = match value {
            DataRef::Int(value) => Ok(*value as f64),
            DataRef::Float(value) => Ok(*value),
            DataRef::Bool(value) => Ok(f64::from(u8::from(*value))),
            DataRef::DateTime(date) => {
                self.dates.insert(column);
                Ok(date.as_f64() * 86_400.0)
            }
            DataRef::String(text) | DataRef::DateTimeIso(text) | DataRef::DurationIso(text) => {
                Err(text.trim().to_owned())
            }
            DataRef::SharedString(text) => Err(text.trim().to_owned()),
            DataRef::Error(_) => Ok(f64::NAN),
            _ => return Some(()),
        };
        if column < MOST_COLUMNS {
            self.now.push((column, cell));
        }
        Some(())
    }

    /// Ends a row.
    fn end(&mut self, left: &mut u64) -> Option<()> {
        let cells = std::mem::take(&mut self.now);
        if cells.is_empty() {
            return Some(());
        }
        let numbers = cells.iter().filter(|(_, cell)| cell.is_ok()).count();
        if self.first.is_none() && 2 * numbers <= cells.len() {
            let texts = cells.into_iter().map(|(column, cell)| match cell {
                Ok(number) => (column, number.to_string()),
                Err(text) => (column, text),
            });
            if self.above.len() == MOST_ABOVE {
                self.above.remove(0);
            }
            self.above.push(texts.collect());
            return Some(());
        }
        let first = *self.first.get_or_insert(self.row);
        let place = (self.row - first) as usize;
        for (column, cell) in cells {
            if self.columns.len() <= column {
                self.columns.resize(column + 1, (Vec::new(), false));
            }
            let (values, has_text) = &mut self.columns[column];
            let more = (place + 1).saturating_sub(values.len()) as u64;
            *left = left.checked_sub(more)?;
            values.resize(place, f64::NAN);
            match cell {
                Ok(value) => values.push(value),
                Err(text) => {
                    *has_text |= !text.is_empty();
                    values.push(f64::NAN);
                }
            }
        }
        Some(())
    }

    /// Numbers in all columns, as many in each as the longest has.
    fn padded(&self) -> u64 {
        let rows = self.columns.iter().map(|(values, _)| values.len()).max();
        rows.unwrap_or_default() as u64 * self.columns.len() as u64
    }

    /// The sheet's table; none where it has no numbers.
    fn table(self, name: &str) -> Option<(Table, Vec<Vec<f64>>)> {
        let (names, units) = self.header();
        let rows = self.columns.iter().map(|(values, _)| values.len()).max()?;
        let mut table = Table {
            name: name.to_owned(),
            rows: Some(rows as u64),
            ..Table::default()
        };
        let mut columns = Vec::new();
        for (index, (mut values, has_text)) in self.columns.into_iter().enumerate() {
            let of = |row: &[String]| {
                let cell = row.get(index).map(|text| text.trim().to_owned());
                cell.filter(|text| !text.is_empty())
            };
            if values.is_empty() {
                continue;
            }
            let name = of(&names).unwrap_or_else(|| format!("column {}", letters(index)));
            if has_text {
                table.skipped.push(format!("column {name} (texts)"));
                continue;
            }
            let is_stamp = self.dates.contains(&index);
            if is_stamp {
                let first = values.iter().copied().find(|value| !value.is_nan());
                let first = first.unwrap_or_default();
                values.iter_mut().for_each(|value| *value -= first);
                table.guesses.push(format!(
                    "the dates of column {name} are taken as seconds after the first of them"
                ));
            }
            let unit = units.as_deref().and_then(of);
            values.resize(rows, f64::NAN);
            table.columns.push(Column {
                name,
                unit: if is_stamp { Some("s".into()) } else { unit },
                is_numeric: true,
                is_stamp,
                first: values.iter().take(Column::FIRST).copied().collect(),
                ..Column::default()
            });
            columns.push(values);
        }
        (!columns.is_empty()).then_some((table, columns))
    }

    /// The names and the units, a cell for each column.
    fn header(&self) -> Named {
        let columns = self.columns.len();
        let row = |row: &Texts| {
            let mut cells = vec![String::new(); columns];
            for (column, text) in row {
                if let Some(cell) = cells.get_mut(*column) {
                    cell.clone_from(text);
                }
            }
            cells
        };
        let above: Vec<Vec<String>> = self.above.iter().map(row).collect();
        header_of(&above, columns)
    }
}

/// A column as Excel calls it: A, B, …, Z, AA.
fn letters(mut index: usize) -> String {
    let mut letters = Vec::new();
    loop {
        letters.push(b'A' + (index % 26) as u8);
        match (index / 26).checked_sub(1) {
            Some(rest) => index = rest,
            None => break,
        }
    }
    letters.reverse();
    String::from_utf8_lossy(&letters).into_owned()
}
