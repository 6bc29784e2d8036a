//! `hil run` that is killed, or whose emulator is killed: the samples recorded before exist, and no process remains.
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use crate::command::wait_for;
use crate::full::emulated;
use mesh_damper_link::image::{Board, FIRMWARE};
use mesh_damper_recording::Recording;

/// A programme that lasts longer than its interruption takes, and a short one with the same beginning.
const LONG: [&str; 2] = ["--blocks", "0.1:5:17000"];
const SHORT: [&str; 2] = ["--blocks", "0.1:5:200"];

fn start(directory: &Path, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_hil"))
        .arg("run")
        .args(arguments)
        .current_dir(directory)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

pub fn wait_for_bytes(file: &Path, bytes: u64) {
    wait_for("nothing is recorded", || {
        fs::metadata(file)
            .is_ok_and(|found| found.len() > bytes)
            .then_some(())
    });
}

/// Removes the output of a run, if there is any: the next run would refuse to overwrite it.
fn clear(directory: &Path) {
    let left = directory.join("run-out");
    if left.exists() {
        fs::remove_dir_all(left).unwrap();
    }
}

/// The process of the emulator that a `hil run` has started.
pub fn emulator_of(harness: &Child) -> u32 {
    let children = format!("/proc/{0}/task/{0}/children", harness.id());
    let is_emulator = |id: &u32| {
        fs::read_to_string(format!("/proc/{id}/comm"))
            .is_ok_and(|name| name.starts_with("qemu-system"))
    };
    wait_for("no emulator was started", || {
        let children = fs::read_to_string(&children).unwrap_or_default();
        let ids = children.split_whitespace().filter_map(|id| id.parse().ok());
        ids.into_iter().find(is_emulator)
    })
}

#[track_caller]
fn begins_like(part: &Recording, whole: &Recording) {
    let same = part.len().min(whole.len());
    assert!(same > 100, "{same}");
    assert_eq!(part.time[..same], whole.time[..same]);
    assert_eq!(part.displacement[..same], whole.displacement[..same]);
    assert_eq!(part.force[..same], whole.force[..same]);
    assert_eq!(
        part.temperature.as_ref().map(|t| t[..same].to_vec()),
        whole.temperature.as_ref().map(|t| t[..same].to_vec())
    );
}

#[test]
fn a_run_that_is_killed_at_any_moment_leaves_what_it_recorded() {
    let root = tempfile::tempdir().unwrap();
    assert!(start(root.path(), &SHORT).wait().unwrap().success());
    let out = root.path().join("run-out");
    let journal = out.join("recording.partial.csv");
    // A successful run leaves no journal.
    assert!(!journal.exists());
    let whole = Recording::read(out.join("recording.csv.gz")).unwrap();
    fs::remove_dir_all(&out).unwrap();
    let mut longest = 0;
    for moment in 0..12 {
        let mut harness = start(root.path(), &LONG);
        wait_for_bytes(&journal, 40_000 * (moment + 1));
        harness.kill().unwrap();
        harness.wait().unwrap();
        let part = Recording::read(&journal).unwrap();
        begins_like(&part, &whole);
        assert_eq!(part.declared("specimen"), whole.declared("specimen"));
        assert!(part.declared("unfinished").is_some());
        longest = longest.max(part.len());
        let left: Vec<_> = fs::read_dir(&out)
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        assert_eq!(left, ["recording.partial.csv"]);
        fs::remove_dir_all(&out).unwrap();
    }
    assert!(longest > 5000, "{longest}");
}

/// The remaining files are the only record of its test.
#[test]
fn a_run_under_way_holds_its_folder_and_what_a_killed_one_left_is_kept() {
    let root = tempfile::tempdir().unwrap();
    let journal = root.path().join("run-out/recording.partial.csv");
    let mut harness = start(root.path(), &LONG);
    wait_for_bytes(&journal, 40_000);
    let again = || {
        let output = start(root.path(), &SHORT).wait_with_output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        (output.status.code(), error)
    };
    let beside = again();
    harness.kill().unwrap();
    harness.wait().unwrap();
    let left = fs::read(&journal).unwrap();
    let after = again();
    let refused = |said: &str| (Some(2), format!("error: {said}\n"));
    assert_eq!(
        beside,
        refused("run-out: in use by another run; wait for it or name another folder")
    );
    assert_eq!(
        after,
        refused(
            "run-out/recording.partial.csv: left by an interrupted run; \
             move it or remove it, or name another folder"
        )
    );
    assert!(fs::read(&journal).unwrap() == left);
    fs::rename(&journal, root.path().join("kept.csv")).unwrap();
    // The lock was released with the process that held it.
    assert!(start(root.path(), &SHORT).wait().unwrap().success());
    assert!(fs::read(root.path().join("kept.csv")).unwrap() == left);
}

/// Wherever the file ends, the recording consists of the whole rows and contains no other number.
#[test]
fn a_row_that_was_cut_is_left_out() {
    let head = "# unfinished: the run was under way\ntime_s,displacement_mm,force_kN\n";
    let rows: String = (0..12).map(|n| format!("{n},{n}.25,1{n}.75\n")).collect();
    let text = format!("{head}{rows}");
    let whole = Recording::from_bytes(Path::new("a.csv"), text.clone().into()).unwrap();
    assert_eq!(whole.len(), 12);
    let mut read = 0;
    for end in head.len()..text.len() {
        let rows = text[head.len()..end].matches('\n').count();
        match Recording::from_bytes(Path::new("a.csv"), text[..end].into()) {
            Ok(part) => {
                assert_eq!(part.len(), rows);
                assert_eq!(part.force, whole.force[..rows]);
                read += 1;
            }
            Err(error) => assert!(rows < 8, "{error}"),
        }
    }
    assert!(read > 30);
}

#[test]
fn an_emulator_killed_at_any_moment_ends_the_run_in_one_message() {
    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    let root = tempfile::tempdir().unwrap();
    let journal = root.path().join("run-out/recording.partial.csv");
    for moment in 0..4 {
        let harness = start(root.path(), &[&LONG[..], &["--on", "image"]].concat());
        let emulator = emulator_of(&harness);
        if moment > 0 {
            wait_for_bytes(&journal, 30_000 * moment);
        }
        let killed = Command::new("kill")
            .args(["-9", &emulator.to_string()])
            .status();
        assert!(killed.unwrap().success());
        let output = harness.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        let said = String::from_utf8(output.stderr).unwrap();
        let message: Vec<&str> = said
            .lines()
            .filter(|line| line.starts_with("error: "))
            .collect();
        let [message] = message[..] else {
            panic!("{said}")
        };
        assert!(
            message.contains("the emulator ended (signal: 9"),
            "{message}"
        );
        if moment > 0 {
            assert!(
                message
                    .ends_with("the samples recorded before are in run-out/recording.partial.csv"),
                "{message}"
            );
            assert!(Recording::read(&journal).unwrap().len() > 100);
        }
        clear(root.path());
        assert!(!emulated::lives(emulator));
    }
}

#[test]
fn a_harness_killed_at_any_moment_leaves_no_emulator() {
    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    let root = tempfile::tempdir().unwrap();
    let journal = root.path().join("run-out/recording.partial.csv");
    for moment in 0..12 {
        let mut harness = start(root.path(), &[&LONG[..], &["--on", "image"]].concat());
        let emulator = emulator_of(&harness);
        // As soon as the emulator exists, then while it starts, then during the run.
        if moment >= 6 {
            wait_for_bytes(&journal, 5_000 * (moment - 5));
        } else {
            for _ in 0..50 * moment {
                std::hint::black_box(emulated::lives(emulator));
            }
        }
        harness.kill().unwrap();
        harness.wait().unwrap();
        wait_for("the emulator outlived the harness", || {
            (!emulated::lives(emulator)).then_some(())
        });
        if moment >= 6 {
            assert!(Recording::read(&journal).is_ok());
        }
        clear(root.path());
    }
}
