//! Parts from who makes them to who owns them.

use core::cell::Cell;

use critical_section::Mutex;

/// A place in a static for one part: put there once, and taken once.
pub struct Handed<T>(Mutex<Cell<Option<T>>>);

impl<T: Send> Handed<T> {
    /// Nothing there yet.
    pub const fn new() -> Self {
        Self(Mutex::new(Cell::new(None)))
    }

    /// Puts a part there.
    pub fn put(&self, part: T) {
        critical_section::with(|section| self.0.borrow(section).set(Some(part)));
    }

    /// The part, unless it is not there yet, or no more.
    pub fn take(&self) -> Option<T> {
        critical_section::with(|section| self.0.borrow(section).take())
    }
}
