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

    /// As [`Recording::to_file`], with two more columns, `predicted_band_UNIT` and `predicted_force_UNIT`, in the recording's own
    /// unit. They replace columns of these names that the recording already has. `predicted` and its half width `band` are in kN,
    /// one value per sample.
    ///
    /// # Errors
    /// As for [`Recording::to_file`]; a predicted value that is not finite.
    pub fn to_file_with_prediction(
        &self,
        path: &Path,
        predicted: &[f64],
        band: &[f64],
    ) -> Result<Vec<u8>, InputError> {
        self.written(path, Some([band, predicted]))
    }

    fn written(&self, path: &Path, predicted: Option<[&[f64]; 2]>) -> Result<Vec<u8>, InputError> {
        let format = WriteAs::of(path).unwrap_or(WriteAs::Csv);
        let name = path.display().to_string();
        let predictions = ["predicted_band", "predicted_force"].into_iter();
        for (column, values) in predictions.zip(predicted.into_iter().flatten()) {
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
            || self.columns(predicted),
            || self.to_csv(predicted),
        )
    }

    /// The columns that the recording was read from if they are numbers, else the recording's channels.
    fn columns(&self, predicted: Option<[&[f64]; 2]>) -> Columns {
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
                let each = self.channels().into_iter().map(|(name, unit, values)| {
                    let of = |value: &f64| unit.map_or(*value, |unit| unit.from_code(*value));
                    (name, values.iter().map(of).collect())
                });
                each.collect()
            }
        };
        let unit = self.units.force;
        for (name, values) in ["predicted_band", "predicted_force"]
            .into_iter()
            .zip(predicted.into_iter().flatten())
        {
            let name = format!("{name}_{}", unit.symbol);
            columns.retain(|(known, _)| *known != name);
            columns.push((
                name,
                values.iter().map(|value| unit.from_code(*value)).collect(),
            ));
        }
        columns
    }

    /// For each channel: the name of its column, its unit (none for a control input) and its samples.
    fn channels(&self) -> Vec<(String, Option<Unit>, &[f64])> {
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

impl Recording {
    /// The recording as text. A recording that was read from a text is written with the same cells.
    fn to_csv(&self, predicted: Option<[&[f64]; 2]>) -> Result<Vec<u8>, Unwritten> {
        let mut bytes = Vec::new();
        for comment in &self.comments {
            bytes.extend(comment_line(comment).bytes());
        }
        let unit = self.units.force.symbol;
        let columns = ["predicted_band", "predicted_force"].map(|name| format!("{name}_{unit}"));
        let channels = self.channels();
        let header: csv::StringRecord = match &self.source {
            Some(source) => source.header.clone(),
            None => channels.iter().map(|(name, ..)| name).collect(),
        };
        let is_replaced: Vec<bool> = header
            .iter()
            .map(|name| predicted.is_some() && columns.iter().any(|column| column == name))
            .collect();
        // A first cell that looks like a comment is quoted.
        let mut writer = csv::WriterBuilder::new()
            .comment(Some(b'#'))
            .from_writer(bytes);
        let mut line = |cells: &csv::StringRecord, last: Option<[String; 2]>| {
            let kept = cells
                .iter()
                .zip(&is_replaced)
                .filter(|(_, is_replaced)| !**is_replaced)
                .map(|(cell, _)| guarded(cell).into_owned());
            writer
                .write_record(kept.chain(last.into_iter().flatten()))
                .map_err(Unwritten::by)
        };
        line(&header, predicted.is_some().then(|| columns.clone()))?;
        let mut cells = self.source.iter().flat_map(|source| source.rows.cells());
        let needs_all = channels.iter().map(|(name, unit, values)| {
            unit.is_some_and(|unit| needs_all_digits(name, unit, values))
        });
        let needs_all: Vec<bool> = needs_all.collect();
        let mut row = csv::StringRecord::new();
        for index in 0..self.len() {
            let force = predicted.map(|both| {
                both.map(|values| {
                    let force = values.get(index).copied().unwrap_or_default();
                    decimal(self.units.force.from_code(force))
                })
            });
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
            line(&row, force)?;
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
