//! `hil trace` followed by `hil predict`: their files agree with each other.

use std::fs;
use std::path::Path;

use mesh_damper_identify::trace::result::{TraceResult, Verdict};
use mesh_damper_recording::Recording;

use crate::command::{hil, words};

/// Eq 13 and a constant force under blocks of sines (amplitude mm, frequency Hz), with noise that is the same on every
/// run.
fn record(path: &Path, blocks: &[(f64, f64)]) {
    let (mut time, mut displacement, mut force) = (Vec::new(), Vec::new(), Vec::new());
    for &(amplitude, frequency) in blocks {
        let count = (8.0 / frequency * 500.0_f64).round() as usize;
        for i in 0..count {
            let phase = std::f64::consts::TAU * frequency * i as f64 / 500.0;
            let (y, v) = (
                amplitude * phase.sin(),
                amplitude * std::f64::consts::TAU * frequency * phase.cos(),
            );
            // A multiplicative congruential sequence, uniform within ±0.7e-3 kN.
            let noise = ((time.len() * 16_807 + 11) % 2_147 * 7_919 % 1_000) as f64 / 1_000.0 - 0.5;
            time.push(time.len() as f64 / 500.0);
            displacement.push(y);
            force.push(
                y + 8.0 * y.powi(3) + 0.1 * v.abs().powf(0.3) * v.signum() + 0.08 + 1.4e-3 * noise,
            );
        }
    }
    let name = path.display().to_string();
    let recording = Recording::new(name, time, displacement, force).unwrap();
    fs::write(path, recording.to_file(path).unwrap()).unwrap();
}

#[test]
fn what_trace_leaves_predict_takes_up() {
    let root = tempfile::tempdir().unwrap();
    record(
        &root.path().join("rec.csv"),
        &[(0.1, 1.0), (0.1, 5.0), (0.2, 1.0), (0.2, 5.0)],
    );
    record(&root.path().join("held.csv.gz"), &[(0.15, 2.0)]);
    let printed = hil(
        root.path(),
        &words("trace rec.csv --held-out held.csv.gz --out a/b --json -"),
    );
    let out = root.path().join("a/b");
    let file = fs::read_to_string(out.join("trace.json")).unwrap();
    // Standard output holds the result and nothing else.
    assert_eq!(printed, file);
    let result: TraceResult = serde_json::from_str(&file).unwrap();
    assert_eq!(result.verdict, Verdict::Found);
    assert_eq!(result.effects[0].family, "offset");
    let force = &result.effects[0].parameters["force"];
    // Noise of 4e-4 kN RMS over thousands of samples: the constant is known to a few 1e-5 kN.
    assert!((force.value - 0.08).abs() < 1e-3, "{force:?}");
    assert_eq!(result.held_out, ["held.csv.gz"]);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("Found: offset") && page.contains("held.csv.gz"));

    for (on, expected) in [
        ("f64", result.augmented.nrmse_held_out),
        ("f32", result.on_target.nrmse_held_out),
    ] {
        let arguments = words("predict --model a/b/model.json held.csv.gz --out p.csv");
        let printed = hil(
            root.path(),
            &[&arguments[..], &["--on", on, "--json", "-"]].concat(),
        );
        let summary: serde_json::Value = serde_json::from_str(&printed).unwrap();
        let nrmse = summary["nrmse"].as_f64().unwrap();
        // The file keeps every digit: only the channels' last printed digit may differ.
        assert!(
            (nrmse / expected - 1.0).abs() < 1e-6,
            "{on}: {nrmse} {expected}"
        );
    }
}

/// A channel that stands still for a while, an inverted sign, a unit that changes within the recording: both commands leave out the
/// same samples and repair the same faults.
#[test]
fn both_say_the_same_of_a_recording_with_faults() {
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    record(
        &at("rec.csv"),
        &[(0.1, 1.0), (0.1, 5.0), (0.2, 1.0), (0.2, 5.0)],
    );
    record(&at("held.csv"), &[(0.15, 2.0), (0.15, 2.0)]);
    let whole = Recording::read(at("held.csv")).unwrap();
    let mut frozen = whole.force.clone();
    frozen[500..900].fill(whole.force[500]);
    let turned = whole.force.iter().map(|force| -force).collect();
    let mut newtons = whole.force.clone();
    newtons[2600..]
        .iter_mut()
        .for_each(|force| *force *= 1000.0);
    let recordings = [
        ("frozen.csv", frozen),
        ("turned.csv", turned),
        ("newtons.csv", newtons),
    ];
    for (name, force) in recordings {
        let (time, y) = (whole.time.clone(), whole.displacement.clone());
        let recording = Recording::new(name, time, y, force).unwrap();
        fs::write(at(name), recording.to_file(&at(name)).unwrap()).unwrap();
        hil(
            root.path(),
            &["trace", "rec.csv", "--held-out", name, "--out", "out"],
        );
        let file = fs::read_to_string(at("out/trace.json")).unwrap();
        let result: TraceResult = serde_json::from_str(&file).unwrap();
        let expected = result.augmented.nrmse_held_out;
        assert!(expected < 0.01, "{name}: {expected}");
        let printed = hil(
            root.path(),
            &words(&format!(
                "predict --model out/model.json {name} --out p.csv --on f64 --json -"
            )),
        );
        let summary: serde_json::Value = serde_json::from_str(&printed).unwrap();
        let nrmse = summary["nrmse"].as_f64().unwrap();
        assert!(
            (nrmse / expected - 1.0).abs() < 1e-3,
            "{name}: {nrmse} {expected}"
        );
    }
}

/// The constant force is known from the first test: it is in the law of the next test, and is not found again.
#[test]
fn what_a_model_knows_stays_in_the_law_of_the_next_test() {
    let root = tempfile::tempdir().unwrap();
    let blocks = [(0.1, 1.0), (0.1, 5.0), (0.2, 1.0), (0.2, 5.0)];
    for name in ["rec.csv", "next.csv"] {
        record(&root.path().join(name), &blocks);
    }
    // The noise of `record` is periodic, like a tone.
    let trace = |arguments: &[&str]| {
        let no_tone = &["--exclude", "periodic"];
        hil(root.path(), &[&["trace"], arguments, no_tone].concat())
    };
    trace(&["rec.csv", "--out", "first"]);
    let printed = trace(&["next.csv", "--law", "first/model.json", "--out", "next"]);
    assert!(
        printed.contains("before: mixed damping law with offset"),
        "{printed}"
    );
    let read = |file: &str| -> serde_json::Value {
        let text = fs::read_to_string(root.path().join(file)).unwrap();
        serde_json::from_str(&text).unwrap()
    };
    let result = read("next/trace.json");
    assert_eq!(result["effects"], serde_json::json!([]));
    assert_eq!(result["baseline"]["known"], serde_json::json!(["offset"]));
    assert_eq!(read("next/model.json")["effects"][0]["family"], "offset");
}

/// The force is in N although its column says kN.
#[test]
fn a_doubtful_unit_is_reported_before_the_search() {
    let root = tempfile::tempdir().unwrap();
    let path = root.path().join("newtons.csv");
    record(&path, &[(0.1, 2.0), (0.1, 5.0), (0.2, 2.0)]);
    let text = fs::read_to_string(&path).unwrap();
    let in_newtons = |line: &str| match line.rsplit_once(',') {
        Some((row, force)) if force.parse::<f64>().is_ok() => {
            format!("{row},{}", 1e3 * force.parse::<f64>().unwrap())
        }
        _ => line.to_owned(),
    };
    let lines: Vec<String> = text.lines().map(in_newtons).collect();
    fs::write(&path, lines.join("\n") + "\n").unwrap();
    let output = crate::refusal::hil(root.path(), &["trace", "newtons.csv"]);
    let error = String::from_utf8(output.stderr).unwrap();
    let warned = error.lines().next().unwrap_or_default();
    assert!(
        warned.starts_with("warning: newtons.csv: unit of the force or of the displacement wrong by a factor of 1000"),
        "{error}"
    );
}
