//! `hil completions` and `hil man`, checked with shells and with `man`.

use std::fs;
use std::process::Command;

use crate::command::hil;

/// Whether `program` is installed. If `CI` is `true` and the program is `needed`, it must be; otherwise a line reports what is
/// skipped.
fn is_there(program: &str, needed: bool) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let found = std::env::split_paths(&path).any(|folder| folder.join(program).is_file());
    assert!(
        found || !needed || std::env::var("CI").as_deref() != Ok("true"),
        "{program} is not installed"
    );
    if !found {
        eprintln!("left out: {program} is not installed");
    }
    found
}

#[test]
fn bash_completes_commands_and_options() {
    if !is_there("bash", true) {
        return;
    }
    let root = tempfile::tempdir().unwrap();
    let script = hil(root.path(), &["completions", "bash"]);
    fs::write(root.path().join("hil.bash"), script).unwrap();
    let complete = |words: &str, last: usize| {
        let ask = format!(
            "source hil.bash && complete -p hil >/dev/null && COMP_WORDS=({words}) COMP_CWORD={last} && \
             _hil hil \"${{COMP_WORDS[{last}]}}\" \"${{COMP_WORDS[{last}-1]}}\" && printf '%s\\n' \"${{COMPREPLY[@]}}\""
        );
        let output = Command::new("bash")
            .args(["--norc", "-c", &ask])
            .current_dir(root.path())
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{error}");
        String::from_utf8(output.stdout).unwrap()
    };
    assert_eq!(complete("hil tra", 1).trim(), "trace");
    assert_eq!(complete("hil trace --held", 2).trim(), "--held-out");
    assert_eq!(complete("hil export --format fm", 3).trim(), "fmu");
}

#[test]
fn every_shell_gets_its_script() {
    let root = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = hil(root.path(), &["completions", shell]);
        for word in ["trace", "held-out", "faults"] {
            assert!(script.contains(word), "{shell} lacks {word}");
        }
    }
    crate::refusal::hil(root.path(), &["completions", "none"]);
}

#[test]
fn every_command_has_a_page_that_man_shows() {
    let root = tempfile::tempdir().unwrap();
    let said = hil(root.path(), &["man", "--out", "man1"]);
    let pages: Vec<_> = fs::read_dir(root.path().join("man1"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    assert_eq!(said.trim(), format!("{} pages are in man1", pages.len()));
    // This is the spelling of a hyphen that can be copied.
    let text = |page: &str| {
        let text = fs::read_to_string(root.path().join("man1").join(page)).unwrap();
        text.replace("\\-", "-")
    };
    let whole = text("hil.1");
    let help = hil(root.path(), &["--help"]);
    for command in &crate::full::reference::below(&help) {
        let text = text(&format!("hil-{command}.1"));
        assert!(text.contains(".SH SYNOPSIS"), "{command}");
        assert!(
            text.contains(&format!("hil {command}")),
            "{command}: {text}"
        );
        assert!(whole.contains(command), "hil.1 lacks {command}");
    }
    if is_there("mandoc", false) {
        let output = Command::new("mandoc")
            .args(["-T", "lint", "-W", "error"])
            .args(&pages)
            .output()
            .unwrap();
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stdout)
        );
    }
    if is_there("man", false) {
        let output = Command::new("man")
            .args(["--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z"])
            .arg(root.path().join("man1/hil-trace.1"))
            .output()
            .unwrap();
        assert!(
            output.status.success() && output.stderr.is_empty(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
    }
}
