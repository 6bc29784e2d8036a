//! Memory that is held for a while.

use crate::budget::Budget;
use mesh_damper_output::error::InputError;

/// Bytes that a part of a reader holds until it is dropped.
#[derive(Debug)]
pub(crate) struct Room<'b> {
    budget: &'b Budget,
    bytes: u64,
}

impl<'b> Room<'b> {
    pub fn of(budget: &'b Budget) -> Self {
        Self { budget, bytes: 0 }
    }

    pub fn budget(&self) -> &'b Budget {
        self.budget
    }

    /// Holds some more bytes, for `part` of the file in words.
    ///
    /// # Errors
    /// The budget has no room for them.
    pub fn more(&mut self, bytes: u64, part: &str) -> Result<(), InputError> {
        self.budget.hold(bytes, part)?;
        self.bytes += bytes;
        Ok(())
    }

    /// Adds an entry to a list, whose room is held as it grows.
    ///
    /// # Errors
    /// The budget has no room for it.
    #[cfg(feature = "formats")]
    pub fn push<T>(&mut self, list: &mut Vec<T>, entry: T, part: &str) -> Result<(), InputError> {
        let before = list.capacity();
        self.budget.push(list, entry, part)?;
        self.bytes += ((list.capacity() - before) * size_of::<T>()) as u64;
        Ok(())
    }

    /// Holds at least this many bytes.
    ///
    /// # Errors
    /// The budget has no room for them.
    pub fn at_least(&mut self, bytes: u64, part: &str) -> Result<(), InputError> {
        self.more(bytes.saturating_sub(self.bytes), part)
    }
}

impl Room<'_> {
    /// Holds them as long as the file.
    pub fn keep(mut self) {
        self.bytes = 0;
    }

    /// Holds what `other` held.
    pub fn take(&mut self, mut other: Room<'_>) {
        self.bytes += std::mem::take(&mut other.bytes);
    }
}

impl Drop for Room<'_> {
    fn drop(&mut self) {
        self.budget.release(self.bytes);
    }
}
