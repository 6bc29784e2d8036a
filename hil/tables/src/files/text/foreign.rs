//! Reading the numbers of a text whose layout is known.

use std::borrow::Cow;
use std::rc::Rc;

use mesh_damper_output::error::{InputError, Place, quoted};

use super::blocks::Blocks;
use super::decimals;
use super::layout::{Kind, Layout};
use super::lines::Lines;
use super::numbers::{Cell, Sign, sign_of};
use super::own::keep;
use super::rows::{RowKind, kind_of};
use super::stamps::{Since, Stamp};
use crate::budget::Budget;
use crate::csv_text::{CsvText, is_blank, number};
use crate::files::{Kept, Table, Tables, Values, Wanted};
use crate::rows::{RowLines, TextRows};

/// A text of another dialect.
pub(super) struct ForeignTable<'a> {
    name: String,
    lines: Lines<CsvText<'a>>,
    layout: Layout,
    budget: Rc<Budget>,
}

impl<'a> ForeignTable<'a> {
    pub fn open(mut text: CsvText<'a>, layout: Layout) -> Self {
        if layout.is_plain {
            text.keep_comments();
        }
        let (budget, buffer) = (Rc::clone(text.budget()), text.of_buffer());
        Self {
            name: text.name(),
            lines: Lines::of(text, buffer, Rc::clone(&budget)),
            layout,
            budget,
        }
    }
}

impl Tables for ForeignTable<'_> {
    fn tables(&self) -> &[Table] {
        std::slice::from_ref(&self.layout.table)
    }

    fn read(
        self: Box<Self>,
        _: usize,
        wanted: &[Wanted],
        kept: Kept,
    ) -> Result<Values, InputError> {
        let Self {
            name,
            mut lines,
            layout,
            budget,
        } = *self;
        let reader = Reader::of(&name, &layout, wanted, &budget);
        let mut taken = Taken {
            columns: vec![Some(Vec::new()); wanted.len()],
            stamps: vec![None; wanted.len()],
            is_rewritten: vec![false; wanted.len()],
            ..Taken::default()
        };
        if kept == Kept::Cells && layout.is_plain {
            taken.cells = Some(TextRows::default());
        }
        let mut blocks = Blocks::of(&name, &layout, &budget);
        let mut text = String::new();
        lines.skip(layout.data_line - 1)?;
        while let Some(line) = lines.row(layout.separator, &mut text)? {
            let (bare, kind) = kind_of(&text, layout.separator);
            if kind == RowKind::Comment {
                blocks.comment(line.number, bare)?;
                continue;
            }
            let mut cells = Vec::new();
            if kind == RowKind::Cells {
                cells.reserve(layout.cells + 1);
                layout.separator.split(bare, &mut cells);
            }
            // A row that consists only of separators is empty.
            if cells.iter().all(|cell| cell.is_empty()) {
                blocks.blank();
                continue;
            }
            match reader.judge(&cells, line.number, &blocks)? {
                Row::Odd => {
                    let is_of_numbers = reader.is_of_numbers(&cells);
                    blocks.odd(line.number, &cells, is_of_numbers)?;
                }
                Row::Numbers if !line.has_end => taken.is_cut = true,
                Row::Numbers => {
                    blocks.numbers(line.number)?;
                    reader.take(&cells, line.number, &mut taken)?;
                }
            }
        }
        let mut notes = blocks.notes();
        if let Some(line) = lines.text().guessed_from() {
            notes.push(format!(
                "from line {line} on the text is not UTF-8 and is read as windows-1252"
            ));
        }
        for (wanted, since) in wanted.iter().zip(&taken.stamps) {
            let guessed = since.as_ref().map_or(0, |since| since.guessed);
            if guessed > 0 {
                let midnights = if guessed == 1 {
                    "midnight is"
                } else {
                    "midnights are"
                };
                notes.push(format!(
                    "column {} has times of day without dates: {guessed} {midnights} assumed, where an hour of 23 is followed by one of 0",
                    quoted(&reader.column(wanted.column))
                ));
            }
        }
        if let Some(column) = taken.lost_to {
            notes.push(format!(
                "column {} holds words, and numbers in a form that must be rewritten, so a written file will lack it and all other columns that are not used",
                quoted(&reader.column(column))
            ));
        }
        let header: csv::StringRecord = layout
            .table
            .columns
            .iter()
            .map(|column| column.name.as_str())
            .collect();
        let is_plain = layout.is_plain && lines.text().guessed_from().is_none();
        Ok(Values {
            columns: taken.columns,
            comments: if layout.is_plain {
                lines.into_text().comments()
            } else {
                layout.comments
            },
            lines: taken.lines,
            is_cut: taken.is_cut,
            cells: taken
                .cells
                .filter(|_| is_plain)
                .map(|cells| (header, cells)),
            notes,
        })
    }
}

/// The data read so far.
#[derive(Default)]
struct Taken {
    columns: Vec<Option<Vec<f64>>>,
    /// The stamps of each wanted column that has them.
    stamps: Vec<Option<Since>>,
    lines: RowLines,
    cells: Option<TextRows>,
    /// Whether a cell of each wanted column was rewritten.
    is_rewritten: Vec<bool>,
    /// The column because of which the cells of the other columns are not kept.
    lost_to: Option<usize>,
    is_cut: bool,
}

/// Kind of a row.
enum Row {
    Numbers,
    /// Words in place of numbers.
    Odd,
}

struct Reader<'r> {
    name: &'r str,
    layout: &'r Layout,
    wanted: &'r [Wanted],
    budget: &'r Budget,
    /// Number of cells that a row must have: those after the last column of numbers may be missing.
    least: usize,
}

impl<'r> Reader<'r> {
    fn of(name: &'r str, layout: &'r Layout, wanted: &'r [Wanted], budget: &'r Budget) -> Self {
        let is_needed = |index: usize| {
            layout
                .kinds
                .get(index)
                .is_some_and(|kind| *kind != Kind::Words)
        };
        let columns = layout.table.columns.len();
        let last = (0..columns).rev().find(|&index| is_needed(index));
        let wanted_last = wanted.iter().map(|wanted| wanted.column).max();
        Self {
            name,
            layout,
            wanted,
            budget,
            least: 1 + last.max(wanted_last).unwrap_or(0),
        }
    }

    fn column(&self, index: usize) -> String {
        let column = self.layout.table.columns.get(index);
        column.map_or_else(String::new, |column| column.name.clone())
    }

    fn is_value(&self, column: usize, cell: &str) -> bool {
        match self.layout.kinds.get(column) {
            Some(Kind::Stamps) => Stamp::of(cell).is_some(),
            _ => !matches!(self.layout.numbers.read(cell), Cell::Words),
        }
    }

    /// Kind of a row: numbers, or words between or after them. A row of numbers that does not have the form of those above is an
    /// error, unless words come before it.
    fn judge(&self, cells: &[&str], line: u64, blocks: &Blocks) -> Result<Row, InputError> {
        let columns = self.layout.table.columns.len();
        let is_longer = cells.iter().skip(columns).any(|cell| !cell.is_empty())
            && !(self.layout.has_remarks && cells.len() == columns + 1);
        if is_longer || cells.len() < self.least {
            let has_words = cells.iter().any(|cell| self.is_word(cell));
            let is_one = !has_words && cells.iter().filter(|cell| !cell.is_empty()).count() == 1;
            let is_sample = self.is_sample(cells) || !(has_words || (is_one && blocks.is_paused()));
            if is_sample && !blocks.has_words() {
                return Err(self.misfit(cells, line));
            }
            return Ok(Row::Odd);
        }
        let must = self.wanted.iter().filter(|wanted| wanted.must_be_numeric);
        let (mut values, mut words) = (0, 0);
        for wanted in must {
            let cell = cells[wanted.column];
            if cell.is_empty() {
                continue;
            }
            if self.is_value(wanted.column, cell) {
                values += 1;
            } else {
                words += 1;
            }
        }
        // After a pause a word is not a damaged number, except next to a time.
        let is_label = blocks.is_paused() && !self.is_sample(cells);
        let is_odd = words > 0 && (values == 0 || is_label)
            // None of the wanted columns can decide.
            || (words + values == 0
                && !(0..cells.len().min(columns)).any(|index| self.is_value(index, cells[index]) && !cells[index].is_empty()));
        Ok(if is_odd { Row::Odd } else { Row::Numbers })
    }

    fn is_word(&self, cell: &str) -> bool {
        matches!(self.layout.numbers.read(cell), Cell::Words) && Stamp::of(cell).is_none()
    }

    /// Whether a row has a number in the first wanted column, which holds the times if there are any, and in another one.
    fn is_sample(&self, cells: &[&str]) -> bool {
        let mut must = self.wanted.iter().filter(|wanted| wanted.must_be_numeric);
        let mut has_value = |wanted: &Wanted| {
            let cell = cells.get(wanted.column).copied().unwrap_or_default();
            !cell.is_empty() && self.is_value(wanted.column, cell)
        };
        must.next().is_some_and(&mut has_value) && must.any(has_value)
    }

    /// Whether a row consists of numbers without a word before them: `Max;2.5;1.5` is a row of statistics.
    fn is_of_numbers(&self, cells: &[&str]) -> bool {
        let mut full = cells.iter().filter(|cell| !cell.is_empty());
        full.next().is_some_and(|cell| !self.is_word(cell)) && full.any(|cell| !self.is_word(cell))
    }

    fn misfit(&self, cells: &[&str], line: u64) -> InputError {
        InputError::new(
            self.name,
            format!(
                "{} cells where the rows above have {}, separated by {}",
                cells.len(),
                self.layout.cells,
                self.layout.separator.name()
            ),
            "write one cell per column",
        )
        .at(Place::Line(line))
    }

    fn take(&self, cells: &[&str], line: u64, taken: &mut Taken) -> Result<(), InputError> {
        for &(column, first) in &self.layout.same {
            if cells.get(column) != cells.get(first) {
                return Err(InputError::new(
                    self.name,
                    format!(
                        "columns {} and {} hold different times, so the row has no single time",
                        quoted(&self.column(column)),
                        quoted(&self.column(first))
                    ),
                    "write the channels with one column of times",
                )
                .at(Place::Line(line)));
            }
        }
        // Numbers in a form that our own format does not take are kept in ours.
        let mut rewritten: Vec<(usize, String)> = Vec::new();
        for (index, wanted) in self.wanted.iter().enumerate() {
            if taken.columns[index].is_none() {
                continue;
            }
            let cell = cells.get(wanted.column).copied().unwrap_or_default();
            match self.value(wanted.column, cell, &mut taken.stamps[index]) {
                Ok(value) => {
                    if taken.cells.is_some() && !is_own(&unescaped(cell), value) {
                        rewritten.push((wanted.column, value.to_string()));
                        taken.is_rewritten[index] = true;
                    }
                    let Some(values) = &mut taken.columns[index] else {
                        continue;
                    };
                    self.budget.push(values, value, "its values")?;
                }
                Err(_) if !wanted.must_be_numeric => {
                    taken.columns[index] = None;
                    // It is a column of words, whose cells must stay as they are.
                    if taken.is_rewritten[index] && taken.cells.take().is_some() {
                        taken.lost_to = Some(wanted.column);
                    }
                }
                Err((problem, remedy)) => {
                    let column = self.column(wanted.column);
                    return Err(InputError::new(self.name, problem, remedy)
                        .at(Place::Cell { line, column }));
                }
            }
        }
        if let Some(kept) = &mut taken.cells {
            let columns = self.layout.table.columns.len();
            let mut row: Vec<Cow<'_, str>> = (0..columns)
                .map(|index| unescaped(cells.get(index).copied().unwrap_or_default()))
                .collect();
            for (column, cell) in rewritten {
                row[column] = cell.into();
            }
            keep(kept, &row.iter().collect(), self.budget)?;
        }
        taken.lines.push_within(line, self.budget)?;
        Ok(())
    }

    /// The value of a cell, NaN for one without a number.
    fn value(
        &self,
        column: usize,
        cell: &str,
        since: &mut Option<Since>,
    ) -> Result<f64, (String, &'static str)> {
        const MEND: &str = "remove the row or correct the value";
        if self.layout.kinds.get(column) == Some(&Kind::Stamps) {
            if cell.is_empty() {
                return Ok(f64::NAN);
            }
            let is_no_time = || (format!("{} is not a time of day", quoted(cell)), MEND);
            let stamp = Stamp::of(cell).ok_or_else(is_no_time)?;
            let since = since.get_or_insert_with(|| Since::of(&stamp));
            return since.seconds(&stamp).map_err(|problem| {
                (
                    format!("{}: {problem}", quoted(cell)),
                    "write dates as 2024-03-01",
                )
            });
        }
        match self.layout.numbers.read(cell) {
            Cell::Number(value) => Ok(value),
            Cell::Blank => Ok(f64::NAN),
            Cell::NotFinite => Err((format!("{} is not finite", quoted(cell)), MEND)),
            Cell::Words => Err((format!("{} is not a number", quoted(cell)), MEND)),
            Cell::OtherSign
                if self.layout.numbers.is_open
                    && matches!(sign_of(cell), Some(Sign::Either(_))) =>
            {
                Err((decimals::could_be_either(cell), decimals::MEND))
            }
            Cell::OtherSign => {
                let (sign, remedy) = match self.layout.numbers.decimal {
                    ',' => (
                        "comma",
                        "correct it, or give --decimal point, which makes the comma a thousands separator",
                    ),
                    _ => (
                        "point",
                        "correct it, or give --decimal comma, which makes the point a thousands separator",
                    ),
                };
                Err((
                    format!(
                        "{} is not a number with a decimal {sign}, which the rows above use",
                        quoted(cell)
                    ),
                    remedy,
                ))
            }
        }
    }
}

fn unescaped(cell: &str) -> Cow<'_, str> {
    if cell.contains("\"\"") {
        cell.replace("\"\"", "\"").into()
    } else {
        cell.into()
    }
}

/// Whether our own format reads `value` from the cell as well. It takes no number such as Fortran's `0.013D4`.
fn is_own(cell: &str, value: f64) -> bool {
    if value.is_nan() {
        is_blank(cell)
    } else {
        number(cell).is_ok()
    }
}
