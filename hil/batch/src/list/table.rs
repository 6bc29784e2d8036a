//! A table of paths with their groups, as CSV or Parquet.

use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

use arrow_array::cast::AsArray as _;
use arrow_array::types::{Int32Type, Int64Type};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_schema::DataType;
use mesh_damper_output::error::{InputError, Place, quoted};
use parquet::arrow::arrow_reader::{ArrowReaderOptions, ParquetRecordBatchReaderBuilder};

use super::{Task, refused, resolved};

/// First bytes of a Parquet file.
pub(super) const PARQUET: &[u8] = b"PAR1";

/// The columns that are understood; others are ignored.
const COLUMNS: [&str; 5] = ["path", "group", "specimen", "role", "held_out"];
/// Possible separators between the cells of a CSV.
const DELIMITERS: [u8; 3] = [b',', b';', b'\t'];

/// One row: a cell for each of [`COLUMNS`], empty if the column is missing.
type Cells = [String; COLUMNS.len()];

/// The traces of a CSV, whose cells mean what `meant` makes of them; `None` if its header has no `path`.
pub(super) fn csv(
    list: &Path,
    text: &str,
    meant: fn(&str) -> Cow<'_, str>,
) -> Result<Option<Vec<Task>>, InputError> {
    let reader = |delimiter| {
        csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes())
    };
    for delimiter in DELIMITERS {
        let mut reader = reader(delimiter);
        let Ok(header) = reader.headers().cloned() else {
            continue;
        };
        let names: Vec<&str> = header.iter().collect();
        let Some(places) = places(list, &names)? else {
            continue;
        };
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| {
                mesh_damper_tables::csv_text::broken_csv(&list.display().to_string(), &error)
            })?;
            let line = record.position().map_or(0, csv::Position::line);
            let cell = |place: Option<usize>| place.and_then(|place| record.get(place));
            rows.push((
                Place::Line(line),
                places.map(|place| meant(cell(place).unwrap_or_default()).into_owned()),
            ));
        }
        return tasks(list, rows).map(Some);
    }
    Ok(None)
}

/// The traces of a Parquet table.
pub(super) fn parquet(list: &Path, bytes: Vec<u8>) -> Result<Vec<Task>, InputError> {
    let broken = |error: &dyn std::fmt::Display| {
        refused(
            list,
            format!("cannot be read as Parquet: {error}"),
            "write it again, or give the table as CSV",
        )
    };
    // Texts in their stored form, not as dictionaries or views, whatever type the program that wrote them declared.
    let options = ArrowReaderOptions::new().with_skip_arrow_metadata(true);
    let reader =
        ParquetRecordBatchReaderBuilder::try_new_with_options(bytes::Bytes::from(bytes), options)
            .and_then(ParquetRecordBatchReaderBuilder::build)
            .map_err(|error| broken(&error))?;
    let mut rows = Vec::new();
    for batch in reader {
        let batch = batch.map_err(|error| broken(&error))?;
        let schema = batch.schema();
        let names: Vec<&str> = schema
            .fields()
            .iter()
            .map(|field| field.name().as_str())
            .collect();
        let Some(places) = places(list, &names)? else {
            return Err(refused(
                list,
                format!("has no column path; it has {}", names.join(", ")),
                "call the column of the paths `path`",
            ));
        };
        for row in 0..batch.num_rows() {
            let mut cells = Cells::default();
            for (cell, place) in cells.iter_mut().zip(places) {
                if let Some(place) = place {
                    *cell = text_at(list, &batch, place, row)?;
                }
            }
            rows.push((Place::Field(format!("row {}", rows.len() + 1)), cells));
        }
    }
    tasks(list, rows)
}

/// The index of each of [`COLUMNS`]; `None` if there is no `path`.
fn places(
    list: &Path,
    names: &[&str],
) -> Result<Option<[Option<usize>; COLUMNS.len()]>, InputError> {
    let mut places = [None; COLUMNS.len()];
    for (column, place) in COLUMNS.iter().zip(&mut places) {
        let mut found = (0..names.len()).filter(|&at| names[at].eq_ignore_ascii_case(column));
        *place = found.next();
        if found.next().is_some() {
            return Err(refused(list, "appears twice", "leave one of them out")
                .at(Place::Column((*column).to_owned())));
        }
    }
    if places[0].is_none() {
        return Ok(None);
    }
    if places[3].is_some() && places[4].is_some() {
        return Err(
            refused(list, "repeats the column held_out", "leave one of them out")
                .at(Place::Column("role".into())),
        );
    }
    Ok(Some(places))
}

/// A cell as text; empty if it is null.
fn text_at(
    list: &Path,
    batch: &RecordBatch,
    place: usize,
    row: usize,
) -> Result<String, InputError> {
    let column: &ArrayRef = batch.column(place);
    if column.is_null(row) {
        return Ok(String::new());
    }
    Ok(match column.data_type() {
        DataType::Utf8 => column.as_string::<i32>().value(row).to_owned(),
        DataType::LargeUtf8 => column.as_string::<i64>().value(row).to_owned(),
        DataType::Int32 => column.as_primitive::<Int32Type>().value(row).to_string(),
        DataType::Int64 => column.as_primitive::<Int64Type>().value(row).to_string(),
        DataType::Boolean => column.as_boolean().value(row).to_string(),
        DataType::Null => String::new(),
        other => {
            let name = batch.schema().field(place).name().clone();
            return Err(refused(
                list,
                format!("holds {other}"),
                "write texts, whole numbers or true and false",
            )
            .at(Place::Column(name)));
        }
    })
}

/// One trace for each group and for each row without a group, in the order of their first rows.
fn tasks(list: &Path, rows: Vec<(Place, Cells)>) -> Result<Vec<Task>, InputError> {
    let mut tasks: Vec<Task> = Vec::new();
    let mut groups: HashMap<String, usize> = HashMap::new();
    for (place, [path, group, specimen, role, held_out]) in rows {
        let refused =
            |problem: String, remedy: &str| Err(refused(list, problem, remedy).at(place.clone()));
        if path.is_empty() {
            return refused("has no path".into(), "write the path of a recording");
        }
        let word = if role.is_empty() { held_out } else { role };
        let is_held_out = match word.to_ascii_lowercase().as_str() {
            "" | "fit" | "false" | "no" | "0" => false,
            "held_out" | "true" | "yes" | "1" => true,
            _ => {
                return refused(
                    format!("{} is not a role", quoted(&word)),
                    "write fit or held_out, or true or false below held_out",
                );
            }
        };
        let new = tasks.len();
        let which = match group.is_empty() {
            true => new,
            false => *groups.entry(group.clone()).or_insert(new),
        };
        if which == new {
            let named = |text: String| (!text.is_empty()).then_some(text);
            tasks.push(Task {
                name: named(group.clone()).unwrap_or_else(|| path.clone()),
                group: named(group),
                specimen: named(specimen),
                ..Task::default()
            });
        } else if !specimen.is_empty() {
            let known = tasks[which]
                .specimen
                .get_or_insert_with(|| specimen.clone());
            if *known != specimen {
                return refused(
                    format!(
                        "group {} is of specimen {} too",
                        quoted(&group),
                        quoted(known)
                    ),
                    "give each specimen groups of its own",
                );
            }
        }
        let task = &mut tasks[which];
        let all = match is_held_out {
            true => &mut task.held_out,
            false => &mut task.recordings,
        };
        all.push(resolved(list, &path));
    }
    if tasks.is_empty() {
        return Err(refused(
            list,
            "has no row",
            "write a row for every recording",
        ));
    }
    match tasks.iter().find(|task| task.recordings.is_empty()) {
        Some(task) => Err(refused(
            list,
            format!(
                "{} has held-out recordings but none to fit",
                quoted(&task.name)
            ),
            "give the recordings of one trace the same group, one of them at least with the role fit",
        )),
        None => Ok(tasks),
    }
}
