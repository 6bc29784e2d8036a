//! Where a health cause stands besides its row in the list: the page, the code that finds it, a test that it is found.

use std::path::{Path, PathBuf};

use mesh_damper::health::{Channel, HealthCause};

fn here() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The tables of the page, made from the list.
fn tables() -> String {
    let of_channels = |is_wanted: bool| {
        let mut rows = String::new();
        for cause in HealthCause::ALL {
            let description = cause.description();
            let name = description.name;
            if cause.channel().is_some() != is_wanted {
                continue;
            }
            let (of, numbers) = match cause.channel() {
                // In the row of the other channel.
                Some(Channel::Force) => continue,
                Some(Channel::Displacement) => (
                    "(channel)",
                    format!("{}, {}", cause.number(), cause.number() + 1),
                ),
                None => ("", cause.number().to_string()),
            };
            let notice = if cause.is_fault() { "" } else { " (a notice)" };
            let meaning = description.meaning.trim_end_matches('.');
            rows += &format!("| `{name}{of}` | {numbers} | {meaning}{notice} |\n");
        }
        rows
    };
    let head = |of: &str| format!("| {of} | number | meaning |\n|---|---|---|\n");
    [
        head("of a channel"),
        of_channels(true),
        "\n".into(),
        head("of specimen, actuator or temperature"),
        of_channels(false),
    ]
    .concat()
}

/// `BLESS=1` writes the tables.
#[test]
fn the_page_lists_every_cause() {
    let (begin, end) = ("<!-- causes, written by BLESS=1 -->\n", "<!-- end -->\n");
    let path = here().join("docs/monitor.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(begin).unwrap();
    let (_, after) = rest.split_once(end).unwrap();
    let expected = [before, begin, &tables(), end, after].concat();
    if std::env::var("BLESS").is_ok_and(|bless| bless == "1") {
        std::fs::write(&path, &expected).unwrap();
        return;
    }
    assert!(
        page == expected,
        "docs/monitor.md: BLESS=1 cargo test -p mesh-damper --test rig causes writes the causes again"
    );
}

/// The Rust files in `folder` and below.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut all = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all.extend(files(&path));
        } else if path.extension().is_some_and(|end| end == "rs") {
            all.push(path);
        }
    }
    all
}

/// The code of `path` without comments: what is built, and the tests in it.
fn code(path: &Path) -> (String, String) {
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text
        .lines()
        .filter(|line| !line.trim_start().starts_with("//"));
    let text = lines.collect::<Vec<_>>().join("\n");
    match text.split_once("#[cfg(test)]") {
        Some((code, tests)) => (code.to_owned(), tests.to_owned()),
        None => (text, String::new()),
    }
}

#[test]
fn every_cause_is_found_by_the_monitor_and_a_test_finds_it() {
    let (mut found, mut tested) = (String::new(), String::new());
    for path in files(&here().join("src/health")) {
        if path.ends_with("health/cause.rs") || path.ends_with("health/tests.rs") {
            continue;
        }
        let (code, tests) = code(&path);
        if path.ends_with("tests.rs") {
            tested += &code;
        } else {
            found += &code;
            tested += &tests;
        }
    }
    for path in files(&here().join("tests/rig")) {
        tested += &code(&path).0;
    }
    let is_named = |text: &str, name: &str| {
        let named = format!("HealthCause::{name}");
        let mut after = text
            .match_indices(&named)
            .map(|(at, _)| &text[at + named.len()..]);
        after.any(|rest| !rest.starts_with(|c: char| c.is_alphanumeric()))
    };
    for cause in HealthCause::ALL {
        let name = cause.description().name;
        assert!(
            is_named(&found, name),
            "{name}: no file of src/health finds it"
        );
        assert!(
            is_named(&tested, name),
            "{name}: no test of src/health or tests/rig expects it"
        );
    }
}
