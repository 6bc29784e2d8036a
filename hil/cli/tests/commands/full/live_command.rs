//! `hil run --live` and `--mqtt`: the data for viewers and subscribers. The run is the same without them.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::command::words;
use crate::full::broker::{Mosquitto, free_port};
use crate::refusal::hil;

const BLOCKS: [&str; 2] = ["--blocks", "0.1:20:6"];

fn run(directory: &Path, arguments: &[&str]) -> Output {
    hil(directory, &[&["run"], &BLOCKS[..], arguments].concat())
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The page changes no bit of the recording, and standard output contains only the requested output. The run does not wait for a
/// viewer.
#[test]
fn a_run_with_a_page_ends_and_is_the_same() {
    let root = tempfile::tempdir().unwrap();
    let plain = run(root.path(), &["--out", "plain"]);
    assert!(plain.status.success(), "{}", text(&plain.stderr));
    let live = ["--live", "--speed", "max", "--out", "live", "--json", "-"];
    let live = run(root.path(), &live);
    assert!(live.status.success(), "{}", text(&live.stderr));
    let summary: Value = serde_json::from_slice(&live.stdout).unwrap();
    let address = summary["live"]["address"].as_str().unwrap();
    assert!(address.starts_with("http://127.0.0.1:"), "{address}");
    let said = text(&live.stderr);
    assert!(
        said.contains(&format!("The live page is {address}")),
        "{said}"
    );
    assert_eq!(summary["live"]["viewers"], 0);
    assert_eq!(summary["mqtt"], Value::Null);
    let cycles = |run: &str| fs::read(root.path().join(run).join("cycles.csv")).unwrap();
    assert_eq!(cycles("plain"), cycles("live"));
}

/// Every cycle of the table is published, with the same numbers.
#[test]
fn a_broker_gets_the_cycles_of_the_table() {
    let Some(broker) = Mosquitto::start(None) else {
        return;
    };
    let mut heard = broker.subscribe(None);
    let root = tempfile::tempdir().unwrap();
    let url = format!("mqtt://127.0.0.1:{}/rig-7", broker.port());
    let output = run(root.path(), &["--mqtt", &url, "--json", "-"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["mqtt"]["dropped"], 0);
    assert_eq!(summary["mqtt"]["broker"], url);
    let messages = heard.until("finished");
    let published: Vec<&Value> = messages
        .iter()
        .filter(|message| message.topic == "mesh-damper/rig-7/cycle")
        .map(|message| &message.payload)
        .collect();
    let rows = summary["cycles"].as_array().unwrap();
    assert_eq!(published.len(), rows.len());
    for (cycle, row) in published.iter().zip(rows) {
        for (name, column) in [
            ("block", "block"),
            ("cycle", "cycle"),
            ("ramp", "ramp"),
            ("amplitude_mm", "amplitude_mm"),
            ("stiffness_kN_per_mm", "stiffness_kn_per_mm"),
            ("loss_factor", "loss_factor"),
            ("energy_J", "energy_j"),
            ("law_stiffness_kN_per_mm", "model_stiffness_kn_per_mm"),
            ("law_loss_factor", "model_loss_factor"),
            ("law_error", "nrmse"),
        ] {
            assert_eq!(cycle[name], row[column], "{name}: {cycle} {row}");
        }
        let frequency = cycle["frequency_Hz"].as_f64().unwrap();
        let is_steady = row["ramp"] == false;
        assert!(!is_steady || (frequency - 20.0).abs() < 1e-3, "{cycle}");
    }
}

/// A fault that the monitor identified is published as it is reported at the end.
#[test]
fn a_broker_gets_the_events_of_the_summary() {
    let Some(broker) = Mosquitto::start(None) else {
        return;
    };
    let mut heard = broker.subscribe(None);
    let root = tempfile::tempdir().unwrap();
    let url = format!("mqtt://127.0.0.1:{}", broker.port());
    let line = format!(
        "run --effect drift:stiffness=-0.5,cycles=500 --blocks 0.1:10:400 --mqtt {url} --json -"
    );
    let output = hil(root.path(), &words(&line));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    let messages = heard.until("finished");
    let published: Vec<&Value> = messages
        .iter()
        .filter(|message| message.topic == "mesh-damper/rig/event")
        .map(|message| &message.payload)
        .collect();
    let told = summary["events"].as_array().unwrap();
    assert!(!told.is_empty());
    assert_eq!(published.len(), told.len());
    for (event, row) in published.iter().zip(told) {
        assert_eq!(event["time_s"], row["time"]);
        assert_eq!(event["cause"], row["cause"]);
        assert_eq!(event["fault"], row["fault"]);
        assert!(event["text"].as_str().unwrap().contains("limit"), "{event}");
    }
}

#[test]
fn without_a_broker_the_test_goes_on_and_says_so() {
    let root = tempfile::tempdir().unwrap();
    let url = format!("mqtt://lab:geheim@127.0.0.1:{}", free_port());
    let output = run(root.path(), &["--mqtt", &url, "--json", "-"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(summary["mqtt"]["dropped"].as_u64().unwrap() > 6);
    assert_eq!(summary["mqtt"]["delivered"], 0);
    let said = text(&output.stderr);
    assert!(said.contains("no broker at mqtt://127.0.0.1:"), "{said}");
    assert!(!said.contains("geheim") && !text(&output.stdout).contains("geheim"));
}

/// Nothing has moved, and no file remains.
#[test]
fn what_cannot_be_is_refused_before_the_rig_moves() {
    let root = tempfile::tempdir().unwrap();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    for (arguments, said) in [
        (&["--mqtt", "http://lab:geheim@localhost"][..], "--mqtt"),
        (
            &["--mqtt", "mqtts://lab:geheim@localhost"],
            "TLS is not supported",
        ),
        (&["--mqtt", "mqtt://localhost/a/b"], "the rig's name"),
        (&["--live", &port], &format!("--live {port}")),
        (&["--live", "70000"], "70000"),
        (&["--live-wait", "5"], "--live"),
        (&["--live", "--live-hold", "1e9"], "--live-hold"),
        (&["--live", "--live-wait", "-1"], "give 0 to 86400"),
        (&["--speed", "0"], "--speed"),
    ] {
        let output = run(root.path(), arguments);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(said), "{arguments:?}: {error}");
        assert!(!error.contains("geheim"), "{error}");
        assert_eq!(
            fs::read_dir(root.path()).unwrap().count(),
            0,
            "{arguments:?}"
        );
    }
}
