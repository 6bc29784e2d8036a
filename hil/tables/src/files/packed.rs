//! The bytes of a packed file: those that it has, and those that come out of its parts.

use std::io::{self, Read};
use std::rc::Rc;

use crate::budget::Budget;

/// A file that is held while its parts are unpacked.
pub(super) struct Packed {
    budget: Rc<Budget>,
    size: u64,
}

impl Packed {
    /// Of a file of this size, which is charged as held.
    pub fn of(size: usize, budget: Rc<Budget>) -> Self {
        let size = size as u64;
        Self { budget, size }
    }

    pub fn budget(&self) -> &Rc<Budget> {
        &self.budget
    }
}

impl Drop for Packed {
    fn drop(&mut self) {
        self.budget.release(self.size);
    }
}

/// A part of a packed file that is unpacked while it is read, with this number of steps of work for each byte.
pub(super) struct Part<'p, R> {
    pub from: R,
    pub packed: &'p Packed,
    /// Whether its bytes are unpacked for the first time.
    pub is_new: bool,
    pub steps: u64,
}

impl<R: Read> Read for Part<'_, R> {
    /// An error of the budget comes out as an [`InputError`](mesh_damper_output::error::InputError) within it.
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let count = self.from.read(to)?;
        let budget = &self.packed.budget;
        let new = if self.is_new { count } else { 0 };
        let charged = budget
            .unpacked(new as u64)
            .and_then(|()| budget.work(self.steps * count as u64, "its unpacked parts"));
        charged.map_err(io::Error::other)?;
        Ok(count)
    }
}
