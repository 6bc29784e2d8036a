//! The table is a block of rows of numbers with equally many cells.

use mesh_damper_output::error::InputError;

use super::super::header::Header;
use super::super::lines::{Cells, Separator};
use super::super::rows::{Row, RowKind};
use super::super::stamps::Stamp;
use super::super::{lvm, numbers};
use crate::csv_text::is_blank;
use crate::room::Room;

/// Rows of numbers that make a table. Its header is used even if other numbers have more rows, and below other numbers it is not a
/// footer. Convention: statistics have fewer rows.
pub(in crate::files::text) const FEW_ROWS: usize = 8;
/// Number of rows of numbers above the table for which a note is given. Convention: fewer are settings of a program.
const WORTH_SAYING: usize = 3;

/// Bytes held for a block, with its first rows, and for another row of it: vectors double as they grow.
const OF_BLOCK: u64 = 2 * size_of::<Block>() as u64 + 4 * OF_ROW;
const OF_ROW: u64 = 2 * size_of::<usize>() as u64;

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
        if is_blank(cell) {
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
///
/// # Errors
/// The budget has no room for its cells.
pub(super) fn block(
    rows: &[Row],
    separator: Separator,
    room: &mut Room,
) -> Result<Option<Block>, InputError> {
    const PART: &str = "its rows of numbers";
    let mut blocks: Vec<Block> = Vec::new();
    let mut cells = Cells::of(room.budget());
    let mut is_broken = true;
    for (index, row) in rows.iter().enumerate() {
        if row.kind != RowKind::Cells {
            continue;
        }
        let cells = cells.split(separator, row.text)?;
        let Some((figures, words)) = counted(cells, separator) else {
            is_broken = true;
            continue;
        };
        let last = blocks
            .last_mut()
            .filter(|last| !is_broken && last.cells == cells.len());
        is_broken = false;
        match last {
            Some(block) => {
                room.more(OF_ROW, PART)?;
                block.rows.push(index);
                block.words += words;
                block.all += figures + words;
            }
            None => {
                room.more(OF_BLOCK, PART)?;
                blocks.push(Block {
                    first: index,
                    rows: vec![index],
                    cells: cells.len(),
                    passed: 0,
                    words,
                    all: figures + words,
                });
            }
        }
    }
    let mut headed = None;
    for (index, block) in blocks.iter().enumerate() {
        if headed.is_none() && block.rows.len() >= FEW_ROWS {
            let mut room = Room::of(room.budget());
            let header = Header::above(rows, block.first, block.cells, separator, &mut room)?;
            headed = (header.named >= 2).then_some(index);
        }
    }
    let longest = || {
        let length = |index: &usize| blocks[*index].rows.len();
        (0..blocks.len()).rev().max_by_key(length)
    };
    let Some(index) = headed.or_else(longest) else {
        return Ok(None);
    };
    let lengths = blocks[..index].iter().map(|block| block.rows.len());
    let passed = lengths.filter(|&rows| rows >= WORTH_SAYING).sum();
    let mut block = blocks.swap_remove(index);
    block.passed = passed;
    Ok(Some(block))
}

/// The rows of numbers of a LabVIEW measurement file: those below the names, which follow the header of a segment. A row may have a
/// remark after its numbers.
///
/// # Errors
/// The budget has no room for its cells.
pub(super) fn lvm_block(
    rows: &[Row],
    separator: Separator,
    room: &mut Room,
) -> Result<Option<Block>, InputError> {
    let is_end = |row: &Row| row.text.trim_start().starts_with(lvm::END);
    let ends = rows.iter().enumerate().filter(|(_, row)| is_end(row));
    let mut ends = ends.map(|(index, _)| index);
    let Some(file) = ends.next() else {
        return Ok(None);
    };
    let begin = ends.next().unwrap_or(file);
    let is_full = |&index: &usize| rows[index].kind == RowKind::Cells;
    let mut full = (begin + 1..rows.len()).filter(is_full);
    let (Some(names), Some(first)) = (full.next(), full.next()) else {
        return Ok(None);
    };
    room.more(OF_ROW * rows.len() as u64, "its rows of numbers")?;
    let mut cells = Cells::of(room.budget());
    let names = cells.split(separator, rows[names].text)?;
    let count = names.len() - usize::from(names.last() == Some(&lvm::REMARK));
    let mut block = vec![first];
    for index in full {
        let is_of_numbers = !is_end(&rows[index])
            && counted(cells.split(separator, rows[index].text)?, separator).is_some();
        if !is_of_numbers {
            break;
        }
        block.push(index);
    }
    Ok(Some(Block {
        first,
        rows: block,
        cells: count,
        passed: 0,
        words: 0,
        all: 1,
    }))
}
