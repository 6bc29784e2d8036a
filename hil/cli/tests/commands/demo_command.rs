//! `hil demo`: one command runs everything up to the report, and the other commands can use its files.

use crate::command::{hil, words};

#[test]
fn the_effect_is_shown_and_the_files_are_used_by_the_other_commands() {
    let root = tempfile::tempdir().unwrap();
    let printed = hil(root.path(), &["demo", "--seed", "3", "--json", "-"]);
    let summary: serde_json::Value = serde_json::from_str(&printed).unwrap();
    // The statement about the loop agrees with its errors.
    let (before, after) = (&summary["loop_error_before"], &summary["loop_error_after"]);
    let nearer = after.as_f64().unwrap() < before.as_f64().unwrap();
    assert_eq!(summary["nearer"], nearer);
    let hidden = summary["hidden"]["effect"]["family"].as_str().unwrap();
    let found = summary["found"].as_array().unwrap();
    assert_eq!(
        summary["named"],
        found.iter().any(|family| family == hidden)
    );

    let out = root.path().join("demo-out");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("Hidden in it") && page.contains(&hidden.replace('_', "-")));
    let picture = std::fs::read_to_string(out.join("loop.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("displacement, mm"));

    // A trace of the recording gives the same result: the demo uses no other information.
    hil(
        root.path(),
        &["trace", "demo-out/recording.csv.gz", "--out", "again"],
    );
    let read = |path: &str| -> serde_json::Value {
        let bytes = std::fs::read(root.path().join(path)).unwrap();
        serde_json::from_slice(&bytes).unwrap()
    };
    let (first, again) = (read("demo-out/trace.json"), read("again/trace.json"));
    assert_eq!(first["verdict"], again["verdict"]);
    assert_eq!(first["effects"][0]["family"], again["effects"][0]["family"]);
    hil(
        root.path(),
        &words(
            "predict --model demo-out/model.json again/../demo-out/recording.csv.gz --out p.csv",
        ),
    );
}
