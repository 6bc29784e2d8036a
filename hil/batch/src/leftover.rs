//! Files that a run left half written when it was killed.

use std::path::Path;

/// Removes what a killed run left half written in `folder`, which it made and which no other run fills.
pub(crate) fn remove(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        if is_unfinished(&entry.file_name().to_string_lossy()) {
            // What stays is no more than a file too many.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Whether a file has the name of one that is still to be renamed, as `tempfile` gives it: `.tmpAbC123`.
fn is_unfinished(name: &str) -> bool {
    let rest = name.strip_prefix(".tmp");
    rest.is_some_and(|rest| {
        rest.len() == 6 && rest.bytes().all(|byte| byte.is_ascii_alphanumeric())
    })
}
