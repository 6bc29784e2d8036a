//! A list of paths as text.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use mesh_damper_output::error::InputError;
use mesh_damper_tables::read_limit::ReadLimit;

use super::{Task, refused, resolved};

/// The bytes of a list.
pub(super) fn read(path: &Path, limit: ReadLimit) -> Result<Vec<u8>, InputError> {
    let failed = |error| InputError::io(path, "read", &error);
    let mut bytes = Vec::new();
    File::open(path)
        .map_err(failed)?
        .take(limit.file().saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    if bytes.len() as u64 > limit.file() {
        return Err(refused(
            path,
            format!("holds more than {limit}, the limit of a file"),
            format!("check that it is a list, or raise {}", ReadLimit::OPTION),
        ));
    }
    Ok(bytes)
}

/// The text of a list, without the byte order mark that some programs write.
pub(super) fn decode(path: &Path, bytes: Vec<u8>) -> Result<String, InputError> {
    match String::from_utf8(bytes) {
        Ok(text) => Ok(text.trim_start_matches('\u{feff}').to_owned()),
        Err(_) => Err(refused(
            path,
            "is neither UTF-8 text nor Parquet, so it cannot be a list",
            "give a list of paths or a folder; one recording is for `hil trace`",
        )),
    }
}

/// One trace for each path: blank lines and lines that begin with `#` do not count.
pub(super) fn paths(list: &Path, text: &str) -> Result<Vec<Task>, InputError> {
    let lines = text.lines().map(str::trim_end);
    let named = lines.filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    let tasks: Vec<Task> = named
        .map(|line| Task {
            name: line.to_owned(),
            ..Task::of(resolved(list, line))
        })
        .collect();
    if tasks.is_empty() {
        return Err(refused(
            list,
            "names no recording",
            "write a path on every line",
        ));
    }
    // A recording given as a list would be thousands of missing files.
    if !tasks.iter().flat_map(Task::paths).any(Path::exists) {
        return Err(refused(
            list,
            "none of its lines is the path of an existing file",
            "give a list of paths, a table with a column path, or a folder; one recording is for `hil trace`",
        ));
    }
    Ok(tasks)
}
