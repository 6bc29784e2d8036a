//! Writes a recording as the bytes of a file, in the format of the file's ending.

use std::path::Path;

use mesh_damper_output::error::InputError;
use mesh_damper_output::finite::check_column;
use mesh_damper_tables::csv_text::{is_blank, number};
use mesh_damper_tables::units::Unit;
use mesh_damper_tables::write::{
    Columns, DIGITS, Unwritten, WriteAs, comment_line, decimal, guarded,
};

use super::Recording;

/// What a model predicts for the motion of a recording, one value per sample.
pub struct Prediction {
    /// The force, kN: the column `predicted_force_UNIT`, in the recording's own unit.
    pub force: Vec<f64>,
    /// Half the width of the band about it, kN: the column `predicted_band_UNIT`.
    pub band: Vec<f64>,
    /// How far the motion is beyond the operating range, as a fraction of the range, 0 within: the column `predicted_beyond`.
    pub beyond: Vec<f64>,
}

/// The name of a column, the unit it is written in (none if it has no other than in the code), and its samples.
type Channel<'a> = (String, Option<Unit>, &'a [f64]);

impl Prediction {
    fn columns(&self, unit: Unit) -> [Channel<'_>; 3] {
        let of_force = |name: &str| format!("{name}_{}", unit.symbol);
        [
            ("predicted_beyond".to_owned(), None, &self.beyond),
            (of_force("predicted_band"), Some(unit), &self.band),
            (of_force("predicted_force"), Some(unit), &self.force),
        ]
    }
}

impl Recording {
    /// The recording as a file of the given name, in the format of the name's ending: see [`WriteAs`].
    ///
    /// A recording that was read from a text keeps its text: cell by cell in a text format, as columns of numbers in the other
    /// formats.
    ///
    /// # Errors
    /// A sample that was computed and is not finite; a recording that the format cannot hold.
    pub fn to_file(&self, path: &Path) -> Result<Vec<u8>, InputError> {
        self.written(path, None)
    }

    /// As [`Recording::to_file`], with the columns of a prediction. They replace columns of these names that the recording already has.
    ///
    /// # Errors
    /// As for [`Recording::to_file`]; a predicted value that is not finite.
    pub fn to_file_with_prediction(
        &self,
        path: &Path,
        prediction: &Prediction,
    ) -> Result<Vec<u8>, InputError> {
        self.written(path, Some(prediction))
    }

    fn written(&self, path: &Path, predicted: Option<&Prediction>) -> Result<Vec<u8>, InputError> {
        let format = WriteAs::of(path).unwrap_or(WriteAs::Csv);
        let name = path.display().to_string();
        let force = self.units.force;
        let predicted = predicted.map(|prediction| prediction.columns(force));
        for (column, _, values) in predicted.iter().flatten() {
            check_column(&name, column, values)?;
        }
        // A text that was read may lack a value.
        if self.source.is_none() {
            for (column, _, values) in self.channels() {
                check_column(&name, &column, values)?;
            }
        }
        format.bytes(
            path,
            &self.comments,
            || self.columns(predicted.as_ref()),
            || self.to_csv(predicted.as_ref()),
        )
    }

    /// The columns that the recording was read from if they are numbers, else the recording's channels.
    fn columns(&self, predicted: Option<&[Channel; 3]>) -> Columns {
        let mut columns: Columns = match &self.source {
            Some(source) => {
                let mut columns: Vec<Option<(String, Vec<f64>)>> = (source.header.iter())
                    .map(|name| Some((name.to_owned(), Vec::new())))
                    .collect();
                let count = columns.len().max(1);
                for (index, cell) in source.rows.cells().enumerate() {
                    let Some(column) = columns.get_mut(index % count) else {
                        break;
                    };
                    let Some((_, values)) = column else { continue };
                    match number(cell) {
                        Ok(value) => values.push(value),
                        Err(_) if is_blank(cell.trim()) => {
                            values.push(f64::NAN);
                        }
                        Err(_) => *column = None,
                    }
                }
                let mut columns: Columns = columns.into_iter().flatten().collect();
                // The text behind the last cell is no column.
                columns
                    .iter_mut()
                    .for_each(|(_, values)| values.truncate(self.len()));
                columns
            }
            None => {
                let each = self.channels().into_iter();
                each.map(|channel| (channel.0.clone(), in_its_unit(&channel)))
                    .collect()
            }
        };
        for channel in predicted.into_iter().flatten() {
            columns.retain(|(known, _)| *known != channel.0);
            columns.push((channel.0.clone(), in_its_unit(channel)));
        }
        columns
    }

    fn channels(&self) -> Vec<Channel<'_>> {
        let units = &self.units;
        let channels = [
            ("time", units.time, Some(&self.time)),
            ("displacement", units.displacement, Some(&self.displacement)),
            ("force", units.force, Some(&self.force)),
            ("velocity", units.velocity, self.velocity.as_ref()),
            ("temperature", units.temperature, self.temperature.as_ref()),
        ]
        .into_iter()
        .filter_map(|(name, unit, channel)| {
            let name = format!("{name}_{}", unit.symbol);
            Some((name, Some(unit), channel?.as_slice()))
        });
        let controls = self.controls.iter();
        let controls = controls.map(|each| (each.name.clone(), None, each.values.as_slice()));
        channels.chain(controls).collect()
    }
}

fn in_its_unit((_, unit, values): &Channel) -> Vec<f64> {
    let each = values.iter();
    each.map(|value| unit.map_or(*value, |unit| unit.from_code(*value)))
        .collect()
}

impl Recording {
    /// The recording as text. A recording that was read from a text is written with the same cells.
    fn to_csv(&self, predicted: Option<&[Channel; 3]>) -> Result<Vec<u8>, Unwritten> {
        let mut bytes = Vec::new();
        for comment in &self.comments {
            bytes.extend(comment_line(comment).bytes());
        }
        let columns = || predicted.into_iter().flatten();
        let channels = self.channels();
        let header: csv::StringRecord = match &self.source {
            Some(source) => source.header.clone(),
            None => channels.iter().map(|(name, ..)| name).collect(),
        };
        let is_replaced: Vec<bool> = header
            .iter()
            .map(|name| columns().any(|(column, ..)| column == name))
            .collect();
        // A first cell that looks like a comment is quoted.
        let mut writer = csv::WriterBuilder::new()
            .comment(Some(b'#'))
            .from_writer(bytes);
        let mut line = |cells: &csv::StringRecord, last: Vec<String>| {
            let kept = cells
                .iter()
                .zip(&is_replaced)
                .filter(|(_, is_replaced)| !**is_replaced)
                .map(|(cell, _)| guarded(cell).into_owned());
            writer.write_record(kept.chain(last)).map_err(Unwritten::by)
        };
        line(&header, columns().map(|(name, ..)| name.clone()).collect())?;
        let mut cells = self.source.iter().flat_map(|source| source.rows.cells());
        let needs_all = channels.iter().map(|(name, unit, values)| {
            unit.is_some_and(|unit| needs_all_digits(name, unit, values))
        });
        let needs_all: Vec<bool> = needs_all.collect();
        let mut row = csv::StringRecord::new();
        for index in 0..self.len() {
            let predicted = columns().map(|(_, unit, values)| {
                let value = values.get(index).copied().unwrap_or_default();
                decimal(unit.map_or(value, |unit| unit.from_code(value)))
            });
            let predicted = predicted.collect();
            row.clear();
            match &self.source {
                Some(_) => row.extend(cells.by_ref().take(header.len())),
                None => row.extend(channels.iter().zip(&needs_all).map(
                    |((_, unit, channel), &all)| {
                        let value = channel.get(index).copied().unwrap_or_default();
                        let value = unit.map_or(value, |unit| unit.from_code(value));
                        if all {
                            value.to_string()
                        } else {
                            decimal(value)
                        }
                    },
                )),
            }
            line(&row, predicted)?;
        }
        writer.into_inner().map_err(Unwritten::by)
    }
}

/// Whether nine digits would change the recording: times that count from so far away that a step is less than a hundred of the last
/// digits, or a displacement that would stand still.
fn needs_all_digits(name: &str, unit: Unit, values: &[f64]) -> bool {
    let written = |value: &f64| unit.from_code(*value);
    if name.starts_with("time") {
        let last = values
            .iter()
            .map(written)
            .fold(0.0, |most: f64, value| most.max(value.abs()));
        let digit = 10_f64.powi(last.log10().floor() as i32 + 1 - DIGITS as i32);
        let steps = values
            .windows(2)
            .map(|pair| written(&pair[1]) - written(&pair[0]));
        return steps.fold(f64::INFINITY, f64::min) < 100.0 * digit;
    }
    let is_first = |value: &f64| decimal(written(value)) == decimal(written(&values[0]));
    name.starts_with("displacement") && values.iter().all(is_first)
}
