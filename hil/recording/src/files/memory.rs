//! Columns in memory, as a program that reads files of its own has them.

use std::path::Path;

use super::{Column, Kept, Table, Tables, Values, Wanted};
use crate::Recording;
use crate::channel::Channel;
use crate::error::{InputError, Place};
use crate::files::Reading;
use crate::rows::RowLines;

/// One table of columns.
struct Memory {
    name: String,
    tables: [Table; 1],
    values: Vec<Vec<f64>>,
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
        let mut lines = RowLines::default();
        let rows = self.values.first().map_or(0, Vec::len) as u64;
        (1..=rows).for_each(|row| lines.push(row));
        let mut columns = Vec::with_capacity(wanted.len());
        for wanted in wanted {
            let values = std::mem::take(&mut self.values[wanted.column]);
            if let Some(row) = values.iter().position(|value| value.is_infinite()) {
                let place = Place::Cell {
                    line: row as u64 + 1,
                    column: self.tables[0].columns[wanted.column].name.clone(),
                };
                let problem = format!("\"{}\" is not finite", values[row]);
                let mend = "remove the row or mend the value";
                return Err(InputError::new(&self.name, problem, mend).at(place));
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
    /// A recording of columns in memory, whose names are taken as those of a file are: `time_s`, `Force [kN]`, `current_A`; what
    /// `reading` says of them counts first. What is done with the rows of a file is done here: a row whose displacement or force is
    /// NaN, as a blank cell is, is left out, and so is one that repeats the row before; a control input that is NaN is as it was
    /// last. Other columns are ignored.
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
    pub fn of_columns<N: Into<String>>(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = (N, Vec<f64>)>,
        reading: &Reading,
    ) -> Result<Self, InputError> {
        let recording = Self::gathered(name.into(), columns, reading, &Channel::is_required)?;
        recording.check()?;
        Ok(recording)
    }

    /// The same of columns that need no force, because only the motion counts: without one the force is 0.
    ///
    /// # Errors
    /// As [`Recording::of_columns`].
    pub fn motion_of_columns<N: Into<String>>(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = (N, Vec<f64>)>,
        reading: &Reading,
    ) -> Result<Self, InputError> {
        Self::motion_of(|needed| Self::gathered(name.into(), columns, reading, needed))
    }

    /// Of the rows of the columns that it was made of, counted from 0, those that are samples; of a file, its lines.
    pub fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).map(|sample| self.line(sample).saturating_sub(1) as usize)
    }

    /// The channels of columns, of which those that are not `needed` may be missing, which leaves them empty. They are still to be
    /// checked.
    pub(crate) fn gathered<N: Into<String>>(
        name: String,
        columns: impl IntoIterator<Item = (N, Vec<f64>)>,
        reading: &Reading,
        needed: &dyn Fn(Channel) -> bool,
    ) -> Result<Self, InputError> {
        let (names, values): (Vec<String>, Vec<Vec<f64>>) = columns
            .into_iter()
            .map(|(name, values)| (name.into(), values))
            .unzip();
        let rows = values.first().map_or(0, Vec::len);
        if let Some(other) = values.iter().position(|column| column.len() != rows) {
            let problem = format!("{} rows, and {} has {rows}", values[other].len(), names[0]);
            let mend = "give every column the same number of rows";
            let place = Place::Column(names[other].clone());
            return Err(InputError::new(name, problem, mend).at(place));
        }
        let columns = names.into_iter().zip(&values).map(|(name, values)| Column {
            name,
            is_numeric: true,
            first: values.iter().copied().take(Column::FIRST).collect(),
            ..Column::default()
        });
        let table = Table {
            columns: columns.collect(),
            rows: Some(rows as u64),
            ..Table::default()
        };
        let memory = Memory {
            name: name.clone(),
            tables: [table],
            values,
        };
        Self::of(
            Path::new(&name),
            Box::new(memory),
            reading,
            Kept::Channels,
            needed,
        )
    }
}
