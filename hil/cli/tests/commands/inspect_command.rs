//! `hil inspect`, and files of other programs in the commands that read recordings.

use std::fs;
use std::path::Path;

use crate::bad_input::MODEL;
use crate::command::words;
use crate::refusal::{hil, refuses};

/// A recording of another program: header, and rows with a semicolon between the cells.
fn foreign(header: &str) -> String {
    let row = |i: u32| {
        let time = f64::from(i) * 0.005;
        let wave = (std::f64::consts::TAU * 2.0 * time).sin();
        format!("{time:.4};{:.6};{:.3}\n", 0.1 * wave, 200.0 * wave).replace('.', ",")
    };
    header.to_owned() + &(0..400).map(row).collect::<String>()
}

fn said(directory: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let output = hil(directory, arguments);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (
        output.status.code(),
        text(output.stdout),
        text(output.stderr),
    )
}

#[test]
fn a_file_that_is_understood_is_shown_with_the_command_to_run() {
    let root = tempfile::tempdir().unwrap();
    let text = foreign("Pr\u{fc}fer;M\u{fc}ller\n\nZeit [s];Weg [mm];Kraft [N]\n");
    fs::write(root.path().join("rig 1.txt"), text + "\nEnde der Messung\n").unwrap();
    let (code, out, err) = said(root.path(), &["inspect", "rig 1.txt"]);
    assert_eq!(code, Some(0), "{err}");
    for part in [
        "rig 1.txt: text",
        "3 columns, 400 rows",
        "Kraft [N]",
        "-200 to 200",
        "force in N",
        "400 samples from 0 to 1.995 s, 200 Hz, 100 samples in the fastest cycles",
        "displacement -0.1 to 0.1 mm",
        "cells are separated by a semicolon, the decimal sign is a comma",
        "1 row of words at the end",
        "next: hil trace 'rig 1.txt'",
    ] {
        assert!(out.contains(part), "{part:?} not in {out}");
    }
    let (_, json, _) = said(root.path(), &["inspect", "rig 1.txt", "--json", "-"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["format"], "mesh-damper inspect");
    assert_eq!(json["version"], 1);
    let file = &json["files"][0];
    assert_eq!(file["recording"]["samples"], 400);
    assert_eq!(file["tables"][0]["columns"][2]["used_as"], "force in N");
    let rate = file["recording"]["rate_hz"].as_f64().unwrap();
    assert!((rate - 200.0).abs() < 1e-6, "{rate}");
}

#[cfg(feature = "full")]
/// It is at rest in the part that is examined.
#[test]
fn a_long_recording_is_examined_in_part_and_that_is_said() {
    let root = tempfile::tempdir().unwrap();
    let row = |i: u32| format!("{},{}\n", i / 600_000 * (i % 9), i % 7);
    let rows: String = (0..610_000).map(row).collect();
    let text = format!("displacement_mm,force_kN\n{rows}");
    fs::write(root.path().join("long.csv"), text).unwrap();
    let (code, out, err) = said(root.path(), &["inspect", "long.csv", "--rate", "1000"]);
    assert_eq!(code, Some(0), "{err}");
    for part in [
        "610000 samples from 0 to 609.999 s, 1000 Hz",
        "displacement 0 to 8 mm; force 0 to 6 kN",
        "its faults are those of its first 524288 samples",
    ] {
        assert!(out.contains(part), "{part:?} not in {out}");
    }
}

#[cfg(feature = "full")]
#[test]
fn the_texts_of_a_file_are_shown() {
    let root = tempfile::tempdir().unwrap();
    let rows: Vec<f64> = (0..60).map(f64::from).collect();
    let mut file = serde_json::json!({
        "time_s": rows, "displacement_mm": rows, "force_kN": rows,
        "operator": "KM", "place": "a\tb", "remark": "x".repeat(1000),
    });
    for note in 0..7 {
        file[format!("z{note}")] = "text".into();
    }
    fs::write(root.path().join("a.json"), file.to_string()).unwrap();
    let (_, out, err) = said(root.path(), &["inspect", "a.json"]);
    let shown: Vec<&str> = out
        .lines()
        .filter(|line| line.contains("comment"))
        .collect();
    assert_eq!(shown.len(), 9, "{out}{err}");
    assert_eq!(
        shown[..2],
        ["  comment: operator: KM", "  comment: place: a b"]
    );
    assert_eq!(shown[2].chars().count(), "  comment: ".len() + 120);
    assert_eq!(shown[8], "  and 2 more comments; --json has all");
    let (_, json, _) = said(root.path(), &["inspect", "a.json", "--json", "-"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let comments = json["files"][0]["comments"].as_array().unwrap();
    assert_eq!(comments.len(), 10);
    assert_eq!(comments[1], "place: a\tb");
}

/// A recording of blocks of 1 and 5 Hz that lacks three samples.
#[test]
fn missing_samples_and_the_fastest_cycles_are_shown() {
    let root = tempfile::tempdir().unwrap();
    let mut text = "time_s,displacement_mm,force_kN\n".to_owned();
    for i in 0..1600 {
        let time = f64::from(i) * 0.005;
        let frequency = if time < 4.0 { 1.0 } else { 5.0 };
        let wave = (std::f64::consts::TAU * frequency * time).sin();
        // An empty cell, two cells that are no number.
        let force = match i {
            100 => String::new(),
            700 | 701 => "nan".into(),
            _ => format!("{:.6}", 0.2 * wave),
        };
        text += &format!("{time:.3},{:.6},{force}\n", 0.1 * wave);
    }
    fs::write(root.path().join("rig.csv"), text).unwrap();
    let (code, out, err) = said(root.path(), &["inspect", "rig.csv"]);
    assert_eq!(code, Some(0), "{err}");
    assert!(
        out.contains("warning: missing samples: 3 in 2 gaps"),
        "{out}"
    );
    assert!(out.contains("40 samples in the fastest cycles"), "{out}");
    let (_, json, _) = said(root.path(), &["inspect", "rig.csv", "--json", "-"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let recording = &json["files"][0]["recording"];
    let samples = recording["samples_per_cycle"].as_f64().unwrap();
    assert!((samples - 40.0).abs() < 0.5, "{samples}");
    assert_eq!(recording["faults"].as_array().unwrap().len(), 1);
}

/// A user inspects a file to see why it cannot be read, so its columns are listed before the refusal.
#[test]
fn a_file_that_no_option_makes_right_is_shown_before_it_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let text = foreign("Zeit [s];Weg [mm];Kraft [N]\n");
    let spoilt = text.replacen("\n0,0500;", "\n0,0100;", 1);
    assert_ne!(spoilt, text);
    fs::write(root.path().join("rig.txt"), spoilt).unwrap();
    let (code, out, err) = said(root.path(), &["inspect", "rig.txt"]);
    assert_eq!(code, Some(2), "{out}");
    assert!(
        out.contains("Kraft [N]") && out.contains("force in N"),
        "{out}"
    );
    assert!(err.contains("rig.txt: line"), "{err}");
    assert!(!out.contains("next"), "{out}");
    let (code, json, _) = said(root.path(), &["inspect", "rig.txt", "--json", "-"]);
    assert_eq!(code, Some(2));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let problem = json["files"][0]["problem"].as_str().unwrap();
    assert!(err.contains(problem), "{problem} not in {err}");
}

/// A column that three questions offer is not the answer to all of them.
#[test]
fn the_command_to_run_takes_no_column_twice() {
    let root = tempfile::tempdir().unwrap();
    let text = foreign("A;B;C\n");
    fs::write(root.path().join("rig.txt"), text).unwrap();
    let (code, out, err) = said(root.path(), &["inspect", "rig.txt"]);
    assert_eq!(code, Some(0), "{err}");
    // The command asks for names and units at once.
    let command = "hil trace rig.txt --channel time=A --unit time=UNIT \
        --channel displacement=NAME --unit displacement=UNIT --channel force=NAME --unit force=UNIT";
    assert!(out.contains(command), "{out}");
    // Only one column rises, as times do.
    assert!(
        out.contains("or say which one it is: --channel time=A, with its unit"),
        "{out}"
    );
    // No option states a factor. So the file is refused, and no command is offered.
    let scaled = foreign("Zeit [s];Weg [1/100 mm];Kraft [N]\n");
    fs::write(root.path().join("scaled.txt"), scaled).unwrap();
    let (code, out, err) = said(root.path(), &["inspect", "scaled.txt"]);
    assert_eq!(code, Some(2), "{out}");
    assert!(err.contains("has a factor, which is not read"), "{err}");
    assert!(out.contains("Kraft [N]") && !out.contains("next"), "{out}");
    // A column that the user named is not offered again, and not called unused while others are missing.
    let (code, out, err) = said(
        root.path(),
        &["inspect", "rig.txt", "--channel", "displacement=B"],
    );
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("displacement, as you stated"), "{out}");
    assert!(
        !out.contains("not used") && !out.contains("force=B"),
        "{out}"
    );
}

/// Each question is printed with its option. The printed command contains the option, and with it no question remains.
#[test]
fn a_question_is_no_error_and_its_command_answers_it() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("a.txt"), foreign("Zeit;Weg [mm];Kraft\n")).unwrap();
    let (code, out, err) = said(root.path(), &["inspect", "a.txt"]);
    assert_eq!(code, Some(0), "{err}");
    assert!(
        out.contains("question: column Zeit: the name carries no unit"),
        "{out}"
    );
    assert!(
        out.contains("question: column Kraft: the name carries no unit"),
        "{out}"
    );
    // Only the user knows the unit, so none is proposed.
    let command = "hil trace a.txt --unit time=UNIT --unit force=UNIT";
    assert!(out.contains(command), "{out}");
    let (code, out, err) = said(
        root.path(),
        &["inspect", "a.txt", "--unit", "time=s", "--unit", "force=N"],
    );
    assert_eq!(code, Some(0), "{err}");
    assert!(
        out.contains("force -0.2 to 0.2 kN") && !out.contains("question"),
        "{out}"
    );
    assert!(
        out.contains("next: hil trace a.txt --unit time=s --unit force=N"),
        "{out}"
    );

    let either = "time_s;displacement_mm;force_kN\n".to_owned()
        + &(0..20)
            .map(|n| format!("1,{:03};{n};{}\n", 100 + n, n % 3))
            .collect::<String>();
    fs::write(root.path().join("b.txt"), either).unwrap();
    let (code, out, err) = said(root.path(), &["inspect", "b.txt"]);
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("--decimal point or --decimal comma"), "{out}");
    refuses(
        root.path(),
        &["inspect", "none.txt"],
        &["none.txt", "does not exist"],
    );
    fs::write(root.path().join("letter.txt"), "Dear reader,\nhello.\n").unwrap();
    refuses(
        root.path(),
        &["inspect", "letter.txt"],
        &["letter.txt", "holds no rows"],
    );
}

/// The guesses are notes, and the prediction is written in our own format.
#[test]
fn a_prediction_for_a_file_of_another_program_is_written_in_our_own_format() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    // Windows-1252, as a German Excel writes it.
    let text = foreign("Pr\u{fc}fzeit [s];Weg [mm];Kraft [N]\n");
    let bytes: Vec<u8> = text
        .chars()
        .map(|c| u8::try_from(u32::from(c)).unwrap())
        .collect();
    fs::write(root.path().join("a.csv"), bytes).unwrap();
    let arguments = words("predict --model model.json a.csv --out p.csv --on f64");
    let (code, _, err) = said(root.path(), &arguments);
    assert_eq!(code, Some(0), "{err}");
    assert!(
        err.contains("note: a.csv: its characters are read as windows-1252"),
        "{err}"
    );
    assert!(
        err.contains("note: a.csv: force is read from column \"Kraft [N]\" in N"),
        "{err}"
    );
    let written = fs::read_to_string(root.path().join("p.csv")).unwrap();
    assert!(
        written.starts_with(
            "time_s,displacement_mm,force_N,predicted_beyond,predicted_band_N,predicted_force_N\n"
        ),
        "{written}"
    );
    assert_eq!(written.lines().count(), 401);
}
