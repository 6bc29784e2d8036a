//! The destination of an output, and the identity of its file, independent of the spelling of its path.

use std::path::{Component, Path, PathBuf};

use crate::error::InputError;

/// The paths that mean standard output.
const STANDARD_OUTPUT: [&str; 4] = ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"];

/// Destination of an output.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Place {
    StandardOutput,
    /// A device, a pipe or a descriptor: written directly, because it cannot be replaced by renaming.
    Device(PathBuf),
    /// A file, or a new name: absolute, without links above the last name.
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
    /// The destination of the output `name`.
    ///
    /// # Errors
    /// A directory in place of a file, or a file in place of a directory; a closed standard output.
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

    /// Whether writing both would keep only one of them. Devices accept everything written to them.
    pub fn is_same_as(&self, other: &Self) -> bool {
        let same_place = self.place == other.place && !matches!(self.place, Place::Device(_));
        same_place || (self.file.is_some() && self.file == other.file)
    }

    /// Whether it is a link of the user's, to a path that the command line does not name.
    pub fn is_link(&self) -> bool {
        matches!(&self.place, Place::File(path) if path.is_symlink())
    }
}

fn place_of(name: &Path) -> Result<Place, InputError> {
    if STANDARD_OUTPUT.iter().any(|known| name == Path::new(known)) {
        return Ok(Place::StandardOutput);
    }
    let refused = |problem: String, remedy: &str| {
        Err(InputError::new(name.display().to_string(), problem, remedy))
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
    // A path that does not exist yet contains no link, so that `..` removes the name before it.
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

/// Whether a link belongs to the system: to a device, or to an open descriptor.
fn is_link_of_the_system(path: &Path) -> bool {
    let Some(folder) = path.parent() else {
        return false;
    };
    folder == Path::new("/dev") || (folder.starts_with("/proc") && folder.ends_with("fd"))
}

/// Identity of a regular file, independent of the path to it: a link, a hard link, another spelling.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FileIdentity(Identity);

#[cfg(unix)]
type Identity = (u64, u64);
#[cfg(not(unix))]
type Identity = PathBuf;

impl FileIdentity {
    /// Identity of the regular file at `path`; `None` if there is none.
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

/// Whether standard output was closed when the command began. Rust's runtime opens /dev/null in its place, for reading and writing;
/// a shell that redirects to it opens it for writing alone.
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

/// The file to which the shell redirects standard output.
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

    /// Files may also be stored below /dev.
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
