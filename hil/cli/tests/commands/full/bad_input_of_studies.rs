//! Bad input of `hil orthogonal`, `hil design` and `hil characterize` through the real command.

use std::fs;
use std::path::Path;

use crate::bad_input::bad_recordings;
use crate::command::words;
use crate::refusal::{hil, refuses};

/// Three factors on an L9 and two repeats of one result, header first. `change` may damage the lines.
fn table(change: impl FnOnce(&mut Vec<String>)) -> String {
    let mut lines = vec!["factor_a,factor_b,factor_c,result_k.1,result_k.2".to_owned()];
    lines.extend((0..9).map(|run| {
        let (a, b) = (run / 3, run % 3);
        format!("{a},{b},{},{}.5,{}.7", (a + b) % 3, run + a, run + b)
    }));
    change(&mut lines);
    lines.join("\n") + "\n"
}

#[test]
fn bad_tables_are_refused_by_orthogonal() {
    let root = tempfile::tempdir().unwrap();
    let row = |line: usize, text: &str| {
        let text = text.to_owned();
        table(move |lines| lines[line - 1] = text)
    };
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("empty.csv", String::new(), &["is empty", "factor_density"]),
        (
            "no-factor.csv",
            row(1, "a,b,c,result_k.1,result_k.2"),
            &["line 1", "no column factor_NAME"],
        ),
        (
            "no-result.csv",
            row(1, "factor_a,factor_b,factor_c,d,e"),
            &["line 1", "no column result_NAME"],
        ),
        (
            "twice.csv",
            row(1, "factor_a,factor_a,factor_c,result_k.1,result_k.2"),
            &["column factor_a", "columns 1 and 2"],
        ),
        (
            "one-factor.csv",
            row(1, "factor_a,b,c,result_k.1,result_k.2"),
            &["1 factors", "2 to 4"],
        ),
        (
            "short.csv",
            table(|lines| lines.truncate(9)),
            &["8 runs, where an L9 has 9"],
        ),
        (
            "ragged.csv",
            row(4, "0,2,2,1.0"),
            &["line 4", "4 cells where the header has 5"],
        ),
        (
            "word.csv",
            row(5, "1,0,1,soft,1.0"),
            &["line 5, column result_k.1", "\"soft\" is not a number"],
        ),
        (
            "nan.csv",
            row(5, "1,0,1,1.0,NaN"),
            &["line 5, column result_k.2", "\"NaN\" is not a number"],
        ),
        (
            "blank-result.csv",
            row(5, "1,0,1,1.0,"),
            &["line 5, column result_k.2", "cell is empty"],
        ),
        (
            "blank-level.csv",
            row(5, "1,,1,1.0,1.0"),
            &["line 5, column factor_b", "name the level"],
        ),
        (
            "fourth-level.csv",
            row(5, "1,7,1,1.0,1.0"),
            &["column factor_b", "4 levels", "\"7\""],
        ),
        (
            "unbalanced.csv",
            row(5, "0,0,1,1.0,1.0"),
            &["column factor_a", "level 0 stands in 4 runs"],
        ),
        (
            "not-orthogonal.csv",
            table(|lines| {
                lines[1] = "0,0,1,1,1".into();
                lines[2] = "0,1,0,1,1".into();
            }),
            &["column factor_c", "not orthogonal to b", "instead of once"],
        ),
    ];
    for (name, text, said) in cases {
        fs::write(root.path().join(name), text).unwrap();
        refuses(
            root.path(),
            &["orthogonal", name, "--json", "new.json"],
            said,
        );
    }
    fs::write(root.path().join("latin.csv"), b"factor_\xe9\n").unwrap();
    refuses(
        root.path(),
        &["orthogonal", "latin.csv"],
        &["line 1", "not UTF-8"],
    );
    refuses(
        root.path(),
        &["orthogonal", "none.csv"],
        &["none.csv", "does not exist"],
    );
    refuses(root.path(), &["orthogonal", "."], &["is a directory"]);
    refuses(
        root.path(),
        &["orthogonal", "--json", "."],
        &["is a directory"],
    );

    fs::write(root.path().join("good.csv"), table(|_| ())).unwrap();
    let output = hil(root.path(), &["orthogonal", "good.csv", "--json", "-"]);
    assert_eq!(output.status.code(), Some(0));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["results"][0]["variance"]["error"], "repeats");
}

#[test]
fn what_cannot_be_designed_is_refused() {
    let root = tempfile::tempdir().unwrap();
    for (arguments, said) in [
        (
            &["--stiffness", "-1", "--loss-factor", "0.3"][..],
            "--stiffness: -1 is outside",
        ),
        (
            &["--stiffness", "inf", "--loss-factor", "0.3"],
            "--stiffness: inf is outside",
        ),
        (
            &["--stiffness", "1", "--loss-factor", "NaN"],
            "--loss-factor: NaN is outside",
        ),
        (
            &words("--stiffness 1 --loss-factor 0.3 --amplitude 0.3"),
            "--amplitude: 0.3 is outside 0.05…0.25",
        ),
        (
            &words("--stiffness 1 --loss-factor 0.3 --amplitude-range 0.2..0.1"),
            "--amplitude-range: 0.2 mm is above 0.1 mm",
        ),
        (
            &words("--stiffness 1 --loss-factor 0.3 --amplitude-range 0.2"),
            "--amplitude-range: \"0.2\" is not a range",
        ),
        (
            &words("--stiffness 1 --loss-factor 0.3 --frequency 0"),
            "--frequency: 0 is outside",
        ),
        (
            &words("--stiffness 1 --loss-factor 0.3 --tolerance 2"),
            "--tolerance: 2 is outside",
        ),
        (
            &["--stiffness", "1", "--loss-factor", "0.3", "--json", "."],
            "is a directory",
        ),
    ] {
        refuses(root.path(), &[&["design"], arguments].concat(), &[said]);
    }
}

/// A requirement that no density meets gives exit code 1, one line with the nearest values, and the complete result.
#[test]
fn what_no_density_gives_ends_with_1_and_what_is_nearest() {
    let root = tempfile::tempdir().unwrap();
    let asked = words("design --stiffness 8 --loss-factor 0.6 --json d.json");
    let output = hil(root.path(), &asked);
    assert_eq!(output.status.code(), Some(1));
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(error.lines().count(), 1, "{error}");
    assert!(error.contains("no density gives K = 8 kN/mm"), "{error}");
    assert!(error.contains("nearest is K = "), "{error}");
    let found: serde_json::Value =
        serde_json::from_slice(&fs::read(root.path().join("d.json")).unwrap()).unwrap();
    assert_eq!(found["solutions"].as_array().unwrap().len(), 0);
    assert!(found["reachable"]["nearest"]["density"].is_f64());
}

#[test]
fn a_design_says_what_the_rig_measured() {
    let root = tempfile::tempdir().unwrap();
    let asked = words("design --stiffness 1.7 --loss-factor 0.6 --frequency 5 --json -");
    let output = hil(root.path(), &asked);
    assert_eq!(
        output.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let runs = found["on_rig"].as_array().unwrap();
    let solutions = found["solutions"].as_array().unwrap();
    assert!(!runs.is_empty());
    assert_eq!(runs.len(), solutions.len());
    for (run, solution) in runs.iter().zip(solutions) {
        let stiffness = run["measured"]["stiffness"].as_f64().unwrap();
        let found = solution["point"]["stiffness"].as_f64().unwrap();
        assert!((stiffness / found - 1.0).abs() < 0.05, "{run} {solution}");
        assert!(solution["by_other_law"]["loss_factor"].is_f64());
    }
}

/// 50 Hz is beyond the rig: the design is still reported, with a note that it was not checked.
#[test]
fn a_design_that_the_rig_cannot_run_is_told_and_ends_with_1() {
    let root = tempfile::tempdir().unwrap();
    let asked = words("design --stiffness 4.1 --loss-factor 0.7 --frequency 50 --json d.json");
    let output = hil(root.path(), &asked);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(
        error.contains("the rig tripped, so not every solution"),
        "{error}"
    );
    let found: serde_json::Value =
        serde_json::from_slice(&fs::read(root.path().join("d.json")).unwrap()).unwrap();
    assert!(found["on_rig"][0]["stopped"].is_string(), "{found}");
}

fn curve(directory: &Path, name: &str, force: impl Fn(f64) -> f64) {
    let mut text = "time_s,displacement_mm,force_kN\n".to_owned();
    for i in 0..=400 {
        let x = 0.5 - (f64::from(i) / 400.0 - 0.5).abs();
        text += &format!("{i},{x},{}\n", force(x));
    }
    fs::write(directory.join(name), text).unwrap();
}

#[test]
fn what_cannot_be_characterized_is_refused() {
    let root = tempfile::tempdir().unwrap();
    curve(root.path(), "good.csv", |x| 2.0 * x);
    curve(root.path(), "no-potential.csv", |_| 0.0);
    let run = |arguments: &[&str]| hil(root.path(), &[&["characterize"], arguments].concat());
    assert_eq!(run(&["good.csv"]).status.code(), Some(2));
    assert_eq!(
        run(&["good.csv", "--static", "--dynamic"]).status.code(),
        Some(2)
    );
    for (arguments, said) in [
        (&["good.csv", "--dynamic"][..], "there is no whole cycle"),
        (
            &["no-potential.csv", "--static"],
            "no cycle has an elastic potential",
        ),
        (&["none.csv", "--static"], "does not exist"),
        (&["good.csv", "--static", "--out", "good.csv"], "is a file"),
    ] {
        refuses(
            root.path(),
            &[&["characterize"], arguments].concat(),
            &[said],
        );
    }
    let output = run(&["good.csv", "--static", "--out", "out", "--json", "-"]);
    assert_eq!(output.status.code(), Some(0));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(found["kind"], "static");
    let stiffness = found["equivalent_stiffness"]["mean"].as_f64().unwrap();
    assert!((stiffness - 2.0).abs() < 1e-9, "{stiffness}");
    let picture = fs::read_to_string(root.path().join("out/characterize.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("middle line"));
}

#[test]
fn paper_refuses_before_it_computes_what_it_could_not_write() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("taken"), "").unwrap();
    fs::create_dir_all(root.path().join("dir/report.html")).unwrap();
    for (arguments, said) in [
        (&["--out", "taken"][..], "taken is a file, not a directory"),
        (&["--out", "dir"], "dir/report.html: is a directory"),
        (&["--json", "."], "is a directory"),
        (&["--json", "taken/paper.json"], "taken is a file"),
    ] {
        refuses(root.path(), &[&["paper"], arguments].concat(), &[said]);
    }
    for arguments in [
        &["paper", "--json", ""][..],
        &["paper", "tables"],
        &["paper", "--seed", "1"],
        &["run", "--law", "moon"],
        &["run", "--law", "surfaces", "--model", "model.json"],
    ] {
        let output = hil(root.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(String::from_utf8(output.stderr).unwrap().contains("--help"));
    }
}

#[test]
fn every_bad_recording_is_refused_by_characterize() {
    let root = tempfile::tempdir().unwrap();
    for (name, bytes, said) in bad_recordings() {
        fs::write(root.path().join(name), bytes).unwrap();
        for kind in ["--static", "--dynamic"] {
            // A load–unload curve may pause for any time.
            if (name, kind) == ("jump.csv", "--static") {
                continue;
            }
            refuses(
                root.path(),
                &words(&format!(
                    "characterize {name} {kind} --out new --json new.json"
                )),
                said,
            );
        }
    }
}
