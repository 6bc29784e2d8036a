//! A text is refused without a table, with too few names, or with a comma for two purposes.

use mesh_damper_output::error::{InputError, Place};

use super::super::declared::Declared;
use super::super::header::Header;
use super::super::lines::Separator;
use super::super::numbers;
use super::Found;

pub(super) fn no_table(name: &str, declared: &Declared) -> InputError {
    let divided = match declared.separator {
        Some(separator) => format!("separated by {}, as it states", separator.name()),
        None => "separated by commas, semicolons, tabs, bars or blanks".into(),
    };
    InputError::new(
        name,
        format!("holds no rows of at least two numbers {divided}"),
        "check that it is the right file; a recording has a header such as time_s,displacement_mm,force_kN and samples below it",
    )
}

impl Found<'_> {
    /// Rejects a header with fewer names than the rows have cells.
    pub(super) fn check_header(
        &self,
        header: &Header,
        samples: &[(u64, Vec<&str>)],
    ) -> Result<(), InputError> {
        let Some((line, names)) = header.misfit else {
            if self.separator == Separator::Sign(',') && self.is_comma_both(samples, header.count())
            {
                return Err(self.comma_both(self.data_line()));
            }
            return Ok(());
        };
        if self.separator == Separator::Sign(',') && self.is_comma_both(samples, names) {
            return Err(self.comma_both(self.data_line()));
        }
        let (cells, separator) = (self.block.cells, self.separator.name());
        Err(InputError::new(
            self.name,
            format!(
                "the header has {names} cells where the rows from line {} on have {cells}, separated by {separator}",
                self.data_line()
            ),
            "give every column one name, in quotes if it contains the separator",
        )
        .at(Place::Line(line)))
    }

    /// Whether commas separate both the cells and the decimals: only whole numbers, more than there are names or with leading
    /// zeros.
    fn is_comma_both(&self, samples: &[(u64, Vec<&str>)], names: usize) -> bool {
        let cells = || samples.iter().flat_map(|(_, row)| row);
        let is_whole = |cell: &&&str| {
            let digits = cell.trim_start_matches(['-', '+']);
            digits.bytes().all(|byte| byte.is_ascii_digit())
        };
        let is_quoted = self
            .block
            .rows
            .iter()
            .any(|&row| self.rows[row].text.contains('"'));
        !is_quoted
            && cells().all(|cell| is_whole(&cell))
            && (cells().any(|cell| numbers::is_padded(cell))
                || (names > 0 && self.block.cells > names))
    }

    fn comma_both(&self, line: u64) -> InputError {
        InputError::new(
            self.name,
            "the comma separates the cells and is also the decimal sign, so every number is ambiguous",
            "export it again with a semicolon or a tab between the cells, or with a decimal point",
        )
        .at(Place::Line(line))
    }
}
