//! The page that lists the dialects.

use std::path::Path;

/// The table of the page is the corpus; `BLESS=1` writes it.
#[test]
fn the_page_lists_every_dialect_and_what_becomes_of_it() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/dialects.md");
    let page = std::fs::read_to_string(&path).expect("the page");
    let head = "| family | dialect | outcome |\n|---|---|---|\n";
    let dialects = super::all();
    let row = |dialect: &super::Dialect| {
        format!(
            "| {} | {} | {} |\n",
            dialect.family,
            dialect.name.replace('|', "\\|"),
            dialect.outcome.word()
        )
    };
    let rows: String = dialects.iter().map(row).collect();
    let count = |word: &str| {
        dialects
            .iter()
            .filter(|dialect| dialect.outcome.word() == word)
            .count()
    };
    let misread = dialects
        .iter()
        .filter(|dialect| dialect.misread().is_some());
    let misread = match misread.count() {
        0 => "none is".to_owned(),
        1 => "1 is".to_owned(),
        count => format!("{count} are"),
    };
    let sum = format!(
        "\nOf {} dialects {} are read, {} are asked about, {} are refused, and {misread} misread.\n",
        dialects.len(),
        count("read"),
        count("asked"),
        count("refused")
    );
    let (before, _) = page.split_once(head).expect("a table in the page");
    let expected = format!("{before}{head}{rows}{sum}");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, &expected).expect("written");
        return;
    }
    assert!(
        page == expected,
        "docs/dialects.md is not as the corpus: run with BLESS=1"
    );
}
