//! Text: rows of cells, in our own format or as other programs and other countries write it.
//!
//! A head of bounded size says what a text is like: its encoding, separator and decimal sign, where names, units and numbers begin.
//! What was found out so is said. Then the text is read on as a stream.

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
mod stamps;

use super::{Format, Reading, Source, Tables};
use crate::csv_text::CsvText;
use crate::error::InputError;

/// Rows of cells that a separator divides, gzipped or not.
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
        let (path, limit) = (source.path().to_owned(), source.limit());
        let mut text = CsvText::of(&path, source.stream(), limit)?;
        let head = head::of(&mut text, limit)?;
        let is_own =
            own::is_own(&head.text) && !own::is_loose(&head.text) && reading.decimal != Some(',');
        if is_own || !head.has_lines() {
            return Ok(Box::new(own::OwnTable::open(text, &head)?));
        }
        let layout = layout::find(&text.name(), &head, reading)?;
        Ok(Box::new(foreign::ForeignTable::open(text, layout)))
    }
}

/// Names and units.
pub(super) type Named = (Vec<String>, Option<Vec<String>>);

/// The names and the units of columns, in rows of cells that stand above their numbers, as in a text that tabs divide.
pub(super) fn header_of(above: &[Vec<String>], columns: usize) -> Named {
    let is_end = |c: char| c.is_control();
    let row = |row: &Vec<String>| {
        let cells = row.iter().map(|cell| cell.replace(is_end, " "));
        cells.collect::<Vec<_>>().join("\t")
    };
    let text: Vec<String> = above.iter().map(row).collect();
    let text = text.join("\n");
    let separator = lines::Separator::Sign('\t');
    let rows = layout::rows(&text, separator);
    let mut header = header::Header::above(&rows, rows.len(), columns, separator);
    header.fit(columns, &|_| false);
    (header.names, header.units)
}
