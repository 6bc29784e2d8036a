//! Names that a terminal would obey, or that a spreadsheet would compute, in the commands of the feature `full`.
#![cfg(target_os = "linux")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use mesh_damper_tables::write::unguarded;
use serde_json::Value;

use crate::command::record;
use crate::refusal::hil;
use crate::terminal::{NAME, shown};

/// The cells of `outcomes.csv`, by the names of its columns.
fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

/// A table of a file in which two tables could be meant.
#[test]
fn the_names_of_tables_are_shown_escaped() {
    let root = tempfile::tempdir().unwrap();
    let values = |of: fn(f64) -> f64| {
        (0..200)
            .map(|i| of(f64::from(i) * 0.05))
            .collect::<Vec<f64>>()
    };
    let table = serde_json::json!({
        "time_s": values(|time| time),
        "displacement_mm": values(f64::sin),
        "force_kN": values(f64::cos),
    });
    let tables = BTreeMap::from([(NAME, &table), ("b", &table)]);
    fs::write(
        root.path().join("two.json"),
        serde_json::to_vec(&tables).unwrap(),
    )
    .unwrap();
    let output = hil(root.path(), &["inspect", "two.json"]);
    let said = shown(&output);
    assert!(
        said.contains(r"table a\u{1b}[2J") && said.contains("--table NAME"),
        "{said}"
    );
    let output = hil(root.path(), &["inspect", "two.json", "--table", NAME]);
    let said = shown(&output);
    assert!(
        said.contains(r"next: hil trace two.json --table=$'a\033[2J\302\2331m"),
        "{said}"
    );
    let output = hil(root.path(), &["trace", "two.json"]);
    assert_eq!(output.status.code(), Some(2));
    shown(&output);
}

#[test]
fn a_batch_shows_names_escaped_and_its_table_holds_no_formula() {
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name);
    let copy = "copy\u{1b}[2J\u{202e}.csv";
    record(&path("=1+1.csv"), 0);
    fs::copy(path("=1+1.csv"), path(copy)).unwrap();
    // They are refused, and have a row all the same.
    let refused = [
        "@SUM(A1)",
        "-2+3",
        "+a;=b",
        "'=c",
        "\u{ff1d}d",
        "-5",
        "e;\"=f",
    ];
    for (number, name) in refused.iter().enumerate() {
        fs::write(path(name), format!("time_s\n{number}\n")).unwrap();
    }
    let names = [&["=1+1.csv", copy][..], &refused].concat();
    fs::write(path("list.txt"), names.join("\n")).unwrap();
    let output = hil(root.path(), &["batch", "list.txt"]);
    let said = shown(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    let copies = r"The same recording, counted once: copy\u{1b}[2J\u{202e}.csv as =1+1.csv";
    assert!(said.contains(copies), "{said}");

    let outcomes = path("batch-out/outcomes.csv");
    let is_formula = |cell: &str| {
        let cell = cell.trim_start_matches('"');
        cell.starts_with(['=', '+', '-', '@', '\t', '\r', '\u{ff1d}'])
            && cell.parse::<f64>().is_err()
    };
    let table = rows(&outcomes);
    for row in &table {
        for cell in row.values().flat_map(|cell| cell.split([',', ';'])) {
            assert!(!is_formula(cell), "{cell}");
        }
    }
    let read: Vec<_> = table
        .iter()
        .map(|row| unguarded(&row["trace"]).into_owned())
        .collect();
    let listed: Vec<&str> = names.iter().copied().filter(|name| *name != copy).collect();
    assert_eq!(read, listed);

    // The names of the table are those of the files, also in a list, and groups and specimens are texts like them.
    let mut list = csv::Writer::from_path(path("again.csv")).unwrap();
    list.write_record(["path", "group", "specimen"]).unwrap();
    for row in &table {
        list.write_record([&row["trace"], "", "'=HYPERLINK(\"http://a\")"])
            .unwrap();
    }
    drop(list);
    let again = hil(root.path(), &["batch", "again.csv", "--json", "-"]);
    let said = String::from_utf8(again.stdout).unwrap();
    let summary: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(
        (&summary["traced"], &summary["computed"]),
        (&1.into(), &0.into())
    );
    let traces = summary["traces"].as_array().unwrap();
    let again: Vec<&str> = traces
        .iter()
        .map(|row| row["trace"].as_str().unwrap())
        .collect();
    assert_eq!(again, listed);
    assert_eq!(traces[0]["specimen"], "=HYPERLINK(\"http://a\")");
    assert_eq!(rows(&outcomes)[0]["specimen"], "'=HYPERLINK(\"http://a\")");

    // Models are named by their folders.
    let model = traces[0]["folder"].as_str().unwrap();
    fs::rename(path("batch-out").join(model), path(NAME)).unwrap();
    for arguments in [
        &["compare", NAME, NAME][..],
        &["compare", NAME, "none\u{1b}"],
    ] {
        shown(&hil(root.path(), arguments));
    }
}
