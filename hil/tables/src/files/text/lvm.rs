//! LabVIEW measurement files: a header of the file, one per segment, and rows of numbers.

use mesh_damper_output::error::InputError;

use super::lines::{Cells, Separator};
use super::numbers::{Cell, Numbers};
use super::rows::{Row, RowKind};
use crate::budget::Budget;
use crate::files::table::{Clock, Column};

/// The end of a header.
pub(super) const END: &str = "***End_of_Header***";
/// The name of the last column, which holds words.
pub(super) const REMARK: &str = "Comment";
/// The name of a column of times.
const X_VALUE: &str = "X_Value";
/// Fields that must be the same in all segments of a table.
const FIXED: [&str; 4] = ["Y_Unit_Label", "Delta_X", "X_Dimension", "Channels"];

/// The columns according to the header of the first segment.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Segment {
    /// The unit of each channel.
    units: Vec<String>,
    /// Whether the columns called `X_Value` are times, in seconds: the format has no other unit for them.
    is_over_time: bool,
    /// Whether a column contains them.
    has_x: bool,
    /// Start and step of each channel, as written.
    starts: Vec<String>,
    steps: Vec<String>,
    /// Lines that must be the same in all segments. Of different lines with one first cell there are two, which no line can equal.
    pub fixed: Vec<Vec<String>>,
}

/// Bytes held for a cell of a line, besides its characters, in one list and in another.
const OF_TEXT: u64 = 2 * size_of::<String>() as u64;

impl Segment {
    /// The segment whose names are in line `header`.
    ///
    /// # Errors
    /// The budget has no room for its lines.
    pub fn of(
        rows: &[Row],
        header: Option<u64>,
        separator: Separator,
        budget: &Budget,
    ) -> Result<Self, InputError> {
        let header = header.unwrap_or(u64::MAX);
        let mut segment = Self {
            is_over_time: true,
            has_x: true,
            ..Self::default()
        };
        let mut split = Cells::of(budget);
        for row in rows.iter().take_while(|row| row.line < header) {
            if row.kind != RowKind::Cells {
                continue;
            }
            let cells = split.split(separator, row.text)?;
            let kept = OF_TEXT * cells.len() as u64 + 2 * row.text.len() as u64;
            budget.hold(kept, "the header of its first segment")?;
            let values =
                || -> Vec<String> { cells[1..].iter().map(|cell| (*cell).to_owned()).collect() };
            match cells[0] {
                "Y_Unit_Label" => segment.units = values(),
                "X_Dimension" => {
                    segment.is_over_time = cells[1..]
                        .iter()
                        .all(|cell| cell.is_empty() || *cell == "Time");
                }
                "X_Columns" => segment.has_x = cells.get(1) != Some(&"No"),
                "X0" => segment.starts = values(),
                "Delta_X" => segment.steps = values(),
                _ => {}
            }
            if FIXED.contains(&cells[0]) {
                let bare = super::header::bare(cells);
                let known = || segment.fixed.iter().filter(|known| known[0] == cells[0]);
                if known().count() < 2 && known().all(|known| known != bare) {
                    let bare = bare.iter().map(|cell| (*cell).to_owned());
                    segment.fixed.push(bare.collect());
                }
            }
        }
        Ok(segment)
    }

    /// Adds the header's statements to the columns. Returns, of several columns of times, those that must equal the first.
    pub fn apply(&self, columns: &mut [Column]) -> Vec<(usize, usize)> {
        let mut same = Vec::new();
        let mut first = None;
        let mut channel = 0;
        for (index, column) in columns.iter_mut().enumerate() {
            if column.name.split(" #").next() != Some(X_VALUE) {
                let unit = self.units.get(channel).filter(|unit| !unit.is_empty());
                column.unit = unit.cloned().or(column.unit.take());
                channel += 1;
                continue;
            }
            if !self.has_x || !self.is_over_time {
                column.is_numeric = false;
                continue;
            }
            match first {
                None => {
                    first = Some(index);
                    column.is_time = true;
                    column.unit = Some("s".into());
                }
                Some(first) => {
                    same.push((index, first));
                    column.is_numeric = false;
                }
            }
        }
        same
    }

    /// The clock in the header, if no column has the times and all channels have the same clock.
    pub fn clock(&self, numbers: Numbers) -> Option<(Clock, String)> {
        let one = |texts: &[String]| {
            let mut values = texts.iter().filter(|text| !text.is_empty());
            let first = values.next()?;
            let Cell::Number(value) = numbers.read(first) else {
                return None;
            };
            values.all(|other| other == first).then_some(value)
        };
        let (start, step) = (one(&self.starts).unwrap_or(0.0), one(&self.steps)?);
        let is_clock = self.is_over_time && !self.has_x && step > 0.0;
        let said = format!(
            "no column has the times; they are computed from the header: X0 = {start} s, Delta_X = {step} s"
        );
        is_clock.then_some((Clock { start, step }, said))
    }
}
