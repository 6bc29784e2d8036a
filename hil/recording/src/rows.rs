//! The cells of a recording's rows as the file has them.

/// What ends a cell: a byte that no UTF-8 text holds.
const END: u8 = 0xff;

/// Rows of equally many cells, in one text: with an allocation for each row they would take many times the file's size.
#[derive(Clone, Debug, Default)]
pub(super) struct TextRows {
    cells: Vec<u8>,
    /// The line of the file in which each row begins.
    lines: Vec<u64>,
}

impl PartialEq for TextRows {
    /// Whether the cells are the same, on whatever lines.
    fn eq(&self, other: &Self) -> bool {
        self.cells == other.cells
    }
}

impl TextRows {
    /// One more row, which has as many cells as every other.
    pub(super) fn push(&mut self, row: &csv::StringRecord, line: u64) {
        for cell in row {
            self.cells.extend_from_slice(cell.as_bytes());
            self.cells.push(END);
        }
        self.lines.push(line);
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.lines.len()
    }

    /// The line of the file in which row `index` begins.
    pub(super) fn line(&self, index: usize) -> Option<u64> {
        self.lines.get(index).copied()
    }

    /// All cells, row after row.
    pub(super) fn cells(&self) -> impl Iterator<Item = &str> {
        // They were text when they came.
        let text = |cell| std::str::from_utf8(cell).unwrap_or_default();
        self.cells.split(|&byte| byte == END).map(text)
    }
}
