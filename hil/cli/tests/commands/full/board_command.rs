//! `hil emulate`, `record` and `upload`: a board on its own timer, from the command line.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};

use mesh_damper_link::image::{Board, OWN_TIMER};
use serde_json::Value;

use crate::command::{hil, words};
use crate::full::emulated;
use crate::full::schema_command::is_as_its_schema_says;
use crate::refusal;

/// `hil emulate`, which runs until this is dropped.
struct Emulate(Child);

impl Emulate {
    /// The address of the board, `serial:PORT`, and the range of its load cell, kN; `None`, with a message, without an emulator.
    fn new(directory: &Path) -> Option<(Self, String, String)> {
        emulated::image(&OWN_TIMER, Board::Mps2An386)?;
        let mut process = Command::new(env!("CARGO_BIN_EXE_hil"))
            .args(["emulate", "--blocks", "0.1:20:6"])
            .args(["--json", "board.json"])
            .current_dir(directory)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut said = String::new();
        BufReader::new(process.stdout.take().unwrap())
            .read_line(&mut said)
            .unwrap();
        assert!(said.starts_with("The board is at /dev/"), "{said}");
        let board = json(&directory.join("board.json"));
        is_as_its_schema_says("emulate", &board);
        let port = format!("serial:{}", board["port"].as_str().unwrap());
        Some((Self(process), port, board["force_range_kn"].to_string()))
    }
}

impl Drop for Emulate {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Asserts that a command is refused and leaves `there` files, and returns its one line.
#[track_caller]
fn refused(directory: &Path, arguments: &[&str], there: usize) -> String {
    let output = refusal::hil(directory, arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert_eq!(said.lines().count(), 1, "{said}");
    assert_eq!(std::fs::read_dir(directory).unwrap().count(), there);
    said
}

#[test]
fn a_test_is_recorded_and_a_law_is_put_onto_the_rig_that_runs() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let Some((_board, port, range)) = Emulate::new(root) else {
        return;
    };
    let record = ["record", "--from", &port, "--out"];
    let blocks = ["--force-range", &range, "--blocks"];

    // The test of a rig in this process, without the data that a board's telemetry lacks.
    hil(root, &["run", "--blocks", "0.1:20:6", "--out", "here"]);
    let whole = words("there.csv --record-every 10 --json there.json --live");
    hil(
        root,
        &[&record[..], &whole, &blocks, &["0.1:20:6"]].concat(),
    );
    let there = json(&root.join("there.json"));
    is_as_its_schema_says("record", &there);
    assert_eq!(there["lost"]["rows"], 0);
    assert_eq!(there["late_ticks"], 0);
    let page = there["live"]["address"].as_str().unwrap();
    assert!(page.starts_with("http://127.0.0.1:"), "{page}");
    assert_eq!(there["stopped"], Value::Null);
    let cycles = there["cycles"].as_array().unwrap();
    let rows = std::fs::read_to_string(root.join("here/cycles.csv")).unwrap();
    assert_eq!(cycles.len(), rows.lines().count() - 1);
    let force = |file: &str| {
        let recording = mesh_damper_recording::Recording::read(root.join(file)).unwrap();
        (recording.time, recording.displacement, recording.force)
    };
    assert_eq!(force("there.csv"), force("here/recording.csv.gz"));
    assert!(!root.join("there.csv.partial.csv").exists());

    // A test that continues while another law is uploaded.
    let model = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../examples/own-timer/src/mount.json"
    );
    let line = format!("export --model {model} --format pack --tick-rate 10000");
    let export = words(&line);
    hil(root, &[&export[..], &["--out", "mount.mdcp"]].concat());
    let keep = ["before.csv", "--duration", "0.3", "--keep-running"];
    hil(
        root,
        &[&record[..], &keep, &blocks, &["0.1:20:4000"]].concat(),
    );
    let line = format!("upload --to {port} mount.mdcp --json upload.json");
    let upload = words(&line);
    hil(root, &upload);
    let uploaded = json(&root.join("upload.json"));
    is_as_its_schema_says("upload", &uploaded);
    assert_eq!(uploaded["in_force"], true);
    assert_eq!(uploaded["late_ticks"], 0);
    let join = words("after.csv --duration 0.3 --join --json after.json");
    hil(root, &[&record[..], &join].concat());
    let after = json(&root.join("after.json"));
    let stiffness = |run: &Value| {
        run["cycles"][1]["model_stiffness_kn_per_mm"]
            .as_f64()
            .unwrap()
    };
    assert!((stiffness(&after) - stiffness(&there)).abs() > 0.05 * stiffness(&there));

    // A pack of another tick rate is refused, and the running law stays.
    let line = format!("export --model {model} --format pack --tick-rate 5000");
    let other = words(&line);
    hil(root, &[&other[..], &["--out", "other.mdcp"]].concat());
    let files = std::fs::read_dir(root).unwrap().count();
    let said = refused(root, &["upload", "--to", &port, "other.mdcp"], files);
    assert!(said.contains("tick_rate"), "{said}");

    // A running rig is not restarted, and a board on its own timer is not run in lockstep.
    let again = [&record[..], &["again.csv"], &blocks, &["0.1:20:6"]].concat();
    let said = refused(root, &again, files);
    assert!(
        said.contains("hil stop") && said.contains("--join"),
        "{said}"
    );

    let stop = ["stop", "--at", &port];
    assert_eq!(hil(root, &stop), "The rig has stopped\n");
    assert_eq!(hil(root, &stop), "The rig did not run\n");

    // A pack is checked before the board is contacted.
    std::fs::write(root.join("no.mdcp"), "no pack").unwrap();
    let pack = ["again.csv", "--pack", "no.mdcp"];
    let said = refused(
        root,
        &[&record[..], &pack, &blocks, &["0.1:20:6"]].concat(),
        files + 1,
    );
    assert!(said.contains("no.mdcp"), "{said}");

    // A name that is not valid for a channel is refused.
    let named = ["again.csv", "--control", "force_kN"];
    refused(
        root,
        &[&record[..], &named, &blocks, &["0.1:20:6"]].concat(),
        files + 1,
    );
}

#[test]
fn a_rig_that_stops_on_a_limit_leaves_its_recording_and_says_why() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let Some((_board, port, range)) = Emulate::new(root) else {
        return;
    };
    let line = format!(
        "record --from {port} --out limit.csv --force-range {range} --force-limit 0.05 --blocks 0.1:20:6"
    );
    let output = refusal::hil(root, &words(&line));
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("the force exceeded its limit"), "{said}");
    assert!(root.join("limit.csv").exists());
}

#[test]
fn a_board_that_is_not_there_is_said_in_one_line() {
    let root = tempfile::tempdir().unwrap();
    let root = root.path();
    let nowhere = "serial:/dev/nowhere";
    let line = format!("record --from {nowhere} --out rec.csv --force-range 1");
    let record = words(&line);
    let said = refused(root, &record, 0);
    assert!(
        said.contains("/dev/nowhere") && said.contains("cannot be opened"),
        "{said}"
    );
    std::fs::write(root.join("no.mdcp"), "no pack").unwrap();
    let said = refused(root, &["upload", "--to", nowhere, "no.mdcp"], 1);
    assert!(
        said.contains("no.mdcp") && said.contains("hil export --format pack"),
        "{said}"
    );
    let said = refused(root, &["upload", "--to", nowhere, "none.mdcp"], 1);
    assert!(said.contains("none.mdcp"), "{said}");
    for (option, value) in [
        ("--silence", "-1"),
        ("--silence", "nan"),
        ("--duration", "0"),
    ] {
        let option = format!("{option}={value}");
        let said = refused(root, &[&record[..], &[&option]].concat(), 1);
        assert!(said.contains("is outside its range"), "{said}");
    }
}
