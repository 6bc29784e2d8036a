//! Files of many formats, written by widely used programs, contain the original recording.
//!
//! `hil/tables/tests/formats/write.py` wrote them. `.ci/formats` writes them again and reads them with this test from the folder in the
//! variable `FORMATS`.

use std::path::{Path, PathBuf};

use mesh_damper_recording::Recording;
use mesh_damper_tables::files::{self, Reading};
use serde::Deserialize;

/// One file of `files.json`.
#[derive(Deserialize)]
struct File {
    file: String,
    program: String,
    /// The largest permitted error of a value, as a fraction of the channel's largest value; 0 requires equality in every bit.
    error: f64,
    #[serde(default)]
    channels: std::collections::BTreeMap<String, String>,
    #[serde(default)]
    units: std::collections::BTreeMap<String, String>,
    table: Option<String>,
    rate: Option<f64>,
    /// Words that the guesses must contain.
    #[serde(default)]
    guesses: Vec<String>,
    #[serde(default)]
    skipped: Vec<String>,
    #[serde(default)]
    comments: Vec<String>,
    /// Samples whose force is not in the file.
    #[serde(default)]
    missing: Vec<usize>,
    /// Words of the message when the file is refused.
    #[serde(default)]
    refused: Vec<String>,
}

fn folder() -> PathBuf {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tables/tests/formats");
    std::env::var_os("FORMATS").map_or(beside, PathBuf::from)
}

fn reading(file: &File) -> Reading {
    let pairs = |map: &std::collections::BTreeMap<String, String>| {
        map.iter().map(|(a, b)| (a.clone(), b.clone())).collect()
    };
    Reading {
        channels: pairs(&file.channels),
        units: pairs(&file.units),
        table: file.table.clone(),
        rate: file.rate,
        ..Reading::default()
    }
}

/// The greatest difference, as a fraction of the channel's largest value.
fn error(read: &[f64], truth: &[f64]) -> f64 {
    let largest = truth
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    let off = read.iter().zip(truth).map(|(a, b)| (a - b).abs());
    off.fold(0.0_f64, f64::max) / largest
}

#[test]
fn what_programs_write_is_read_as_it_was_meant() {
    let folder = folder();
    let list = std::fs::read(folder.join("files.json")).unwrap();
    let list: Vec<File> = serde_json::from_slice(&list).unwrap();
    assert!(list.len() > 50);
    let truth = Recording::read(folder.join("truth.csv")).unwrap();
    let read = list.iter().filter(|file| file.refused.is_empty());
    let exact = read.clone().filter(|file| file.error == 0.0).count();
    let said = format!("{} files: {exact} bit by bit", read.count());
    assert!(
        include_str!("../../../../docs/validation.md").contains(&said),
        "{said}"
    );
    let mut wrong = Vec::new();
    for file in list {
        let path = folder.join(&file.file);
        let reading = reading(&file);
        let name = format!("{} of {}", file.file, file.program);
        let read = Recording::read_as(&path, &reading);
        let read = match (read, file.refused.is_empty()) {
            (Ok(read), true) => read,
            (Err(error), false) => {
                let message = error.to_string();
                println!("{name}: {message}");
                let lacks = file
                    .refused
                    .iter()
                    .filter(|words| !message.contains(*words));
                wrong.extend(
                    lacks.map(|words| format!("{name}: \"{words}\" is not in \"{message}\"")),
                );
                continue;
            }
            (Ok(_), false) => {
                wrong.push(format!("{name}: is read"));
                continue;
            }
            (Err(error), true) => {
                wrong.push(format!("{name}: {error}"));
                continue;
            }
        };
        let kept = |values: &[f64]| -> Vec<f64> {
            let each = values.iter().enumerate();
            each.filter(|(index, _)| !file.missing.contains(index))
                .map(|(_, value)| *value)
                .collect()
        };
        let mut errors = Vec::new();
        for (channel, read, truth) in [
            ("time", &read.time, &truth.time),
            ("displacement", &read.displacement, &truth.displacement),
            ("force", &read.force, &truth.force),
        ] {
            let truth = kept(truth);
            let off = error(read, &truth);
            errors.push(off);
            let is_same = read.len() == truth.len() && off <= file.error;
            if !is_same {
                let (read, truth) = (read.len(), truth.len());
                wrong.push(format!(
                    "{name}: {channel} is off by {off:e}, {read} values of {truth}"
                ));
            }
        }
        println!("{name}: {:.1e}", errors.into_iter().fold(0.0, f64::max));
        let (_, opened) = files::open(&path, &reading).unwrap();
        let skipped: Vec<&String> = opened
            .tables()
            .iter()
            .flat_map(|table| &table.skipped)
            .collect();
        for (what, said, words) in [
            ("guesses", &read.guesses().iter().collect(), &file.guesses),
            ("skipped", &skipped, &file.skipped),
            ("comments", &read.comments.iter().collect(), &file.comments),
        ] {
            let lacks = words
                .iter()
                .filter(|words| !said.iter().any(|said| said.contains(*words)));
            wrong.extend(
                lacks.map(|words| format!("{name}: \"{words}\" is not in {what} {said:?}")),
            );
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}
