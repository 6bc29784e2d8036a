//! Directories created for outputs, and the lock on the folder that a command fills.

use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::ending::{self, AtEnd};
use crate::error::InputError;

/// Largest number of attempts to create a folder that other commands remove at the same time.
const ATTEMPTS: usize = 16;

/// Directories created on the way, removed again unless they are kept, also at an [end](ending) of the program, and the lock on the
/// command's folder.
///
/// The lock is the system's on an open file, so that it ends with the process in any case.
#[derive(Debug, Default)]
pub(super) struct Folders {
    made: Vec<(PathBuf, AtEnd)>,
    lock: Option<Lock>,
}

impl Folders {
    /// Creates `directory` and missing ones above it.
    pub fn make(&mut self, directory: &Path) -> io::Result<()> {
        let missing: Vec<&Path> = directory
            .ancestors()
            .take_while(|ancestor| !ancestor.as_os_str().is_empty() && !ancestor.exists())
            .collect();
        for directory in missing.into_iter().rev() {
            match fs::create_dir(directory) {
                Ok(()) => {
                    let made = directory.to_owned();
                    let at_end = ending::at_end({
                        let made = made.clone();
                        move |_| remove(&made)
                    });
                    self.made.push((made, at_end));
                }
                // Another command has just created it.
                Err(error) if error.kind() == ErrorKind::AlreadyExists && directory.is_dir() => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Creates `folder` if it is missing, and locks it.
    ///
    /// # Errors
    /// A folder that cannot be created or opened, or whose lock another command holds.
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
                    // It belongs to the other command now, even if it was created here.
                    self.keep();
                    break;
                }
                // Another command removed it before it was locked here.
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

    /// Keeps the directories created so far.
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
        // Before the lock is released, or another command could lock a folder that is about to be removed.
        for (directory, _) in self.made.iter().rev() {
            remove(directory);
        }
    }
}

/// Removes an empty directory. One that is not empty stays.
fn remove(directory: &Path) {
    // It may be gone already.
    let _ = fs::remove_dir(directory);
}

/// A lock on a folder. On Unix the directory itself is locked, and nothing is left in it.
#[cfg(unix)]
#[derive(Debug)]
struct Lock {
    /// Held while it is open.
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

/// A lock on a folder, for systems that cannot lock a directory: on a file in it, which is removed at the end.
#[cfg(not(unix))]
#[derive(Debug)]
struct Lock {
    path: PathBuf,
    /// Held while it is open.
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
        // A command that finds it in use does not remove it, whatever the spelling of its path.
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

    /// However many commands give up and remove it again, the one that gets the lock holds it on the existing folder.
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
                            // It is alone in the folder, and the folder exists.
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
