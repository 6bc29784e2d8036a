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
use super::lines::Separator;
use super::lvm;
use super::metadata;
use super::numbers::Numbers;
use super::rows::{Row, RowKind, rows};
use crate::columns;
use crate::files::{Reading, Table};
use block::{Block, block, lvm_block};
use kinds::kinds;
use refused::no_table;

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
/// The text has no table of numbers, an ambiguous decimal sign, or a comma as separator and decimal sign.
pub(super) fn find(name: &str, head: &Head, reading: &Reading) -> Result<Layout, InputError> {
    find_as(name, head, reading, Declared::of(&head.text))
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
) -> Result<Layout, InputError> {
    let separators: Vec<Separator> = match declared.separator {
        Some(separator) => vec![separator],
        None => Separator::ALL.to_vec(),
    };
    let mut best: Option<(Separator, Vec<Row>, Block)> = None;
    for separator in separators {
        let rows = rows(&head.text, separator);
        let block = if declared.is_lvm {
            lvm_block(&rows, separator)
        } else {
            block(&rows, separator)
        };
        let Some(block) = block else {
            continue;
        };
        let is_better = best.as_ref().is_none_or(|(_, _, known)| {
            // Fewer words among the numbers are better; then more rows.
            let (mine, other) = (block.words * known.all, known.words * block.all);
            mine < other || (mine == other && block.rows.len() > known.rows.len())
        });
        if is_better {
            best = Some((separator, rows, block));
        }
    }
    let Some((separator, rows, block)) = best else {
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
    };
    found.layout()
}

/// Findings about a text.
struct Found<'f> {
    name: &'f str,
    head: &'f Head,
    declared: &'f Declared,
    reading: &'f Reading,
    separator: Separator,
    rows: &'f [Row<'f>],
    block: &'f Block,
}

impl Found<'_> {
    fn layout(&self) -> Result<Layout, InputError> {
        let mut header = Header::above(
            self.rows,
            self.block.first,
            self.block.cells,
            self.separator,
        );
        let samples = self.samples();
        let is_empty = |column: usize| {
            let mut cells = samples.iter().map(|(_, row)| row.get(column));
            cells.all(|cell| cell.is_none_or(|cell| cell.is_empty()))
        };
        header.fit(self.block.cells, &is_empty);
        self.check_header(&header, &samples)?;
        let numbers = self.numbers(&samples)?;
        let kinds = kinds(&samples, self.block.cells, numbers);
        let lvm = self
            .declared
            .is_lvm
            .then(|| lvm::Segment::of(self.rows, header.line, self.separator));
        let mut guesses: Vec<String> = self.head.encoding.iter().cloned().collect();
        let mut columns = self.columns(&header, &kinds, &samples, numbers, &mut guesses);
        let mut same = Vec::new();
        if let Some(lvm) = &lvm {
            same = lvm.apply(&mut columns);
        }
        let comments = metadata::of(
            self.rows,
            header.first_line,
            self.block.first,
            self.separator,
        );
        let mut table = Table {
            header_line: Some(header.line.unwrap_or(self.data_line())),
            is_nameless: header.line.is_none(),
            columns,
            ..Table::default()
        };
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
    fn samples(&self) -> Vec<(u64, Vec<&str>)> {
        let rows = self.block.rows.iter().map(|&index| {
            let row = &self.rows[index];
            let mut cells = Vec::new();
            self.separator.split(row.text, &mut cells);
            cells.truncate(self.block.cells);
            (row.line, cells)
        });
        rows.collect()
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
