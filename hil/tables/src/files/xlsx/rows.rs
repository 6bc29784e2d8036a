//! A sheet as lines of text, which are read as those of any text: a sheet lacks rules, too, about where a table begins, what follows
//! it and which numbers are texts.

use std::collections::BTreeMap;
use std::path::Path;
use std::rc::Rc;

use mesh_damper_output::error::InputError;

use super::cells::Value;
use crate::budget::Budget;
use crate::files::text::{self, Evidence};
use crate::files::{Reading, Table, Tables};
use crate::room::Room;

/// Placeholder for the decimal sign of a number until the sign of the numbers stored as texts is known.
const DECIMAL: char = '\u{1}';
/// Bytes held for a column, and for its place.
const OF_COLUMN: u64 = 2 * size_of::<Counted>() as u64;

/// Kinds of the cells in a column.
#[derive(Default)]
struct Counted {
    numbers: usize,
    /// Numbers stored as texts, and what they say of the decimal sign, with their rows, counted from 1.
    of_texts: usize,
    signs: Evidence,
}

/// A sheet during reading: its rows as lines of cells separated by tabs.
pub(super) struct Rows<'b> {
    text: String,
    /// For each finished row, its number of bytes and of cells.
    ended: Vec<(usize, usize)>,
    /// Number of finished rows with cells.
    full: usize,
    /// Beginning of the current row, and its number of cells.
    begin: usize,
    cells: usize,
    columns: BTreeMap<usize, Counted>,
    room: Room<'b>,
}

impl<'b> Rows<'b> {
    pub fn of(budget: &'b Budget) -> Self {
        Self {
            text: String::new(),
            ended: Vec::new(),
            full: 0,
            begin: 0,
            cells: 0,
            columns: BTreeMap::new(),
            room: Room::of(budget),
        }
    }

    /// Adds a cell; returns whether it comes after those before.
    ///
    /// # Errors
    /// The budget has no room for it, or for the empty cells and rows before it.
    pub fn take(&mut self, row: u32, column: u32, value: &Value) -> Result<bool, InputError> {
        let (row, column) = (row as usize, column as usize);
        if (self.ended.len(), self.cells) > (row, column) {
            return Ok(false);
        }
        if let Some(more) = row.checked_sub(self.ended.len()).filter(|more| *more > 0) {
            let bytes = (more * size_of::<(usize, usize)>()) as u64;
            // The vector doubles as it grows.
            self.room.more(2 * bytes, "its rows")?;
            self.room.budget().work(more as u64, "its rows")?;
            (0..more).for_each(|_| self.end());
        }
        let (cell, is_number) = match value {
            Value::Number(value) => (written(*value), true),
            Value::Date(days) => (stamp(*days), true),
            Value::Text(text) => (cleaned(text), false),
            Value::None => return Ok(true),
        };
        if cell.is_empty() {
            return Ok(true);
        }
        if !self.columns.contains_key(&column) {
            self.room.more(OF_COLUMN, "its columns")?;
        }
        let counted = self.columns.entry(column).or_default();
        if is_number {
            counted.numbers += 1;
        } else if text::is_number(&cell) {
            counted.of_texts += 1;
            let kept = counted.signs.take(row as u64 + 1, &cell);
            self.room.more(kept as u64, "its numbers stored as texts")?;
        }
        let tabs = (column + 1).saturating_sub(self.cells.max(1));
        self.reserve(tabs + cell.len())?;
        self.text.extend(std::iter::repeat_n('\t', tabs));
        self.text.push_str(&cell);
        self.cells = column + 1;
        Ok(true)
    }

    fn reserve(&mut self, more: usize) -> Result<(), InputError> {
        if self.text.capacity() - self.text.len() < more {
            let more = more.max(self.text.len() / 4).max(1 << 12);
            self.room.more(more as u64, "its cells")?;
            self.text.reserve_exact(more);
        }
        Ok(())
    }

    /// Ends a row.
    fn end(&mut self) {
        self.ended.push((self.text.len() - self.begin, self.cells));
        self.full += usize::from(self.cells > 0);
        self.begin = self.text.len();
        self.cells = 0;
    }

    pub fn has_numbers(&self) -> bool {
        (self.columns.values()).any(|column| column.numbers + column.of_texts > 0)
    }

    /// The decimal sign of numbers stored as texts; `None` if no column has any.
    fn decimal(&self, file: &str) -> Result<Option<char>, InputError> {
        let of_texts = self.columns.values();
        let of_texts = of_texts.filter(|column| column.of_texts > column.numbers);
        let signs = of_texts.map(|column| &column.signs);
        let signs = signs.cloned().reduce(Evidence::and);
        signs.map(|signs| text::decimal_of(file, signs)).transpose()
    }

    /// The sheet's table, found as in a text.
    ///
    /// # Errors
    /// It has none, or the budget has no room for it.
    pub fn opened<'a>(
        mut self,
        path: &Path,
        reading: &Reading,
        budget: &Rc<Budget>,
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
        // Each row with cells gets as many as the longest.
        let most = (widest - first).saturating_mul(self.full);
        let size = most.saturating_add(self.text.len() + self.ended.len());
        budget.hold(
            size as u64,
            "its rows, each with as many cells as the longest,",
        )?;
        budget.work(
            size as u64,
            "its rows, each with as many cells as the longest,",
        )?;
        let mut lines = String::with_capacity(size);
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
        drop((self.text, self.columns, self.room));
        let opened = text::of_sheet(path, lines.into_bytes(), &reading, budget)?;
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
