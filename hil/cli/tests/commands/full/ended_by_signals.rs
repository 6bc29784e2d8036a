//! Commands of the feature `full` ended by a signal: their exit code, and what they leave, files, processes and messages.
#![cfg(target_os = "linux")]

use std::fs;
use std::io::{BufRead as _, BufReader, Read};
use std::os::unix::fs::PermissionsExt as _;
use std::path::Path;
use std::process::{Command, Stdio};

use mesh_damper_link::image::{Board, FIRMWARE, OWN_TIMER};
use mesh_damper_recording::Recording;
use serde_json::Value;

use crate::bad_input::MODEL;
use crate::command::{wait_for, words};
use crate::full::batch_command::record_all;
use crate::full::broker::Mosquitto;
use crate::full::emulated;
use crate::full::interrupted_run::{emulator_of, wait_for_bytes};
use crate::signals::{Running, SIGNALS, command, leaves_nothing, tree};

/// It lasts longer than its interruption takes.
const LONG: [&str; 2] = ["--blocks", "0.1:5:17000"];

/// The line of a command's output that begins with `begin`.
fn line(output: &mut Option<impl Read>, begin: &str) -> String {
    let lines = BufReader::new(output.as_mut().unwrap()).lines();
    let mut lines = lines.map(Result::unwrap);
    lines.find(|line| line.starts_with(begin)).unwrap()
}

#[test]
fn a_command_that_is_ended_while_it_reads_leaves_nothing() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    let export = words("export --model pipe --tick-rate 10000 --format");
    leaves_nothing(
        root.path(),
        &[
            &[&export[..], &["pack", "--out", "a.mdcp"]].concat(),
            &[&export[..], &["c", "--out", "a.c", "--json", "a.json"]].concat(),
            &["run", "--model", "pipe"],
            &["run", "--drive", "pipe", "--out", "new/out"],
            &["characterize", "pipe", "--static", "--out", "new"],
            &["batch", "pipe", "--out", "new"],
        ],
    );
}

/// What is finished stays, and the next batch goes on there.
#[test]
fn a_batch_leaves_whole_traces() {
    const COUNT: usize = 6;
    for (name, ended) in SIGNALS {
        let root = tempfile::tempdir().unwrap();
        record_all(root.path(), COUNT);
        let journal = root.path().join("batch-out/journal.jsonl");
        let kept = || {
            let text = fs::read_to_string(&journal).unwrap_or_default();
            text.matches('\n').count().saturating_sub(1)
        };
        let batch = ["batch", "tests", "--jobs", "2", "--reports"];
        let running = Running::start(root.path(), &batch);
        wait_for("no trace was kept", || (kept() > 1).then_some(()));
        let (code, said) = running.ended_by(name);
        assert_eq!(code, ended, "{said}");
        let left = tree(&root.path().join("batch-out"));
        for path in &left {
            assert!(!path.contains(".tmp"), "{left:?}");
            let is_trace = path.starts_with("traces/") && path.matches('/').count() == 1;
            for file in ["model.json", "report.html", "trace.json"]
                .iter()
                .filter(|_| is_trace)
            {
                assert!(left.contains(&format!("{path}/{file}")), "{left:?}");
            }
        }
        for line in fs::read_to_string(&journal).unwrap().lines() {
            serde_json::from_str::<Value>(line).unwrap();
        }
        let before = kept();
        assert!(
            before < COUNT && !left.contains(&"outcomes.csv".to_owned()),
            "{left:?}"
        );
        let again = command(root.path(), &[&batch[..], &["--json", "-"]].concat(), &[]);
        let output = { again }.output().unwrap();
        let summary: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(summary["computed"], COUNT - before);
        assert_eq!(summary["traced"], COUNT);
    }
}

#[test]
fn a_run_leaves_whole_rows() {
    for (name, ended) in SIGNALS {
        let root = tempfile::tempdir().unwrap();
        let journal = root.path().join("run-out/recording.partial.csv");
        let running = Running::start(root.path(), &[&["run"], &LONG[..]].concat());
        wait_for_bytes(&journal, 40_000);
        let (code, said) = running.ended_by(name);
        assert_eq!(code, ended, "{said}");
        assert_eq!(
            tree(&root.path().join("run-out")),
            ["recording.partial.csv"]
        );
        assert!(fs::read(&journal).unwrap().ends_with(b"\n"));
        assert!(Recording::read(&journal).unwrap().len() > 100);
    }
}

/// The emulator has ended when the command has, at its first moment and later.
#[test]
fn a_run_on_the_image_leaves_no_emulator() {
    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    for (name, ended) in SIGNALS {
        for bytes in [None, Some(20_000)] {
            let root = tempfile::tempdir().unwrap();
            let arguments = [&["run", "--on", "image"], &LONG[..]].concat();
            let running = Running::start(root.path(), &arguments);
            let emulator = emulator_of(&running.0);
            if let Some(bytes) = bytes {
                wait_for_bytes(&root.path().join("run-out/recording.partial.csv"), bytes);
            }
            let (code, said) = running.ended_by(name);
            assert_eq!(code, ended, "{said}");
            assert!(!emulated::lives(emulator), "{said}");
            assert!(!said.contains("error"), "{said}");
        }
    }
}

#[test]
fn a_broker_learns_what_ended_the_test() {
    for (name, ended) in SIGNALS {
        let Some(broker) = Mosquitto::start(None) else {
            return;
        };
        let mut heard = broker.subscribe(None);
        let root = tempfile::tempdir().unwrap();
        let url = format!("mqtt://127.0.0.1:{}/rig-7", broker.port());
        let arguments = [&["run", "--mqtt", &url], &LONG[..]].concat();
        let running = Running::start(root.path(), &arguments);
        heard.until("running");
        let (code, said) = running.ended_by(name);
        assert_eq!(code, ended, "{said}");
        // A last will would be one of these, or come later and stay.
        let mut states = std::iter::repeat_with(|| heard.next())
            .filter(|message| message.topic.ends_with("/status"))
            .skip_while(|message| message.payload["state"] == "running");
        let last = states.next().unwrap().payload;
        assert_eq!(last["state"], "broken_off");
        assert_eq!(last["cause"], format!("ended by SIG{name}"));
        let mut later = broker.subscribe(None);
        let status = [later.next(), later.next()];
        let status = status
            .iter()
            .find(|message| message.topic.ends_with("/status"));
        assert_eq!(status.unwrap().payload["state"], "broken_off");
    }
}

#[test]
fn a_live_page_ends_with_the_command_and_results_stay() {
    for (name, ended) in SIGNALS {
        let root = tempfile::tempdir().unwrap();
        // While it waits for a page, nothing has been recorded.
        let waits = ["run", "--live", "--live-wait", "80000"];
        let mut running = Running::start(root.path(), &waits);
        line(&mut running.0.stderr, "The live page is");
        let (code, _) = running.ended_by(name);
        assert_eq!(code, ended);
        assert_eq!(tree(root.path()), <[&str; 0]>::default());
        // While it shows the page after the test.
        let holds = words("run --live --live-hold 80000 --speed max --blocks 0.1:20:6");
        let mut running = Running::start(root.path(), &holds);
        line(&mut running.0.stderr, "The live page stays");
        let (code, _) = running.ended_by(name);
        assert_eq!(code, ended);
        let left = tree(&root.path().join("run-out"));
        assert_eq!(left, ["cycles.csv", "recording.csv.gz"]);
    }
}

/// A board in an emulator, and the recording of a test on it.
#[test]
fn a_recording_of_a_board_leaves_whole_rows_and_a_board_no_emulator() {
    if emulated::image(&OWN_TIMER, Board::Mps2An386).is_none() {
        return;
    }
    for (name, ended) in SIGNALS {
        let root = tempfile::tempdir().unwrap();
        let blocks = ["--blocks", "0.1:20:4000"];
        let emulate = [&["emulate", "--json", "board.json"], &blocks[..]].concat();
        let mut board = Running::start(root.path(), &emulate);
        line(&mut board.0.stdout, "The board is at");
        let emulator = emulator_of(&board.0);
        let about = fs::read(root.path().join("board.json")).unwrap();
        let about: Value = serde_json::from_slice(&about).unwrap();
        let port = format!("serial:{}", about["port"].as_str().unwrap());
        let range = about["force_range_kn"].to_string();
        let line = format!("record --from {port} --force-range {range} --out rec.csv");
        let record = words(&line);
        let running = Running::start(root.path(), &[&record[..], &blocks].concat());
        let partial = root.path().join("rec.csv.partial.csv");
        wait_for_bytes(&partial, 10_000);
        let (code, said) = running.ended_by(name);
        assert_eq!(code, ended, "{said}");
        assert_eq!(tree(root.path()), ["board.json", "rec.csv.partial.csv"]);
        assert!(fs::read(&partial).unwrap().ends_with(b"\n"));
        assert!(Recording::read(&partial).unwrap().len() > 100);
        assert!(emulated::lives(emulator));
        let (code, said) = board.ended_by(name);
        assert_eq!(code, ended, "{said}");
        assert!(!emulated::lives(emulator));
    }
}

/// A cargo that starts a compiler and waits for it. Both write their numbers.
const CARGO: &str = "#!/bin/sh\nsleep 100000 &\necho $! > ids.part\necho $$ >> ids.part\nmv ids.part \"$IDS\"\nwait\n";

/// A build of an FMU's library and of an image: neither cargo nor what it has started is left.
#[test]
fn a_build_is_ended_with_its_compilers() {
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name);
    fs::write(path("model.json"), MODEL).unwrap();
    fs::write(path("cargo"), CARGO).unwrap();
    fs::set_permissions(path("cargo"), fs::Permissions::from_mode(0o755)).unwrap();
    // Alone, without the library of an FMU beside it.
    let alone = path("hil-alone");
    fs::copy(env!("CARGO_BIN_EXE_hil"), &alone).unwrap();
    let export = words("export --model model.json --format fmu --tick-rate 1e4");
    let mut commands = vec![[&export[..], &["--out", "a.fmu"]].concat()];
    if Board::Mps2An386.check().is_ok() {
        commands.push(vec!["run", "--on", "image"]);
        commands.push(vec!["emulate"]);
    }
    // What is unpacked for a build stays for the next one.
    let cache = tempfile::tempdir().unwrap();
    for arguments in commands {
        for (name, ended) in SIGNALS {
            let before = tree(root.path());
            let running = alone_with(&alone, root.path(), &arguments, cache.path());
            let ids = wait_for("nothing is built", || fs::read_to_string(path("ids")).ok());
            fs::remove_file(path("ids")).unwrap();
            let (code, said) = running.ended_by(name);
            assert_eq!(code, ended, "{said}");
            for id in ids.lines().map(|id| id.parse().unwrap()) {
                assert!(!emulated::lives(id), "{arguments:?}: {id}");
            }
            assert_eq!(tree(root.path()), before, "{arguments:?}");
        }
    }
}

fn alone_with(alone: &Path, root: &Path, arguments: &[&str], cache: &Path) -> Running {
    let mut command = Command::new("env");
    command
        .arg("--default-signal")
        .arg(alone)
        .args(arguments)
        .current_dir(root)
        // No repository surrounds it.
        .env_remove("CARGO_MANIFEST_DIR")
        .env("XDG_CACHE_HOME", cache)
        .env("CARGO", root.join("cargo"))
        .env("IDS", root.join("ids"))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped());
    Running(command.spawn().unwrap())
}
