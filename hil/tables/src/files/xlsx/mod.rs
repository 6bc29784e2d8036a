//! Workbooks of Excel; each sheet is a table.
//!
//! A sheet is converted to a text of its rows. The same code thus determines for both where the table begins, which rows are names
//! and units, what follows it and which numbers are texts.

mod book;
mod cells;
mod parts;
mod rows;

use std::collections::HashSet;
use std::path::Path;

use mesh_damper_output::error::InputError;

use super::guard::{damaged, guarded};
use super::packed::Packed;
use super::unread::is_npz;
use super::{Format, Kept, Reading, Source, Table, Tables, Values, Wanted};
use book::Book;
use cells::Cells;
use parts::Parts;
use rows::Rows;

const NAME: &str = "Excel";
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
        let budget = source.budget();
        let bytes = source.bytes()?;
        let packed = Packed::of(bytes.len(), budget);
        guarded(NAME, &name, || open(&path, &bytes, &packed, reading))
    }
}

fn open<'a>(
    path: &Path,
    bytes: &[u8],
    packed: &Packed,
    reading: &Reading,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    let name = path.display().to_string();
    let budget = packed.budget();
    let mut parts = Parts::of(&name, bytes, packed)?;
    if parts.place("xl/workbook.xml").is_none() {
        return Err(InputError::new(
            name,
            "is a ZIP archive, not an Excel workbook",
            "unpack it and name a file of it",
        ));
    }
    let book = Book::of(&name, &mut parts, budget)?;
    let mut sheets = Sheets::default();
    let mut refused: Option<InputError> = None;
    let mut skipped = Vec::new();
    let mut unread = Vec::new();
    let mut visited = HashSet::new();
    let several = book.sheets.len() > 1;
    for (sheet, path_of_it) in &book.sheets {
        // A sheet of a chart has no cells.
        let Some(part) = path_of_it else { continue };
        let lacks = || damaged(NAME, &name, format!("it has no {part:.100}"));
        let place = parts.place(part).ok_or_else(lacks)?;
        if !visited.insert(place) {
            skipped.push(format!("sheet {sheet}, whose cells are those of another"));
            continue;
        }
        let Some(mut cells) = Cells::of(parts.at(place)?, &book)? else {
            continue;
        };
        let mut rows = Rows::of(budget);
        while let Some((row, column, value)) = cells.next()? {
            if !rows.take(row, column, &value)? {
                return Err(damaged(NAME, &name, "its cells are in no order"));
            }
        }
        drop(cells);
        if !rows.has_numbers() {
            budget.hold(sheet.len() as u64, "notes about its sheets")?;
            skipped.push(format!("sheet {sheet}, which has no columns of numbers"));
            continue;
        }
        match rows.opened(path, reading, budget) {
            Ok((mut table, opened)) => {
                budget.hold(table.size() + sheet.len() as u64, "its tables")?;
                table.name.clone_from(sheet);
                sheets.tables.push(table);
                sheets.opened.push(opened);
            }
            Err(error) if budget.is_used_up() => return Err(error.in_table(Some(sheet))),
            Err(error) => {
                let what = format!("({}; {})", error.problem, error.remedy);
                budget.hold(
                    2 * (what.len() + sheet.len()) as u64,
                    "notes about its sheets",
                )?;
                skipped.push(format!("sheet {sheet} {what}"));
                unread.push(format!("sheet {sheet} is not read {what}"));
                let is_named = |table: &String| table.eq_ignore_ascii_case(sheet);
                let error = error.in_table(Some(sheet));
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
        Table::note_in_all(&mut sheets.tables, &unread, budget)?;
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
