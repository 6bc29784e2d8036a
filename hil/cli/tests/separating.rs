//! What one condition cannot tell apart, the test that a trace asks for does.

mod command;

use command::hil;
use serde_json::Value;

/// One amplitude at one frequency.
const ONE_CONDITION: &str = "0.1:2:12";

/// The trace of a specimen with `effect` under `blocks`.
fn traced(effect: &str, blocks: &str) -> Value {
    let root = tempfile::tempdir().unwrap();
    hil(
        root.path(),
        &["run", "--effect", effect, "--blocks", blocks],
    );
    hil(root.path(), &["trace", "run-out/recording.csv.gz"]);
    let text = std::fs::read_to_string(root.path().join("trace-out/trace.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn families(result: &Value) -> Vec<&str> {
    let effects = result["effects"].as_array().unwrap();
    effects
        .iter()
        .map(|effect| effect["family"].as_str().unwrap())
        .collect()
}

/// What one condition says: the family alone, or several with it; then the test that is asked for leaves it alone.
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

/// At one frequency a dashpot is a Maxwell branch too.
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
