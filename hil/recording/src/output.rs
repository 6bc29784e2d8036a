//! Files that are written whole or not at all.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use crate::error::InputError;

/// The path that means standard output.
const STANDARD_OUTPUT: &str = "-";

/// The files of one command, gathered while it works and written together at its end.
///
/// Each is written beside its place under another name and then renamed, so that a reader never sees half of one; none
/// is renamed before all are written. An error leaves neither a file nor a directory that was not there before.
#[derive(Debug, Default)]
pub struct Outputs {
    files: Vec<(PathBuf, Vec<u8>)>,
}

impl Outputs {
    /// No files.
    pub fn new() -> Self {
        Self::default()
    }

    /// One more file; `-` is standard output.
    pub fn add(&mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) {
        self.files.push((path.into(), bytes.into()));
    }

    /// One more file of indented JSON with a newline at its end; `-` is standard output.
    ///
    /// # Errors
    /// A value that JSON cannot hold.
    pub fn add_json(
        &mut self,
        path: impl Into<PathBuf>,
        value: &impl serde::Serialize,
    ) -> Result<(), InputError> {
        let path = path.into();
        let mut bytes = serde_json::to_vec_pretty(value).map_err(|error| {
            InputError::new(
                path.display().to_string(),
                format!("not to be written as JSON: {error}"),
                "report this",
            )
        })?;
        bytes.push(b'\n');
        self.add(path, bytes);
        Ok(())
    }

    /// Refuses what [`Outputs::write`] would refuse at once: a directory where a file shall be, or a file where a
    /// directory shall be. Called before long work, so that its result is not lost to a mistyped path.
    ///
    /// # Errors
    /// The path and why it cannot be written.
    pub fn check(path: &Path) -> Result<(), InputError> {
        if path == Path::new(STANDARD_OUTPUT) {
            return Ok(());
        }
        let name = || path.display().to_string();
        if path.as_os_str().is_empty() {
            return Err(InputError::new(
                "output",
                "the path is empty",
                "name a file",
            ));
        }
        if path.is_dir() {
            return Err(InputError::new(
                name(),
                "is a directory",
                "name a file in it",
            ));
        }
        let existing = path.ancestors().skip(1).find(|ancestor| ancestor.exists());
        match existing {
            Some(ancestor) if !ancestor.is_dir() => Err(InputError::new(
                name(),
                format!("{} is a file, not a directory", ancestor.display()),
                "name another directory",
            )),
            _ => Ok(()),
        }
    }

    /// Writes all files; directories that are missing are made.
    ///
    /// # Errors
    /// The path that cannot be written and why.
    pub fn write(self) -> Result<(), InputError> {
        let mut made = MadeDirectories::default();
        let mut staged: Vec<(TempPath, PathBuf)> = Vec::new();
        let mut direct: Vec<(PathBuf, Vec<u8>)> = Vec::new();
        for (path, bytes) in self.files {
            Self::check(&path)?;
            // A device or a pipe cannot be renamed over; standard output is one.
            if path == Path::new(STANDARD_OUTPUT) || (path.exists() && !path.is_file()) {
                direct.push((path, bytes));
            } else {
                // A link stays a link: what it points to is replaced.
                let path = fs::canonicalize(&path).unwrap_or(path);
                staged.push((stage(&path, &bytes, &mut made)?, path));
            }
        }
        for (temporary, path) in staged {
            temporary
                .persist(&path)
                .map_err(|failed| InputError::io(&path, "write", &failed.error))?;
        }
        made.keep();
        for (path, bytes) in direct {
            write_directly(&path, &bytes)?;
        }
        Ok(())
    }
}

/// `bytes` in a file beside `path`, which goes away unless it is renamed.
fn stage(path: &Path, bytes: &[u8], made: &mut MadeDirectories) -> Result<TempPath, InputError> {
    let failed = |error| InputError::io(path, "write", &error);
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    made.make(directory).map_err(failed)?;
    let mut file = create_temporary(directory).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    // So that a name never stands for less than the whole, whatever happens to the machine after it is given.
    file.as_file().sync_all().map_err(failed)?;
    Ok(file.into_temp_path())
}

/// A temporary file is its owner's only; the file that it becomes has the permissions that any new file has.
#[cfg(unix)]
fn create_temporary(directory: &Path) -> std::io::Result<NamedTempFile> {
    use std::os::unix::fs::PermissionsExt as _;
    tempfile::Builder::new()
        .permissions(fs::Permissions::from_mode(0o666))
        .tempfile_in(directory)
}

#[cfg(not(unix))]
fn create_temporary(directory: &Path) -> std::io::Result<NamedTempFile> {
    NamedTempFile::new_in(directory)
}

fn write_directly(path: &Path, bytes: &[u8]) -> Result<(), InputError> {
    let written = if path == Path::new(STANDARD_OUTPUT) {
        let mut output = std::io::stdout().lock();
        output.write_all(bytes).and_then(|()| output.flush())
    } else {
        fs::write(path, bytes)
    };
    match written {
        // Who reads has read enough.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|error| InputError::io(path, "write", &error)),
    }
}

/// Directories made on the way, removed again unless they are kept.
#[derive(Default)]
struct MadeDirectories(Vec<PathBuf>);

impl MadeDirectories {
    fn make(&mut self, directory: &Path) -> std::io::Result<()> {
        let missing: Vec<&Path> = directory
            .ancestors()
            .take_while(|ancestor| !ancestor.as_os_str().is_empty() && !ancestor.exists())
            .collect();
        for directory in missing.into_iter().rev() {
            fs::create_dir(directory)?;
            self.0.push(directory.to_owned());
        }
        Ok(())
    }

    fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for MadeDirectories {
    fn drop(&mut self) {
        for directory in self.0.iter().rev() {
            // One that is not empty stays, as does one that someone else removed.
            let _ = fs::remove_dir(directory);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn writes_all_with_their_directories() {
        let root = tempfile::tempdir().unwrap();
        let mut outputs = Outputs::new();
        outputs.add(root.path().join("a/b/one.txt"), *b"1");
        outputs
            .add_json(root.path().join("two.json"), &[1, 2])
            .unwrap();
        outputs.write().unwrap();
        assert_eq!(names(root.path()), ["a", "two.json"]);
        assert_eq!(fs::read(root.path().join("a/b/one.txt")).unwrap(), b"1");
        assert_eq!(
            fs::read(root.path().join("two.json")).unwrap(),
            b"[\n  1,\n  2\n]\n"
        );
    }

    #[test]
    fn writes_none_when_one_cannot_be_written() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("file"), "old").unwrap();
        let mut outputs = Outputs::new();
        outputs.add(root.path().join("new/one.txt"), *b"1");
        outputs.add(root.path().join("file"), *b"new");
        outputs.add(root.path().join("file/two.txt"), *b"2");
        let error = outputs.write().unwrap_err().to_string();
        assert!(error.contains("is a file, not a directory"), "{error}");
        assert_eq!(names(root.path()), ["file"]);
        assert_eq!(fs::read(root.path().join("file")).unwrap(), b"old");
    }

    #[test]
    fn a_directory_is_no_file_to_write() {
        let root = tempfile::tempdir().unwrap();
        let mut outputs = Outputs::new();
        outputs.add(root.path(), *b"1");
        assert!(
            outputs
                .write()
                .unwrap_err()
                .to_string()
                .contains("is a directory")
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_link_and_a_device_stay_what_they_are() {
        let root = tempfile::tempdir().unwrap();
        let (target, link) = (root.path().join("target"), root.path().join("link"));
        fs::write(&target, "old").unwrap();
        std::os::unix::fs::symlink(&target, &link).unwrap();
        let mut outputs = Outputs::new();
        outputs.add(&link, *b"new");
        outputs.add("/dev/null", *b"gone");
        outputs.write().unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert!(!Path::new("/dev/null").is_file());
    }
}
