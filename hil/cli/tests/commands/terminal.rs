//! Names that a terminal would obey, in files, columns, comments and arguments: every command shows them escaped.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use mesh_damper_output::terminal::visible;

use crate::bad_input::MODEL;
use crate::command::record;
use crate::refusal::hil;

/// It clears the screen, colours, turns the direction of text, hides, and begins a line that looks like the command's own.
pub const NAME: &str = "a\u{1b}[2J\u{9b}1m\u{202e}b\u{200b}\u{2066}\u{ad}\u{61c}\u{206a}\u{e0041}\r\n  next: rm rec\u{85}\u{7f}.csv";

/// Both outputs of a command, in which nothing but ends of lines is obeyed.
#[track_caller]
pub fn shown(output: &Output) -> String {
    let both = [&output.stdout[..], &output.stderr].concat();
    let text = String::from_utf8(both).unwrap();
    for line in text.split('\n') {
        assert_eq!(visible(line), line);
    }
    text
}

/// A recording of another program whose names and comment a terminal obeys.
fn foreign(root: &Path, name: &str) {
    let path = root.join(name);
    record(&path, 0);
    let rows = fs::read_to_string(&path).unwrap();
    let header = "# specimen: \u{1b}]0;title\u{7}\u{202e}\nTime [s],Weg\u{1b}c [mm],\"Kraft\u{202e}\n  next: x [kN]\"";
    let rows = rows.replacen("time_s,displacement_mm,force_kN", header, 1);
    fs::write(path, rows).unwrap();
}

/// What bash makes of `command`, whose first word is `hil`.
fn typed(directory: &Path, command: &str) -> Output {
    Command::new("bash")
        .args(["-c", &format!("hil() {{ \"$HIL\" \"$@\"; }}; {command}")])
        .env("HIL", env!("CARGO_BIN_EXE_hil"))
        .current_dir(directory)
        .output()
        .unwrap()
}

#[test]
fn a_file_is_inspected_and_the_next_command_runs() {
    let root = tempfile::tempdir().unwrap();
    for name in [NAME, "-x.csv", "it's $HOME `id` \\ \"!\".csv"] {
        foreign(root.path(), name);
        let output = hil(root.path(), &["inspect", "--", name]);
        let said = shown(&output);
        assert!(output.status.success(), "{said}");
        let mut commands = said
            .lines()
            .filter_map(|line| line.strip_prefix("  next: "));
        let (Some(command), None) = (commands.next(), commands.next()) else {
            panic!("{said}");
        };
        let traced = typed(root.path(), command);
        let said = shown(&traced);
        assert!(traced.status.success(), "{command}: {said}");
        // Its columns are those of the file.
        assert!(said.contains(r"Kraft\u{202e}"), "{said}");
        fs::remove_dir_all(root.path().join("trace-out")).unwrap();
    }
}

/// A name that is no text, as another system may have written it.
#[test]
fn the_next_command_names_a_file_by_its_bytes() {
    let root = tempfile::tempdir().unwrap();
    foreign(root.path(), "a.csv");
    assert!(
        typed(root.path(), r"mv a.csv $'pr\374fung\033.csv'")
            .status
            .success()
    );
    let said = shown(&typed(root.path(), "hil inspect pr*"));
    let mut commands = said
        .lines()
        .filter_map(|line| line.strip_prefix("  next: "));
    let traced = typed(root.path(), commands.next().unwrap());
    assert!(traced.status.success(), "{}", shown(&traced));
}

#[test]
fn json_is_exact_and_shown_escaped() {
    let root = tempfile::tempdir().unwrap();
    foreign(root.path(), NAME);
    let output = hil(root.path(), &["inspect", NAME, "--json", "-"]);
    let said = shown(&output);
    let json: serde_json::Value = serde_json::from_str(&said).unwrap();
    let file = &json["files"][0];
    assert_eq!(file["file"], NAME);
    assert_eq!(file["comments"][0], "specimen: \u{1b}]0;title\u{7}\u{202e}");
    let column = file["tables"][0]["columns"][1]["name"].as_str().unwrap();
    assert!(column.contains("Weg\u{1b}c"), "{column:?}");
}

#[test]
fn results_and_errors_show_names_escaped() {
    let root = tempfile::tempdir().unwrap();
    record(&root.path().join(NAME), 0);
    fs::write(root.path().join("model.json"), MODEL).unwrap();
    let missing = format!("no {NAME}");
    let option = format!("--{NAME}");
    let unit = format!("force={NAME}");
    for (arguments, code) in [
        (
            &["predict", "--model", "model.json", NAME, "--out", "p.csv"][..],
            0,
        ),
        (
            &["predict", "--model", "model.json", NAME, "--out", &missing],
            0,
        ),
        (&["predict", "--model", NAME, NAME, "--out", "p.csv"], 2),
        (&["inspect", &format!("{NAME}/none.csv")], 2),
        (&["trace", &format!("none{NAME}")], 2),
        (&["inspect", &option], 2),
        (&["inspect", NAME, "--decimal", NAME], 2),
        (&["inspect", NAME, "--unit", &unit], 2),
        (&["inspect", NAME, "--unit", NAME], 2),
        (&["inspect", NAME, "--table", NAME], 2),
        (&[NAME], 2),
    ] {
        let output = hil(root.path(), arguments);
        let said = shown(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {said}");
        // No name is a line of its own.
        assert!(
            !said.lines().any(|line| line.starts_with("  next: rm")),
            "{said}"
        );
    }
}
