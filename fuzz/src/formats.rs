//! The readers of all formats but text.

use std::fs;
use std::path::Path;
use std::sync::LazyLock;

use mesh_damper_recording::Recording;
use mesh_damper_recording::files::{self, Kept, Reading, Source, Wanted};
use mesh_damper_recording::read_limit::ReadLimit;

use crate::edit::edited;

/// Most that is read of a file: more than each of them has, and little enough that what is beyond it is seen.
const LIMIT: u64 = 1 << 22;

/// Marks of blocks, and numbers that a count or a place may be.
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

/// What programs wrote of one recording, as the tests read it.
static GOOD: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../hil/recording/tests/formats");
    let files = fs::read_dir(folder).expect("the files are beside the tests that read them");
    let mut paths: Vec<_> = files.map(|file| file.expect("a file").path()).collect();
    // In one order on all machines.
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

/// What is read of a file is as much as the file says that it has, and all columns of a table have the same length. Nothing panics:
/// what other people's decoders do is an error of the file.
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
    // Another check has those.
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
            panic!("it is read, and is not when it is read again");
        };
        let Ok(values) = file.read(index, &wanted, Kept::Channels) else {
            continue;
        };
        let first = values.columns.iter().flatten().next();
        let first = first.map(|column| column.len() as u64);
        for column in values.columns.iter().flatten() {
            assert_eq!(
                Some(column.len() as u64),
                // Of a sheet, as of a text, is known only when it is read which rows are samples.
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
