//! The results of a batch for its recordings.

use std::fs;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use mesh_damper_batch::outcome::Outcome;
use mesh_damper_batch::table::{Values, outcomes, parameters};
use mesh_damper_batch::{Batch, List, Row, Settings, Summary};
use mesh_damper_identify::trace::result::TraceResult;
use mesh_damper_identify::trace::trace;
use mesh_damper_model::file::ModelFile;
use mesh_damper_recording::Recording;
use mesh_damper_tables::read_limit::ReadLimit;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

use crate::simulated::drawn;

pub fn batch(list: &Path, out: &Path) -> Batch {
    Batch {
        list: List::read(list, ReadLimit::default()).unwrap(),
        settings: Settings::default(),
        reads: Vec::new(),
        out: out.to_owned(),
        jobs: NonZeroUsize::new(2).unwrap(),
        json: None,
    }
}

pub fn run(batch: &Batch) -> Summary {
    batch.run(&|_| ()).unwrap()
}

/// `count` recordings in a folder of this name.
pub fn record(folder: &Path, count: u64) {
    fs::create_dir_all(folder).unwrap();
    for seed in 0..count {
        write(&drawn(seed), &folder.join(format!("{seed}.csv")));
    }
}

pub fn write(recording: &Recording, path: &Path) {
    fs::write(path, recording.to_file(path).unwrap()).unwrap();
}

fn failed(row: &Row) -> Option<&str> {
    match &row.outcome {
        Outcome::Failed(failure) => Some(&failure.error),
        Outcome::Traced(_) => None,
    }
}

#[test]
fn each_recording_is_traced_as_it_is_alone() {
    let root = tempfile::tempdir().unwrap();
    let (folder, out) = (root.path().join("recordings"), root.path().join("out"));
    record(&folder, 3);
    let summary = run(&batch(&folder, &out));
    assert_eq!(
        (summary.traced, summary.failed, summary.computed),
        (3, 0, 3)
    );
    for (seed, row) in summary.traces.iter().enumerate() {
        let path = folder.join(format!("{seed}.csv"));
        assert_eq!(row.recordings, [path.display().to_string()]);
        let Outcome::Traced(found) = &row.outcome else {
            panic!("{row:?}");
        };
        let recording = Recording::read_channels(&path, &ReadLimit::default().into()).unwrap();
        let alone = trace(&[recording], &[], &|_| ()).unwrap();
        let traced = out.join(&found.folder);
        let text = fs::read_to_string(traced.join("trace.json")).unwrap();
        assert_eq!(
            serde_json::from_str::<TraceResult>(&text).unwrap(),
            alone.result
        );
        assert_eq!(
            ModelFile::read(traced.join("model.json")).unwrap(),
            alone.model_file()
        );
        assert_eq!(found.verdict, alone.result.verdict);
        assert_eq!(
            found.nrmse.augmented_held_out,
            Some(alone.result.augmented.nrmse_held_out)
        );
        assert!(!traced.join("report.html").exists());
    }
}

#[test]
fn what_cannot_be_traced_is_a_row_and_what_is_there_twice_is_none() {
    let root = tempfile::tempdir().unwrap();
    let (folder, out) = (root.path().join("recordings"), root.path().join("out"));
    record(&folder, 2);
    let path = |name: &str| folder.join(name);
    fs::copy(path("0.csv"), path("again.csv")).unwrap();
    fs::write(path("broken.csv"), "time_s,displacement_mm\n0,0\n").unwrap();
    let recording = Recording::read(path("0.csv")).unwrap();
    fs::write(
        path("packed.csv.gz"),
        recording.to_file(&path("packed.csv.gz")).unwrap(),
    )
    .unwrap();
    let mut still = drawn(5);
    still.force.fill(1.0);
    write(&still, &path("still.csv"));
    let list = root.path().join("list.csv");
    fs::write(
        &list,
        "path,group,role\nrecordings/again.csv,,\nrecordings/0.csv,,\nrecordings/packed.csv.gz,,\nrecordings/broken.csv,,\n\
        recordings/still.csv,,\nrecordings/gone.csv,,\nrecordings/0.csv,twice,\nrecordings/again.csv,twice,held_out\n\
        recordings/1.csv,both,\nrecordings/0.csv,both,held_out\n",
    )
    .unwrap();
    let summary = run(&batch(&list, &out));
    let shown = |name: &str| path(name).display().to_string();
    assert_eq!(summary.traces.len(), 6);
    let [first, broken, still, gone, twice, both] = &summary.traces[..] else {
        panic!("{:?}", summary.traces);
    };
    // The first of the list represents all copies.
    assert_eq!(first.trace, "recordings/again.csv");
    assert_eq!(first.copies, [shown("0.csv"), shown("packed.csv.gz")]);
    assert!(failed(first).is_none() && failed(both).is_none());
    assert_eq!(both.held_out, [shown("0.csv")]);
    for (row, said) in [
        (broken, "broken.csv: "),
        (still, "has a force that never changes"),
        (gone, "gone.csv: cannot read it: does not exist"),
        (twice, "again.csv: is the same recording as "),
    ] {
        let error = failed(row).unwrap();
        assert!(
            error.contains(said) && error.lines().count() == 1,
            "{error}"
        );
    }
    assert_eq!((summary.traced, summary.failed), (2, 4));
    assert_eq!(summary.shared.len(), 1, "{:?}", summary.shared);
    // The copies contain the recording as well: the message identifies the row that represents them.
    assert!(
        summary.shared[0].contains("\"recordings/again.csv\" and in \"twice\""),
        "{:?}",
        summary.shared
    );
}

/// Every value of a Parquet file in the form of CSV cells, row by row.
fn cells(path: &Path) -> Vec<Vec<String>> {
    let file = fs::File::open(path).unwrap();
    let reader = ParquetRecordBatchReaderBuilder::try_new(file)
        .unwrap()
        .build()
        .unwrap();
    let mut rows = Vec::new();
    for batch in reader {
        let batch = batch.unwrap();
        let names = batch
            .schema()
            .fields()
            .iter()
            .map(|field| field.name().clone())
            .collect();
        if rows.is_empty() {
            rows.push(names);
        }
        for row in 0..batch.num_rows() {
            let cells = batch
                .columns()
                .iter()
                .map(|column| arrow_cast_like(column, row));
            rows.push(cells.collect());
        }
    }
    rows
}

/// A value as the CSV shows it.
fn arrow_cast_like(column: &arrow_array::ArrayRef, row: usize) -> String {
    use arrow_array::Array as _;
    use arrow_array::cast::AsArray as _;
    use arrow_array::types::{Float64Type, UInt64Type};
    use arrow_schema::DataType;
    if column.is_null(row) {
        return String::new();
    }
    match column.data_type() {
        DataType::Utf8 => column.as_string::<i32>().value(row).to_owned(),
        DataType::Float64 => column.as_primitive::<Float64Type>().value(row).to_string(),
        DataType::UInt64 => column.as_primitive::<UInt64Type>().value(row).to_string(),
        DataType::Boolean => column.as_boolean().value(row).to_string(),
        DataType::List(_) => {
            let texts = column.as_list::<i32>().value(row);
            let texts = texts
                .as_string::<i32>()
                .iter()
                .map(Option::unwrap)
                .map(str::to_owned);
            texts.collect::<Vec<_>>().join(";")
        }
        other => panic!("{other}"),
    }
}

#[test]
fn the_tables_hold_the_rows_in_both_formats() {
    let root = tempfile::tempdir().unwrap();
    let (folder, out) = (root.path().join("recordings"), root.path().join("out"));
    record(&folder, 2);
    fs::write(folder.join("broken.csv"), "time_s\n0\n").unwrap();
    let summary = run(&batch(&folder, &out));
    let csv = fs::read(out.join("outcomes.csv")).unwrap();
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(&csv[..]);
    let rows = reader
        .records()
        .map(|row| row.unwrap().iter().map(str::to_owned).collect());
    let rows: Vec<Vec<String>> = rows.collect();
    assert_eq!(cells(&out.join("outcomes.parquet")), rows);
    assert_eq!(rows.len(), 4);
    let column = |name: &str| rows[0].iter().position(|each| each == name).unwrap();
    assert_eq!(rows[3][column("outcome")], "failed");
    assert!(rows[3][column("error")].contains("broken.csv"));
    assert_eq!(rows[1][column("verdict")], "found");
    // One row for each parameter, in the units of the model file.
    let effects = cells(&out.join("effects.parquet"));
    let parameters = parameters(&summary.traces);
    assert_eq!(effects.len(), 1 + rows_of(&parameters.0[0].values));
    let column = |name: &str| effects[0].iter().position(|each| each == name).unwrap();
    let law: Vec<&Vec<String>> = effects
        .iter()
        .filter(|row| row[column("part")] == "law")
        .collect();
    assert_eq!(law.len() % 4, 0);
    assert_eq!(
        (
            &law[0][column("parameter")][..],
            &law[0][column("unit")][..]
        ),
        ("k1", "kN/mm")
    );
    let found: Vec<&Vec<String>> = effects
        .iter()
        .filter(|row| row[column("part")] == "effect")
        .collect();
    assert!(!found.is_empty());
    for row in &found {
        let [low, value, high] =
            ["low", "value", "high"].map(|name| row[column(name)].parse::<f64>().unwrap());
        assert!(low <= value && value <= high, "{row:?}");
    }
}

fn rows_of(values: &Values) -> usize {
    match values {
        Values::Text(values) => values.len(),
        _ => 0,
    }
}

/// Other programs read the columns by their names.
#[test]
fn the_page_has_every_column_of_the_tables() {
    let page =
        fs::read_to_string(PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/batch.md"))
            .unwrap();
    for table in [outcomes(&[]), parameters(&[])] {
        let rows: Vec<String> = table
            .0
            .iter()
            .map(|column| {
                format!(
                    "| `{}` | {} | {} |",
                    column.name,
                    column.values.kind(),
                    column.about
                )
            })
            .collect();
        assert!(
            page.contains(&rows.join("\n")),
            "docs/batch.md lacks\n{}",
            rows.join("\n")
        );
    }
}

#[test]
fn so_many_jobs_that_they_take_the_machine_down_are_refused() {
    let root = tempfile::tempdir().unwrap();
    let (folder, out) = (root.path().join("recordings"), root.path().join("out"));
    record(&folder, 1);
    let mut many = batch(&folder, &out);
    many.jobs = NonZeroUsize::new(100_000).unwrap();
    let error = many.run(&|_| ()).unwrap_err().to_string();
    assert!(error.contains("--jobs: 100000 is above 1024"), "{error}");
    assert!(!out.join("outcomes.csv").exists());
}
