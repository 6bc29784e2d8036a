//! The table is a block of rows of numbers with equally many cells.

use super::super::header::Header;
use super::super::lines::Separator;
use super::super::rows::{Row, RowKind};
use super::super::stamps::Stamp;
use super::super::{lvm, numbers};

/// Rows of numbers that make a table. Its header is used even if other numbers have more rows, and below other numbers it is not a
/// footer. Convention: statistics have fewer rows.
pub(in crate::files::text) const FEW_ROWS: usize = 8;
/// Largest number of columns in a text. Convention: ten times the number in the largest loggers' files; our own format may have
/// more.
const MOST_COLUMNS: usize = 100_000;

/// Largest number of bytes in a row of numbers: splitting a row takes many times its size.
const LONGEST: usize = 10 * MOST_COLUMNS;

/// Number of rows of numbers above the table for which a note is given. Convention: fewer are settings of a program.
const WORTH_SAYING: usize = 3;

/// Consecutive rows of numbers with equally many cells.
pub(super) struct Block {
    /// Index of the first one among the rows.
    pub(super) first: usize,
    pub(super) rows: Vec<usize>,
    pub(super) cells: usize,
    /// Number of rows of numbers in longer runs above it.
    pub(super) passed: usize,
    /// Number of cells that are neither numbers nor empty, and number of cells that are not empty.
    pub(super) words: usize,
    pub(super) all: usize,
}

/// Counts of numbers and words in a row, if it is a row of numbers.
fn counted(cells: &[&str], separator: Separator) -> Option<(usize, usize)> {
    let may_group = !matches!(separator, Separator::Blanks | Separator::Sign(','));
    let (mut figures, mut words) = (0, 0);
    for cell in cells {
        if numbers::is_blank(cell) {
            continue;
        }
        if numbers::is_number(cell, may_group) || Stamp::of(cell).is_some() {
            figures += 1;
        } else {
            words += 1;
        }
    }
    (cells.len() >= 2 && figures > 0 && figures >= words).then_some((figures, words))
}

/// The table of a text: the first rows of numbers below a header with names of channels, else the longest run of rows.
pub(super) fn block(rows: &[Row], separator: Separator) -> Option<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut cells = Vec::new();
    let mut is_broken = true;
    for (index, row) in rows.iter().enumerate() {
        if row.kind != RowKind::Cells {
            continue;
        }
        if row.text.len() > LONGEST {
            is_broken = true;
            continue;
        }
        separator.split(row.text, &mut cells);
        let Some((figures, words)) = counted(&cells, separator) else {
            is_broken = true;
            continue;
        };
        let last = blocks
            .last_mut()
            .filter(|last| !is_broken && last.cells == cells.len());
        is_broken = false;
        match last {
            Some(block) => {
                block.rows.push(index);
                block.words += words;
                block.all += figures + words;
            }
            None => blocks.push(Block {
                first: index,
                rows: vec![index],
                cells: cells.len(),
                passed: 0,
                words,
                all: figures + words,
            }),
        }
    }
    blocks.retain(|block| block.cells <= MOST_COLUMNS);
    let is_headed = |block: &Block| {
        let header = Header::above(rows, block.first, block.cells, separator);
        header.named() >= 2
    };
    let headed = blocks
        .iter()
        .position(|block| block.rows.len() >= FEW_ROWS && is_headed(block));
    let longest = || {
        let length = |index: &usize| blocks[*index].rows.len();
        (0..blocks.len()).rev().max_by_key(length)
    };
    let index = headed.or_else(longest)?;
    let lengths = blocks[..index].iter().map(|block| block.rows.len());
    let passed = lengths.filter(|&rows| rows >= WORTH_SAYING).sum();
    let mut block = blocks.swap_remove(index);
    block.passed = passed;
    Some(block)
}

/// The rows of numbers of a LabVIEW measurement file: those below the names, which follow the header of a segment. A row may have a
/// remark after its numbers.
pub(super) fn lvm_block(rows: &[Row], separator: Separator) -> Option<Block> {
    let is_end = |row: &Row| row.text.trim_start().starts_with(lvm::END);
    let ends = rows.iter().enumerate().filter(|(_, row)| is_end(row));
    let mut ends = ends.map(|(index, _)| index);
    let file = ends.next()?;
    let begin = ends.next().unwrap_or(file);
    let is_full = |&index: &usize| rows[index].kind == RowKind::Cells;
    let mut full = (begin + 1..rows.len()).filter(is_full);
    let names = full.next()?;
    let first = full.next()?;
    let mut cells = Vec::new();
    separator.split(rows[names].text, &mut cells);
    let count = cells.len() - usize::from(cells.last() == Some(&lvm::REMARK));
    let rows_of_numbers = full.take_while(|&index| {
        !is_end(&rows[index]) && {
            separator.split(rows[index].text, &mut cells);
            counted(&cells, separator).is_some()
        }
    });
    Some(Block {
        first,
        rows: [first].into_iter().chain(rows_of_numbers).collect(),
        cells: count,
        passed: 0,
        words: 0,
        all: 1,
    })
}
