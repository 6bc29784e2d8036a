//! Recordings of columns in memory, as a program that reads files of its own has them.

use super::faults::{Channel, ChannelFault, ChannelFaultKind};
use super::read::{Column, Columns};
use super::rows::RowLines;
use super::units::Units;
use super::{ControlChannel, Recording};
use crate::csv_text::number;
use crate::error::{InputError, Place};

impl Recording {
    /// A recording of columns that are named as those of a file are: `time_s`, `displacement_mm`, `force_N`, `current_A`. What the
    /// file's reader does with rows is done here: a row whose displacement or force is NaN, as a blank cell is, is left out, and so
    /// is one that repeats the row before; a control input that is NaN is as it was last. Other columns are ignored.
    ///
    /// # Errors
    /// As [`Recording::read`]; columns of different lengths. A place is a row, counted from 1.
    ///
    /// ```
    /// use mesh_damper_recording::Recording;
    ///
    /// let time: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
    /// let displacement: Vec<f64> = time.iter().map(|t| (6.3 * t).sin()).collect();
    /// let force = displacement.iter().map(|y| 8000.0 * y).collect();
    /// let columns = [("time_s", time), ("displacement_mm", displacement), ("force_N", force)];
    /// let recording = Recording::of_columns("a spring", columns)?;
    /// assert!((recording.force[20] - 8.0 * recording.displacement[20]).abs() < 1e-12);
    /// # Ok::<(), mesh_damper_recording::error::InputError>(())
    /// ```
    pub fn of_columns<N: Into<String>>(
        name: impl Into<String>,
        columns: impl IntoIterator<Item = (N, Vec<f64>)>,
    ) -> Result<Self, InputError> {
        let recording = Self::gathered(name.into(), columns, Channel::is_required)?;
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
    ) -> Result<Self, InputError> {
        let needed = |channel: Channel| channel.is_required() && channel != Channel::Force;
        let mut recording = Self::gathered(name.into(), columns, needed)?;
        if recording.force.is_empty() {
            recording.force = vec![0.0; recording.time.len()];
        }
        recording.check()?;
        Ok(recording)
    }

    /// Of the rows of the file or the columns that it was made of, counted from 0, those that are samples.
    pub fn rows(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).map(|sample| self.line(sample).saturating_sub(1) as usize)
    }

    /// The channels of columns, of which those that are not `needed` may be missing, which leaves them empty. They are still to be
    /// checked.
    pub(super) fn gathered<N: Into<String>>(
        name: String,
        columns: impl IntoIterator<Item = (N, Vec<f64>)>,
        needed: impl Fn(Channel) -> bool,
    ) -> Result<Self, InputError> {
        let (names, values): (Vec<String>, Vec<Vec<f64>>) = columns
            .into_iter()
            .map(|(name, values)| (name.into(), values))
            .unzip();
        let header = csv::StringRecord::from(names.as_slice());
        let found = Columns::find(&name, &header, &needed)?;
        let rows = values.first().map_or(0, Vec::len);
        if let Some(other) = values.iter().position(|column| column.len() != rows) {
            let problem = format!(
                "{} rows, and {} has {rows}",
                values[other].len(),
                names.first().map_or("", String::as_str)
            );
            let mend = "give every column the same number of rows";
            let place = Place::Column(names[other].clone());
            return Err(InputError::new(name, problem, mend).at(place));
        }

        let mut channels = vec![Vec::with_capacity(rows); found.used.len()];
        let mut controls: Vec<Control<'_>> = (found.controls.iter())
            .map(|&index| Control::new(&names[index], &values[index]))
            .collect();
        let mut lines = RowLines::default();
        let (mut blank, mut first_blank, mut repeated) = (0, None, 0);
        let value = |column: &Column, row: usize| values[column.index][row];
        for row in 0..rows {
            let line = row as u64 + 1;
            let at = |column: &Column| value(column, row);
            controls.iter_mut().for_each(|control| control.see(row));
            let is_blank = |column: &&Column| column.may_be_blank() && at(column).is_nan();
            if let Some(column) = found.used.iter().find(is_blank) {
                blank += 1;
                first_blank = first_blank.or(Some((line, column.index)));
                continue;
            }
            if let Some(column) = found.used.iter().find(|column| !at(column).is_finite()) {
                return Err(not_finite(&name, line, &names[column.index], at(column)));
            }
            let scaled = |column: &Column| at(column) * column.unit.scale;
            let is_last =
                |(channel, column): (&Vec<f64>, &Column)| channel.last() == Some(&scaled(column));
            if channels.iter().zip(&found.used).all(is_last) {
                repeated += 1;
                continue;
            }
            for (channel, column) in channels.iter_mut().zip(&found.used) {
                channel.push(scaled(column));
            }
            controls.iter_mut().for_each(Control::keep);
            lines.push(line);
        }
        if let Some((line, column)) = first_blank
            && blank > lines.len()
        {
            return Err(not_finite(&name, line, &names[column], f64::NAN));
        }

        let mut recording = Self {
            name,
            time: Vec::new(),
            displacement: Vec::new(),
            force: Vec::new(),
            velocity: None,
            temperature: None,
            controls: controls.into_iter().filter_map(Control::channel).collect(),
            comments: Vec::new(),
            units: Units::default(),
            source: None,
            lines,
            faults: Vec::new(),
        };
        if repeated > 0 {
            recording.faults.push(ChannelFault {
                channel: Channel::Time,
                kind: ChannelFaultKind::Repeated { samples: repeated },
            });
        }
        recording.fill(found.used, channels);
        Ok(recording)
    }
}

/// As a file's reader says it of a cell.
fn not_finite(name: &str, line: u64, column: &str, value: f64) -> InputError {
    let said = number(&value.to_string()).err();
    let (problem, mend) = said.unwrap_or_default();
    InputError::new(name, problem, mend).at(Place::Cell {
        line,
        column: column.into(),
    })
}

/// A control input while its column is gone through.
struct Control<'c> {
    name: &'c str,
    column: &'c [f64],
    /// What it was last; NaN before it first was a number.
    now: f64,
    values: Vec<f64>,
}

impl<'c> Control<'c> {
    fn new(name: &'c str, column: &'c [f64]) -> Self {
        Self {
            name,
            column,
            now: f64::NAN,
            values: Vec::with_capacity(column.len()),
        }
    }

    fn see(&mut self, row: usize) {
        if !self.column[row].is_nan() {
            self.now = self.column[row];
        }
    }

    fn keep(&mut self) {
        self.values.push(self.now);
    }

    /// Before it first was a number it was as it was then; of one that never was, nothing is known.
    fn channel(mut self) -> Option<ControlChannel> {
        let first = self.values.iter().position(|value| !value.is_nan())?;
        let (before, since) = self.values.split_at_mut(first);
        before.fill(since[0]);
        Some(ControlChannel {
            name: self.name.to_owned(),
            values: self.values,
        })
    }
}
