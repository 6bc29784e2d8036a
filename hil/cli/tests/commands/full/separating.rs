//! The test that a trace requests distinguishes effects that one condition cannot distinguish.

use std::path::Path;

use crate::command::{hil, words};
use serde_json::Value;

/// One amplitude at one frequency.
const ONE_CONDITION: &str = "0.1:2:12";

/// The trace of a specimen with `effect` under `blocks`, in `root`.
fn traced_in(root: &Path, effect: &str, blocks: &str) -> Value {
    hil(root, &["run", "--effect", effect, "--blocks", blocks]);
    hil(root, &["trace", "run-out/recording.csv.gz"]);
    result(root)
}

fn result(root: &Path) -> Value {
    let text = std::fs::read_to_string(root.join("trace-out/trace.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn traced(effect: &str, blocks: &str) -> Value {
    traced_in(tempfile::tempdir().unwrap().path(), effect, blocks)
}

fn families(result: &Value) -> Vec<&str> {
    let effects = result["effects"].as_array().unwrap();
    effects
        .iter()
        .map(|effect| effect["family"].as_str().unwrap())
        .collect()
}

/// One condition gives the family alone, or several families including it. In the second case the requested test gives it alone.
fn separates(family: &str, effect: &str) {
    let before = traced(effect, ONE_CONDITION);
    let rivals = families(&before);
    assert!(rivals.contains(&family), "{rivals:?}");
    if before["verdict"] == "found" {
        assert_eq!(rivals, [family]);
        assert!(before["separating_test"].is_null());
        return;
    }
    assert_eq!(before["verdict"], "ambiguous", "{rivals:?}");
    assert!(rivals.len() > 1, "{rivals:?}");
    let asked = before["separating_test"].as_str().unwrap();
    let (_, alike) = asked.split_once("collinearity ").unwrap();
    let alike: f64 = alike.split(')').next().unwrap().parse().unwrap();
    assert!(alike > 0.9 && alike <= 1.0, "{asked}");
    let (_, programme) = asked.split_once("--blocks ").unwrap();
    let programme = programme.split_whitespace().next().unwrap();
    let after = traced(effect, programme);
    assert_eq!(after["verdict"], "found", "{:?}", families(&after));
    assert_eq!(families(&after), [family]);
    assert!(after["separating_test"].is_null());
}

/// At one frequency a dashpot is also a Maxwell branch.
#[test]
fn a_dashpot_is_ambiguous_until_the_test_that_is_asked_for() {
    assert_eq!(
        traced("viscous:c=0.05", ONE_CONDITION)["verdict"],
        "ambiguous"
    );
    separates("viscous", "viscous:c=0.05");
}

#[test]
fn a_maxwell_branch() {
    separates("relaxation", "relaxation:stiffness=1.0,time=0.05");
}

#[test]
fn a_late_channel() {
    separates("delay", "delay:time=0.001");
}

/// The file contains the test: one command runs it, and its trace identifies the effect.
#[test]
fn the_test_is_a_file_that_one_command_runs() {
    let effect = "viscous:c=0.05";
    let root = tempfile::tempdir().unwrap();
    let before = traced_in(root.path(), effect, ONE_CONDITION);
    assert_eq!(before["verdict"], "ambiguous");
    let text = std::fs::read_to_string(root.path().join("trace-out/separating-test.csv")).unwrap();
    let rows: Vec<[f64; 2]> = text
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|line| {
            let (time, displacement) = line.split_once(',').unwrap();
            [time, displacement].map(|cell| cell.parse().unwrap())
        })
        .collect();
    assert_eq!((rows[0], rows[rows.len() - 1][1]), ([0.0, 0.0], 0.0));
    // It is as long as its blocks with two cycles of ramp before each and after the last, and as large.
    let blocks = before["separating_blocks"].as_array().unwrap();
    let field = |block: &Value, name: &str| block[name].as_f64().unwrap();
    let largest = blocks
        .iter()
        .map(|b| field(b, "amplitude"))
        .fold(0.0, f64::max);
    let moved = rows.iter().map(|[_, y]| y.abs()).fold(0.0, f64::max);
    assert!((moved / largest - 1.0).abs() < 1e-3, "{moved}, {largest}");
    let steady: f64 = blocks
        .iter()
        .map(|b| field(b, "cycles") / field(b, "frequency"))
        .sum();
    let last = rows[rows.len() - 1][0];
    assert!(
        last > steady && last < 3.0 * steady,
        "{last} s of {steady} s"
    );

    // The command in the file.
    let command = text
        .lines()
        .find_map(|line| line.strip_prefix("# run: cargo hil "));
    let mut command = words(command.unwrap());
    command.extend(["--effect", effect]);
    hil(root.path(), &command);
    let trace = words("trace separating-out/recording.csv.gz --out trace-out");
    hil(root.path(), &trace);
    let after = result(root.path());
    assert_eq!(after["verdict"], "found", "{:?}", families(&after));
    // The rival is gone. The sensors' lag of 0.15 ms may appear in the remaining residual: it rounds the force where the friction
    // reverses, but not the displacement.
    let found = families(&after);
    assert_eq!(found[0], "viscous", "{found:?}");
    assert!(
        found[1..].iter().all(|family| *family == "delay"),
        "{found:?}"
    );
    for effect in &after["effects"].as_array().unwrap()[1..] {
        // As a time, or as a low-pass, which delays slow changes by √2/ω.
        let value = |name: &str| effect["parameters"][name]["value"].as_f64();
        let of_corner = |corner: f64| 2.0_f64.sqrt() / (std::f64::consts::TAU * corner);
        let late = value("time").or(value("corner").map(of_corner)).unwrap();
        assert!(late < 3e-4, "{late} s");
    }
    assert_eq!(after["separating_blocks"], serde_json::json!([]));
}

/// One motion with a band of frequencies gives the same information as several blocks of sines.
#[test]
fn a_random_motion_names_a_maxwell_branch_and_its_numbers() {
    let root = tempfile::tempdir().unwrap();
    let random = "random:rms=0.08mm,from=0.5Hz,to=12Hz,duration=10s,seed=2";
    let effect = "relaxation:stiffness=1.0,time=0.05";
    hil(root.path(), &["run", "--effect", effect, "--drive", random]);
    hil(root.path(), &["trace", "run-out/recording.csv.gz"]);
    let found = result(root.path());
    assert_eq!(
        (&found["verdict"], families(&found)),
        (&"found".into(), vec!["relaxation"])
    );
    for (name, truth) in [("stiffness", 1.0), ("time", 0.05)] {
        let value = found["effects"][0]["parameters"][name]["value"]
            .as_f64()
            .unwrap();
        assert!((value / truth - 1.0).abs() < 0.05, "{name} = {value}");
    }
    assert!(!root.path().join("trace-out/separating-test.csv").exists());
}
