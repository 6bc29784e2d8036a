//! `docs/command-reference.md` contains the help of every command.

use std::path::Path;

const COMMANDS: &str = include_str!("../../../../../docs/commands.md");
const HEAD: &str = "# Command reference

This page holds the help of every command, as `hil COMMAND --help` prints it.
[Commands](commands.md) lists the commands by purpose and names the page that explains each.
With `cargo`, write `cargo hil` for `hil`.
";

/// The names in the table of `docs/commands.md`, in its order, such as `study numbers`.
fn named() -> Vec<&'static str> {
    let rows = COMMANDS.lines();
    rows.filter_map(|row| row.strip_prefix("| `hil ")?.split_once('`'))
        .map(|(name, _)| name)
        .collect()
}

/// The help of a command, at the width that it has without a terminal.
fn help(command: &str) -> String {
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_hil"))
        .args(command.split_whitespace())
        .arg("--help")
        .env_remove("COLUMNS")
        .output()
        .unwrap();
    assert!(output.status.success(), "{command}");
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<&str> = text.trim_end().lines().map(str::trim_end).collect();
    lines.join("\n")
}

/// The subcommands of a command, as its help lists them.
pub fn below(help: &str) -> Vec<String> {
    let mut lines = help.lines().skip_while(|line| *line != "Commands:");
    lines.next();
    lines
        .take_while(|line| !line.is_empty())
        // A name follows two blanks; the continuation of a long description is further to the right.
        .filter_map(|line| {
            line.strip_prefix("  ")?
                .split_whitespace()
                .next()
                .filter(|_| !line.starts_with("   "))
        })
        .filter(|name| *name != "help")
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_list_of_commands_names_each() {
    let mut expected = Vec::new();
    for command in below(&help("")) {
        match &below(&help(&command))[..] {
            [] => expected.push(command),
            names => expected.extend(names.iter().map(|name| format!("{command} {name}"))),
        }
    }
    let mut listed = named();
    listed.sort_unstable();
    expected.sort_unstable();
    assert_eq!(listed, expected);
}

/// The page is generated from the help; `BLESS=1` writes it.
#[test]
fn the_page_is_the_help_of_every_command() {
    let mut page = HEAD.to_owned();
    let mut add = |command: &str| {
        let called = format!("hil {command}");
        page += &format!(
            "\n## `{}`\n\n```text\n{}\n```\n",
            called.trim_end(),
            help(command)
        );
    };
    add("");
    let mut groups = Vec::new();
    for command in named() {
        if let Some((group, _)) = command.split_once(' ')
            && !groups.contains(&group)
        {
            groups.push(group);
            add(group);
        }
        add(command);
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/command-reference.md");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &page).unwrap();
        return;
    }
    let written = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        written == page,
        "docs/command-reference.md is not the commands' help: run with BLESS=1"
    );
}
