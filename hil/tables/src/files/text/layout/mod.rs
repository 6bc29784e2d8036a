//! The layout of a text: where its numbers begin, what each column holds, and what the rows above say of it.

mod block;
mod findings;
mod kinds;
mod refused;

pub(super) use block::FEW_ROWS;
pub(super) use kinds::Kind;

use mesh_damper_output::error::InputError;

use super::decimals;
use super::declared::Declared;
use super::head::Head;
use super::header::Header;
use super::lines::{Cells, OF_CELL, Separator};
use super::lvm;
use super::metadata;
use super::numbers::Numbers;
use super::rows::{Row, RowKind, lines, rows};
use crate::budget::Budget;
use crate::columns;
use crate::files::{Reading, Table};
use crate::room::Room;
use block::{Block, block, lvm_block};
use kinds::kinds;
use refused::no_table;

/// Bytes held for a column while its text is read: its name in the header, among the names known, and as it may be written again.
const OF_COLUMN: u64 = 256;
/// Steps of work for the look whether a column may hold the times.
pub(super) const STEPS_OF_LOOK: u64 = 200;

/// Layout of a text.
pub(super) struct Layout {
    pub separator: Separator,
    pub numbers: Numbers,
    /// The line in which the numbers begin.
    pub data_line: u64,
    /// Number of cells in a row, including those at its end that are always empty.
    pub cells: usize,
    pub kinds: Vec<Kind>,
    /// The cells of the rows of names and of units as written, by which repetitions are recognized.
    pub repeated: Vec<Vec<String>>,
    /// Whether the names are in a comment.
    pub is_named_in_comment: bool,
    /// Lines that must be the same wherever one with the same first cell occurs.
    pub fixed: Vec<Vec<String>>,
    /// Columns whose cells must equal those of another: a second column of the same times.
    pub same: Vec<(usize, usize)>,
    pub comments: Vec<String>,
    /// Whether a row may have one more cell, a remark that is not read.
    pub has_remarks: bool,
    /// Whether the times come from outside of the table.
    pub has_clock: bool,
    /// Whether it differs from our own format only in names.
    pub is_plain: bool,
    pub table: Table,
}

/// Determines the layout of a text.
///
/// # Errors
/// The text has no table of numbers, an ambiguous decimal sign, or a comma as separator and decimal sign; or the budget has no room for
/// what it holds.
pub(super) fn find(
    name: &str,
    head: &Head,
    reading: &Reading,
    budget: &Budget,
) -> Result<Layout, InputError> {
    find_as(name, head, reading, Declared::of(&head.text), budget)
}

/// [`find`] for a text whose declarations are known.
///
/// # Errors
/// As [`find`].
pub(super) fn find_as(
    name: &str,
    head: &Head,
    reading: &Reading,
    declared: Declared,
    budget: &Budget,
) -> Result<Layout, InputError> {
    let mut room = Room::of(budget);
    let lines = lines(&head.text, &mut room)?;
    let separators: Vec<Separator> = match declared.separator {
        Some(separator) => vec![separator],
        None => Separator::ALL.to_vec(),
    };
    let mut best: Option<(Separator, Vec<Row>, Block, Room)> = None;
    for separator in separators {
        let mut room = Room::of(budget);
        let rows = rows(&head.text, &lines, separator, &mut room)?;
        let block = if declared.is_lvm {
            lvm_block(&rows, separator, &mut room)?
        } else {
            block(&rows, separator, &mut room)?
        };
        let Some(block) = block else {
            continue;
        };
        let is_better = best.as_ref().is_none_or(|(_, _, known, _)| {
            // Fewer words among the numbers are better; then more rows.
            let (mine, other) = (block.words * known.all, known.words * block.all);
            mine < other || (mine == other && block.rows.len() > known.rows.len())
        });
        if is_better {
            best = Some((separator, rows, block, room));
        }
    }
    let Some((separator, rows, block, _room)) = best else {
        return Err(no_table(name, &declared));
    };
    let found = Found {
        name,
        head,
        declared: &declared,
        reading,
        separator,
        rows: &rows,
        block: &block,
        budget,
    };
    found.layout()
}

/// Findings about a text.
struct Found<'f> {
    name: &'f str,
    head: &'f Head<'f>,
    declared: &'f Declared,
    reading: &'f Reading,
    separator: Separator,
    rows: &'f [Row<'f>],
    block: &'f Block,
    budget: &'f Budget,
}

impl Found<'_> {
    fn layout(&self) -> Result<Layout, InputError> {
        let mut room = Room::of(self.budget);
        room.more(OF_COLUMN * self.block.cells as u64, "its columns")?;
        let mut header = Header::above(
            self.rows,
            self.block.first,
            self.block.cells,
            self.separator,
            &mut room,
        )?;
        let samples = self.samples(&mut room)?;
        let is_empty = |column: usize| {
            let mut cells = samples.iter().map(|(_, row)| row.get(column));
            cells.all(|cell| cell.is_none_or(|cell| cell.is_empty()))
        };
        header.fit(self.block.cells, &is_empty);
        self.check_header(&header, &samples)?;
        let numbers = self.numbers(&samples)?;
        let kinds = kinds(&samples, self.block.cells, numbers);
        let lvm = match self.declared.is_lvm {
            true => Some(self.segment(&header)?),
            false => None,
        };
        let mut guesses: Vec<String> = self.head.encoding.iter().cloned().collect();
        let mut columns = self.columns(&header, &kinds, &samples, numbers, &mut guesses)?;
        let mut same = Vec::new();
        if let Some(lvm) = &lvm {
            same = lvm.apply(&mut columns);
        }
        let comments = metadata::of(
            self.rows,
            header.first_line,
            self.block.first,
            self.separator,
            self.budget,
        )?;
        let mut table = Table {
            header_line: Some(header.line.unwrap_or(self.data_line())),
            is_nameless: header.line.is_none(),
            columns,
            ..Table::default()
        };
        let looked = STEPS_OF_LOOK * table.columns.len() as u64;
        self.budget.work(looked, "the names of its columns")?;
        let has_times = self.reading.channels.iter().any(|(of, _)| of == "time")
            || (table.columns.iter()).any(columns::may_be_time);
        if self.reading.rate.is_none() && !has_times {
            let given = match &lvm {
                Some(lvm) => lvm.clock(numbers),
                None => metadata::clock(self.name, &comments, numbers)?,
            };
            if let Some((clock, said)) = given {
                table.clock = Some(clock);
                guesses.push(said);
            }
        }
        let has_preamble = (self.rows.iter()).any(|row| {
            row.kind == RowKind::Cells && header.first_line.is_some_and(|line| row.line < line)
        });
        let is_plain = self.separator == Separator::Sign(',')
            && numbers == Numbers::POINT
            && self.head.is_utf8
            && header.is_line()
            && header.units.is_none()
            && !has_preamble
            && self.block.passed == 0
            && header.passed.is_empty()
            && !header.is_changed
            && !self.declared.is_said()
            && !kinds.contains(&Kind::Stamps)
            && lvm.is_none();
        if !is_plain {
            guesses.extend(self.findings(numbers, &header));
        }
        guesses.extend(self.first_is_whole(&samples, &kinds));
        table.guesses = guesses;
        Ok(Layout {
            separator: self.separator,
            numbers,
            data_line: self.data_line(),
            cells: self.block.cells,
            kinds,
            repeated: header.repeated(),
            is_named_in_comment: header.is_comment,
            fixed: lvm.map(|lvm| lvm.fixed).unwrap_or_default(),
            same,
            has_remarks: self.declared.is_lvm,
            comments: comments.into_iter().map(|each| each.text).collect(),
            has_clock: table.clock.is_some() || self.reading.rate.is_some(),
            is_plain,
            table,
        })
    }

    fn data_line(&self) -> u64 {
        self.rows[self.block.first].line
    }

    /// The rows of numbers with their lines.
    fn samples(&self, room: &mut Room) -> Result<Vec<(u64, Vec<&str>)>, InputError> {
        let count = self.block.rows.len();
        let of_row = size_of::<(u64, Vec<&str>)>() as u64 + OF_CELL * self.block.cells as u64;
        room.more(of_row * count as u64, "the cells of its first rows")?;
        let mut split = Cells::of(self.budget);
        let mut samples = Vec::with_capacity(count);
        for &index in &self.block.rows {
            let row = &self.rows[index];
            let cells = split.split(self.separator, row.text)?;
            let cells = &cells[..cells.len().min(self.block.cells)];
            samples.push((row.line, cells.to_vec()));
        }
        Ok(samples)
    }

    fn segment(&self, header: &Header) -> Result<lvm::Segment, InputError> {
        lvm::Segment::of(self.rows, header.line, self.separator, self.budget)
    }

    fn numbers(&self, samples: &[(u64, Vec<&str>)]) -> Result<Numbers, InputError> {
        if let Some(decimal) = self.reading.decimal {
            return Ok(decimals::with_sign(samples, decimal));
        }
        if let Some(decimal) = self.declared.decimal {
            return Ok(Numbers {
                decimal,
                ..Numbers::POINT
            });
        }
        decimals::of(samples, self.separator).map_err(|asked| asked.refused(self.name))
    }
}
