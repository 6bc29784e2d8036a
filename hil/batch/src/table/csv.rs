//! A table as CSV.

use mesh_damper_tables::write::guarded;

use super::{Table, Values};

/// Separator between the texts of a list.
const BETWEEN: &str = ";";

impl Table {
    /// The table as CSV with a header. A missing value is an empty cell; semicolons separate the texts of a list; a text that a
    /// spreadsheet would take for a formula is [`guarded`].
    pub fn to_csv(&self) -> Vec<u8> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        // Writing to memory does not fail, and every row has as many cells as the header.
        let _ = writer.write_record(self.0.iter().map(|column| column.name));
        let rows = self.0.first().map_or(0, |column| column.values.len());
        for row in 0..rows {
            let cells = self.0.iter().map(|column| column.values.cell(row));
            let _ = writer.write_record(cells.map(|cell| guarded(&cell).into_owned()));
        }
        writer.into_inner().unwrap_or_default()
    }
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Text(values) => values.len(),
            Self::Texts(values) => values.len(),
            Self::Real(values) => values.len(),
            Self::Count(values) => values.len(),
            Self::Flag(values) => values.len(),
        }
    }

    fn cell(&self, row: usize) -> String {
        fn shown<T: ToString>(value: &Option<T>) -> String {
            value.as_ref().map(T::to_string).unwrap_or_default()
        }
        match self {
            Self::Text(values) => shown(&values[row]),
            Self::Texts(values) => values[row].join(BETWEEN),
            Self::Real(values) => shown(&values[row]),
            Self::Count(values) => shown(&values[row]),
            Self::Flag(values) => shown(&values[row]),
        }
    }
}
