//! `hil run`: it writes a normal recording, and the same one for the same seed.

use std::fs;
use std::path::Path;
use std::process::Output;

use mesh_damper_recording::Recording;

use crate::command::words;
use crate::refusal::hil;

fn run(directory: &Path, arguments: &[&str]) -> Output {
    hil(directory, &[&["run"], arguments].concat())
}

/// A specimen that softens for longer than a run-in lasts. Within the run-in it softens by no more than the permitted 15 % of k1 at
/// which the monitor learned it.
const SOFTENING: [&str; 4] = [
    "--effect",
    "drift:stiffness=-0.5,cycles=500",
    "--blocks",
    "0.1:10:500",
];

/// Each fault that the monitor identifies is reported, in the JSON with its evidence.
#[test]
fn what_the_monitor_names_is_told() {
    let root = tempfile::tempdir().unwrap();
    let told = run(root.path(), &SOFTENING);
    assert!(told.status.success());
    let told = String::from_utf8_lossy(&told.stdout).into_owned();
    let output = run(root.path(), &[&SOFTENING[..], &["--json", "-"]].concat());
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let events = summary["events"].as_array().unwrap();
    assert!(events.len() > 1, "{events:?}");
    for event in events {
        let (value, limit) = (
            event["value"].as_f64().unwrap(),
            event["limit"].as_f64().unwrap(),
        );
        assert!(value.abs() >= limit && limit > 0.0, "{event}");
        let time = event["time"].as_f64().unwrap();
        assert!(
            (time - event["cycle"].as_f64().unwrap() / 10.0).abs() < 0.2,
            "{event}"
        );
        let at = format!("found {time:.3} s after the start");
        assert!(told.contains(&at), "{at}: {told}");
    }
    assert_eq!(events[0]["cause"], "RunIn");
    assert_eq!(events[0]["fault"], false);
    assert!(events.iter().any(|event| event["fault"] == true));
}

/// The same specimen with a law that may adapt: its error is smaller, and no fault is reported.
#[test]
fn a_law_that_follows_errs_less_and_says_by_how_much_it_went() {
    let root = tempfile::tempdir().unwrap();
    let summary = |more: &[&str]| -> serde_json::Value {
        let output = run(
            root.path(),
            &[&SOFTENING[..], &["--json", "-"], more].concat(),
        );
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let last = |summary: &serde_json::Value, field: &str| {
        let cycles = summary["cycles"].as_array().unwrap();
        cycles.iter().rfind(|cycle| cycle["ramp"] == false).unwrap()[field]
            .as_f64()
            .unwrap()
    };
    let (stays, follows) = (summary(&[]), summary(&["--follow", "0.2"]));
    assert!(last(&stays, "nrmse") > 0.1);
    assert!(last(&follows, "nrmse") < 0.02);
    assert_eq!(last(&stays, "followed_k1"), 0.0);
    // −0.5·(1 − e^(−500/500)) is −0.316.
    assert!(last(&follows, "followed_k1") < -0.28);
    assert!(last(&follows, "followed_c").abs() < 0.01);
    let faults = |summary: &serde_json::Value| {
        let events = summary["events"].as_array().unwrap();
        events.iter().filter(|event| event["fault"] == true).count()
    };
    assert_eq!((faults(&stays), faults(&follows)), (1, 0));
    let refused = run(root.path(), &["--follow", "0.6"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert!(said.contains("follow = 0.6 is outside 0…0.5"), "{said}");
}

#[test]
fn leaves_a_recording_and_its_cycles() {
    let root = tempfile::tempdir().unwrap();
    let arguments = words("--blocks 0.1:5:4,0.05:10:6 --seed 3 --json -");
    let output = run(root.path(), &arguments);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(summary["stopped"].is_null());
    assert_eq!(summary["events"], serde_json::json!([]));

    let recording = Recording::read(root.path().join("run-out/recording.csv.gz")).unwrap();
    assert!((recording.sample_period() - 1e-3).abs() < 1e-9);
    assert_eq!(
        recording.declared("specimen"),
        Some("simulated MMD, density_g_cm3 = 3")
    );
    let largest = recording
        .displacement
        .iter()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    // The amplitude is within 1 %, with noise of 1e-4 mm.
    assert!((largest - 0.1).abs() < 5e-3, "{largest}");

    let cycles = fs::read_to_string(root.path().join("run-out/cycles.csv")).unwrap();
    let rows = summary["cycles"].as_array().unwrap();
    assert_eq!(cycles.lines().count(), rows.len() + 1);
    for (block, cycles) in [(0, 4), (1, 6)] {
        let steady = |row: &&serde_json::Value| row["block"] == block && row["ramp"] == false;
        assert_eq!(rows.iter().filter(steady).count(), cycles);
        for row in rows.iter().filter(steady) {
            // The law in the rig has the specimen's own density at 0.1 mm.
            let (measured, model) = (
                &row["stiffness_kn_per_mm"],
                &row["model_stiffness_kn_per_mm"],
            );
            let ratio = measured.as_f64().unwrap() / model.as_f64().unwrap();
            assert!((ratio - 1.0).abs() < 0.1, "{row}");
        }
    }

    fs::rename(root.path().join("run-out"), root.path().join("first")).unwrap();
    run(root.path(), &arguments);
    let csv = |directory: &str| fs::read(root.path().join(directory).join("cycles.csv")).unwrap();
    assert_eq!(csv("first"), csv("run-out"));
    run(
        root.path(),
        &["--blocks", "0.1:5:4,0.05:10:6", "--seed", "4"],
    );
    assert_ne!(csv("first"), csv("run-out"));
}

/// 0.05 mm and 0.1 mm with a model that was fitted on 0.07 mm: ticks of the second block are outside, as the recording shows.
#[test]
fn ticks_outside_the_operating_range_of_the_model_are_counted() {
    let root = tempfile::tempdir().unwrap();
    let model = |speed: f64| {
        let text = format!(
            r#"{{ "format": "mesh-damper-model", "version": 1,
            "units": {{ "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" }},
            "law": [ {{ "amplitude": 0.0, "k1": 2.0, "k3": 0.0, "c": 0.1, "alpha": 0.5 }} ], "effects": [],
            "fitted_range": {{ "displacement": [-0.07, 0.07], "velocity": [-{speed}, {speed}] }} }}"#
        );
        fs::write(root.path().join("model.json"), text).unwrap();
    };
    let blocks = ["--model", "model.json", "--blocks", "0.05:5:10,0.1:5:10"];
    let ran = |arguments: &[&str]| {
        let output = run(root.path(), &[arguments, &["--json", "-"]].concat());
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{error}");
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (json, error)
    };
    model(100.0);
    let (json, error) = ran(&blocks);
    let outside = &json["outside_operating_range"];
    let (ticks, all) = (outside["ticks"].as_u64(), json["ticks"].as_u64());
    let (ticks, all) = (ticks.unwrap() as f64, all.unwrap() as f64);
    let part = outside["part"].as_f64().unwrap();
    assert_eq!(part, ticks / all);
    let recording = Recording::read(root.path().join("run-out/recording.csv.gz")).unwrap();
    let beyond = recording.displacement.iter().filter(|y| y.abs() > 0.0735);
    let expected = beyond.count() as f64 / recording.len() as f64;
    // Every tenth tick is a sample.
    assert!(
        part > 0.1 && (part - expected).abs() < 5e-3,
        "{part} {expected}"
    );
    let warned = format!(
        "warning: {:.1} % of the ticks, {ticks} of {all}, lie outside the operating range of model.json",
        100.0 * part
    );
    assert!(error.lines().any(|line| line == warned), "{error}");

    // 0.1 mm at 5 Hz is 3.1 mm/s: more of the ticks are outside if only 1 mm/s was fitted.
    model(1.0);
    let (json, _) = ran(&blocks);
    assert!(json["outside_operating_range"]["part"].as_f64().unwrap() > part + 0.1);

    model(100.0);
    let (json, error) = ran(&["--model", "model.json", "--blocks", "0.05:5:10"]);
    assert_eq!(json["outside_operating_range"]["ticks"], 0);
    assert!(!error.contains("operating range"), "{error}");
    // The published coefficients have no operating range.
    let (json, _) = ran(&["--blocks", "0.05:5:10"]);
    assert!(json["outside_operating_range"].is_null());
}

#[test]
fn a_rig_that_stops_on_a_limit_ends_with_1_and_keeps_what_it_recorded() {
    let root = tempfile::tempdir().unwrap();
    let output = run(root.path(), &["--blocks", "0.1:5:4,2:5:10"]);
    assert_eq!(output.status.code(), Some(1));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.starts_with("error: the rig tripped "), "{error}");
    assert_eq!(error.lines().count(), 1);
    Recording::read(root.path().join("run-out/recording.csv.gz")).unwrap();
}

#[test]
fn the_file_of_a_programme_says_what_blocks_say() {
    let root = tempfile::tempdir().unwrap();
    let programme = r#"{"blocks": [{"amplitude": 0.1, "from": 2, "to": 8, "cycles": 6}]}"#;
    fs::write(root.path().join("p.json"), programme).unwrap();
    let outputs = [["--blocks", "0.1:2-8:6"], ["--programme", "p.json"]].map(|arguments| {
        let output = run(root.path(), &[&arguments[..], &["--json", "-"]].concat());
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        output.stdout
    });
    assert_eq!(outputs[0], outputs[1]);
}

/// The JSON, or the exit code and the message of a failure.
fn driven(directory: &Path, arguments: &[&str]) -> Result<serde_json::Value, (i32, String)> {
    let output = run(directory, &[arguments, &["--json", "-"]].concat());
    if output.status.success() {
        return Ok(serde_json::from_slice(&output.stdout).unwrap());
    }
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    Err((output.status.code().unwrap(), said))
}

const RANDOM: &str = "random:rms=0.08mm,from=0.5Hz,to=12Hz,duration=10s,seed=2";

/// The recording of a run is a motion for the next run, whose recording can be traced.
#[test]
fn a_motion_is_followed_recorded_and_followed_again() {
    let root = tempfile::tempdir().unwrap();
    let first = driven(root.path(), &["--drive", RANDOM]).unwrap();
    let figure = |summary: &serde_json::Value, name: &str| summary["drive"][name].as_f64().unwrap();
    assert!((figure(&first, "rms_mm") - 0.08).abs() < 1e-4, "{first}");
    assert_eq!(figure(&first, "duration_s"), 14.0);
    assert!(figure(&first, "following_error_rms_mm") < 0.1 * 0.08);
    // The law is the specimen's. The remaining error is the observer's, whose input is the demand and not the actuator's motion.
    assert!(figure(&first, "law_nrmse") < 0.1);
    assert_eq!(first["cycles"], serde_json::json!([]));
    assert!(!root.path().join("run-out/cycles.csv").exists());
    let recording = Recording::read(root.path().join("run-out/recording.csv.gz")).unwrap();
    let said = recording.declared("excitation").unwrap();
    assert!(
        said.contains(RANDOM) && said.contains("ramps of 2 s"),
        "{said}"
    );

    // A column of displacement is sufficient, in any unit.
    let mut text = "time_ms,displacement_um\n".to_owned();
    for (time, y) in recording.time.iter().zip(&recording.displacement) {
        text += &format!("{},{}\n", 1e3 * time, 1e3 * y);
    }
    fs::write(root.path().join("motion.csv"), text).unwrap();
    let arguments = ["--drive", "motion.csv", "--scale", "0.5", "--out", "again"];
    let second = driven(root.path(), &arguments).unwrap();
    assert!(figure(&second, "following_error_rms_mm") < 0.1 * 0.04);
    // The noise of the displacement channel, 1e-4 mm, halved with the motion, is about the rejected part.
    let left_out = figure(&second, "left_out_rms_mm");
    assert!(left_out > 2e-5 && left_out < 2e-4, "{left_out}");
    let again = Recording::read(root.path().join("again/recording.csv.gz")).unwrap();
    let rms = |y: &[f64]| (y.iter().map(|y| y * y).sum::<f64>() / y.len() as f64).sqrt();
    let ratio = rms(&again.displacement) / rms(&recording.displacement);
    // The actuator exceeds the demand at the band's upper end in both runs.
    assert!((ratio / 0.5 - 1.0).abs() < 0.1, "{ratio}");
}

#[test]
fn a_motion_that_cannot_be_is_refused_in_one_line_and_leaves_nothing() {
    let root = tempfile::tempdir().unwrap();
    let text = "time_s,displacement_mm\n0,0\n".to_owned()
        + &(1..2000)
            .map(|i| {
                format!(
                    "{},{}\n",
                    f64::from(i) * 1e-3,
                    3.0 * (0.02 * f64::from(i)).sin()
                )
            })
            .collect::<String>();
    fs::write(root.path().join("large.csv"), text).unwrap();
    for (arguments, said) in [
        (&["--drive", "large.csv"][..], "field displacement: 3.0"),
        (&["--drive", "large.csv"], "--scale 0.1"),
        (
            &["--drive", "large.csv", "--scale", "0"],
            "field --scale: 0 gives no motion",
        ),
        (&["--drive", "large.csv", "--scale", "nan"], "field --scale"),
        (&["--drive", "missing.csv"], "missing.csv"),
        (&["--drive", "random:rms=1mm"], "field from: it is missing"),
        (&["--drive", RANDOM, "--shift", "1"], "field --shift"),
        (&["--drive", RANDOM, "--tick-rate", "0"], "--tick-rate"),
        (
            &["--drive", RANDOM, "--blocks", "0.1:1:6"],
            "cannot be used with",
        ),
        (
            &["--drive", RANDOM, "--follow", "0.1"],
            "cannot be used with",
        ),
        (&["--scale", "2"], "--drive"),
    ] {
        let (code, message) = driven(root.path(), arguments).unwrap_err();
        assert_eq!(code, 2, "{message}");
        assert!(message.contains(said), "{said}: {message}");
        assert!(!root.path().join("run-out").exists(), "{message}");
    }
    // The refusal gives a scale at which the run succeeds.
    let (_, message) = driven(root.path(), &["--drive", "large.csv"]).unwrap_err();
    let scale = message
        .split("--scale ")
        .nth(1)
        .unwrap()
        .split_whitespace()
        .next()
        .unwrap();
    driven(root.path(), &["--drive", "large.csv", "--scale", scale]).unwrap();
}

/// A model that was fitted on `reach` mm and 100 mm/s. Its stiffness differs from the specimen's if `factor` is not 1.
fn model_of_stiffness(directory: &Path, factor: f64, reach: f64) {
    // A specimen of 3 g/cm³ at 0.1 mm.
    let (k1, k3, c) = (1.0539 * factor, 10.5 * factor, 0.1114 * factor);
    let text = format!(
        r#"{{ "format": "mesh-damper-model", "version": 1,
        "units": {{ "displacement": "mm", "force": "kN", "time": "s", "temperature": "degC" }},
        "law": [ {{ "amplitude": 0.0, "k1": {k1}, "k3": {k3}, "c": {c}, "alpha": 0.3969 }} ], "effects": [],
        "fitted_range": {{ "displacement": [-{reach}, {reach}], "velocity": [-100.0, 100.0] }} }}"#
    );
    fs::write(directory.join("model.json"), text).unwrap();
}

/// A law of another specimen once ran with this one with an error of 613 % and without a warning.
#[test]
fn a_model_of_another_specimen_is_warned_of_first() {
    let root = tempfile::tempdir().unwrap();
    let ran = |factor: f64, arguments: &[&str]| {
        model_of_stiffness(root.path(), factor, 0.3);
        let with = ["--model", "model.json", "--json", "-"];
        let output = run(root.path(), &[arguments, &with].concat());
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{error}");
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (json, error)
    };
    let blocks = ["--blocks", "0.1:5:6"];
    // The error is as large as the excess of stiffness.
    for (factor, expected) in [(7.13, 6.13), (1.9, 0.9), (0.4, 0.6)] {
        let (json, error) = ran(factor, &blocks);
        let first = &json["first_error"];
        let nrmse = first["nrmse"].as_f64().unwrap();
        assert!((nrmse / expected - 1.0).abs() < 0.05, "{factor}: {nrmse}");
        assert_eq!(
            (&first["cycles"], &first["limit"]),
            (&3.into(), &0.5.into())
        );
        let line = error.lines().next().unwrap();
        let said = format!(
            "warning: model.json does not fit this specimen: over the first 3 steady cycles the error of its force is {:.0} % of ",
            100.0 * nrmse
        );
        assert!(line.starts_with(&said), "{error}");
        assert_eq!(
            format!("warning: {}", json["warnings"][0].as_str().unwrap()),
            line
        );
    }
    let (json, error) = ran(1.3, &blocks);
    assert_eq!((&*error, &json["warnings"]), ("", &serde_json::json!([])));
    let nrmse = json["first_error"]["nrmse"].as_f64().unwrap();
    assert!((nrmse - 0.3).abs() < 0.05, "{nrmse}");
    // Cycles of a streamed motion are not distinguished: all of it counts.
    let drive = [
        "--drive",
        "random:rms=0.08mm,from=0.5Hz,to=12Hz,duration=3s,seed=2",
    ];
    let (json, error) = ran(3.0, &drive);
    assert_eq!(json["first_error"]["cycles"], 0);
    assert!(
        error.contains("over the recording the error of its force is "),
        "{error}"
    );
}

/// Before the run, for the requested motion: an amplitude and a speed that are outside the fitted range.
#[test]
fn blocks_outside_the_operating_range_are_warned_of_first() {
    let root = tempfile::tempdir().unwrap();
    model_of_stiffness(root.path(), 1.0, 0.07);
    let with = ["--model", "model.json", "--json", "-", "--blocks"];
    let ran = |blocks: &str| {
        let output = run(root.path(), &[&with[..], &[blocks]].concat());
        let error = String::from_utf8(output.stderr).unwrap();
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (json, error)
    };
    let (json, error) = ran("0.05:5:4,0.14:5:4");
    let line = "50.0 % of the blocks lie outside the operating range of model.json: displacement at 50.0 % by up to 1.00 times the range";
    assert_eq!(error.lines().next().unwrap(), format!("warning: {line}"));
    assert_eq!(json["warnings"][0], line);
    let asked = &json["asked_outside_operating_range"];
    assert_eq!(
        (&asked["part"], &asked["velocity"]["part"]),
        (&0.5.into(), &0.0.into())
    );
    // 0.05 mm at 400 Hz are 126 mm/s, at the end of a sweep or at its beginning.
    for blocks in ["0.05:300-400:40", "0.05:400-300:40"] {
        let (json, error) = ran(blocks);
        assert!(
            error.starts_with("warning: 100.0 % of the blocks lie outside"),
            "{error}"
        );
        let most = json["asked_outside_operating_range"]["velocity"]["most"]
            .as_f64()
            .unwrap();
        assert!((most - 0.2566).abs() < 1e-3, "{most}");
    }
    let (json, error) = ran("0.05:5:4");
    assert_eq!((&*error, &json["warnings"]), ("", &serde_json::json!([])));
    // A law that was not fitted has no range to check.
    let output = run(root.path(), &["--blocks", "0.05:5:4", "--json", "-"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json["asked_outside_operating_range"].is_null() && json["first_error"].is_null());
}
