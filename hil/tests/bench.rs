//! `hil bench` in an emulator where there is one; left out, and said so, where there is none.

mod emulated;

use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Output};

use hil::bench::{Baseline, IMAGE, Verdict, run};
use hil::image::Board;
use serde_json::Value;

fn command(arguments: &[&str], baseline: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hil"))
        .arg("bench")
        .args(arguments)
        .arg("--baseline")
        .arg(baseline)
        .output()
        .unwrap()
}

fn is_ci() -> bool {
    std::env::var("CI").as_deref() == Ok("true")
}

/// Past the test harness, which keeps what passing tests print to itself.
fn say(line: &str) {
    let said = writeln!(std::io::stderr(), "{line}");
    said.unwrap();
}

#[test]
fn counts_are_the_same_in_every_run_no_higher_than_the_baseline_and_within_the_limits() {
    if emulated::image(&IMAGE, Board::Mps2An386).is_none() {
        return;
    }
    let results = run(&|_| ()).unwrap();
    assert_eq!(run(&|_| ()).unwrap().counts, results.counts);

    for left_out in &results.left_out {
        assert!(!is_ci(), "{left_out}");
        say(&format!("left out: {left_out}"));
    }
    let baseline = Baseline::read(&Baseline::path()).unwrap();
    let failures = baseline.failures(&results);
    // Another compiler makes other code, which says nothing about ours.
    if baseline.tools.rustc != results.tools.rustc && !is_ci() {
        say(&format!(
            "left out: the baseline of instructions is of {}, not of {}; rustup toolchain install {} has it compared",
            baseline.tools.rustc,
            results.tools.rustc,
            baseline
                .tools
                .rustc
                .split_whitespace()
                .nth(1)
                .unwrap_or("it"),
        ));
        return;
    }
    assert!(failures.is_empty(), "{failures:#?}");
    let missed = results.limits.iter().filter_map(Verdict::failure);
    assert_eq!(missed.collect::<Vec<_>>(), Vec::<String>::new());
    // Who reaches a limit takes its excuse away; what hangs on the machine has one whatever it came to.
    let idle = results.limits.iter().filter(|verdict| {
        verdict.excuse.is_some() && verdict.holds() && verdict.unit != "a second"
    });
    assert_eq!(idle.count(), 0, "{:#?}", results.limits);
}

#[test]
fn a_count_above_the_baseline_is_named_and_fails_the_command() {
    if emulated::image(&IMAGE, Board::Mps2An386).is_none() {
        return;
    }
    let mut baseline = Baseline::read(&Baseline::path()).unwrap();
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

    let output = command(&["--json", "-"], &path);
    assert_eq!(output.status.code(), Some(1));
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        said.contains("power/table call on a Cortex-M4F: mean"),
        "{said}"
    );
    // What was counted is given all the same.
    let results: Value = serde_json::from_slice(&output.stdout).unwrap();
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
