//! The real command with bad input.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// The command with these arguments in `directory`.
pub fn hil(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hil"))
        .args(arguments)
        .current_dir(directory)
        .env("RUST_BACKTRACE", "1")
        .output()
        .unwrap()
}

fn names(directory: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(directory)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

/// Asserts that the command refuses with `said` in its one line, and leaves `directory` unchanged.
#[track_caller]
pub fn refuses(directory: &Path, arguments: &[&str], said: &[&str]) {
    let before = names(directory);
    let output = hil(directory, arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
    assert_eq!(error.lines().count(), 1, "{arguments:?}: {error}");
    assert!(error.starts_with("error: "), "{error}");
    for part in said {
        assert!(
            error.contains(part),
            "{arguments:?}: {part:?} not in {error}"
        );
    }
    assert!(output.stdout.is_empty());
    assert_eq!(names(directory), before, "{arguments:?}");
}
