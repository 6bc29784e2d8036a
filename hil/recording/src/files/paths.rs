//! A bound on the names that a file's parts are kept with.

/// The most bytes of the paths that are kept of one file. A long name of a group is a part of the path of everything in it, so a
/// small file may take any memory. Convention: half a kilobyte for each of the most columns.
const MOST: usize = 512 * super::arrays::MOST_COLUMNS;

/// The bytes of the paths kept so far.
#[derive(Debug, Default)]
pub(super) struct Paths {
    bytes: usize,
}

impl Paths {
    /// Why a file is refused whose paths take too much.
    pub const TOO_LONG: &'static str = "the names of its groups are too long";

    /// Counts the path of a part; returns whether all so far are within the bound.
    pub fn have_room(&mut self, path: &[String]) -> bool {
        let bytes = path.iter().map(|name| name.len() + size_of::<String>());
        self.bytes = self.bytes.saturating_add(bytes.sum());
        !self.are_too_long()
    }

    /// Whether a path was beyond the bound.
    pub fn are_too_long(&self) -> bool {
        self.bytes > MOST
    }
}
