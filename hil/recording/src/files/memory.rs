//! Columns in memory, for programs that read files themselves.

use std::path::Path;

use super::{Column, Kept, Needs, Reading, Table, Tables, Values, Wanted};
use crate::Recording;
use crate::error::{InputError, Place};
use crate::rows::RowLines;

/// A column in memory, with information in addition to its name.
#[derive(Clone, Debug)]
pub struct GivenColumn {
    /// Its name, its unit if that is stated elsewhere, and whether it holds the times. The rest is determined.
    pub column: Column,
    /// Its values, NaN for a missing one; or why they are not numbers, for example `holds words`.
    pub values: Result<Vec<f64>, String>,
}

impl<N: Into<String>> From<(N, Vec<f64>)> for GivenColumn {
    fn from((name, values): (N, Vec<f64>)) -> Self {
        Self {
            column: Column {
                name: name.into(),
                ..Column::default()
            },
            values: Ok(values),
        }
    }
}

impl GivenColumn {
    /// Findings from its values, as for a file's column.
    fn looked_at(self) -> (Column, Result<Vec<f64>, String>) {
        let first = self.values.iter().flatten().copied();
        let column = Column {
            name: self.column.name.trim().to_owned(),
            is_numeric: self.values.is_ok(),
            first: first.take(Column::FIRST).collect(),
            ..self.column
        };
        (column, self.values)
    }
}

/// One table of columns.
struct Memory {
    name: String,
    tables: [Table; 1],
    rows: usize,
    values: Vec<Result<Vec<f64>, String>>,
}

impl Tables for Memory {
    fn tables(&self) -> &[Table] {
        &self.tables
    }

    fn read(
        mut self: Box<Self>,
        _: usize,
        wanted: &[Wanted],
        _: Kept,
    ) -> Result<Values, InputError> {
        let lines = RowLines::of_samples(self.rows);
        let mut columns = Vec::with_capacity(wanted.len());
        for (place, one) in wanted.iter().enumerate() {
            let name = || self.tables[0].columns[one.column].name.clone();
            let is_wanted_again =
                (wanted[place + 1..].iter()).any(|other| other.column == one.column);
            let values = match &mut self.values[one.column] {
                Ok(values) if is_wanted_again => values.clone(),
                Ok(values) => std::mem::take(values),
                Err(_) if !one.must_be_numeric => {
                    columns.push(None);
                    continue;
                }
                Err(problem) => {
                    let error = InputError::new(&self.name, &*problem, "give a column of numbers");
                    return Err(error.at(Place::Column(name())));
                }
            };
            if let Some(row) = values.iter().position(|value| value.is_infinite()) {
                let place = lines.place(row, Some(&name()));
                let problem = format!("\"{}\" is not finite", values[row]);
                let remedy = "remove the row or correct the value";
                return Err(InputError::new(&self.name, problem, remedy).at(place));
            }
            columns.push(Some(values));
        }
        Ok(Values {
            columns,
            lines,
            ..Values::default()
        })
    }
}

impl Recording {
    /// A recording from columns in memory, whose names are interpreted like those of a file: `time_s`, `Force [kN]`, `current_A`.
    /// The settings in `reading` have precedence. Rows are treated like those of a file. A row whose displacement or force is NaN,
    /// like a blank cell, is left out, and so is one that repeats the row before. A control input that is NaN keeps its last value.
    /// Other columns are ignored.
    ///
    /// # Errors
    /// As [`Recording::read`]; columns of different lengths. A place is a row, counted from 1.
    ///
    /// ```
    /// use mesh_damper_recording::Recording;
    /// use mesh_damper_recording::files::Reading;
    ///
    /// let time: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
    /// let displacement: Vec<f64> = time.iter().map(|t| (6.3 * t).sin()).collect();
    /// let force = displacement.iter().map(|y| 8000.0 * y).collect();
    /// let columns = [("time_s", time), ("displacement_mm", displacement), ("force_N", force)];
    /// let recording = Recording::of_columns("a spring", columns, &Reading::default())?;
    /// assert!((recording.force[20] - 8.0 * recording.displacement[20]).abs() < 1e-12);
    /// # Ok::<(), mesh_damper_recording::error::InputError>(())
    /// ```
    pub fn of_columns(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = impl Into<GivenColumn>>,
        reading: &Reading,
    ) -> Result<Self, InputError> {
        Self::of_columns_for(name, columns, reading, &Needs::default())
    }

    /// The same for callers with their own requirements. Without a force, if none is needed, it is 0.
    ///
    /// # Errors
    /// As [`Recording::of_columns`], and a control input that is needed and not there.
    pub fn of_columns_for(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = impl Into<GivenColumn>>,
        reading: &Reading,
        needs: &Needs,
    ) -> Result<Self, InputError> {
        Self::gathered(name.into(), columns, reading, needs)?.checked()
    }

    /// The rows of its columns, counted from 0, that are samples; for a file, its lines.
    pub fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).map(|sample| self.line(sample).saturating_sub(1) as usize)
    }

    /// The channels of columns. Channels that are not needed may be missing, and are empty then. They are not checked yet.
    pub(crate) fn gathered(
        name: String,
        columns: impl IntoIterator<Item = impl Into<GivenColumn>>,
        reading: &Reading,
        needs: &Needs,
    ) -> Result<Self, InputError> {
        let given: Vec<GivenColumn> = columns.into_iter().map(Into::into).collect();
        let mut lengths = given.iter().filter_map(|each| {
            let values = each.values.as_ref().ok()?;
            Some((each.column.name.as_str(), values.len()))
        });
        let (first, rows) = lengths.next().unwrap_or_default();
        if let Some((other, length)) = lengths.find(|(_, length)| *length != rows) {
            let problem = format!("{length} rows, and {first} has {rows}");
            let remedy = "give every column the same number of rows";
            let place = Place::Column(other.into());
            return Err(InputError::new(name, problem, remedy).at(place));
        }
        let (columns, values) = given.into_iter().map(GivenColumn::looked_at).unzip();
        let table = Table {
            columns,
            rows: Some(rows as u64),
            ..Table::default()
        };
        let memory = Memory {
            name: name.clone(),
            tables: [table],
            rows,
            values,
        };
        Self::of(
            Path::new(&name),
            Box::new(memory),
            reading,
            Kept::Channels,
            needs,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_and_durations_are_seconds_whatever_unit_is_said() {
        let read = |name: &str, unit: &str| {
            let stamps = GivenColumn {
                column: Column {
                    name: name.into(),
                    unit: Some("s".into()),
                    is_stamp: true,
                    ..Column::default()
                },
                values: Ok((0..100).map(|i| 0.01 * f64::from(i)).collect()),
            };
            let wave = |scale: f64| (0..100).map(move |i| scale * (0.1 * f64::from(i)).sin());
            let columns = [
                stamps,
                ("displacement_mm", wave(1.0).collect::<Vec<f64>>()).into(),
                ("force_kN", wave(2.0).collect::<Vec<f64>>()).into(),
            ];
            let reading = Reading {
                units: vec![("time".into(), unit.into())],
                ..Reading::default()
            };
            Recording::of_columns("a", columns, &reading)
        };
        for name in ["time_ms", "Time (ms)", "Zeit", "Datum"] {
            let error = read(name, "ms").unwrap_err().to_string();
            assert!(
                error.contains(
                    "its dates or times of day are read as seconds, and --unit time=ms says ms"
                ),
                "{error}"
            );
            assert_eq!(read(name, "s").unwrap().time[99], 0.99, "{name}");
        }
    }
}
