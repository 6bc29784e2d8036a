//! The rows of a recording as in the file.

use mesh_damper_output::error::{InputError, Place};

use crate::budget::Budget;

use crate::write::unguarded;

/// End of a cell: a byte that no UTF-8 text contains.
const END: u8 = 0xff;

/// Rows with equal numbers of cells, in one text: with one allocation per row they would take many times the file's size.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TextRows {
    cells: Vec<u8>,
}

impl TextRows {
    /// Adds a row of a CSV, which must have as many cells as every other, without the apostrophes before what would be formulas.
    pub fn push(&mut self, row: &csv::StringRecord) {
        for cell in row {
            self.cells.extend_from_slice(unguarded(cell).as_bytes());
            self.cells.push(END);
        }
    }

    /// Reserves memory for a row: a quarter more than present, if there is not enough, for whose bytes `hold` asks first.
    pub(crate) fn reserve<E>(
        &mut self,
        row: &csv::StringRecord,
        hold: impl FnOnce(u64) -> Result<(), E>,
    ) -> Result<(), E> {
        let needed = row.as_slice().len() + row.len();
        if self.cells.capacity() - self.cells.len() < needed {
            let more = needed.max(self.cells.len() / 4).max(4096);
            hold(more as u64)?;
            self.cells.reserve_exact(more);
        }
        Ok(())
    }

    /// Keeps the rows of `columns` cells that `is_kept`.
    pub fn keep(&mut self, columns: usize, is_kept: &[bool]) {
        let mut cell = 0;
        self.cells.retain(|&byte| {
            let is_kept = is_kept.get(cell / columns).copied().unwrap_or(false);
            cell += usize::from(byte == END);
            is_kept
        });
    }

    /// All cells, row after row.
    pub fn cells(&self) -> impl Iterator<Item = &str> {
        // They were text when they were added.
        let text = |cell| std::str::from_utf8(cell).unwrap_or_default();
        self.cells.split(|&byte| byte == END).map(text)
    }
}

/// The line of the file in which each row begins, or the number of its sample in a file without lines.
#[derive(Clone, Debug, Default)]
pub struct RowLines {
    rows: usize,
    /// Whether it holds lines of a text.
    are_lines: bool,
    /// Rows that are not one line below the row before, each with its line.
    jumps: Vec<(usize, u64)>,
}

impl PartialEq for RowLines {
    /// Always equal: rows are the same regardless of their lines.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl RowLines {
    /// Whether there are rows.
    pub fn has_rows(&self) -> bool {
        self.rows > 0
    }

    /// The numbers of `rows` samples.
    pub fn of_samples(rows: usize) -> Self {
        Self {
            rows,
            are_lines: false,
            jumps: vec![(0, 1)],
        }
    }

    /// Adds one row of a text.
    pub fn push(&mut self, line: u64) {
        self.are_lines = true;
        if self.line_of(self.rows) != Some(line) {
            self.jumps.push((self.rows, line));
        }
        self.rows += 1;
    }

    /// [`RowLines::push`], within a budget.
    ///
    /// # Errors
    /// The budget has no room for it.
    pub(crate) fn push_within(&mut self, line: u64, budget: &Budget) -> Result<(), InputError> {
        let held = self.jumps.capacity();
        self.push(line);
        let more = (self.jumps.capacity() - held) * size_of::<(usize, u64)>();
        match more {
            0 => Ok(()),
            more => budget.hold(more as u64, "the lines of its rows"),
        }
    }

    /// Keeps the rows that `is_kept`.
    pub fn keep(&mut self, is_kept: &[bool]) {
        let mut kept = Self::default();
        let lines = (0..self.rows).filter(|&row| is_kept.get(row) == Some(&true));
        lines
            .filter_map(|row| self.line(row))
            .for_each(|line| kept.push(line));
        kept.are_lines = self.are_lines;
        *self = kept;
    }

    /// The place of row `index`, in `column` if there is one.
    pub fn place(&self, index: usize, column: Option<&str>) -> Place {
        let number = self.line(index).unwrap_or(index as u64 + 1);
        let column = column.map(str::to_owned);
        match (self.are_lines, column) {
            (true, None) => Place::Line(number),
            (true, Some(column)) => Place::Cell {
                line: number,
                column,
            },
            (false, column) => Place::Sample(Box::new((number, column))),
        }
    }

    /// The line of the file in which row `index` begins, or the number of its sample.
    pub fn line(&self, index: usize) -> Option<u64> {
        (index < self.rows).then(|| self.line_of(index)).flatten()
    }

    /// The same, assuming that row `index` is one line below the row before unless it is listed otherwise.
    fn line_of(&self, index: usize) -> Option<u64> {
        let after = self.jumps.partition_point(|&(row, _)| row <= index);
        let &(row, line) = self.jumps.get(after.checked_sub(1)?)?;
        Some(line + (index - row) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_has_the_line_that_it_came_with() {
        let lines = [2, 3, 4, 7, 8, 20, 22, 23];
        let mut rows = RowLines::default();
        lines.iter().for_each(|&line| rows.push(line));
        let each = (0..9).map(|index| rows.line(index));
        let expected = lines.iter().copied().map(Some).chain([None]);
        assert!(each.eq(expected));
        assert_eq!(rows.jumps.len(), 4);
    }
}
