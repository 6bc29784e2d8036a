//! Files that a killed run left half written.

use std::path::Path;

/// Removes half-written files of a killed run in `folder`, which that run created and which no other run fills.
pub(crate) fn remove(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        if is_unfinished(&entry.file_name().to_string_lossy()) {
            // A file that remains does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Whether a file has a temporary name from `tempfile`: `.tmpAbC123`.
fn is_unfinished(name: &str) -> bool {
    let rest = name.strip_prefix(".tmp");
    rest.is_some_and(|rest| {
        rest.len() == 6 && rest.bytes().all(|byte| byte.is_ascii_alphanumeric())
    })
}
