//! Where an output goes, and which file that is however its path is spelled.

use std::path::{Component, Path, PathBuf};

use crate::error::InputError;

/// The paths that mean standard output.
const STANDARD_OUTPUT: [&str; 4] = ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];

/// Where an output goes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Place {
    StandardOutput,
    /// A device, a pipe or a descriptor: written as it is, as it cannot be renamed over.
    Device(PathBuf),
    /// A file or its name to be: absolute, with no link above the last name.
    File(PathBuf),
}

/// One output of a command.
#[derive(Debug)]
pub(super) struct Target {
    /// As the user named it.
    pub name: PathBuf,
    pub place: Place,
    /// The regular file that is there already.
    pub file: Option<FileIdentity>,
}

impl Target {
    /// What the output `name` is.
    ///
    /// # Errors
    /// A directory where a file shall be, or a file where a directory shall be; standard output that is closed.
    pub fn of(name: PathBuf) -> Result<Self, InputError> {
        let place = place_of(&name)?;
        if place == Place::StandardOutput && is_closed() {
            return Err(InputError::new(
                name.display().to_string(),
                "standard output is closed",
                "leave it open, or name a file",
            ));
        }
        let file = match &place {
            Place::StandardOutput => identity_of_standard_output(),
            Place::Device(path) | Place::File(path) => FileIdentity::of(path),
        };
        Ok(Self { name, place, file })
    }

    /// Whether writing both would keep one of them only. Devices take whatever is written to them.
    pub fn is_same_as(&self, other: &Self) -> bool {
        let same_place = self.place == other.place && !matches!(self.place, Place::Device(_));
        same_place || (self.file.is_some() && self.file == other.file)
    }

    /// Whether it is a link of the user's, to somewhere that the command line does not name.
    pub fn is_link(&self) -> bool {
        matches!(&self.place, Place::File(path) if path.is_symlink())
    }
}

fn place_of(name: &Path) -> Result<Place, InputError> {
    if STANDARD_OUTPUT.iter().any(|known| name == Path::new(known)) {
        return Ok(Place::StandardOutput);
    }
    let refused = |problem: String, mend: &str| {
        Err(InputError::new(name.display().to_string(), problem, mend))
    };
    let is_directory = || refused("is a directory".into(), "name a file in it");
    if name.is_dir() {
        return is_directory();
    }
    let (Some(parent), Some(last)) = (name.parent(), name.file_name()) else {
        return refused("names no file".into(), "name a file");
    };
    let present = |ancestor: &&Path| ancestor.symlink_metadata().is_ok();
    let known = parent
        .ancestors()
        .find(present)
        .unwrap_or_else(|| Path::new("."));
    if !known.is_dir() {
        let what = if known.is_symlink() {
            "a link that does not lead to a directory"
        } else {
            "a file, not a directory"
        };
        return refused(
            format!("{} is {what}", known.display()),
            "name another directory",
        );
    }
    let mut path = known
        .canonicalize()
        .map_err(|error| InputError::io(name, "write", &error))?;
    // What is not there yet holds no link, so that `..` takes away the name before it.
    for component in parent.strip_prefix(known).unwrap_or(parent).components() {
        match component {
            Component::ParentDir => _ = path.pop(),
            Component::Normal(name) => path.push(name),
            _ => {}
        }
    }
    path.push(last);
    if path.is_dir() {
        return is_directory();
    }
    let is_device = if path.is_symlink() {
        is_link_of_the_system(&path)
    } else {
        path.exists() && !path.is_file()
    };
    Ok(if is_device {
        Place::Device(path)
    } else {
        Place::File(path)
    })
}

/// Whether a link is the system's own: to a device, or to an open descriptor.
fn is_link_of_the_system(path: &Path) -> bool {
    let Some(folder) = path.parent() else {
        return false;
    };
    folder == Path::new("/dev") || (folder.starts_with("/proc") && folder.ends_with("fd"))
}

/// Which regular file it is, whatever leads to it: a link, a hard link, another spelling.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FileIdentity(Identity);

#[cfg(unix)]
type Identity = (u64, u64);
#[cfg(not(unix))]
type Identity = PathBuf;

impl FileIdentity {
    /// That of the regular file at `path`; none where there is none.
    #[cfg(unix)]
    pub fn of(path: &Path) -> Option<Self> {
        Self::in_metadata(&path.metadata().ok()?)
    }

    #[cfg(not(unix))]
    pub fn of(path: &Path) -> Option<Self> {
        let path = path.canonicalize().ok()?;
        path.is_file().then_some(Self(path))
    }

    #[cfg(unix)]
    fn in_metadata(metadata: &std::fs::Metadata) -> Option<Self> {
        use std::os::unix::fs::MetadataExt as _;
        metadata
            .is_file()
            .then(|| Self((metadata.dev(), metadata.ino())))
    }
}

/// Whether standard output was closed when the command began. Rust's runtime opens /dev/null in its place, for reading and writing; a shell
/// that sends it there opens it for writing alone.
#[cfg(target_os = "linux")]
fn is_closed() -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let output = std::io::stdout();
    let is_null = Path::new("/dev/null").metadata().is_ok_and(|null| {
        rustix::fs::fstat(&output).is_ok_and(|output| output.st_rdev == null.rdev())
    });
    let flags = rustix::fs::fcntl_getfl(&output);
    is_null && flags.is_ok_and(|flags| flags.contains(rustix::fs::OFlags::RDWR))
}

#[cfg(not(target_os = "linux"))]
fn is_closed() -> bool {
    false
}

/// The file that the shell sends standard output to.
#[cfg(unix)]
fn identity_of_standard_output() -> Option<FileIdentity> {
    use std::os::fd::AsFd as _;
    let descriptor = std::io::stdout().as_fd().try_clone_to_owned().ok()?;
    FileIdentity::in_metadata(&std::fs::File::from(descriptor).metadata().ok()?)
}

#[cfg(not(unix))]
fn identity_of_standard_output() -> Option<FileIdentity> {
    None
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// Files may be kept below /dev too.
    #[test]
    fn a_link_in_shared_memory_is_the_users() {
        let root = tempfile::tempdir_in("/dev/shm").unwrap();
        let link = root.path().join("link");
        std::os::unix::fs::symlink("/dev/null", &link).unwrap();
        assert!(Target::of(link).unwrap().is_link());
        for known in ["/dev/null", "/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"] {
            let place = Target::of(known.into()).unwrap().place;
            assert!(matches!(place, Place::Device(_)), "{known}: {place:?}");
        }
    }
}
