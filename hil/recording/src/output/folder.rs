//! Directories that are made for outputs, and the lock on the one that a command fills.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::error::InputError;

/// How often a folder that others remove at the same time is made again.
const ATTEMPTS: usize = 16;

/// Directories made on the way, removed again unless they are kept, and the lock on the command's folder.
///
/// The lock is the system's on an open file, so that it goes away with the process however that ends.
#[derive(Debug, Default)]
pub(super) struct Folders {
    made: Vec<PathBuf>,
    lock: Option<Lock>,
}

impl Folders {
    /// Makes `directory` and those above it that are missing.
    pub fn make(&mut self, directory: &Path) -> io::Result<()> {
        let missing: Vec<&Path> = directory
            .ancestors()
            .take_while(|ancestor| !ancestor.as_os_str().is_empty() && !ancestor.exists())
            .collect();
        for directory in missing.into_iter().rev() {
            match fs::create_dir(directory) {
                Ok(()) => self.made.push(directory.to_owned()),
                // By another command, just now.
                Err(error) if error.kind() == ErrorKind::AlreadyExists && directory.is_dir() => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Makes `folder` where it is missing, and locks it.
    ///
    /// # Errors
    /// A folder that cannot be made or opened, or that another holds the lock of.
    pub fn lock(&mut self, folder: &Path) -> Result<(), InputError> {
        for _ in 0..ATTEMPTS {
            self.make(folder)
                .map_err(|error| InputError::io(folder, "make", &error))?;
            match Lock::take(folder) {
                Ok(lock) => {
                    self.lock = Some(lock);
                    return Ok(());
                }
                Err(TryLockError::WouldBlock) => {
                    // Theirs now, even if it was made here.
                    self.keep();
                    break;
                }
                // Whoever made it gave up and removed it before it was locked here.
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::NotFound => {}
                Err(TryLockError::Error(error)) => {
                    return Err(InputError::io(folder, "lock", &error));
                }
            }
        }
        Err(InputError::new(
            folder.display().to_string(),
            "in use by another run",
            "wait for it or name another folder",
        ))
    }

    /// The directories made so far stay.
    pub fn keep(&mut self) {
        self.made.clear();
    }
}

impl Drop for Folders {
    fn drop(&mut self) {
        #[cfg(not(unix))]
        if let Some(lock) = &self.lock {
            lock.remove();
        }
        // Before the lock is given back, or another could take hold of a folder that is about to go.
        for directory in self.made.iter().rev() {
            // One that is not empty stays, as does one that someone else removed.
            let _ = fs::remove_dir(directory);
        }
    }
}

/// A lock on a folder. On Unix it is one on the directory itself and leaves nothing in it.
#[cfg(unix)]
#[derive(Debug)]
struct Lock {
    /// Held for as long as it is open.
    _directory: File,
}

#[cfg(unix)]
impl Lock {
    fn take(folder: &Path) -> Result<Self, TryLockError> {
        use std::os::unix::fs::MetadataExt as _;
        let identity = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
        let directory = File::open(folder).map_err(TryLockError::Error)?;
        directory.try_lock()?;
        let locked = directory.metadata().map(identity);
        let there = fs::metadata(folder).map(identity);
        match (locked, there) {
            (Ok(locked), Ok(there)) if locked == there => Ok(Self {
                _directory: directory,
            }),
            (Err(error), _) | (_, Err(error)) => Err(TryLockError::Error(error)),
            // Another directory has its name by now.
            _ => Err(TryLockError::Error(ErrorKind::NotFound.into())),
        }
    }
}

/// A lock on a folder, where a directory itself cannot be locked: on a file in it, which is removed at the end.
#[cfg(not(unix))]
#[derive(Debug)]
struct Lock {
    path: PathBuf,
    /// Held for as long as it is open.
    _file: File,
}

#[cfg(not(unix))]
impl Lock {
    fn take(folder: &Path) -> Result<Self, TryLockError> {
        let path = folder.join(".hil-lock");
        let file = File::create(&path).map_err(TryLockError::Error)?;
        file.try_lock()?;
        Ok(Self { path, _file: file })
    }

    fn remove(&self) {
        let _ = fs::remove_file(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_held_by_one_until_it_is_dropped() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("a/b");
        let mut first = Folders::default();
        first.lock(&folder).unwrap();
        // What finds it in use does not take it away, however it is spelled.
        for spelled in [folder.clone(), root.path().join("a/./b/../b")] {
            let refused = Folders::default().lock(&spelled).unwrap_err().to_string();
            let said = "in use by another run; wait for it or name another folder";
            assert!(refused.ends_with(said), "{refused}");
        }
        assert!(folder.is_dir());
        drop(first);
        // Nothing was written into it.
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
        Folders::default().lock(&folder).unwrap();
    }

    #[test]
    fn the_lock_of_a_folder_that_stays_leaves_nothing_in_it() {
        let root = tempfile::tempdir().unwrap();
        let mut folders = Folders::default();
        folders.lock(root.path()).unwrap();
        drop(folders);
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 0);
    }

    /// However many give up and remove it again, who is given the lock holds it on the folder that is there.
    #[test]
    fn a_folder_that_others_make_and_remove_is_held_by_one() {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("folder");
        let held = std::sync::atomic::AtomicUsize::new(0);
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..500 {
                        let mut folders = Folders::default();
                        if folders.lock(&folder).is_ok() {
                            use std::sync::atomic::Ordering::SeqCst;
                            assert_eq!(held.fetch_add(1, SeqCst), 0);
                            // Alone in it, and it is there.
                            fs::write(folder.join("mine"), "").unwrap();
                            fs::remove_file(folder.join("mine")).unwrap();
                            held.fetch_sub(1, SeqCst);
                        }
                    }
                });
            }
        });
    }
}
