//! Text over a board's link.

use core::fmt;

use crate::board::Link;

/// Writes lines to a link.
pub struct Output<L>(pub L);

impl<L: Link> fmt::Write for Output<L> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.send(text.as_bytes());
        Ok(())
    }
}
