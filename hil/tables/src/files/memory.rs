//! Columns in memory, for programs that read files themselves.

use std::collections::HashMap;

use mesh_damper_output::error::{InputError, Place};

use super::{Column, Kept, Table, Tables, Values, Wanted};
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
        let last: HashMap<usize, usize> = (wanted.iter().enumerate())
            .map(|(place, one)| (one.column, place))
            .collect();
        for (place, one) in wanted.iter().enumerate() {
            let name = || self.tables[0].columns[one.column].name.clone();
            let is_wanted_again = last.get(&one.column) != Some(&place);
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

/// Columns in memory as a file's one table.
///
/// # Errors
/// Columns of different lengths.
pub fn in_memory(
    name: &str,
    columns: impl IntoIterator<Item = impl Into<GivenColumn>>,
) -> Result<Box<dyn Tables>, InputError> {
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
    Ok(Box::new(Memory {
        name: name.to_owned(),
        tables: [table],
        rows,
        values,
    }))
}
