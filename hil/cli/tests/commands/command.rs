//! The real command.

use std::path::Path;
use std::process::Command;

/// The output of the command with these arguments in `directory`; the command must succeed.
#[track_caller]
pub fn hil(directory: &Path, arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_hil"))
        .args(arguments)
        .current_dir(directory)
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}
