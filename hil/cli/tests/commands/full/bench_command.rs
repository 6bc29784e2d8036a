//! `hil bench` in an emulator if one is installed; otherwise the benchmark is skipped with a message.

use std::path::Path;
use std::process::{Command, Output};

use mesh_damper_link::image::Board;
use mesh_damper_trials::bench::{Baseline, IMAGE};
use serde_json::Value;

use crate::full::emulated;
use crate::full::junit_command;

fn command(arguments: &[&str], baseline: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hil"))
        .arg("bench")
        .args(arguments)
        .arg("--baseline")
        .arg(baseline)
        .output()
        .unwrap()
}

#[test]
#[ignore = "minutes: everything is counted once more; in the full tier"]
fn a_count_above_the_baseline_is_named_and_fails_the_command() {
    if emulated::image(&IMAGE, Board::Mps2An386).is_none() {
        return;
    }
    let mut baseline = Baseline::read(&Baseline::path().unwrap()).unwrap();
    let entry = baseline
        .counts
        .iter_mut()
        .find(|entry| entry.name == "power/table")
        .unwrap();
    entry.mean *= 0.9;
    let lowered = entry.mean;
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("baseline.json");
    std::fs::write(&path, serde_json::to_vec(&baseline).unwrap()).unwrap();

    let junit = directory.path().join("bench.xml");
    let output = command(&["--json", "-", "--junit", junit.to_str().unwrap()], &path);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("power/table call on a Cortex-M4F: mean"),
        "{said}"
    );
    // The counts are still reported, and the failures are among the checks.
    let suite = junit_command::suite(&junit);
    assert!(
        suite
            .failure("power/table call on a Cortex-M4F, mean")
            .contains("above the baseline")
    );
    assert!(
        suite
            .cases
            .iter()
            .any(|case| case.class == "hil.bench.limit")
    );
    let results: Value = serde_json::from_slice(&output.stdout).unwrap();
    crate::full::schema_command::is_as_its_schema_says("bench", &results);
    let counts = results["counts"].as_array().unwrap();
    let table = counts
        .iter()
        .find(|count| count["name"] == "power/table")
        .unwrap();
    assert!(table["mean"].as_f64().unwrap() > lowered);
}

#[test]
fn what_is_no_baseline_is_refused_before_anything_is_counted() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("baseline.json");
    for text in [None, Some("{}"), Some("[1,2")] {
        if let Some(text) = text {
            std::fs::write(&path, text).unwrap();
        }
        let output = command(&[], &path);
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.contains("baseline.json"), "{said}");
    }
}
