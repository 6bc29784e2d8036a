//! An experiment from CSV: columns `factor_NAME` and `result_NAME`, one row for each of the nine runs.
//!
//! ```text
//! # anything
//! factor_density,factor_angle,factor_wire,result_stiffness.1,result_stiffness.2
//! 2.0,15,0.10,0.022,0.025
//! ```
//!
//! A factor's cells name its level, as numbers or words; cells with the same text are the same level. Results are numbers. Columns
//! that differ only in a number after a point are repeats of one result. All other columns are ignored.

use std::cmp::Ordering;
use std::collections::HashMap;
use std::path::Path;

use mesh_damper_output::error::{InputError, Place, quoted};
use mesh_damper_tables::csv_text::{CsvText, broken_csv, doubled, is_cut, next_row, number};
use mesh_damper_tables::read_limit::ReadLimit;

use super::array::{LEVELS, RUNS};
use super::experiment::{Defect, Experiment, Factor, Response};

const FACTOR: &str = "factor_";
const RESULT: &str = "result_";
/// An example header for a table.
const HEADER: &str = "factor_density,factor_angle,factor_wire,result_stiffness";

impl Experiment {
    /// Reads CSV, or gzipped CSV.
    ///
    /// # Errors
    /// The error names the file, the line or column, the problem and the remedy: no such file, not UTF-8, empty, beyond the default
    /// [`ReadLimit`], no factor or no result, a column twice, not nine runs, a row too short or too long, a last row without a line
    /// end, whose last number may be cut off, an empty cell, a result that is not finite, not three levels, or columns that are not
    /// orthogonal.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, InputError> {
        Self::read_within(path, ReadLimit::default())
    }

    /// [`Experiment::read`] of a file within another limit.
    ///
    /// # Errors
    /// As [`Experiment::read`].
    pub fn read_within(path: impl AsRef<Path>, limit: ReadLimit) -> Result<Self, InputError> {
        let table = Table::parse(CsvText::open(path.as_ref(), limit)?)?;
        let factors = table
            .columns(FACTOR)
            .map(|(index, name)| table.factor(index, name))
            .collect::<Result<_, _>>()?;
        let responses = table.responses()?;
        Self::new(factors, responses).map_err(|defect| table.defect(&defect))
    }
}

/// A header and its nine rows.
struct Table {
    name: String,
    header: csv::StringRecord,
    rows: Vec<csv::StringRecord>,
}

impl Table {
    fn parse(text: CsvText) -> Result<Self, InputError> {
        let name = &text.name();
        let mut reader = text.rows();
        let broken = |error: csv::Error| broken_csv(name, &error);
        let mut header = csv::StringRecord::new();
        if !next_row(&mut reader, &mut header).map_err(broken)? {
            return Err(InputError::new(
                name,
                "is empty",
                format!("write a header such as {HEADER} and nine rows below it"),
            ));
        }
        let mut rows = Vec::new();
        let mut runs = 0;
        let mut row = csv::StringRecord::new();
        while next_row(&mut reader, &mut row).map_err(broken)? {
            if is_cut(&reader) {
                return Err(InputError::new(
                    name,
                    "the last row has no line end, so that its last number may have been cut",
                    "check the row and end its line",
                )
                .at(Place::Line(line(&row))));
            }
            if row.len() != header.len() {
                return Err(InputError::new(
                    name,
                    format!("{} cells where the header has {}", row.len(), header.len()),
                    "write one cell per column, separated by commas",
                )
                .at(Place::Line(line(&row))));
            }
            runs += 1;
            // Further rows are only counted, for the message.
            if runs <= RUNS {
                rows.push(row.clone());
            }
        }
        if let Some((column, first, second)) = doubled(&header) {
            return Err(InputError::new(
                name,
                format!(
                    "the name stands in columns {} and {}",
                    first + 1,
                    second + 1
                ),
                "give every column its own name",
            )
            .at(Place::Column(column.into())));
        }
        let table = Self {
            name: name.clone(),
            header,
            rows,
        };
        for kind in [FACTOR, RESULT] {
            if table.columns(kind).next().is_none() {
                return Err(InputError::new(
                    name,
                    format!("there is no column {kind}NAME"),
                    format!("write a header such as {HEADER}"),
                )
                .at(Place::Line(line(&table.header))));
            }
        }
        if runs != RUNS {
            return Err(InputError::new(
                name,
                format!("{runs} runs, where an L9 has {RUNS}"),
                "write one row to each run, and repeats into columns result_NAME.1, result_NAME.2",
            ));
        }
        Ok(table)
    }

    /// The columns of a kind: their place and the rest of their name after the kind.
    fn columns(&self, kind: &'static str) -> impl Iterator<Item = (usize, &str)> {
        let columns = self.header.iter().enumerate();
        columns.filter_map(move |(index, column)| Some((index, column.strip_prefix(kind)?)))
    }

    fn cell(&self, row: &csv::StringRecord, column: usize) -> Place {
        Place::Cell {
            line: line(row),
            column: self.header.get(column).unwrap_or_default().into(),
        }
    }

    fn factor(&self, column: usize, name: &str) -> Result<Factor, InputError> {
        let mut levels: Vec<&str> = Vec::new();
        for row in &self.rows {
            let cell = row.get(column).unwrap_or_default();
            if cell.is_empty() {
                return Err(InputError::new(
                    &self.name,
                    "the cell is empty",
                    "name the level that the run had",
                )
                .at(self.cell(row, column)));
            }
            if !levels.contains(&cell) {
                levels.push(cell);
            }
        }
        let Ok(mut sorted) = <[&str; LEVELS]>::try_from(levels.clone()) else {
            let found: Vec<String> = levels.iter().map(|level| quoted(level)).collect();
            return Err(InputError::new(
                &self.name,
                format!(
                    "{} levels, where an L9 has {LEVELS}: {}",
                    levels.len(),
                    found.join(", ")
                ),
                "write the same level in the same way, and another array's table elsewhere",
            )
            .at(Place::Column(format!("{FACTOR}{name}"))));
        };
        let value = |level: &str| level.parse::<f64>().ok();
        if sorted.iter().all(|level| value(level).is_some()) {
            sorted.sort_by(|a, b| value(a).partial_cmp(&value(b)).unwrap_or(Ordering::Equal));
        }
        Ok(Factor {
            name: name.into(),
            levels: sorted.map(str::to_owned),
            column: std::array::from_fn(|run| {
                let cell = self.rows[run].get(column);
                sorted
                    .iter()
                    .position(|&level| Some(level) == cell)
                    .unwrap_or(0)
            }),
        })
    }

    fn responses(&self) -> Result<Vec<Response>, InputError> {
        let mut responses: Vec<Response> = Vec::new();
        let mut places = HashMap::new();
        for (column, name) in self.columns(RESULT) {
            let name = without_repeat(name);
            let place = *places.entry(name).or_insert_with(|| {
                responses.push(Response {
                    name: name.into(),
                    runs: Default::default(),
                });
                responses.len() - 1
            });
            for (row, values) in self.rows.iter().zip(&mut responses[place].runs) {
                let value = number(row.get(column).unwrap_or_default());
                values.push(value.map_err(|(problem, remedy)| {
                    InputError::new(&self.name, problem, remedy).at(self.cell(row, column))
                })?);
            }
        }
        Ok(responses)
    }

    fn defect(&self, defect: &Defect) -> InputError {
        let error = |remedy| InputError::new(&self.name, defect.to_string(), remedy);
        match defect {
            Defect::Unbalanced { factor, .. } | Defect::NotOrthogonal { factor, .. } => error(
                "give the nine runs the levels of an L9: every pair of levels of any two factors once",
            )
            .at(Place::Column(format!("{FACTOR}{factor}"))),
            Defect::Repeats { response, .. } | Defect::NotFinite { response, .. } => {
                error("give every run every value")
                    .at(Place::Column(format!("{RESULT}{response}")))
            }
            Defect::Factors(_) => error("name two to four columns factor_NAME"),
            Defect::Responses => error("name a column result_NAME"),
        }
    }
}

/// `stiffness` for `stiffness.2`.
fn without_repeat(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((before, number)) if !before.is_empty() && number.parse::<u32>().is_ok() => before,
        _ => name,
    }
}

fn line(record: &csv::StringRecord) -> u64 {
    record.position().map_or(1, csv::Position::line)
}
