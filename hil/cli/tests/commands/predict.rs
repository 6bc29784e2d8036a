//! `hil predict`: writes the recording's rows with the force of the model, in the recording's own unit.

use std::fs;
use std::path::Path;

use mesh_damper_recording::Recording;

use crate::command::{hil, words};
use crate::refusal;

/// k1 = 2 kN/mm and a preload of 0.5 kN: each line of the file shows this force.
const MODEL: &str = r#"{ "format": "mesh-damper-model", "version": 1,
  "units": { "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" },
  "law": [ { "amplitude": 0.0, "k1": 2.0, "k3": 0.0, "c": 0.0, "alpha": 0.5 } ],
  "effects": [ { "family": "offset", "parameters": { "force": 0.5 } } ],
  "fitted_range": { "displacement": [-0.2, 0.2], "velocity": [-6.3, 6.3] } }"#;

fn displacement(time: f64) -> f64 {
    0.1 * (std::f64::consts::TAU * 2.0 * time).sin()
}

fn predict(directory: &Path, recording: &str, out: &str, on: &str) {
    fs::write(directory.join("model.json"), MODEL).unwrap();
    let line = format!("predict --model model.json {recording} --out {out} --on {on}");
    hil(directory, &words(&line));
}

/// A recording in a unit other than the fitted one is reported, and its error is not a percentage of twenty digits.
#[test]
fn a_force_of_another_size_than_the_predicted_one_is_named() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    for (name, factor, error) in [
        ("right.csv", 1.0, "% of the measured"),
        ("small.csv", 1e-6, "times the measured"),
    ] {
        let row = |i: u32| {
            let time = f64::from(i) * 0.002;
            let y = displacement(time);
            format!("{time},{y},{}\n", factor * (2.0 * y + 0.5))
        };
        let rows: String = (0..1000).map(row).collect();
        let text = format!("time_s,displacement_mm,force_kN\n{rows}");
        fs::write(root.path().join(name), text).unwrap();
        let line = format!("predict --model model.json {name} --out pred.csv --on f64");
        let output = refusal::hil(root.path(), &words(&line));
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let (out, err) = (text(&output.stdout), text(&output.stderr));
        assert!(out.contains(error), "{out}");
        assert_eq!(
            err.contains("times the predicted one; check the units"),
            factor < 1.0,
            "{err}"
        );
    }
}

#[test]
fn the_rows_come_back_with_a_column_in_the_recordings_own_unit() {
    let root = tempfile::tempdir().unwrap();
    // Time in ms, displacement in inches, force in pound-force; an unknown column, and a quoted one.
    let mut text = String::from("# specimen: one\ntime_ms,note,displacement_in,force_lbf\n");
    for i in 0..1000 {
        let time = f64::from(i) * 0.002;
        let inches = displacement(time) / 25.4;
        text += &format!("{},\"a, {i}\",{inches:.9},{:.3}\n", i * 2, 100.0 + inches);
    }
    fs::write(root.path().join("rec.csv"), &text).unwrap();
    for on in ["f32", "f64"] {
        predict(root.path(), "rec.csv", "out/pred.csv", on);
        let predicted = fs::read_to_string(root.path().join("out/pred.csv")).unwrap();
        let lines: Vec<&str> = predicted.lines().collect();
        let before: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), before.len());
        assert_eq!(lines[0], before[0]);
        assert_eq!(
            lines[1],
            format!(
                "{},predicted_beyond,predicted_band_lbf,predicted_force_lbf",
                before[1]
            )
        );
        for (i, (line, before)) in lines.iter().zip(&before).enumerate().skip(2) {
            let (row, force) = line.rsplit_once(',').unwrap();
            let (row, band) = row.rsplit_once(',').unwrap();
            let (row, beyond) = row.rsplit_once(',').unwrap();
            assert_eq!(row, *before);
            assert!(beyond.parse::<f64>().unwrap() >= 0.0, "{i}: {beyond}");
            let [force, band]: [f64; 2] = [force, band].map(|cell| cell.parse().unwrap());
            assert!((0.0..5e-3).contains(&band), "{i}: {band}");
            let expected =
                (0.5 + 2.0 * displacement((i - 2) as f64 * 0.002)) / 4.448_221_615_260_5e-3;
            // The motion is estimated from samples printed to 1e-9 in: far below 1e-4 of the force's 45 lbf.
            assert!((force - expected).abs() < 5e-3, "{i}: {force} {expected}");
        }
    }
}

#[test]
fn a_jittering_recording_is_predicted_at_its_own_times() {
    let root = tempfile::tempdir().unwrap();
    let mut text = String::from("time_s,displacement_mm,force_N\n");
    let times: Vec<f64> = (0..1000)
        .map(|i| (f64::from(i) + 0.1 * f64::from((i * 3) % 5)) * 0.002)
        .collect();
    for time in &times {
        text += &format!("{time:.6},{:.9},0\n", displacement(*time));
    }
    text = text.replace(",0\n", ",1\n");
    fs::write(root.path().join("rec.csv"), &text).unwrap();
    predict(root.path(), "rec.csv", "pred.csv.gz", "f64");
    let predicted = Recording::read(root.path().join("pred.csv.gz")).unwrap();
    assert_eq!(predicted.len(), times.len());
    let mut csv = String::new();
    let file = fs::File::open(root.path().join("pred.csv.gz")).unwrap();
    std::io::Read::read_to_string(&mut flate2::read::GzDecoder::new(file), &mut csv).unwrap();
    for (line, time) in csv.lines().skip(1).zip(&times) {
        let force: f64 = line.rsplit_once(',').unwrap().1.parse().unwrap();
        let expected = 500.0 + 2000.0 * displacement(*time);
        // Interpolated there and back: below 1e-5 of an amplitude of 200 N inside, a straight line at the ends.
        assert!((force - expected).abs() < 0.2, "{time}: {force} {expected}");
    }
}

/// A sine of 0.1 mm at 2 Hz, up to 1.26 mm/s, against the operating range of a model: JSON, output and warnings.
fn beside(range: &str) -> (serde_json::Value, String, String) {
    let root = tempfile::tempdir().unwrap();
    let model = MODEL.replace(
        r#""displacement": [-0.2, 0.2], "velocity": [-6.3, 6.3]"#,
        range,
    );
    assert!(model.contains(range));
    fs::write(root.path().join("model.json"), model).unwrap();
    let mut text = String::from("time_s,displacement_mm,force_kN\n");
    for i in 0..2000 {
        let time = f64::from(i) * 0.002;
        let y = displacement(time);
        text += &format!("{time:.3},{y:.9},{:.6}\n", 0.5 + 2.0 * y);
    }
    fs::write(root.path().join("rec.csv"), text).unwrap();
    let arguments = "predict --model model.json rec.csv --out pred.csv --json pred.json";
    let output = refusal::hil(root.path(), &words(arguments));
    let said = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(output.status.success(), "{}", said[1]);
    let json = fs::read(root.path().join("pred.json")).unwrap();
    let [out, error] = said;
    (serde_json::from_slice(&json).unwrap(), out, error)
}

#[test]
fn samples_outside_the_operating_range_are_counted_and_warned_of() {
    let range = r#""displacement": [-0.05, 0.05], "velocity": [-1.0, 1.0]"#;
    let (json, out, error) = beside(range);
    let outside = &json["outside_operating_range"];
    let figure = |value: &serde_json::Value| value.as_f64().unwrap();
    // The fractions of a sine beyond 0.0525 of 0.1 mm, and beyond 1.05 of 1.257 mm/s.
    let part = |edge: f64| 1.0 - edge.asin() / std::f64::consts::FRAC_PI_2;
    let speed = 0.1 * std::f64::consts::TAU * 2.0;
    for (channel, edge, most) in [
        ("displacement", 0.525, 1.0),
        ("velocity", 1.05 / speed, speed - 1.0),
    ] {
        // Each of four crossings in a cycle of 250 samples is off by at most half a sample.
        let off = figure(&outside[channel]["part"]) - part(edge);
        assert!(off.abs() < 8e-3, "{channel}: {off}");
        assert!((figure(&outside[channel]["most"]) - most).abs() < 5e-3);
    }
    // One is large where the other is small. So the fraction is the sum of both, except for the samples that both share.
    let all = figure(&outside["part"]);
    assert!(all > part(0.525) + 0.05 && all <= 1.0, "{all}");
    assert!((figure(&json["beyond_fitted_range"]) - 1.0).abs() < 5e-3);
    let percent = format!("{:.1} % of the samples", 100.0 * all);
    let line = format!("outside the operating range: {percent}, by up to 1.00 times the range");
    assert!(out.lines().any(|said| said == line), "{out}");
    assert!(
        error.starts_with(&format!(
            "warning: {percent} lie outside the operating range of model.json: displacement at "
        )),
        "{error}"
    );
    assert!(error.contains("by up to 1.00 times the range, velocity at "));
}

/// The sine exceeds the range by a 50th: the number is reported, without a warning.
#[test]
fn a_tiny_overshoot_of_the_operating_range_is_no_warning() {
    let range = r#""displacement": [-0.098, 0.098], "velocity": [-6.3, 6.3]"#;
    let (json, out, error) = beside(range);
    assert_eq!(error, "");
    assert_eq!(json["outside_operating_range"]["part"], 0.0);
    let beyond = json["beyond_fitted_range"].as_f64().unwrap();
    assert!((beyond - 0.002 / 0.098).abs() < 1e-3, "{beyond}");
    assert!(
        out.ends_with("outside the operating range: none of the samples\n"),
        "{out}"
    );
}

/// A logger that changes to newtons under a header of kilonewtons: a trace repairs this, and a prediction is compared with the same
/// repaired force.
#[test]
fn a_unit_that_changes_on_the_way_is_mended_as_a_trace_mends_it() {
    let root = tempfile::tempdir().unwrap();
    let mut text = String::from("time_s,displacement_mm,force_kN\n");
    for i in 0..4000 {
        let time = f64::from(i) * 0.002;
        let unit = if i < 2600 { 1.0 } else { 1000.0 };
        let force = unit * (0.5 + 2.0 * displacement(time));
        text += &format!("{time},{:.9},{force:.9}\n", displacement(time));
    }
    fs::write(root.path().join("rec.csv"), text).unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    let hil = |arguments: &[&str]| hil(root.path(), arguments);
    let json = |name: &str| -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(root.path().join(name)).unwrap()).unwrap()
    };
    hil(&words(
        "predict --model model.json rec.csv --out pred.csv --json p.json",
    ));
    let error = json("p.json")["nrmse"].as_f64().unwrap();
    assert!(error < 1e-3, "{error}");
    hil(&["trace", "rec.csv", "--out", "traced"]);
    let warnings = json("traced/trace.json")["warnings"].to_string();
    assert!(warnings.contains("1000"), "{warnings}");
}

/// The motion that the law received, with the force to the last bit.
#[test]
fn the_motion_comes_along_where_it_is_asked_for() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    let mut text = String::from("time_s,displacement_mm,force_kN\n");
    for i in 0..1000 {
        let time = f64::from(i) * 0.002;
        let y = displacement(time);
        text += &format!("{time:.3},{y:.9},{:.9}\n", 2.0 * y + 0.5);
    }
    fs::write(root.path().join("test.csv"), text).unwrap();
    let arguments =
        words("predict --model model.json test.csv --on f64 --out pred.csv --motion motion.json");
    hil(root.path(), &arguments);
    let motion = fs::read(root.path().join("motion.json")).unwrap();
    let motion: serde_json::Value = serde_json::from_slice(&motion).unwrap();
    let column = |name: &str| -> Vec<f64> {
        let values = motion[name].as_array().unwrap().iter();
        values.map(|value| value.as_f64().unwrap()).collect()
    };
    assert_eq!(motion["tick"], 0.002);
    let (y, v, force) = (column("displacement"), column("velocity"), column("force"));
    assert_eq!([y.len(), v.len(), force.len()], [1000; 3]);
    let rate = std::f64::consts::TAU * 2.0;
    for sample in 100..900 {
        let time = 0.002 * sample as f64;
        assert!((y[sample] - displacement(time)).abs() < 1e-6);
        assert!((v[sample] - 0.1 * rate * (rate * time).cos()).abs() < 1e-3);
        // A spring and a preload, to the last bit.
        assert_eq!(force[sample], 2.0 * y[sample] + 0.5);
    }
    assert_eq!(column("temperature")[7], 20.0);
}

/// The name determines the format, whatever the format of the recording. An unknown format is refused before the model is read.
/// Parquet and MCAP are formats of `full`.
#[cfg(feature = "full")]
#[test]
fn a_prediction_goes_where_its_name_ends() {
    let root = tempfile::tempdir().unwrap();
    let mut text = String::from("# specimen: one\ntime_s,displacement_mm,force_N\n");
    for i in 0..1000 {
        let time = f64::from(i) * 0.002;
        text += &format!(
            "{time},{:.6},{:.3}\n",
            displacement(time),
            2000.0 * displacement(time)
        );
    }
    fs::write(root.path().join("rec.csv"), &text).unwrap();
    let mut read = Vec::new();
    for name in ["pred.csv.gz", "pred.mat", "pred.parquet"] {
        predict(root.path(), "rec.csv", name, "f64");
        let path = root.path().join(name);
        let reading = mesh_damper_tables::files::Reading {
            channels: vec![("force".into(), "predicted_force_N".into())],
            units: vec![("force".into(), "N".into())],
            ..Default::default()
        };
        let predicted = Recording::read_as(&path, &reading).unwrap();
        assert_eq!(predicted.declared("specimen"), Some("one"), "{name}");
        assert_eq!(predicted.len(), 1000);
        // A prediction can be the input of another prediction.
        predict(root.path(), name, "again.mcap", "f64");
        read.push(predicted.force);
    }
    let off = |other: &[f64]| read[0].iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-8);
    assert!(off(&read[1]) && off(&read[2]));
    assert_eq!(read[1], read[2]);
    let mcap = fs::read(root.path().join("again.mcap")).unwrap();
    assert!(mcap.starts_with(b"\x89MCAP0\r\n") && mcap.ends_with(b"\x89MCAP0\r\n"));
    let none = words("predict --model none.json rec.csv --out pred.xlsx");
    refusal::refuses(
        root.path(),
        &none,
        &["pred.xlsx", "of no format", ".parquet"],
    );
}

#[test]
fn a_motion_without_a_force_is_enough() {
    let root = tempfile::tempdir().unwrap();
    let whole: String = (0..1000)
        .map(|i| f64::from(i) * 0.002)
        .map(|time| {
            format!(
                "{time},{:.9},{:.9}\n",
                displacement(time),
                2.0 * displacement(time)
            )
        })
        .collect();
    let motion: String = whole
        .lines()
        .map(|row| row.rsplit_once(',').unwrap().0.to_owned() + "\n")
        .collect();
    fs::write(
        root.path().join("whole.csv"),
        format!("time_s,displacement_mm,force_kN\n{whole}"),
    )
    .unwrap();
    fs::write(
        root.path().join("motion.csv"),
        format!("time_s,displacement_mm\n{motion}"),
    )
    .unwrap();
    predict(root.path(), "whole.csv", "whole_out.csv", "f64");
    predict(root.path(), "motion.csv", "motion_out.csv", "f64");
    let forces = |name: &str| -> Vec<String> {
        let text = fs::read_to_string(root.path().join(name)).unwrap();
        assert!(text.starts_with("time_s,"), "{text}");
        let last = |row: &str| row.rsplit_once(',').unwrap().1.to_owned();
        text.lines().map(last).collect()
    };
    assert_eq!(forces("whole_out.csv"), forces("motion_out.csv"));
    let line = "predict --model model.json motion.csv --out again.csv --json said.json";
    let output = refusal::hil(root.path(), &words(line));
    let [out, error] =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    assert!(out.contains("no force was measured"), "{out}");
    assert!(
        error.contains("from the motion alone") && error.contains("force"),
        "{error}"
    );
    let said: serde_json::Value =
        serde_json::from_slice(&fs::read(root.path().join("said.json")).unwrap()).unwrap();
    assert!(
        said["nrmse"].is_null() && said["band"].as_f64().unwrap().is_finite(),
        "{said}"
    );
}
