//! Our own format: comments, a header whose names contain units, and rows of cells separated by commas.
//!
//! It is read strictly and fast. A text with our own names that has anything of another program's form, such as dates or a rate in
//! a comment, is left to the reader of those forms.

use std::rc::Rc;

use mesh_damper_output::error::{InputError, Place};

use super::blocks::Again;
use super::head::Head;
use super::header;
use super::layout::STEPS_OF_LOOK;
use super::lines::{Cells, Separator};
use super::numbers;
use super::stamps::Stamp;
use crate::budget::Budget;
use crate::columns::{self, spelling};
use crate::csv_text::{CsvText, broken_csv, doubled, is_blank, is_cut, next_row, number};
use crate::files::{Column, Kept, Reading, Table, Tables, Values, Wanted};
use crate::room::Room;
use crate::rows::{RowLines, TextRows};
use crate::write::unguarded;

/// Bytes held for a column, besides its name and its first values: with its place among the names known.
const OF_COLUMN: u64 = size_of::<Column>() as u64 + 64;

/// Whether a text has our own format: of the names in its first line, at least two, or all, are names of channels with their units.
pub(super) fn is_own(head: &str) -> bool {
    let lines = head.lines().map(|line| line.trim_start_matches('\u{feff}'));
    let mut lines = lines.filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let Some(header) = lines.next() else {
        return false;
    };
    // One after the other, because a header may have as many names as its line has bytes.
    let names = || header.split(',').map(|name| name.trim().trim_matches('"'));
    let own = names().filter(|name| columns::is_own(name)).take(2).count();
    own >= names().take(2).count()
}

/// Whether the first row below a header of our own names has another program's form: with units, times of day, thousands, or a
/// separator at its end; or whether several columns have no name, as a sheet's empty columns.
///
/// # Errors
/// The budget has no room for its names.
pub(super) fn is_loose(head: &str, budget: &Budget) -> Result<bool, InputError> {
    let lines = head.lines().map(|line| line.trim_start_matches('\u{feff}'));
    let mut lines = lines.filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let (Some(header), Some(row)) = (lines.next(), lines.next()) else {
        return Ok(false);
    };
    let (mut names, mut cells) = (Cells::of(budget), Cells::of(budget));
    let names = names.split(Separator::Sign(','), header)?;
    let cells = cells.split(Separator::Sign(','), row)?;
    let is_strict = |cell: &str| number(cell).is_ok() || is_blank(cell);
    let is_other = |(name, cell): (&&str, &&str)| {
        columns::is_own(name)
            && !is_strict(cell)
            && (spelling::is_unit(cell)
                || Stamp::of(cell).is_some()
                || numbers::is_number(cell, false))
    };
    let more = cells.get(names.len()..).unwrap_or_default();
    let nameless = names.iter().filter(|name| name.is_empty()).count();
    Ok(nameless > 1
        || (!more.is_empty() && more.iter().all(|cell| cell.is_empty()))
        || names.iter().zip(cells).any(is_other))
}

/// Whether no column of numbers can have the times and the user gives no rate: then dates below any name, or a rate in a comment,
/// may give them.
///
/// # Errors
/// The budget has no room for its columns.
pub(super) fn lacks_times(
    head: &str,
    reading: &Reading,
    budget: &Budget,
) -> Result<bool, InputError> {
    let lines = head.lines().map(|line| line.trim_start_matches('\u{feff}'));
    let mut lines = lines.filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let Some(header) = lines.next().filter(|_| reading.rate.is_none()) else {
        return Ok(false);
    };
    let mut names = Cells::of(budget);
    let names = names.split(Separator::Sign(','), header)?;
    let mut room = Room::of(budget);
    room.more(
        OF_COLUMN * names.len() as u64 + header.len() as u64,
        "its columns",
    )?;
    let mut columns = columns_of(names.iter().copied(), &mut Vec::new());
    let mut said = reading.channels.iter().filter(|(of, _)| of == "time");
    let said = said.next().map(|(_, name)| name);
    // A word below one of our own names is an error, which the strict reader shows.
    let is_ours = |column: &Column| columns::is_own(&column.name);
    if said.is_none() && (columns.iter()).any(|each| is_ours(each) && columns::may_be_time(each)) {
        return Ok(false);
    }
    look(&mut columns, head, &mut room)?;
    let looked = STEPS_OF_LOOK * columns.len() as u64;
    budget.work(looked, "the names of its columns")?;
    Ok(match said {
        Some(name) => {
            (columns.iter()).any(|each| each.name == *name && !each.is_numeric && !is_ours(each))
        }
        None => !(columns.iter()).any(|each| each.is_numeric && columns::may_be_time(each)),
    })
}

/// Columns whose values are not examined yet. One without a name gets a name that the user can type.
fn columns_of<'h>(
    header: impl Iterator<Item = &'h str> + Clone,
    guesses: &mut Vec<String>,
) -> Vec<Column> {
    let column = |name| Column {
        name,
        is_numeric: true,
        ..Column::default()
    };
    if header.clone().any(str::is_empty) {
        let names: Vec<String> = header.map(name_in).collect();
        let names = header::distinct(&names, guesses);
        return names.into_iter().map(column).collect();
    }
    header.map(name_in).map(column).collect()
}

/// The name in a cell of the header.
fn name_in(cell: &str) -> String {
    unguarded(cell).into_owned()
}

/// Rows of words after the numbers.
struct Footer {
    line: u64,
    rows: usize,
    /// Whether the header is one of them.
    has_header: bool,
    /// The error in the first of them, if numbers follow.
    refused: InputError,
}

impl Footer {
    fn note(self) -> String {
        let rows = if self.rows == 1 { "row" } else { "rows" };
        format!(
            "{} {rows} of words at the end, from line {} on, are left out",
            self.rows, self.line
        )
    }
}

/// Puts the values of a row into `values`: NaN for a missing one, `None` for a word in a column that need not be numeric.
fn sample(
    name: &str,
    row: &csv::StringRecord,
    line: u64,
    columns: &[Column],
    wanted: &[Wanted],
    values: &mut Vec<Option<f64>>,
) -> Result<(), InputError> {
    if row.len() != columns.len() {
        return Err(InputError::new(
            name,
            format!("{} cells where the header has {}", row.len(), columns.len()),
            "write one cell per column, separated by commas",
        )
        .at(Place::Line(line)));
    }
    values.clear();
    for wanted in wanted {
        let cell = row.get(wanted.column).unwrap_or_default();
        values.push(match number(cell) {
            _ if is_blank(cell) => Some(f64::NAN),
            Ok(value) => Some(value),
            Err(_) if !wanted.must_be_numeric => None,
            Err((problem, remedy)) => {
                let column = columns[wanted.column].name.clone();
                let place = Place::Cell { line, column };
                return Err(InputError::new(name, problem, remedy).at(place));
            }
        });
    }
    Ok(())
}

/// Whether a row that is not a sample is a row of words: it has no number in a channel, or is a labelled row of statistics after a
/// blank line.
fn is_of_words(row: &csv::StringRecord, wanted: &[Wanted], is_behind_blank: bool) -> bool {
    let must = || wanted.iter().filter(|wanted| wanted.must_be_numeric);
    let cell = |wanted: &Wanted| row.get(wanted.column).unwrap_or_default();
    let is_word = |cell: &str| !is_blank(cell) && cell.parse::<f64>().is_err();
    let has_number = must().any(|wanted| number(cell(wanted)).is_ok());
    let is_labelled = || must().next().is_some_and(|wanted| is_word(cell(wanted)));
    row.iter().any(is_word) && (!has_number || (is_behind_blank && is_labelled()))
}

/// A text after its header.
pub(super) struct OwnTable<'a> {
    name: String,
    rows: csv::Reader<CsvText<'a>>,
    header: csv::StringRecord,
    tables: [Table; 1],
    is_utf8: bool,
    /// Whether the times come from a rate.
    has_clock: bool,
    budget: Rc<Budget>,
}

impl<'a> OwnTable<'a> {
    pub fn open(text: CsvText<'a>, head: &Head, reading: &Reading) -> Result<Self, InputError> {
        let (name, budget) = (text.name(), Rc::clone(text.budget()));
        let mut rows = text.rows();
        let mut header = csv::StringRecord::new();
        match next_row(&mut rows, &mut header) {
            Ok(true) => {}
            Err(error) => return Err(broken_csv(&name, &error)),
            Ok(false) => {
                let problem = if rows.into_inner().comments().is_empty() {
                    "is empty"
                } else {
                    "holds comments only"
                };
                return Err(InputError::new(
                    name,
                    problem,
                    "write a header such as time_s,displacement_mm,force_kN and samples below it",
                ));
            }
        }
        let line = header.position().map_or(1, csv::Position::line);
        if header.iter().any(|cell| number(cell).is_ok()) {
            return Err(InputError::new(
                name,
                "there is no header, the first row holds numbers",
                "write a header such as time_s,displacement_mm,force_kN above it",
            )
            .at(Place::Line(line)));
        }
        let named = header.as_slice().len() as u64;
        budget.hold(OF_COLUMN * header.len() as u64 + named, "its columns")?;
        let names = header.iter().map(name_in).collect();
        if let Some((column, first, second)) = doubled(&names) {
            let (first, second) = (first + 1, second + 1);
            return Err(InputError::new(
                name,
                format!("the name stands in columns {first} and {second}"),
                "give every column its own name",
            )
            .at(Place::Column(column.into())));
        }
        let mut guesses: Vec<String> = head.encoding.iter().cloned().collect();
        let mut columns = columns_of(header.iter(), &mut guesses);
        // They are held as long as the file.
        let mut room = Room::of(&budget);
        look(&mut columns, &head.text, &mut room)?;
        room.keep();
        let table = Table {
            columns,
            guesses,
            header_line: Some(line),
            ..Table::default()
        };
        Ok(Self {
            name,
            rows,
            header,
            tables: [table],
            is_utf8: head.is_utf8,
            has_clock: reading.rate.is_some(),
            budget,
        })
    }
}

impl Tables for OwnTable<'_> {
    fn tables(&self) -> &[Table] {
        &self.tables
    }

    fn read(
        self: Box<Self>,
        _: usize,
        wanted: &[Wanted],
        kept: Kept,
    ) -> Result<Values, InputError> {
        let Self {
            name,
            mut rows,
            header,
            tables: [table],
            is_utf8,
            has_clock,
            budget,
        } = *self;
        let mut columns = vec![Some(Vec::new()); wanted.len()];
        let mut cells = (kept == Kept::Cells).then(TextRows::default);
        let mut lines = RowLines::default();
        let mut cut = false;
        let mut row = csv::StringRecord::new();
        let mut values = Vec::with_capacity(wanted.len());
        let mut footer: Option<Footer> = None;
        let mut again = Again::default();
        while next_row(&mut rows, &mut row).map_err(|error| broken_csv(&name, &error))? {
            if is_cut(&rows) {
                // The reader returns an empty row for a comment there.
                cut = row.iter().any(|cell| !cell.is_empty());
                break;
            }
            let line = row.position().map_or(0, csv::Position::line);
            // A row's position includes the blank lines above it.
            let is_behind_blank = rows.position().line() > line + 1;
            if let Err(refused) = sample(&name, &row, line, &table.columns, wanted, &mut values) {
                // If numbers continue after words, those are not a footer.
                if !lines.has_rows() || !is_of_words(&row, wanted, is_behind_blank) {
                    return Err(footer.map_or(refused, |footer| footer.refused));
                }
                let footer = footer.get_or_insert(Footer {
                    line,
                    rows: 0,
                    has_header: false,
                    refused,
                });
                footer.rows += 1;
                footer.has_header |= row == header;
                continue;
            }
            match footer.take() {
                Some(footer) if footer.has_header => again.begins(&name, footer.line, has_clock)?,
                Some(footer) => return Err(footer.refused),
                None => {}
            }
            for (value, column) in values.iter().zip(&mut columns) {
                match (value, &mut *column) {
                    (Some(value), Some(values)) => {
                        budget.push(values, *value, "its values")?;
                    }
                    _ => *column = None,
                }
            }
            if let Some(cells) = &mut cells {
                keep(cells, &row, &budget)?;
            }
            lines.push_within(line, &budget)?;
        }
        let text = rows.into_inner();
        let guessed_from = text.guessed_from();
        if guessed_from.is_some() || !is_utf8 {
            cells = None;
        }
        let note =
            |line| format!("from line {line} on the text is not UTF-8 and is read as windows-1252");
        Ok(Values {
            columns,
            notes: guessed_from
                .map(note)
                .into_iter()
                .chain(again.note())
                .chain(footer.map(Footer::note))
                .collect(),
            comments: text.comments(),
            lines,
            is_cut: cut,
            cells: cells.map(|cells| (header.iter().map(name_in).collect(), cells)),
        })
    }
}

/// Keeps the cells of a row as written.
///
/// # Errors
/// The budget has no room for it.
pub(super) fn keep(
    rows: &mut TextRows,
    row: &csv::StringRecord,
    budget: &Budget,
) -> Result<(), InputError> {
    rows.reserve(row, |bytes| budget.hold(bytes, "its cells as written"))?;
    rows.push(row);
    Ok(())
}

/// Examines the first rows below the header. Columns of channels are numbers whatever they contain; a cell that is not a number is
/// rejected there. `room` holds their first values.
///
/// # Errors
/// The budget has no room for it.
fn look(columns: &mut [Column], head: &str, room: &mut Room) -> Result<(), InputError> {
    let lines = head
        .lines()
        .filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let mut cells = Cells::of(room.budget());
    let mut words = vec![0_usize; columns.len()];
    for line in lines.skip(1).take(Column::FIRST) {
        let cells = cells.split(Separator::Sign(','), line)?;
        let both = cells.len().min(columns.len());
        // The vectors double as they grow.
        room.more(
            (2 * size_of::<f64>() * both) as u64,
            "the first values of its columns",
        )?;
        for ((column, words), cell) in columns.iter_mut().zip(&mut words).zip(cells) {
            let value = number(cell).ok();
            *words += usize::from(value.is_none() && !is_blank(cell));
            column.first.push(value.unwrap_or(f64::NAN));
        }
    }
    for (column, words) in columns.iter_mut().zip(words) {
        column.is_numeric = 2 * words <= column.first.len();
    }
    Ok(())
}
