//! `hil respond`: the motion of a mass on a model, and the sweep.

use std::f64::consts::TAU;
use std::fs;
use std::path::Path;

use crate::command::words;
use crate::refusal::{hil, refuses};
use mesh_damper_recording::Recording;
use serde_json::Value;

/// 2 kN/mm, a dashpot of 1e-3 kN·s/mm, and a channel with a delay.
const MODEL: &str = r#"{ "format": "mesh-damper-model", "version": 1,
  "units": { "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" },
  "law": [ { "amplitude": 0.0, "k1": 2.0, "k3": 0.0, "c": 0.001, "alpha": 1.0 } ],
  "effects": [ { "family": "delay", "parameters": { "time": 0.001 } } ],
  "fitted_range": { "displacement": [-0.02, 0.02], "velocity": [-6.3, 6.3] } }"#;

/// A force in N without a displacement column, and a base in µm.
fn files(directory: &Path) {
    fs::write(directory.join("model.json"), MODEL).unwrap();
    let (mut force, mut base) = (
        String::from("time_s,force_N\n"),
        String::from("time_ms,displacement_um\n"),
    );
    for index in 0..2000 {
        let time = f64::from(index) * 1e-3;
        let wave = (TAU * 10.0 * time).sin();
        force += &format!("{time:.3},{:.6}\n", 100.0 * wave);
        base += &format!("{index},{:.6}\n", 100.0 * wave);
    }
    fs::write(directory.join("force.csv"), force).unwrap();
    fs::write(directory.join("base.csv"), base).unwrap();
}

fn done(directory: &Path, arguments: &[&str]) -> (String, String) {
    let output = hil(directory, arguments);
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let (out, error) = (text(output.stdout), text(output.stderr));
    assert!(output.status.success(), "{arguments:?}: {error}");
    (out, error)
}

const FORCE: [&str; 9] = [
    "respond",
    "--model",
    "model.json",
    "--mass",
    "50",
    "--force",
    "force.csv",
    "--out",
    "out.csv",
];

#[test]
fn a_force_moves_the_mass_and_the_file_is_a_recording() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let (out, error) = done(root.path(), &FORCE);
    assert!(out.contains("Energy, J: input"), "{out}");
    assert!(
        error.contains("delay: a delay of the force channel"),
        "{error}"
    );
    assert!(
        error.contains(
            "of the samples lie outside the operating range of model.json: displacement at "
        ),
        "{error}"
    );
    let recording = Recording::read(root.path().join("out.csv")).unwrap();
    assert_eq!(recording.len(), 2000);
    assert!(recording.velocity.is_some());
    // X = P/|k − Mω² + icω|
    let omega = TAU * 10.0;
    let expected = 0.1 / (2.0 - 50e-6 * omega * omega).hypot(1e-3 * omega);
    let last = recording.displacement[1500..].iter();
    let amplitude = last.fold(0.0_f64, |most, y| most.max(y.abs()));
    assert!(
        (amplitude / expected - 1.0).abs() < 5e-3,
        "{amplitude} {expected}"
    );
    let spring = |index: usize| 2.0 * recording.displacement[index];
    let dashpot = |index: usize| 1e-3 * recording.velocity.as_ref().unwrap()[index];
    for index in 1..2000 {
        let expected = spring(index) + dashpot(index);
        assert!((recording.force[index] - expected).abs() < 1e-6, "{index}");
    }
}

#[test]
fn json_has_what_a_run_did() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let arguments =
        words("respond --model model.json --mass 50 --base base.csv --out out.csv.gz --json -");
    let (out, _) = done(root.path(), &arguments);
    let json: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["format"], "mesh-damper respond");
    assert_eq!(json["drive"], "base");
    assert_eq!(json["left_out"][0]["family"], "delay");
    assert_eq!(json["settled"], true);
    let number = |path: &str| json.pointer(path).unwrap().as_f64().unwrap();
    assert!(number("/step") < 1e-3 && number("/change_on_halving") <= 1e-3);
    let sum = ["kinetic", "elastic", "dissipated", "residual"]
        .map(|part| number(&format!("/energy/{part}")));
    assert!((number("/energy/input") - sum.iter().sum::<f64>()).abs() < 1e-12);
    // 10 Hz is half of the resonance: the mass moves further than the base.
    assert!(number("/displacement/peak") > 0.1);
    assert!(number("/relative_displacement/rms") < number("/displacement/rms"));
}

#[test]
fn a_sweep_has_the_resonance_in_table_json_and_picture() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let arguments = words(
        "respond --model model.json --mass 50 --sweep --amplitudes 0.01,0.02 --from 10 --to 90 --points 9 --out sweep.csv --picture sweep.svg --json sweep.json",
    );
    let (out, error) = done(root.path(), &arguments);
    assert!(out.contains("below 1 from"), "{out}");
    let table = fs::read_to_string(root.path().join("sweep.csv")).unwrap();
    assert!(table.starts_with("base_amplitude_mm,frequency_Hz,transmissibility,"));
    assert_eq!(table.lines().count(), 1 + 2 * 9);
    let json = fs::read_to_string(root.path().join("sweep.json")).unwrap();
    let json: Value = serde_json::from_str(&json).unwrap();
    let points = json["points"].as_array().unwrap();
    // The operating range is 0.02 mm and 6.3 mm/s, with a margin of 5 %.
    let beyond = |name: &str, edge: f64| {
        let values = points.iter().map(|point| point[name].as_f64().unwrap());
        values.map(|value| value / edge - 1.0).collect::<Vec<_>>()
    };
    let (y, v) = (
        beyond("damper_amplitude", 0.02),
        beyond("damper_speed", 6.3),
    );
    let outside = y.iter().zip(&v).filter(|(y, v)| y.max(**v) > 0.05).count();
    assert!(outside > 0 && outside < 18, "{outside}");
    let told = |path: &str| json.pointer(path).unwrap().as_f64().unwrap();
    assert_eq!(told("/outside_operating_range/part"), outside as f64 / 18.0);
    let most = |of: &[f64]| of.iter().fold(0.0_f64, |most, one| most.max(*one));
    assert!((told("/outside_operating_range/displacement/most") - most(&y)).abs() < 1e-9);
    assert!((told("/outside_operating_range/velocity/most") - most(&v)).abs() < 1e-9);
    assert!((told("/beyond_fitted_range") - most(&y).max(most(&v))).abs() < 1e-9);
    let warned = format!(
        "{:.1} % of the motions lie outside",
        100.0 * outside as f64 / 18.0
    );
    assert!(error.contains(&warned), "{error}");
    for point in points {
        let number = |name: &str| point[name].as_f64().unwrap();
        let omega = TAU * number("frequency");
        let (damping, rest) = (1e-3 * omega, 2.0 - 50e-6 * omega * omega);
        let expected = 2.0_f64.hypot(damping) / rest.hypot(damping);
        let found = number("transmissibility");
        assert!((found / expected - 1.0).abs() < 2e-3, "{point} {expected}");
    }
    let picture = fs::read_to_string(root.path().join("sweep.svg")).unwrap();
    assert!(picture.contains("base ±0.02 mm"));
}

#[test]
fn what_gives_no_motion_is_refused_in_one_line() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let with = |option: &str, value: &str| {
        let mut arguments: Vec<String> = FORCE.map(String::from).into();
        let at = arguments.iter().position(|one| one == option).unwrap();
        arguments[at + 1] = value.into();
        arguments
    };
    let spoil = |text: &str| fs::write(root.path().join("bad.csv"), text).unwrap();
    let refused = |arguments: &[String], said: &[&str]| {
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        refuses(root.path(), &arguments, said);
    };
    spoil("time_s,displacement_mm\n0,1\n");
    refused(
        &with("--mass", "0"),
        &[
            "--mass: 0 and the model has no effect `inertia`",
            "give a mass",
        ],
    );
    refused(
        &with("--mass", "-3"),
        &["--mass: -3 is outside", "give the mass"],
    );
    refused(&with("--mass", "nan"), &["--mass: NaN is outside"]);
    refused(
        &with("--force", "bad.csv"),
        &["bad.csv: line 1", "there is no force column"],
    );
    refused(
        &with("--force", "none.csv"),
        &["none.csv", "does not exist"],
    );
    refused(&with("--model", "force.csv"), &["force.csv", "not JSON"]);
    refused(
        &with("--out", "force.csv"),
        &["force.csv: would replace the input"],
    );
    let mut twice = with("--mass", "50");
    twice.extend(["--tolerance".into(), "0".into()]);
    refused(&twice, &["--tolerance: 0 is outside"]);
    spoil("time_s,force_N\n0,1\n0.1,inf\n");
    refused(
        &with("--force", "bad.csv"),
        &["bad.csv: line 3, column force_N", "not finite"],
    );
    spoil("time_s,force_N\n0,1\n0.1,2\n");
    refused(
        &with("--force", "bad.csv"),
        &["bad.csv", "holds only 2 samples"],
    );
    let rows = |time: fn(i32) -> f64| {
        let rows = (0..60).map(|i| format!("{},{}\n", time(i), f64::from(i).sin()));
        "time_s,force_N\n".to_owned() + &rows.collect::<String>()
    };
    spoil(&rows(|i| if i == 30 { 0.1 } else { 0.01 * f64::from(i) }));
    refused(
        &with("--force", "bad.csv"),
        &["bad.csv: line 32", "time runs backwards"],
    );
    spoil(&rows(|i| if i == 59 { 1e9 } else { 0.01 * f64::from(i) }));
    refused(
        &with("--force", "bad.csv"),
        &["bad.csv: line 61", "time jumps"],
    );
}

/// Jittering times are resampled to equal steps, as in every other command.
#[test]
fn uneven_times_are_resampled() {
    let root = tempfile::tempdir().unwrap();
    files(root.path());
    let mut text = String::from("time_s,force_N\n");
    for index in 0..2000 {
        let time = (f64::from(index) + 0.1 * f64::from((index * 3) % 5)) * 1e-3;
        text += &format!("{time:.6},{:.6}\n", 100.0 * (TAU * 10.0 * time).sin());
    }
    fs::write(root.path().join("jitter.csv"), text).unwrap();
    done(root.path(), &FORCE);
    let even = Recording::read(root.path().join("out.csv")).unwrap();
    let mut arguments = FORCE;
    (arguments[6], arguments[8]) = ("jitter.csv", "uneven.csv");
    done(root.path(), &arguments);
    let uneven = Recording::read(root.path().join("uneven.csv")).unwrap();
    for (time, y) in uneven
        .time
        .iter()
        .zip(&uneven.displacement)
        .skip(1000)
        .take(900)
    {
        let index = (time / 1e-3).floor() as usize;
        let part = time / 1e-3 - index as f64;
        let same = even.displacement[index] * (1.0 - part) + even.displacement[index + 1] * part;
        assert!((y - same).abs() < 1e-3 * 0.055, "{time}: {y} {same}");
    }
}
