//! Text: a header and rows of cells.

use std::path::Path;

use super::{Column, Format, Kept, Reading, Source, Table, Tables, Values, Wanted};
use crate::csv_text::{CsvText, broken_csv, doubled, is_blank, is_cut, number};
use crate::error::{InputError, Place};
use crate::rows::{RowLines, TextRows};

/// Rows of cells that a separator divides, gzipped or not.
pub struct Text;

impl Format for Text {
    fn name(&self) -> &'static str {
        "text"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["csv", "txt", "tsv", "dat", "asc", "gz"]
    }

    fn recognizes(&self, _: &[u8]) -> bool {
        true
    }

    fn open<'a>(
        &self,
        source: Source<'a>,
        _: &Reading,
    ) -> Result<Box<dyn Tables + 'a>, InputError> {
        let path = source.path().to_owned();
        Ok(Box::new(TextTable::open(&path, source)?))
    }
}

/// A text whose header was read.
struct TextTable<'a> {
    name: String,
    rows: csv::Reader<CsvText<'a>>,
    header: csv::StringRecord,
    tables: [Table; 1],
}

impl<'a> TextTable<'a> {
    fn open(path: &Path, source: Source<'a>) -> Result<Self, InputError> {
        let limit = source.limit();
        let text = CsvText::of(path, source.stream(), limit)?;
        let name = text.name();
        let mut rows = text.rows();
        let mut header = csv::StringRecord::new();
        match rows.read_record(&mut header) {
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
        if let Some((column, first, second)) = doubled(&header) {
            let (first, second) = (first + 1, second + 1);
            return Err(InputError::new(
                name,
                format!("the name stands in columns {first} and {second}"),
                "give every column its own name",
            )
            .at(Place::Column(column.into())));
        }
        let columns = header.iter().map(|name| Column {
            name: name.to_owned(),
            is_numeric: true,
            ..Column::default()
        });
        let table = Table {
            columns: columns.collect(),
            header_line: Some(line),
            ..Table::default()
        };
        Ok(Self {
            name,
            rows,
            header,
            tables: [table],
        })
    }
}

impl Tables for TextTable<'_> {
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
            ..
        } = *self;
        let mut columns = vec![Some(Vec::new()); wanted.len()];
        let mut cells = (kept == Kept::Cells).then(TextRows::default);
        let mut lines = RowLines::default();
        let mut cut = false;
        let mut row = csv::StringRecord::new();
        while (rows.read_record(&mut row)).map_err(|error| broken_csv(&name, &error))? {
            if is_cut(&rows) {
                // The reader makes an empty row of a comment there.
                cut = row.iter().any(|cell| !cell.is_empty());
                break;
            }
            let line = row.position().map_or(0, csv::Position::line);
            if row.len() != header.len() {
                return Err(InputError::new(
                    name,
                    format!("{} cells where the header has {}", row.len(), header.len()),
                    "write one cell per column, separated by commas",
                )
                .at(Place::Line(line)));
            }
            for (wanted, column) in wanted.iter().zip(&mut columns) {
                let Some(values) = column else { continue };
                let cell = row.get(wanted.column).unwrap_or_default();
                let value = match number(cell) {
                    _ if is_blank(cell) => f64::NAN,
                    Ok(value) => value,
                    Err(_) if !wanted.must_be_numeric => {
                        *column = None;
                        continue;
                    }
                    Err((problem, mend)) => {
                        let column = header.get(wanted.column).unwrap_or_default().into();
                        let place = Place::Cell { line, column };
                        return Err(InputError::new(name, problem, mend).at(place));
                    }
                };
                grow(values);
                values.push(value);
            }
            if let Some(cells) = &mut cells {
                cells.push(&row);
            }
            lines.push(line);
        }
        Ok(Values {
            columns,
            comments: rows.into_inner().comments(),
            lines,
            is_cut: cut,
            cells: cells.map(|cells| (header, cells)),
        })
    }
}

/// Makes room for one more value: a quarter more than there is. Twice as much, as a vector takes by itself, is all that a file of
/// short rows may take.
fn grow(values: &mut Vec<f64>) {
    if values.len() == values.capacity() {
        values.reserve_exact((values.len() / 4).max(1024));
    }
}
