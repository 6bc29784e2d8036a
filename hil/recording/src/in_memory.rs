//! Recordings from columns in memory, for programs that read files themselves.

use std::path::Path;

use mesh_damper_output::error::InputError;
use mesh_damper_tables::files::{GivenColumn, Kept, Needs, Reading, in_memory};

use crate::Recording;

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
    /// use mesh_damper_tables::files::Reading;
    ///
    /// let time: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i)).collect();
    /// let displacement: Vec<f64> = time.iter().map(|t| (6.3 * t).sin()).collect();
    /// let force = displacement.iter().map(|y| 8000.0 * y).collect();
    /// let columns = [("time_s", time), ("displacement_mm", displacement), ("force_N", force)];
    /// let recording = Recording::of_columns("a spring", columns, &Reading::default())?;
    /// assert!((recording.force[20] - 8.0 * recording.displacement[20]).abs() < 1e-12);
    /// # Ok::<(), mesh_damper_output::error::InputError>(())
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
        let memory = in_memory(&name, columns)?;
        Self::of(Path::new(&name), memory, reading, Kept::Channels, needs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh_damper_tables::files::Column;

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
