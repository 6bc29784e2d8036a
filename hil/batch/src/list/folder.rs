//! The recordings of a folder.

use std::path::Path;

use mesh_damper_recording::error::InputError;

use super::{List, Task, refused};

/// The endings of the names of recordings, in small letters.
pub const ENDINGS: [&str; 2] = [".csv", ".csv.gz"];

/// Every recording in `folder`, by name. Hidden files and folders in it are left alone.
///
/// # Errors
/// A folder that cannot be read, or that holds no recording.
pub(super) fn list(folder: &Path) -> Result<List, InputError> {
    let failed = |error| InputError::io(folder, "read", &error);
    let mut list = List::default();
    let mut folders = 0;
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let name = name.to_lowercase();
        if name.starts_with('.') {
        } else if path.is_dir() {
            folders += 1;
        } else if ENDINGS.iter().any(|ending| name.ends_with(ending)) {
            list.tasks.push(Task::of(path));
        } else {
            list.ignored.push(path);
        }
    }
    if list.tasks.is_empty() {
        let within = match folders {
            0 => String::new(),
            folders => format!("; the {folders} folders in it are not searched"),
        };
        return Err(refused(
            folder,
            format!(
                "holds no recording, of which the names end in {}{within}",
                ENDINGS.join(" or ")
            ),
            "name the folder with the recordings, or give a list of their paths",
        ));
    }
    list.tasks.sort_by(|a, b| a.recordings.cmp(&b.recordings));
    list.ignored.sort();
    Ok(list)
}
