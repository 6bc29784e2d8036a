//! What the commands have in common towards the system and its user.
//!
//! | module | for |
//! |---|---|
//! | the root | files that are written completely or not at all, and never over an input of the command |
//! | [`error`] | errors in one line |
//! | [`terminal`], [`shell`] | lines for a person: what a terminal would obey is escaped; words of commands to type |
//! | [`documents`] | the same in documents, without a change of their meaning |
//! | [`process`], [`scratch`] | programs that are started, and files for the time of the work |
//! | [`ending`] | the end by a signal, which leaves none of these behind |

#![forbid(unsafe_code)]

pub mod documents;
pub mod ending;
pub mod error;
pub mod finite;
mod folder;
mod label;
mod place;
mod plan;
pub mod process;
pub mod scratch;
pub mod shell;
pub mod terminal;

use std::fs;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

use tempfile::{NamedTempFile, TempPath};

use crate::error::InputError;
use folder::Folders;
use place::{Place, Target};

pub use label::{Label, LabelField, Labelled};
pub use plan::Plan;

/// The files of one command, collected while it works and written together at its end; [`Plan::begin`] returns them.
///
/// Each is written in the same folder under another name and then renamed, so that a reader never sees a part of one; none is
/// renamed before all are written. An error leaves neither a new file nor a new directory.
#[derive(Debug)]
pub struct Outputs {
    planned: Vec<Target>,
    files: Vec<(PathBuf, Vec<u8>)>,
    folders: Folders,
    /// The recording of a running test, which the files will replace.
    unfinished: Option<PathBuf>,
    /// Whether standard output or a device may have received a part of the files, which no other file can replace.
    is_sent: bool,
}

impl Outputs {
    fn new(planned: Vec<Target>, folders: Folders, unfinished: Option<PathBuf>) -> Self {
        Self {
            planned,
            files: Vec::new(),
            folders,
            unfinished,
            is_sent: false,
        }
    }

    /// Adds the bytes of a file that was planned under this path.
    pub fn add(&mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) {
        self.files.push((path.into(), bytes.into()));
    }

    /// The same as indented JSON with a newline at its end. What a terminal would obey in its texts is escaped, as JSON escapes.
    ///
    /// # Errors
    /// A number that is not finite, by the name of its field; a value that JSON cannot represent.
    pub fn add_json(
        &mut self,
        path: impl Into<PathBuf>,
        value: &impl serde::Serialize,
    ) -> Result<(), InputError> {
        let path = path.into();
        // JSON would have `null` in its place.
        finite::check_document(&path.display().to_string(), value)?;
        let text = serde_json::to_string_pretty(value).map_err(|error| {
            InputError::new(
                path.display().to_string(),
                format!("not to be written as JSON: {error}"),
                "report this",
            )
        })?;
        self.add(path, documents::json(&text) + "\n");
        Ok(())
    }

    /// Writes all files. Missing directories are created, and an unfinished recording is removed once all files are written. The
    /// command's folder stays locked until `self` is dropped.
    ///
    /// # Errors
    /// The path that cannot be written and why; a path that was not planned.
    pub fn write(&mut self) -> Result<(), InputError> {
        // An end by a signal leaves all files or none.
        let whole = ending::whole();
        let mut staged: Vec<(TempPath, &Path, &Path)> = Vec::new();
        let mut direct: Vec<(&Target, &[u8])> = Vec::new();
        for (name, bytes) in &self.files {
            let Some(target) = self.planned.iter().find(|target| target.name == *name) else {
                return Err(not_planned(name));
            };
            match &target.place {
                Place::File(path) => {
                    staged.push((stage(name, path, bytes, &mut self.folders)?, name, path));
                }
                Place::StandardOutput | Place::Device(_) => direct.push((target, bytes)),
            }
        }
        for (temporary, name, path) in staged {
            temporary
                .persist(path)
                .map_err(|failed| InputError::io(name, "write", &failed.error))?;
        }
        self.folders.keep();
        if let Some(unfinished) = self.unfinished.take() {
            // All files are in place, whatever happens to direct outputs. The unfinished recording may not exist.
            let _ = fs::remove_file(unfinished);
        }
        // The reader of a pipe may let wait.
        drop(whole);
        for (target, bytes) in direct {
            self.is_sent = true;
            write_directly(target, bytes)?;
        }
        Ok(())
    }

    /// Writes a planned file alone, in place of all files: the work broke off. An unfinished recording stays. Standard output and a
    /// device get nothing after [`Outputs::write`] has sent something.
    ///
    /// # Errors
    /// As for [`Outputs::write`].
    pub fn write_alone(&mut self, name: &Path, bytes: &[u8]) -> Result<(), InputError> {
        let Some(target) = self.planned.iter().find(|target| target.name == name) else {
            return Err(not_planned(name));
        };
        match &target.place {
            Place::File(path) => {
                let _whole = ending::whole();
                stage(name, path, bytes, &mut self.folders)?
                    .persist(path)
                    .map_err(|failed| InputError::io(name, "write", &failed.error))
            }
            Place::StandardOutput | Place::Device(_) if self.is_sent => Ok(()),
            Place::StandardOutput | Place::Device(_) => write_directly(target, bytes),
        }
    }
}

fn not_planned(name: &Path) -> InputError {
    InputError::new(
        name.display().to_string(),
        "is an output that was not planned",
        "report this",
    )
}

/// `bytes` in a temporary file next to `path`, which disappears unless it is renamed; `name` is the user's name for it.
fn stage(
    name: &Path,
    path: &Path,
    bytes: &[u8],
    folders: &mut Folders,
) -> Result<TempPath, InputError> {
    let failed = |error| InputError::io(name, "write", &error);
    let directory = path.parent().unwrap_or(path);
    folders.make(directory).map_err(failed)?;
    let mut file = create_temporary(directory).map_err(failed)?;
    file.write_all(bytes).map_err(failed)?;
    // So that a name never refers to an incomplete file, even if the machine fails afterwards.
    file.as_file().sync_all().map_err(failed)?;
    Ok(file.into_temp_path())
}

/// A temporary file is private to its owner; the final file gets the permissions of any new file.
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

fn write_directly(target: &Target, bytes: &[u8]) -> Result<(), InputError> {
    let written = match &target.place {
        Place::StandardOutput => {
            let mut output = std::io::stdout().lock();
            // What a table or a comment holds may be anything.
            let written = match str::from_utf8(bytes) {
                Ok(text) if output.is_terminal() => {
                    output.write_all(terminal::visible_lines(text).as_bytes())
                }
                _ => output.write_all(bytes),
            };
            written.and_then(|()| output.flush())
        }
        Place::Device(path) | Place::File(path) => fs::write(path, bytes),
    };
    match written {
        // The reader has read enough.
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        written => written.map_err(|error| InputError::io(&target.name, "write", &error)),
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

    /// Refused before anything is done, with `said` in the message, and `root` is unchanged.
    #[track_caller]
    fn refuses(root: &Path, plan: Plan, said: &str) {
        let before = names(root);
        let error = plan.begin().unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
        assert_eq!(names(root), before);
    }

    #[test]
    fn writes_all_with_their_directories() {
        let root = tempfile::tempdir().unwrap();
        let (one, two) = (
            root.path().join("a/b/one.txt"),
            root.path().join("two.json"),
        );
        let mut outputs = Plan::new().writes([&one, &two]).begin().unwrap();
        outputs.add(&one, *b"1");
        outputs.add_json(&two, &[1, 2]).unwrap();
        outputs.write().unwrap();
        assert_eq!(names(root.path()), ["a", "two.json"]);
        assert_eq!(fs::read(one).unwrap(), b"1");
        assert_eq!(fs::read(two).unwrap(), b"[\n  1,\n  2\n]\n");
    }

    #[test]
    fn writes_none_when_one_cannot_be_written() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        fs::write(path("file"), "old").unwrap();
        let all = ["new/one.txt", "file", "later/two.txt"].map(path);
        let mut outputs = Plan::new().writes(&all).begin().unwrap();
        fs::write(path("later"), "").unwrap();
        for one in &all {
            outputs.add(one, *b"new");
        }
        let error = outputs.write().unwrap_err().to_string();
        assert!(error.contains("two.txt: cannot write it"), "{error}");
        drop(outputs);
        assert_eq!(names(root.path()), ["file", "later"]);
        assert_eq!(fs::read(path("file")).unwrap(), b"old");
    }

    /// The work broke off: the other files stay as they are, and so does the recording of the test.
    #[test]
    fn one_file_is_written_alone() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        fs::write(path("checks.xml"), "of yesterday").unwrap();
        let mut outputs = Plan::new()
            .fills(path("new").as_path(), ["result"])
            .writes([path("checks.xml"), path("sub/other.xml")])
            .keeps(path("left.csv"))
            .begin()
            .unwrap();
        fs::write(path("left.csv"), "all there is").unwrap();
        outputs.add(path("new/result"), *b"half of it");
        for name in ["checks.xml", "sub/other.xml"] {
            outputs.write_alone(&path(name), b"broke off").unwrap();
        }
        let refused = outputs.write_alone(&path("no.xml"), b"").unwrap_err();
        assert!(refused.to_string().contains("not planned"), "{refused}");
        drop(outputs);
        // The folder of the command is empty.
        assert_eq!(names(root.path()), ["checks.xml", "left.csv", "sub"]);
        for name in ["checks.xml", "sub/other.xml"] {
            assert_eq!(fs::read(path(name)).unwrap(), b"broke off");
        }
    }

    #[test]
    fn an_output_that_was_not_planned_is_not_written() {
        let root = tempfile::tempdir().unwrap();
        let mut outputs = Plan::new().begin().unwrap();
        outputs.add(root.path().join("one.txt"), *b"1");
        let error = outputs.write().unwrap_err().to_string();
        assert!(error.contains("was not planned"), "{error}");
        assert!(names(root.path()).is_empty());
    }

    #[test]
    fn what_is_no_place_for_a_file_is_refused() {
        let root = tempfile::tempdir().unwrap();
        fs::write(root.path().join("file"), "").unwrap();
        fs::create_dir(root.path().join("folder")).unwrap();
        for (name, said) in [
            ("", "is a directory"),
            ("new/..", "names no file"),
            ("new/../folder", "is a directory"),
            ("file/two.txt", "is a file, not a directory"),
            ("file/new/two.txt", "is a file, not a directory"),
        ] {
            refuses(
                root.path(),
                Plan::new().writes([root.path().join(name)]),
                said,
            );
        }
        refuses(root.path(), Plan::new().writes([""]), "names no file");
    }

    #[test]
    fn an_input_is_no_output_however_it_is_spelled() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        fs::create_dir(path("sub")).unwrap();
        fs::write(path("input"), "old").unwrap();
        fs::hard_link(path("input"), path("hard")).unwrap();
        for output in ["input", "./input", "sub/../input", "new/../input", "hard"] {
            refuses(
                root.path(),
                Plan::new().reads([path("input")]).writes([path(output)]),
                "would replace the input ",
            );
        }
    }

    #[test]
    fn two_outputs_are_two_files_before_they_are_there() {
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        for (one, other) in [
            ("x", "x"),
            ("x", "./x"),
            ("new/x", "new/../new/x"),
            ("x", "new/../x"),
        ] {
            refuses(
                root.path(),
                Plan::new().writes([path(one), path(other)]),
                "would be written twice",
            );
        }
        refuses(
            root.path(),
            Plan::new().writes(["-", "-"]),
            "standard output: ",
        );
        Plan::new().writes([path("x"), path("y")]).begin().unwrap();
    }

    #[test]
    fn what_goes_through_a_directory_that_is_not_there_is_written_without_it() {
        let root = tempfile::tempdir().unwrap();
        let output = root.path().join("new/../x");
        let mut outputs = Plan::new().writes([&output]).begin().unwrap();
        outputs.add(&output, *b"1");
        outputs.write().unwrap();
        assert_eq!(names(root.path()), ["x"]);
    }

    #[test]
    fn an_unfinished_recording_is_kept() {
        let root = tempfile::tempdir().unwrap();
        let left = root.path().join("left.csv");
        fs::write(&left, "all there is").unwrap();
        refuses(root.path(), Plan::new().keeps(&left), "an interrupted run");
        fs::remove_file(&left).unwrap();
        Plan::new().keeps(&left).begin().unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_refused_and_a_device_stays_what_it_is() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let path = |name: &str| root.path().join(name);
        fs::write(path("target"), "old").unwrap();
        fs::create_dir(path("folder")).unwrap();
        symlink(path("target"), path("link")).unwrap();
        symlink(path("nowhere"), path("dangling")).unwrap();
        symlink("/dev/null", path("null")).unwrap();
        for name in ["link", "dangling", "null"] {
            refuses(
                root.path(),
                Plan::new().writes([path(name)]),
                "is a symbolic link",
            );
        }
        refuses(
            root.path(),
            Plan::new().writes([path("dangling/file")]),
            "is a link that does not lead to a directory",
        );
        refuses(
            root.path(),
            Plan::new().reads([path("target")]).writes([path("link")]),
            "would replace the input ",
        );
        // A folder reached through a link is still the same folder.
        symlink(path("folder"), path("other")).unwrap();
        let files = [path("folder/x"), path("other/x")];
        refuses(
            root.path(),
            Plan::new().writes(&files),
            "would be written twice",
        );
        let device = "/dev/null";
        let mut outputs = Plan::new().writes([device, device]).begin().unwrap();
        outputs.add(device, *b"gone");
        outputs.write().unwrap();
        assert!(!Path::new(device).is_file());
    }

    /// If a link takes a file's place meanwhile, it is replaced and not followed.
    #[cfg(unix)]
    #[test]
    fn a_link_that_is_made_meanwhile_is_not_followed() {
        let root = tempfile::tempdir().unwrap();
        let (target, output) = (root.path().join("target"), root.path().join("output"));
        fs::write(&target, "old").unwrap();
        let mut outputs = Plan::new().writes([&output]).begin().unwrap();
        std::os::unix::fs::symlink(&target, &output).unwrap();
        outputs.add(&output, *b"new");
        outputs.write().unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"old");
        assert_eq!(fs::read(&output).unwrap(), b"new");
    }
}
