//! A recording as the bytes of a file.

use std::io::Write as _;
use std::path::Path;

use super::Recording;
use super::units::Unit;

/// Significant digits with which numbers made here are written: a thousandth of a 24-bit converter's step.
const DIGITS: usize = 9;

impl Recording {
    /// The recording as a file of the given name, gzipped when the name ends in `.gz`.
    ///
    /// A recording that was read is written as it was read, cell by cell.
    pub fn to_file(&self, path: &Path) -> Vec<u8> {
        packed(path, self.to_csv(None))
    }

    /// The same with columns `predicted_band_UNIT` and `predicted_force_UNIT`, in the recording's own unit; columns of these names which the
    /// recording has already are replaced. `predicted` and `band`, its half width, in kN, one per sample.
    pub fn to_file_with_prediction(&self, path: &Path, predicted: &[f64], band: &[f64]) -> Vec<u8> {
        packed(path, self.to_csv(Some([band, predicted])))
    }

    fn to_csv(&self, predicted: Option<[&[f64]; 2]>) -> Vec<u8> {
        let mut bytes = Vec::new();
        for comment in &self.comments {
            bytes.extend(format!("# {}\n", comment.replace(['\n', '\r'], " ")).bytes());
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
        // A first cell that begins as a comment does is quoted.
        let mut writer = csv::WriterBuilder::new()
            .comment(Some(b'#'))
            .from_writer(bytes);
        let mut line = |cells: &csv::StringRecord, last: Option<[String; 2]>| {
            let kept = cells
                .iter()
                .zip(&is_replaced)
                .filter(|(_, is_replaced)| !**is_replaced)
                .map(|(cell, _)| cell.to_owned());
            // Writing to memory does not fail, and every row has as many cells as the header.
            let _ = writer.write_record(kept.chain(last.into_iter().flatten()));
        };
        line(&header, predicted.is_some().then(|| columns.clone()));
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
            line(&row, force);
        }
        writer.into_inner().unwrap_or_default()
    }

    /// Each channel's column name, its unit, none of a control input, and its samples.
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

/// Whether a channel's own digits would make another recording of it: times that count from far away, of which a step is less than a
/// hundred of the last digits, or a displacement that would not change any more.
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

/// `value` to nine significant digits, as recordings are written, without trailing zeros or an exponent.
pub fn decimal(value: f64) -> String {
    let digits = DIGITS - 1;
    let rounded: f64 = format!("{value:.digits$e}").parse().unwrap_or(value);
    // Adding zero takes the sign off a negative zero.
    format!("{}", rounded + 0.0)
}

/// A table as a file of the given name, gzipped when the name ends in `.gz`: comment lines, a header, and a row for each value of
/// the first of `columns`, each of which is a name and as many values.
pub fn table(path: &Path, comments: &[String], columns: &[(&str, Vec<f64>)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for comment in comments {
        bytes.extend(format!("# {}\n", comment.replace(['\n', '\r'], " ")).bytes());
    }
    let mut writer = csv::WriterBuilder::new()
        .comment(Some(b'#'))
        .from_writer(bytes);
    // Writing to memory does not fail, and every row has as many cells as the header.
    let _ = writer.write_record(columns.iter().map(|(name, _)| name));
    for row in 0..columns.first().map_or(0, |(_, values)| values.len()) {
        let cells = columns.iter().map(|(_, values)| values.get(row).copied());
        let _ = writer.write_record(cells.map(|cell| decimal(cell.unwrap_or_default())));
    }
    packed(path, writer.into_inner().unwrap_or_default())
}

fn packed(path: &Path, text: Vec<u8>) -> Vec<u8> {
    if path.extension().is_none_or(|extension| extension != "gz") {
        return text;
    }
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    // Writing to memory does not fail.
    let _ = encoder.write_all(&text);
    encoder.finish().unwrap_or_default()
}
