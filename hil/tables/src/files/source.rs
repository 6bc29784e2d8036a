//! The bytes of a file, before its format is known.

use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use mesh_damper_output::error::InputError;

use crate::budget::Budget;
use crate::read_limit::{ReadLimit, open};

/// A file's bytes: the first ones are known, the others are read on request. A pipe works as well as a file.
pub struct Source<'a> {
    path: PathBuf,
    budget: Rc<Budget>,
    head: Vec<u8>,
    rest: Box<dyn Read + 'a>,
}

impl<'a> Source<'a> {
    /// The number of bytes at the beginning by which formats recognize their files. The farthest mark is that of tar, at 257; HDF5
    /// may begin at 512, 1024 or 2048, after a program's own block.
    pub const HEAD: usize = 4096;

    /// Opens a file.
    ///
    /// # Errors
    /// The file and why it cannot be read: it does not exist, or is a folder.
    pub fn file(path: &Path, limit: ReadLimit) -> Result<Self, InputError> {
        Self::of(path, open(path)?, limit)
    }

    /// The bytes of `input`; `path` is its name in errors.
    ///
    /// # Errors
    /// An error of `input`.
    pub fn of(
        path: &Path,
        mut input: impl Read + 'a,
        limit: ReadLimit,
    ) -> Result<Self, InputError> {
        let mut head = Vec::new();
        (input.by_ref().take(Self::HEAD as u64))
            .read_to_end(&mut head)
            .map_err(|error| InputError::io(path, "read", &error))?;
        Ok(Self {
            path: path.to_owned(),
            budget: Rc::new(Budget::new(path.display().to_string(), limit)),
            head,
            rest: Box::new(input),
        })
    }

    /// The file as the user named it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The same for messages.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Limit of its size.
    pub fn limit(&self) -> ReadLimit {
        self.budget.limit()
    }

    /// What reading it may cost. Who reads its bytes as a stream charges them.
    pub fn budget(&self) -> Rc<Budget> {
        Rc::clone(&self.budget)
    }

    /// Its first bytes: [`Source::HEAD`] of them, or all.
    pub fn head(&self) -> &[u8] {
        &self.head
    }

    /// All bytes, one after the other. The reader must check the limit.
    pub fn stream(self) -> impl Read + 'a {
        io::Cursor::new(self.head).chain(self.rest)
    }

    /// All bytes at once. They are charged as read and held.
    ///
    /// # Errors
    /// An error of the file system, or a file beyond the limit.
    pub fn bytes(self) -> Result<Vec<u8>, InputError> {
        let (path, budget) = (self.path.clone(), self.budget());
        let mut bytes = Vec::new();
        (self.stream().take(budget.limit().file().saturating_add(1)))
            .read_to_end(&mut bytes)
            .map_err(|error| InputError::io(&path, "read", &error))?;
        let read = bytes.len() as u64;
        budget.read(read)?;
        budget.hold(read, "the file")?;
        // They came with room for twice as many.
        bytes.shrink_to_fit();
        Ok(bytes)
    }
}
