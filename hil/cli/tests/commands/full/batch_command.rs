//! `hil batch` and `hil compare`: their output, their files and their exit codes.

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::command::{hil, record, wait_for};
use crate::refusal;

pub fn record_all(root: &Path, count: usize) {
    fs::create_dir(root.join("tests")).unwrap();
    for number in 0..count {
        record(&root.join(format!("tests/{number}.csv")), number);
    }
}

fn batch(root: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hil"));
    command.arg("batch").args(arguments).current_dir(root);
    command
}

#[test]
fn a_batch_says_what_failed_and_its_models_are_compared() {
    let root = tempfile::tempdir().unwrap();
    record_all(root.path(), 2);
    fs::write(root.path().join("tests/broken.csv"), "time_s\n0\n").unwrap();
    fs::write(root.path().join("tests/photo.jpg"), "").unwrap();
    let done = batch(root.path(), &["tests"]).output().unwrap();
    let [said, warned] = [done.stdout, done.stderr].map(|text| String::from_utf8(text).unwrap());
    assert_eq!(done.status.code(), Some(1), "{said}{warned}");
    assert!(
        said.contains("3 traces, in ") && said.contains("1  failed"),
        "{said}"
    );
    assert!(said.contains("Effects: offset 2"), "{said}");
    assert!(
        warned.contains("not that of a recording: photo.jpg"),
        "{warned}"
    );
    assert!(warned.contains("error: 1 of 3 traces failed"), "{warned}");
    let page = fs::read_to_string(root.path().join("batch-out/index.html")).unwrap();
    assert!(page.contains("broken.csv"));

    // The same with names on standard input, without the recording that fails: no trace is computed again.
    let mut child = batch(root.path(), &["-", "--json", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child
        .stdin
        .take()
        .unwrap()
        .write_all(b"tests/1.csv\ntests/0.csv\n")
        .unwrap();
    let done = child.wait_with_output().unwrap();
    assert_eq!(done.status.code(), Some(0));
    let summary: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(summary["format"], "mesh-damper batch");
    assert_eq!(
        (&summary["computed"], &summary["traced"]),
        (&0.into(), &2.into())
    );

    let folders = [1, 0].map(|row| {
        let folder = summary["traces"][row]["folder"].as_str().unwrap();
        format!("batch-out/{folder}")
    });
    let [one, other] = &folders;
    let printed = hil(
        root.path(),
        &[
            "compare", one, other, "--times", "0,30.5", "--out", "c.svg", "--json", "c.json",
        ],
    );
    assert!(
        printed.contains("offset force") && printed.contains("Force compared with model 0"),
        "{printed}"
    );
    let found: serde_json::Value =
        serde_json::from_slice(&fs::read(root.path().join("c.json")).unwrap()).unwrap();
    assert_eq!(found["models"][1]["time"], 30.5);
    assert!(
        fs::read_to_string(root.path().join("c.svg"))
            .unwrap()
            .starts_with("<svg")
    );
}

/// The process is killed in the middle of a batch, at any point.
#[cfg(unix)]
#[test]
fn a_batch_that_is_killed_goes_on_where_it_was() {
    const COUNT: usize = 8;
    let root = tempfile::tempdir().unwrap();
    record_all(root.path(), COUNT);
    let kept = || {
        let journal = fs::read(root.path().join("batch-out/journal.jsonl")).unwrap_or_default();
        journal
            .iter()
            .filter(|&&byte| byte == b'\n')
            .count()
            .saturating_sub(1)
    };
    let mut child = batch(root.path(), &["tests", "--jobs", "2"])
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    wait_for("no trace was kept", || (kept() >= 2).then_some(()));
    child.kill().unwrap();
    child.wait().unwrap();
    let before = kept();
    assert!(before < COUNT && !root.path().join("batch-out/outcomes.parquet").exists());
    let done = batch(root.path(), &["tests", "--json", "-"])
        .output()
        .unwrap();
    let summary: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(summary["computed"], COUNT - before);
    assert_eq!(summary["traced"], COUNT);
}

#[test]
fn what_is_no_list_and_no_model_is_refused_in_one_line() {
    let root = tempfile::tempdir().unwrap();
    record_all(root.path(), 1);
    for (arguments, said) in [
        (
            &["batch", "tests/0.csv"][..],
            "one recording is for `hil trace`",
        ),
        (&["batch", "nowhere"], "does not exist"),
        (
            &["batch", "tests", "--out", "tests"],
            "holds recordings of the list",
        ),
        (&["compare", "tests", "tests"], "model.json: cannot read it"),
        (
            &["compare", "a", "b", "--times", "1"],
            "--times: has 1 for 2 models",
        ),
    ] {
        let done = refusal::hil(root.path(), arguments);
        let error = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(2), "{error}");
        assert!(
            error.contains(said) && error.lines().count() == 1,
            "{error}"
        );
    }
    let left: Vec<_> = fs::read_dir(root.path()).unwrap().collect();
    assert_eq!(left.len(), 1, "{left:?}");
}
