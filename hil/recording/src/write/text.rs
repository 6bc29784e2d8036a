//! A recording as text: comment lines, a header, and a row for each sample.

use std::io::Write as _;

use super::{DIGITS, Unwritten, decimal};
use crate::Recording;
use crate::units::Unit;

impl Recording {
    /// The recording as text. A recording that was read from a text is written with the same cells.
    pub(super) fn to_csv(&self, predicted: Option<[&[f64]; 2]>) -> Result<Vec<u8>, Unwritten> {
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
        // A first cell that looks like a comment is quoted.
        let mut writer = csv::WriterBuilder::new()
            .comment(Some(b'#'))
            .from_writer(bytes);
        let mut line = |cells: &csv::StringRecord, last: Option<[String; 2]>| {
            let kept = cells
                .iter()
                .zip(&is_replaced)
                .filter(|(_, is_replaced)| !**is_replaced)
                .map(|(cell, _)| cell.to_owned());
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

/// A table as text: comment lines, a header, and one row per value of the first column. Each of `columns` is a name with its
/// values, all of the same length.
pub(super) fn table(
    comments: &[String],
    columns: &[(&str, Vec<f64>)],
) -> Result<Vec<u8>, Unwritten> {
    let mut bytes = Vec::new();
    for comment in comments {
        bytes.extend(format!("# {}\n", comment.replace(['\n', '\r'], " ")).bytes());
    }
    let mut writer = csv::WriterBuilder::new()
        .comment(Some(b'#'))
        .from_writer(bytes);
    let mut write = |record: Vec<String>| writer.write_record(record).map_err(Unwritten::by);
    write(columns.iter().map(|(name, _)| (*name).to_owned()).collect())?;
    for row in 0..columns.first().map_or(0, |(_, values)| values.len()) {
        let cells = columns.iter().map(|(_, values)| values.get(row).copied());
        write(
            cells
                .map(|cell| decimal(cell.unwrap_or_default()))
                .collect(),
        )?;
    }
    writer.into_inner().map_err(Unwritten::by)
}

/// Bytes, gzipped.
pub(super) fn gzipped(text: &[u8]) -> Result<Vec<u8>, Unwritten> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    let written = encoder.write_all(text).and_then(|()| encoder.finish());
    written.map_err(Unwritten::by)
}
