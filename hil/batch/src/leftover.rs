//! Files that a run left half written when it was killed.

use std::path::Path;

/// How the names of files begin that are still to be renamed.
const UNFINISHED: &str = ".tmp";

/// Removes what a killed run left half written in `folder`, which no other run fills.
pub(crate) fn remove(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        if entry.file_name().to_string_lossy().starts_with(UNFINISHED) {
            // What stays is no more than a file too many.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}
