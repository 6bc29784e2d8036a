//! Code that pages of `docs/` quote from the examples equals the code of the examples.
//!
//! A block after `<!-- from PATH:ANCHOR -->` contains the lines of that file between `ANCHOR: NAME` and `ANCHOR_END: NAME`. A block
//! after `<!-- from PATH -->` contains the whole file. The code is in the page itself, so that code hosting sites show it too.
//! `BLESS=1` writes the blocks.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The lines of a file, or of the anchor after a colon, without their common indentation.
fn quoted(source: &str) -> Result<String, String> {
    let (path, anchor) = source
        .split_once(':')
        .map_or((source, None), |(path, anchor)| (path, Some(anchor)));
    let text =
        std::fs::read_to_string(root().join(path)).map_err(|error| format!("{path}: {error}"))?;
    let lines: Vec<&str> = text.lines().collect();
    let is_mark = |line: &str| line.contains("ANCHOR: ") || line.contains("ANCHOR_END: ");
    let within: Vec<&str> = match anchor {
        None => lines,
        Some(anchor) => {
            let place = |mark: String| {
                let found = lines
                    .iter()
                    .position(|line| line.trim_end_matches(" */").ends_with(&mark));
                found.ok_or(format!("{path} has no {mark}"))
            };
            let start = place(format!("ANCHOR: {anchor}"))?;
            let end = place(format!("ANCHOR_END: {anchor}"))?;
            lines[start + 1..end].to_vec()
        }
    };
    let within: Vec<&str> = within.into_iter().filter(|line| !is_mark(line)).collect();
    let indents = within
        .iter()
        .filter(|line| !line.trim().is_empty())
        .map(|line| line.len() - line.trim_start().len());
    let indent = indents.min().unwrap_or(0);
    let cut = within
        .iter()
        .map(|line| line.get(indent..).unwrap_or_default());
    let text: Vec<&str> = cut.collect();
    Ok(text.join("\n").trim_matches('\n').to_owned() + "\n")
}

/// A page with its quotes updated from the files, and the number of quotes.
fn renewed(page: &str) -> Result<(String, usize), String> {
    let mut renewed = String::new();
    let mut quotes = 0;
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        renewed += line;
        renewed.push('\n');
        let source = line
            .strip_prefix("<!-- from ")
            .and_then(|rest| rest.strip_suffix(" -->"));
        let Some(source) = source else {
            continue;
        };
        let fence = lines.next().filter(|line| line.starts_with("```"));
        let fence = fence.ok_or(format!("no block follows the quote of {source}"))?;
        lines
            .find(|line| *line == "```")
            .ok_or(format!("the quote of {source} does not end"))?;
        renewed += &format!("{fence}\n{}```\n", quoted(source)?);
        quotes += 1;
    }
    Ok((renewed, quotes))
}

#[test]
fn quotes_are_the_examples_own() {
    let mut quotes = 0;
    for (name, page) in crate::full::book::pages() {
        let (expected, count) = renewed(&page).unwrap_or_else(|error| panic!("{name}: {error}"));
        quotes += count;
        if std::env::var_os("BLESS").is_some() {
            if expected != page {
                std::fs::write(root().join(&name), expected).unwrap();
            }
            continue;
        }
        assert!(
            expected == page,
            "{name}: a quote is not as its file: run with BLESS=1"
        );
    }
    assert!(quotes > 0, "no page quotes anything");
}
