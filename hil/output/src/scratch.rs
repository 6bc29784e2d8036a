//! A folder for files that are needed while a command works.

use std::fs;
use std::io;
use std::path::Path;

use tempfile::TempDir;

use crate::ending::{self, AtEnd};

/// A new folder, which is removed with all that is in it when this is dropped, and at an [end](crate::ending) of this program.
#[derive(Debug)]
pub struct Scratch {
    folder: TempDir,
    _at_end: AtEnd,
}

impl Scratch {
    /// A folder in the system's folder for temporary files.
    ///
    /// # Errors
    /// It cannot be created.
    pub fn new() -> io::Result<Self> {
        Self::within(&std::env::temp_dir())
    }

    /// A folder in `parent`.
    ///
    /// # Errors
    /// It cannot be created.
    pub fn within(parent: &Path) -> io::Result<Self> {
        // No end comes between the folder and its entry for the end.
        let _whole = ending::whole();
        let folder = TempDir::with_prefix_in("mesh-damper-", parent)?;
        let path = folder.path().to_owned();
        Ok(Self {
            folder,
            // If something is put there meanwhile, it stays: there is nobody to tell.
            _at_end: ending::at_end(move |_| _ = fs::remove_dir_all(path)),
        })
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_with_its_files() {
        let parent = tempfile::tempdir().unwrap();
        let scratch = Scratch::within(parent.path()).unwrap();
        fs::write(scratch.path().join("a"), "").unwrap();
        assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 1);
        drop(scratch);
        assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 0);
    }
}
