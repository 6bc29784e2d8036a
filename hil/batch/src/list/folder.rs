//! The recordings of a folder.

use std::path::Path;

use mesh_damper_output::error::InputError;
use mesh_damper_tables::files::FORMATS;

use super::{List, Task, refused};

/// Files that the commands write next to recordings.
const WRITTEN: [&str; 2] = ["model.json", "trace.json"];

/// Whether a file's name, in lower case, has an ending of a readable format.
fn is_recording(name: &str) -> bool {
    if WRITTEN.contains(&name) {
        return false;
    }
    let mut endings = FORMATS.iter().flat_map(|format| format.endings());
    let ending = name.rsplit_once('.').map(|(_, ending)| ending);
    ending.is_some_and(|ending| endings.any(|known| *known == ending))
}

/// Every recording in `folder`, by name. Hidden files and subfolders are ignored.
///
/// # Errors
/// The folder cannot be read, or contains no recording.
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
        } else if is_recording(&name) {
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
            format!("holds no file with an ending of recordings, such as .csv{within}"),
            "name the folder with the recordings, or give a list of their paths",
        ));
    }
    list.tasks.sort_by(|a, b| a.recordings.cmp(&b.recordings));
    list.ignored.sort();
    Ok(list)
}
