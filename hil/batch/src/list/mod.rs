//! The list of traces to make: a folder, a list of paths, or a table of paths with their groups.

mod folder;
mod table;
mod text;

use std::path::{Path, PathBuf};

use mesh_damper_output::error::InputError;
use mesh_damper_tables::read_limit::ReadLimit;
use mesh_damper_tables::write::unguarded;

/// One trace of a batch: the recordings that it fits, and those that it holds out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Task {
    /// Its name in rows, folders and messages: the group, or the recording's path as listed.
    pub name: String,
    /// The group from the table; none for a single recording.
    pub group: Option<String>,
    /// The specimen from the table.
    pub specimen: Option<String>,
    /// Recordings to fit, at least one.
    pub recordings: Vec<PathBuf>,
    /// Recordings that are only predicted. If there are none, a part of the others is held out.
    pub held_out: Vec<PathBuf>,
}

impl Task {
    /// The trace of one recording.
    pub fn of(path: impl Into<PathBuf>) -> Self {
        let path = path.into();
        Self {
            name: path.display().to_string(),
            recordings: vec![path],
            ..Self::default()
        }
    }

    /// All its recordings, the held-out ones last.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.recordings
            .iter()
            .chain(&self.held_out)
            .map(PathBuf::as_path)
    }
}

/// The traces of a batch, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct List {
    /// One trace each.
    pub tasks: Vec<Task>,
    /// Files of the folder whose endings are not those of recordings.
    pub ignored: Vec<PathBuf>,
    /// The list or the table itself, if there is one.
    pub file: Option<PathBuf>,
}

impl List {
    /// Reads `path`: a folder, in which every file with an ending of a readable format is a recording; a text with one path per
    /// line; or a table as CSV or Parquet with a column `path` and optional columns `group`, `specimen`, and `role` or `held_out`.
    /// The rows of one group are one trace.
    ///
    /// A relative path starts at the list's folder or, if there is no such file, at the working directory.
    ///
    /// # Errors
    /// A file cannot be read; a folder or a list has no recordings; none of a list's files exists; a column is not understood; a
    /// group fits nothing, or has two specimens.
    pub fn read(path: &Path, limit: ReadLimit) -> Result<Self, InputError> {
        if path.is_dir() {
            return Self::of_folder(path);
        }
        let bytes = text::read(path, limit)?;
        let tasks = if bytes.starts_with(table::PARQUET) {
            table::parquet(path, bytes)?
        } else {
            let text = text::decode(path, bytes)?;
            match table::csv(path, &text, unguarded)? {
                Some(tasks) => tasks,
                None => text::paths(path, &text)?,
            }
        };
        Ok(Self {
            tasks,
            ignored: Vec::new(),
            file: Some(path.to_owned()),
        })
    }

    /// One trace for every recording in `folder`, by name: every file with an ending of a readable format. Hidden files and
    /// subfolders are ignored.
    ///
    /// # Errors
    /// The folder cannot be read, or contains no recording.
    pub fn of_folder(folder: &Path) -> Result<Self, InputError> {
        folder::list(folder)
    }

    /// One path per line of `text`, relative to the working directory; errors call it `name`.
    ///
    /// # Errors
    /// No path, or no file at any of them.
    pub fn of_lines(name: &str, text: &str) -> Result<Self, InputError> {
        Ok(Self {
            tasks: text::paths(Path::new(name), text)?,
            ..Self::default()
        })
    }

    /// The table `text`, as CSV; its cells are what they mean, other than in a file ([`unguarded`]), and its paths are relative to the working directory. Errors call it `name`.
    ///
    /// # Errors
    /// As [`List::read`] of a table.
    pub fn of_table(name: &str, text: &str) -> Result<Self, InputError> {
        let list = Path::new(name);
        let tasks = table::csv(list, text, |cell| cell.into())?;
        let tasks = tasks.ok_or_else(|| {
            refused(
                list,
                "has no column path",
                "call the column of the paths `path`",
            )
        })?;
        Ok(Self {
            tasks,
            ..Self::default()
        })
    }

    /// One trace for each recording.
    pub fn of_recordings<P: Into<PathBuf>>(paths: impl IntoIterator<Item = P>) -> Self {
        Self {
            tasks: paths.into_iter().map(Task::of).collect(),
            ..Self::default()
        }
    }

    /// The files that are left out, as a sentence with the first names; `None` if there are none.
    pub fn left_out(&self) -> Option<String> {
        const NAMED: usize = 3;
        let count = self.ignored.len();
        let files = match count {
            0 => return None,
            1 => "1 file is".to_owned(),
            _ => format!("{count} files are"),
        };
        let names = self.ignored.iter().take(NAMED);
        let names = names.filter_map(|file| file.file_name());
        let names: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
        let more = if count > NAMED { ", …" } else { "" };
        Some(format!(
            "{files} left out, because the ending is not that of a recording: {}{more}",
            names.join(", ")
        ))
    }
}

/// The file that a path in `list` refers to.
fn resolved(list: &Path, path: &str) -> PathBuf {
    let beside = list.parent().unwrap_or(Path::new("")).join(path);
    let here = PathBuf::from(path);
    if !beside.exists() && here.exists() {
        here
    } else {
        beside
    }
}

fn refused(list: &Path, problem: impl Into<String>, remedy: impl Into<String>) -> InputError {
    InputError::new(list.display().to_string(), problem, remedy)
}
