//! Bad models, programmes, outputs and usage through the real command, and recordings that contradict each other.

use std::fs;

use crate::bad_input::{MODEL, recording};
use crate::command::words;
use crate::refusal::{hil, refuses};

#[test]
fn a_bad_model_is_refused() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("rec.csv"), recording(|_| ())).unwrap();
    for (from, to, said) in [
        (
            "\"version\": 1",
            "\"version\": 2",
            "field version: version 2 is not supported",
        ),
        (
            "0.3 }",
            "1.3 }",
            "field law[0].alpha: alpha = 1.3 is outside 0…1",
        ),
        ("\"k1\": 1.2", "\"k1\": 1e300", "field law[0].k1: k1 ="),
        (
            "\"offset\"",
            "\"magic\"",
            "field effects[0].family: unknown variant `magic`",
        ),
        (
            "\"force\": 0.01",
            "\"force\": 1e12",
            "field effects[0] (offset): force",
        ),
        (
            "mesh-damper-model",
            "other",
            "field format: \"other\" is another format",
        ),
        (
            "\"effects\"",
            "\"affects\"",
            "field affects: unknown field `affects`",
        ),
        ("]", "", "not JSON"),
    ] {
        assert!(MODEL.contains(from));
        fs::write(root.path().join("model.json"), MODEL.replacen(from, to, 1)).unwrap();
        refuses(
            root.path(),
            &words("predict --model model.json rec.csv --out pred.csv"),
            &["model.json: ", said],
        );
    }
    for (model, said) in [("none.json", "does not exist"), (".", "directory")] {
        refuses(
            root.path(),
            &["predict", "--model", model, "rec.csv", "--out", "pred.csv"],
            &[said],
        );
    }
}

#[test]
fn an_output_that_cannot_be_written_is_refused_before_the_work() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    fs::write(root.path().join("rec.csv"), recording(|_| ())).unwrap();
    for (out, said) in [(".", "is a directory"), ("rec.csv/p.csv", "is a file")] {
        refuses(
            root.path(),
            &["predict", "--model", "model.json", "rec.csv", "--out", out],
            &[said],
        );
    }
}

#[test]
fn bad_usage_ends_with_2_and_help_shows_an_example() {
    let root = tempfile::tempdir().unwrap();
    for arguments in [
        &[][..],
        &["predict"],
        &["no-such-command"],
        &["predict", "--on", "moon"],
    ] {
        assert_eq!(hil(root.path(), arguments).status.code(), Some(2));
    }
    for command in [
        "demo",
        "trace",
        "predict",
        "respond",
        "run",
        "characterize",
        "orthogonal",
        "design",
        "paper",
    ] {
        let output = hil(root.path(), &[command, "--help"]);
        assert_eq!(output.status.code(), Some(0));
        let help = String::from_utf8(output.stdout).unwrap();
        assert!(help.contains("Example"), "{help}");
        assert!(help.contains("--json"), "{help}");
    }
}

#[test]
fn recordings_that_contradict_each_other_are_refused() {
    let root = tempfile::tempdir().unwrap();
    let changed = |factor: f64, comment: &str| {
        recording(|lines| {
            for line in &mut lines[1..] {
                let (row, force) = line.rsplit_once(',').unwrap();
                *line = format!("{row},{}", factor * force.parse::<f64>().unwrap());
            }
            lines.insert(0, comment.into());
        })
    };
    for (name, bytes) in [
        ("a.csv", changed(1.0, "# specimen: ring 3")),
        ("turned.csv", changed(-1.0, "#")),
        ("newtons.csv", changed(1000.0, "#")),
        ("ring-4.csv", changed(1.0, "# specimen: ring 4")),
    ] {
        fs::write(root.path().join(name), bytes).unwrap();
    }
    for (other, said) in [
        (
            "turned.csv",
            "contradicts a.csv: under the same motion its force has the opposite sign",
        ),
        (
            "newtons.csv",
            "contradicts a.csv: under the same motion its force is 1000.0000 times",
        ),
        (
            "ring-4.csv",
            "declare the specimen \"ring 4\" where a.csv declares \"ring 3\"",
        ),
        ("./a.csv", "is given twice"),
    ] {
        refuses(root.path(), &["trace", "a.csv", other], &[other, said]);
        // Another specimen may be predicted: that is said.
        if other != "ring-4.csv" {
            refuses(
                root.path(),
                &["trace", "a.csv", "--held-out", other],
                &[other, said],
            );
        }
    }
}

#[test]
fn a_bad_programme_or_specimen_is_refused_by_run() {
    let root = tempfile::tempdir().unwrap();
    fs::write(
        root.path().join("p.json"),
        r#"{"blocks": [{"amplitude": 0.1, "frequency": 1}]}"#,
    )
    .unwrap();
    let bad = MODEL.replace("\"version\": 1", "\"version\": 7");
    fs::write(root.path().join("model.json"), bad).unwrap();
    for (arguments, said) in [
        (&["--blocks", "0.1:1"][..], "--blocks: field block 1"),
        (
            &["--blocks", "0.1:1:6,0.1:5000:6"],
            "field block 2: frequency = 5000 is outside",
        ),
        (
            &["--programme", "p.json"],
            "p.json: field blocks[0]: missing field `cycles`",
        ),
        (
            &["--programme", "none.json"],
            "none.json: cannot read it: does not exist",
        ),
        (&["--density", "9"], "--density: 9 g/cm³ is outside"),
        (&["--tick-rate", "0"], "tick_rate = 0 is outside"),
        (
            &["--model", "model.json"],
            "field version: version 7 is not supported",
        ),
    ] {
        refuses(root.path(), &[&["run"], arguments].concat(), &[said]);
    }
}

/// Models that `hil trace --law` cannot use as the known law.
#[test]
fn a_known_effect_that_a_fit_lacks_is_refused() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("rec.csv"), recording(|_| ())).unwrap();
    let friction = r#"{ "family": "stick_slip", "parameters": { "stiffness": 1.0, "stretch_limit": 0.1,
        "sharpness": 1.0, "hardening": 7.5, "loss": 0.5 } }"#;
    let offset = r#"{ "family": "offset", "parameters": { "force": 0.01 } }"#;
    let known = MODEL.replacen(offset, friction, 1);
    assert_ne!(known, MODEL);
    fs::write(root.path().join("known.json"), known).unwrap();
    let refuses = |law: &str, said: &[&str]| {
        refuses(root.path(), &["trace", "rec.csv", "--law", law], said);
    };
    refuses(
        "known.json",
        &["known.json: field effects[0]", "leave it out"],
    );
    refuses("none.json", &["none.json", "does not exist"]);
    refuses("rec.csv", &["rec.csv", "not JSON"]);
}
