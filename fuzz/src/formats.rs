//! The readers of all formats but text.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use mesh_damper_recording::Recording;
use mesh_damper_tables::files::{self, Kept, Reading, Source, Wanted};
use mesh_damper_tables::read_limit::ReadLimit;

use crate::edit::edited;

/// The read limit of a file: larger than each good file, and small enough to detect reading beyond it.
const LIMIT: u64 = 1 << 22;

/// Markers of blocks, and numbers that can be a count or an offset.
const WORDS: [&str; 24] = [
    "##HD",
    "##DG",
    "##CG",
    "##CN",
    "##CC",
    "##DZ",
    "##DL",
    "##HL",
    "PAR1",
    "ARROW1",
    "TDSm",
    "OHDR",
    "TREE",
    "SNOD",
    "\0\0\0\0",
    "\u{1}\0\0\0",
    "\u{7f}\u{7f}\u{7f}\u{7f}",
    "\0\0\0\0\0\0\0\u{7f}",
    "\0\0\0\u{8}",
    "[[[[",
    "{\"a\":",
    "NaN",
    "1e308",
    "",
];

/// Files of one recording by several programs, as the tests read them.
static GOOD: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../hil/tables/tests/formats");
    let files = fs::read_dir(folder).expect("the files are beside the tests that read them");
    let mut paths: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
    // In the same order on all machines.
    paths.sort();
    let is_text = |path: &Path| {
        let ending = path.extension().unwrap_or_default();
        ["py", "txt", "csv"].iter().any(|text| ending == *text) || path.ends_with("files.json")
    };
    paths.retain(|path| !is_text(path));
    paths
        .iter()
        .map(|path| fs::read(path).expect("a file"))
        .collect()
});

/// The reader gives as many values as the file declares, and all columns of a table have the same length. Nothing of this repository
/// panics: a panic in the source of a third-party decoder becomes an error of the file, and with debug assertions, as here and under
/// libFuzzer, no other panic does.
pub fn check(script: &[u8]) -> bool {
    let bytes = edited(&GOOD, &WORDS, script);
    let name = Path::new("fuzzed");
    let reading = Reading::from(ReadLimit::new(LIMIT));
    let opened = || {
        let source = Source::of(name, bytes.as_slice(), reading.limit).ok()?;
        files::opened(source, &reading).ok()
    };
    let Some((format, file)) = opened() else {
        return false;
    };
    // Another check covers texts.
    if format.name() == "text" {
        return false;
    }
    let tables = file.tables().to_vec();
    let mut is_read = false;
    for (index, table) in tables.iter().enumerate().take(4) {
        let columns = table.columns.iter().enumerate();
        let wanted: Vec<Wanted> = (columns.filter(|(_, column)| column.is_numeric).take(16))
            .map(|(column, _)| Wanted {
                column,
                must_be_numeric: true,
            })
            .collect();
        let Some((_, file)) = opened() else {
            panic!("the second reading of the file fails");
        };
        let Ok(values) = file.read(index, &wanted, Kept::Channels) else {
            continue;
        };
        let first = values.columns.iter().flatten().next();
        let first = first.map(|column| column.len() as u64);
        for column in values.columns.iter().flatten() {
            assert_eq!(
                Some(column.len() as u64),
                // In a sheet, as in a text, only reading shows which rows are samples.
                table.rows.or(first),
                "{}: {}",
                format.name(),
                table.name
            );
        }
        is_read |= !values.columns.is_empty();
    }
    let _ = Recording::from_bytes(name, bytes.clone());
    is_read
}
