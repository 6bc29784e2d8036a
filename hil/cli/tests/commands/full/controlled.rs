//! Control inputs on the command line: a column of a recording, or a value for the whole recording.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use mesh_damper_recording::Recording;
use serde_json::Value;

use crate::command::words;
use crate::refusal::{hil, refuses};

/// A dashpot of 0.01 kN·s/mm at an ampere, without a branch.
const MODEL: &str = r#"{ "format": "mesh-damper-model", "version": 1,
  "units": { "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" },
  "law": [ { "amplitude": 0.0, "k1": 2.0, "k3": 0.0, "c": 0.0, "alpha": 0.5 } ],
  "effects": [ { "family": "control_input", "parameters":
    { "stiffness": 0.0, "yield_stretch": 0.1, "rate": 1.0, "viscosity": 0.01, "input": 1 } } ],
  "controls": [ { "name": "pressure_bar", "range": [1.0, 2.0] }, { "name": "current_A", "range": [0.0, 1.0] } ],
  "fitted_range": { "displacement": [-0.2, 0.2], "velocity": [-6.3, 6.3] } }"#;

/// 0.1 mm at 2 Hz, with the columns `header`, each with the value `value`.
fn recording(path: &Path, header: &str, values: &str) {
    let mut text = format!("time_s,displacement_mm,force_kN{header}\n");
    for row in 0..1000 {
        let time = f64::from(row) * 2e-3;
        let y = 0.1 * (std::f64::consts::TAU * 2.0 * time).sin();
        writeln!(text, "{time:.3},{y:.9},{:.9}{values}", 2.0 * y).unwrap();
    }
    fs::write(path, text).unwrap();
}

/// Largest predicted force in addition to the spring's, kN.
fn beyond_the_spring(directory: &Path, recording: &str, more: &[&str]) -> f64 {
    let arguments = [
        &[
            "predict",
            "--model",
            "model.json",
            recording,
            "--out",
            "pred.csv",
        ],
        more,
    ]
    .concat();
    let output = hil(directory, &arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{error}");
    let text = fs::read_to_string(directory.join("pred.csv")).unwrap();
    let rows = text.lines().skip(1);
    rows.map(|row| {
        let cells: Vec<&str> = row.split(',').collect();
        let cell = |place: usize| cells[place].parse::<f64>().unwrap();
        (cell(cells.len() - 1) - 2.0 * cell(1)).abs()
    })
    .fold(0.0, f64::max)
}

/// Speed at the middle of the motion, mm/s.
const SPEED: f64 = 0.1 * std::f64::consts::TAU * 2.0;

#[test]
fn a_prediction_takes_the_column_by_its_name_or_a_value_in_its_place() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    recording(
        &root.path().join("both.csv"),
        ",current_A,pressure_bar",
        ",0.5,2",
    );
    recording(&root.path().join("none.csv"), "", "");
    let near = |found: f64, current: f64| {
        let expected = 0.01 * current * SPEED;
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    };
    near(beyond_the_spring(root.path(), "both.csv", &[]), 0.5);
    let given = ["--control", "current_A=0.25"];
    near(beyond_the_spring(root.path(), "both.csv", &given), 0.25);
    let both = ["--control", "current_A=1", "--control", "pressure_bar=2"];
    near(beyond_the_spring(root.path(), "none.csv", &both), 1.0);

    let predict = |control| {
        let model = ["predict", "--model", "model.json", "none.csv"];
        [&model[..], &["--out", "no.csv", "--control", control]].concat()
    };
    refuses(
        root.path(),
        &predict("current_A=1"),
        &[
            "none.csv",
            "no column pressure_bar",
            "--control pressure_bar",
        ],
    );
    refuses(
        root.path(),
        &predict("voltage_V=1"),
        &["voltage_V", "pressure_bar, current_A"],
    );
    let output = hil(root.path(), &predict("current_A=much"));
    assert_eq!(output.status.code(), Some(2));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("such as current_A=0.5"), "{error}");
    assert!(!root.path().join("no.csv").exists());
}

/// A mass of 50 kg that only its dashpot moves: twice the current, half the motion at the resonance.
#[test]
fn a_response_depends_on_the_input() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    let sweep = |current: &str| {
        let current = format!("current_A={current}");
        let arguments = [
            "respond",
            "--model",
            "model.json",
            "--mass",
            "50",
            "--sweep",
            "--amplitudes",
            "0.01",
            "--from",
            "31",
            "--to",
            "33",
            "--points",
            "3",
            "--out",
            "sweep.csv",
            "--json",
            "sweep.json",
            "--control",
            "pressure_bar=1",
            "--control",
            &current,
        ];
        let output = hil(root.path(), &arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{error}");
        let text = fs::read_to_string(root.path().join("sweep.csv")).unwrap();
        let mut rows = text.lines().filter(|row| !row.starts_with('#'));
        let header: Vec<&str> = rows.next().unwrap().split(',').collect();
        let place = header
            .iter()
            .position(|name| name.starts_with("transmissibility"));
        let cell = |row: &str| row.split(',').nth(place.unwrap()).unwrap().parse::<f64>();
        rows.map(|row| cell(row).unwrap()).fold(0.0, f64::max)
    };
    // For a mass on a spring with a dashpot: √(1 + (2ζ)²)/2ζ at the resonance, 2ζ = c·ω/k.
    for (current, c) in [("0.1", 1e-3), ("0.2", 2e-3)] {
        let omega = (2.0_f64 / 50e-6).sqrt();
        let twice_damping = c * omega / 2.0;
        let expected = (1.0 + twice_damping * twice_damping).sqrt() / twice_damping;
        let found = sweep(current);
        assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}");
    }
}

/// The mass follows the column of its excitation, or a value in its place. With neither, the command is refused.
#[test]
fn a_response_takes_the_column_of_its_excitation() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    recording(
        &root.path().join("one.csv"),
        ",current_A,pressure_bar",
        ",1,2",
    );
    recording(&root.path().join("none.csv"), "", "");
    let respond = |base: &'static str, more: &[&'static str]| {
        let model = words("respond --model model.json --mass 50 --out r.csv");
        [&model[..], &["--base", base], more].concat()
    };
    let response = |arguments: &[&str]| {
        let output = hil(root.path(), arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{error}");
        (
            fs::read_to_string(root.path().join("r.csv")).unwrap(),
            error,
        )
    };
    let (by_column, _) = response(&respond("one.csv", &[]));
    let both = ["--control", "current_A=1", "--control", "pressure_bar=2"];
    let (by_value, _) = response(&respond("none.csv", &both));
    assert_eq!(by_column, by_value);
    let less = ["--control", "current_A=0", "--control", "pressure_bar=2"];
    assert_ne!(response(&respond("none.csv", &less)).0, by_value);
    let more = ["--control", "current_A=3", "--control", "pressure_bar=2"];
    let (_, said) = response(&respond("none.csv", &more));
    assert!(
        said.contains("current_A ranges from 3 to 3, but the model was fitted from 0 to 1"),
        "{said}"
    );
    fs::remove_file(root.path().join("r.csv")).unwrap();
    refuses(
        root.path(),
        &respond("none.csv", &[]),
        &["none.csv", "no column pressure_bar"],
    );
}

/// A law under a pressure and a specimen that is under no pressure, or under a current.
#[test]
fn a_rig_refuses_a_model_whose_input_it_does_not_have() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    let effect =
        "control_input:stiffness=0.8,force=0.03,rate=0.6,c=0.004,lag=0.05,most=1,hold=0.5,seed=3";
    let run = |more: &[&'static str]| {
        let run = words("run --model model.json --blocks 0.1:2:6 --out run-out");
        [&run[..], more].concat()
    };
    refuses(root.path(), &run(&[]), &["model.json", "pressure_bar"]);
    refuses(
        root.path(),
        &run(&["--effect", effect]),
        &["model.json", "pressure_bar"],
    );
    refuses(
        root.path(),
        &run(&["--effect", effect, "--effect", effect]),
        &["--effect", "second control input"],
    );
}

#[test]
fn a_specimen_under_a_current_is_recorded_with_it() {
    let root = tempfile::tempdir().unwrap();
    let effect =
        "control_input:stiffness=0.8,force=0.03,rate=0.6,c=0.004,lag=0.05,most=1,hold=0.5,seed=3";
    let arguments = [
        "run", "--effect", effect, "--blocks", "0.1:2:6", "--out", "run-out", "--seed", "1",
    ];
    let output = hil(root.path(), &arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{error}");
    let recording = Recording::read(root.path().join("run-out/recording.csv.gz")).unwrap();
    let [current] = recording.controls.as_slice() else {
        panic!("one input: {:?}", recording.controls.len())
    };
    assert_eq!(current.name, "current_A");
    assert!(current.changes());
    assert!(
        current
            .values
            .iter()
            .all(|value| (0.0..=1.0).contains(value))
    );
    let trace = ["trace", "run-out/recording.csv.gz", "--out", "trace-out"];
    assert!(hil(root.path(), &trace).status.success());
    let text = fs::read_to_string(root.path().join("trace-out/trace.json")).unwrap();
    let result: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(result["verdict"], "found", "{text}");
    assert_eq!(result["effects"][0]["family"], "control_input");
    let model = fs::read_to_string(root.path().join("trace-out/model.json")).unwrap();
    let model: Value = serde_json::from_str(&model).unwrap();
    assert_eq!(model["controls"][0]["name"], "current_A");
}

/// An index that no control input has, and an invalid range.
#[test]
fn a_model_whose_controls_are_wrong_is_refused() {
    let root = tempfile::tempdir().unwrap();
    recording(
        &root.path().join("rec.csv"),
        ",current_A,pressure_bar",
        ",0.5,2",
    );
    let arguments = words("predict --model model.json rec.csv --out no.csv");
    for (right, wrong, told) in [
        ("\"input\": 1", "\"input\": 2", "effects[0]"),
        ("[0.0, 1.0]", "[1.0, 0.0]", "controls[1].range"),
    ] {
        fs::write(root.path().join("model.json"), MODEL.replace(right, wrong)).unwrap();
        refuses(root.path(), &arguments, &["model.json", told]);
    }
}
