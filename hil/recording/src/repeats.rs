//! Recordings given twice.

use std::path::{Path, PathBuf};

use mesh_damper_output::error::InputError;

/// Rejects a file that is given twice: it would be both test data and training data, or be counted twice.
///
/// # Errors
/// The second path to one file.
pub fn refuse_repeats(paths: impl IntoIterator<Item = impl AsRef<Path>>) -> Result<(), InputError> {
    let mut known: Vec<PathBuf> = Vec::new();
    for path in paths {
        // A path that cannot be resolved is rejected when it is read.
        let Ok(resolved) = path.as_ref().canonicalize() else {
            continue;
        };
        if known.contains(&resolved) {
            return Err(InputError::new(
                path.as_ref().display().to_string(),
                "is given twice",
                "give each recording once, either to fit or after --held-out",
            ));
        }
        known.push(resolved);
    }
    Ok(())
}
