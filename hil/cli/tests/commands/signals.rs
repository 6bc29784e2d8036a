//! The command ended by a signal: its exit code, and what it leaves.

use std::fs::{self, File, OpenOptions};
use std::os::unix::fs::OpenOptionsExt as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};

use crate::bad_input::MODEL;
use crate::command::{record, shell, wait_for, words};

/// The signals with the codes that a shell gives for them.
pub const SIGNALS: [(&str, i32); 2] = [("INT", 130), ("TERM", 143)];

/// `hil` with `arguments` in `directory`, with pipes for both outputs, and with these signals ignored.
pub fn command(directory: &Path, arguments: &[&str], ignored: &[&str]) -> Command {
    let mut command = Command::new("env");
    command
        // A shell that runs the tests in the background has them ignore signals, and so would what they start.
        .arg("--default-signal")
        .args(ignored.iter().map(|name| format!("--ignore-signal={name}")))
        .arg(env!("CARGO_BIN_EXE_hil"))
        .args(arguments)
        .current_dir(directory)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// A command under way, which is killed when this is dropped.
pub struct Running(pub Child);

impl Running {
    /// `hil` with `arguments` in `directory`, with pipes for both outputs.
    pub fn start(directory: &Path, arguments: &[&str]) -> Self {
        Self(command(directory, arguments, &[]).spawn().unwrap())
    }

    /// Sends SIG`name`.
    pub fn signal(&self, name: &str) {
        let id = self.0.id().to_string();
        let sent = Command::new("kill")
            .args([&format!("-{name}"), &id])
            .status();
        assert!(sent.unwrap().success());
    }

    /// Sends SIG`name`, and waits for the end. Returns the code that a shell gives for it, and what was said on standard error.
    pub fn ended_by(mut self, name: &str) -> (i32, String) {
        self.signal(name);
        let mut said = String::new();
        if let Some(mut errors) = self.0.stderr.take() {
            std::io::Read::read_to_string(&mut errors, &mut said).unwrap();
        }
        (code(self.0.wait().unwrap()), said)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The code that a shell gives.
pub fn code(status: ExitStatus) -> i32 {
    let by_signal = status.signal().map(|signal| 128 + signal);
    status.code().or(by_signal).unwrap()
}

/// All paths below `directory`, sorted.
pub fn tree(directory: &Path) -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![directory.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(directory).unwrap().display().to_string();
            found.push(name);
            if path.is_dir() && !path.is_symlink() {
                folders.push(path);
            }
        }
    }
    found.sort();
    found
}

/// A named pipe: a command that reads it waits for what comes.
pub fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// Waits until a command reads the pipe, and returns its other end, which keeps the command waiting.
pub fn reader_of(pipe: &Path) -> File {
    // O_NONBLOCK: it does not open before there is a reader.
    let mut options = OpenOptions::new();
    options.write(true).custom_flags(0o4000);
    wait_for("nobody reads the pipe", || options.open(pipe).ok())
}

/// Each command that reads a pipe, ended while it waits for what comes.
pub fn leaves_nothing(root: &Path, commands: &[&[&str]]) {
    pipe(&root.join("pipe"));
    let before = tree(root);
    for arguments in commands {
        for (name, code) in SIGNALS {
            let running = Running::start(root, arguments);
            let _other_end = reader_of(&root.join("pipe"));
            let (ended, said) = running.ended_by(name);
            assert_eq!(ended, code, "{arguments:?}: {said}");
            assert_eq!(said, "", "{arguments:?}");
            assert_eq!(tree(root), before, "{arguments:?}");
        }
    }
}

#[test]
fn a_command_that_is_ended_while_it_reads_leaves_nothing() {
    let root = tempfile::tempdir().unwrap();
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    leaves_nothing(
        root.path(),
        &[
            &["trace", "pipe", "--out", "new/out", "--json", "t.json"],
            &["predict", "--model", "model.json", "pipe", "--out", "p.csv"],
            &words("respond --model model.json --base pipe --mass 1 --out r.csv"),
            &["inspect", "pipe", "--json", "i.json"],
        ],
    );
}

/// A trace and a demo while they search, and at the moment when the first of their files is there.
#[test]
fn of_the_files_of_a_command_all_are_there_or_none() {
    let root = tempfile::tempdir().unwrap();
    record(&root.path().join("rec.csv"), 0);
    let trace = ["model.json", "report.html", "trace.json"];
    let demo = [
        "loop.svg",
        "model.json",
        "recording.csv.gz",
        "report.html",
        "trace.json",
    ];
    for (arguments, all) in [
        (&["trace", "rec.csv", "--out", "out"][..], &trace[..]),
        (&["demo", "--out", "out"], &demo),
    ] {
        for (name, ended) in SIGNALS {
            for is_late in [false, true] {
                let out = root.path().join("out");
                let mut running = Running::start(root.path(), arguments);
                let first = || {
                    let has_file =
                        || fs::read_dir(&out).is_ok_and(|mut files| files.next().is_some());
                    (out.is_dir() && (!is_late || has_file())).then_some(())
                };
                wait_for("nothing is written", first);
                running.signal(name);
                let status = running.0.wait().unwrap();
                let left = if out.exists() { tree(&out) } else { Vec::new() };
                match (code(status), &left[..]) {
                    (code, []) => assert_eq!(code, ended),
                    // All was written when the signal came: it is the last that the command hears, or comes too late.
                    (code, left) => {
                        assert!(is_late && left == all, "{left:?}");
                        assert!(code == ended || code == 0, "{code}");
                    }
                }
                let _ = fs::remove_dir_all(out);
            }
        }
    }
}

/// As under `nohup`.
#[test]
fn a_signal_that_a_command_was_started_to_ignore_stays_ignored() {
    let root = tempfile::tempdir().unwrap();
    pipe(&root.path().join("pipe"));
    let mut command = command(root.path(), &["inspect", "pipe"], &["HUP"]);
    let running = Running(command.spawn().unwrap());
    let _other_end = reader_of(&root.path().join("pipe"));
    running.signal("HUP");
    assert_eq!(running.ended_by("TERM").0, 143);
}

/// The code is that of the work; 2 where results are lost.
#[test]
fn an_output_that_takes_nothing_is_no_crash() {
    let root = tempfile::tempdir().unwrap();
    record(&root.path().join("rec.csv"), 0);
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    // A note, and no result on standard output.
    let foreign = fs::read_to_string(root.path().join("rec.csv")).unwrap();
    let foreign = foreign.replacen(
        "time_s,displacement_mm,force_kN",
        "Time [s],Weg [mm],Kraft [kN]",
        1,
    );
    fs::write(root.path().join("foreign.csv"), foreign).unwrap();
    for (arguments, own, lost) in [
        ("inspect rec.csv", 0, 2),
        ("inspect none.csv", 2, 2),
        ("predict --model model.json rec.csv --out p.csv", 0, 2),
        (
            "predict --model model.json foreign.csv --out p.csv --json -",
            0,
            2,
        ),
        ("trace none.csv", 2, 2),
        ("trace", 2, 2),
        ("nonsense", 2, 2),
        ("--help", 0, 2),
        ("help trace", 0, 2),
        ("--version", 0, 2),
    ] {
        for (to, code) in [
            ("2> /dev/full", own),
            ("> /dev/full", lost),
            ("> /dev/full 2>&1", lost),
            ("2>&-", own),
            ("2>&1 | true; exit ${PIPESTATUS[0]}", own),
            ("2>&1 | head -c 1; exit ${PIPESTATUS[0]}", own),
        ] {
            let output = shell("bash", root.path(), &format!("\"$HIL\" {arguments} {to}"));
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(code), "{arguments} {to}: {said}");
            assert!(!said.contains("panicked"), "{arguments} {to}: {said}");
        }
    }
}
