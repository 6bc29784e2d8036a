//! Text: rows of cells, in our own format or in the formats of other programs and countries.
//!
//! The layout of a text follows from a head of bounded size: its encoding, separator and decimal sign, and where names, units and
//! numbers begin. The findings are reported. Then the text is read as a stream.

mod blocks;
mod decimals;
mod declared;
mod encoding;
mod foreign;
mod head;
mod header;
mod layout;
mod lines;
mod lvm;
mod metadata;
mod numbers;
mod own;
mod rows;
mod stamps;

pub(super) use decimals::Evidence;

use std::path::Path;
use std::rc::Rc;

use mesh_damper_output::error::InputError;

use super::{Format, Reading, Source, Tables};
use crate::budget::Budget;
use crate::csv_text::CsvText;

/// Rows of cells with a separator, gzipped or not.
pub struct Text;

impl Format for Text {
    fn name(&self) -> &'static str {
        "text"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["csv", "txt", "tsv", "dat", "asc", "lvm", "gz"]
    }

    fn recognizes(&self, _: &[u8]) -> bool {
        true
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        reading: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let (path, budget) = (source.path().to_owned(), source.budget());
        let mut text = CsvText::of(&path, source.stream(), Rc::clone(&budget))?;
        let head = head::of(&mut text, &budget)?;
        let is_own = own::is_own(&head.text)
            && !own::is_loose(&head.text, &budget)?
            && !own::lacks_times(&head.text, reading, &budget)?
            && reading.decimal != Some(',');
        if is_own || !head.has_lines() {
            return Ok(Box::new(own::OwnTable::open(text, &head, reading)?));
        }
        let layout = layout::find(&text.name(), &head, reading, &budget)?;
        Ok(Box::new(foreign::ForeignTable::open(text, layout)))
    }
}

/// The rows of a workbook's sheet, as lines of cells separated by tabs, read like a text of the same rows. `budget` is that of the
/// workbook, whose bytes are counted already.
///
/// # Errors
/// As for a text.
pub(super) fn of_sheet<'a>(
    path: &Path,
    rows: Vec<u8>,
    reading: &Reading,
    budget: &Rc<Budget>,
) -> Result<Box<dyn Tables + 'a>, InputError> {
    let mut text = CsvText::made(path, rows, Rc::clone(budget));
    let head = head::of(&mut text, budget)?;
    let declared = declared::Declared {
        separator: Some(TAB),
        is_sheet: true,
        ..declared::Declared::default()
    };
    let layout = layout::find_as(&text.name(), &head, reading, declared, budget)?;
    Ok(Box::new(foreign::ForeignTable::open(text, layout)))
}

/// Whether a cell of text is, or may be, a number in any country's form.
pub(super) fn is_number(cell: &str) -> bool {
    numbers::is_number(cell, true)
}

/// The decimal sign of numbers stored as texts in a workbook.
///
/// # Errors
/// The sign is ambiguous.
pub(super) fn decimal_of(file: &str, signs: Evidence) -> Result<char, InputError> {
    let numbers = signs.decided(TAB).map_err(|asked| asked.refused(file))?;
    Ok(numbers.decimal)
}

const TAB: lines::Separator = lines::Separator::Sign('\t');
