//! What is to be traced: a folder, a list of paths, a table of paths with their groups.

mod folder;
mod table;
mod text;

use std::path::{Path, PathBuf};

use mesh_damper_recording::error::InputError;
use mesh_damper_recording::read_limit::ReadLimit;

/// One trace of a batch: the recordings that it fits, and those that it holds out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Task {
    /// What rows, folders and messages call it: the group, or the recording's path as it was listed.
    pub name: String,
    /// The group that the table names; none of a recording alone.
    pub group: Option<String>,
    /// The specimen that the table names.
    pub specimen: Option<String>,
    /// Recordings to fit, at least one.
    pub recordings: Vec<PathBuf>,
    /// Recordings that are only predicted. Where there is none, a part of the others is held out.
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

    /// All its recordings, those held out last.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.recordings
            .iter()
            .chain(&self.held_out)
            .map(PathBuf::as_path)
    }
}

/// The traces that a batch is to make, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct List {
    /// One trace each.
    pub tasks: Vec<Task>,
    /// Files of the folder that are no recordings by the endings of their names.
    pub ignored: Vec<PathBuf>,
    /// The list or the table itself, where there is one.
    pub file: Option<PathBuf>,
}

impl List {
    /// Reads `path`: a folder, of which every file with an ending of a format that is read is a recording; a text with a path on every line; or a
    /// table as CSV or Parquet with a column `path`, and `group`, `specimen`, and `role` or `held_out` where they are wanted. The rows of
    /// one group are one trace.
    ///
    /// A path that is relative begins at the list's folder; where there is no such file there, at the working directory.
    ///
    /// # Errors
    /// What cannot be read; a folder or a list without recordings; a list of which no file exists; a column that is not understood; a
    /// group that fits nothing, or with two specimens.
    pub fn read(path: &Path, limit: ReadLimit) -> Result<Self, InputError> {
        if path.is_dir() {
            return folder::list(path);
        }
        let bytes = text::read(path, limit)?;
        let tasks = if bytes.starts_with(table::PARQUET) {
            table::parquet(path, bytes)?
        } else {
            let text = text::decode(path, bytes)?;
            match table::csv(path, &text)? {
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

    /// A path on every line of `text`, relative to the working directory; `name` is what errors call it.
    ///
    /// # Errors
    /// No path; no file at any of them.
    pub fn of_lines(name: &str, text: &str) -> Result<Self, InputError> {
        Ok(Self {
            tasks: text::paths(Path::new(name), text)?,
            ..Self::default()
        })
    }

    /// The table `text`, as CSV; its paths are relative to the working directory. `name` is what errors call it.
    ///
    /// # Errors
    /// As [`List::read`] of a table.
    pub fn of_table(name: &str, text: &str) -> Result<Self, InputError> {
        let list = Path::new(name);
        let tasks = table::csv(list, text)?;
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

    /// One trace of each recording.
    pub fn of_recordings<P: Into<PathBuf>>(paths: impl IntoIterator<Item = P>) -> Self {
        Self {
            tasks: paths.into_iter().map(Task::of).collect(),
            ..Self::default()
        }
    }
}

/// Where a path that `list` holds leads to.
fn resolved(list: &Path, path: &str) -> PathBuf {
    let beside = list.parent().unwrap_or(Path::new("")).join(path);
    let here = PathBuf::from(path);
    if !beside.exists() && here.exists() {
        here
    } else {
        beside
    }
}

fn refused(list: &Path, problem: impl Into<String>, mend: impl Into<String>) -> InputError {
    InputError::new(list.display().to_string(), problem, mend)
}
