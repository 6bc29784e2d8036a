//! What reading a file may cost: bytes held, and steps of work.
//!
//! A limit of the bytes read and one of the items counted do not bound their product: a name of a megabyte in each of 1e5 elements.
//! So everything a reader makes is charged here where it is made: names, notes, clones, unpacked blocks and values. The allowance
//! grows with the bytes that were read, so that an honest file of any size is read, and a small one can cost only little.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;

use mesh_damper_output::error::InputError;

use crate::read_limit::ReadLimit;

/// Part of the limit of a file that may be held, or worked, before a byte is read: 64 MiB and 67 million steps at the default. Derived
/// from the number of things of some hundred bytes that an honest file has without bytes of its own for each: 1e5 columns.
const FLOOR: u64 = 8;
/// Bytes that may be held for each byte read. Derived: a row of text with one digit and its end becomes a number of 8 bytes, 4 for
/// each byte, beside the file's bytes themselves, once packed and once unpacked. A file of 4 MiB that unpacks to 64 MiB may thus hold
/// 448 MiB. Outside of the budget are the block or page that a library decodes, if it is charged afterwards; the room by which maps,
/// and a file that is read, grow; and what is made of the columns when they were read. The growing fuzzers measure all of it.
const HELD_PER_BYTE: u64 = 6;
/// Steps for each byte read. A step is a look at some byte, value or entry, of a few nanoseconds. Derived: a byte is unpacked, checked
/// as a text, searched for an end and parsed, and its value is looked at once when times are compared and once when it is converted.
const STEPS_PER_BYTE: u64 = 8;
/// What a text takes beside its bytes: its place in a list, and what an allocator adds to it.
const TEXT: u64 = 48;
/// What a list takes beside its entries, the same way.
const LIST: u64 = 48;
/// Bytes to which a list is short. Derived: an allocator gives what is larger back to the system.
const SHORT_LIST: usize = 128 << 10;
/// What the place of a packed part takes in a map.
const OF_PART: u64 = 32;

/// Bytes that a text of this many takes when it is held.
pub fn of_text(length: usize) -> u64 {
    TEXT.saturating_add(length as u64)
}

/// Bytes that a list of this many `T` takes when it is held.
pub fn of_list<T>(count: usize) -> u64 {
    let each = size_of::<T>() as u64;
    LIST.saturating_add(each.saturating_mul(count as u64))
}

/// The budget of one file.
///
/// It is charged by `&self`, so that the parts of a reader can share it: `Rc<Budget>`.
#[derive(Debug)]
pub struct Budget {
    file: String,
    limit: ReadLimit,
    read: Cell<u64>,
    unpacked: Cell<u64>,
    /// Where the packed parts begin and end that were unpacked, in memory.
    parts: RefCell<BTreeMap<usize, usize>>,
    held: Cell<u64>,
    steps: Cell<u64>,
    is_used_up: Cell<bool>,
}

impl Budget {
    /// The budget of `file`, by its name in errors.
    pub fn new(file: impl Into<String>, limit: ReadLimit) -> Self {
        Self {
            file: file.into(),
            limit,
            read: Cell::new(0),
            unpacked: Cell::new(0),
            parts: RefCell::default(),
            held: Cell::new(0),
            steps: Cell::new(0),
            is_used_up: Cell::new(false),
        }
    }

    /// The limit from which it is derived.
    pub fn limit(&self) -> ReadLimit {
        self.limit
    }

    /// Bytes that came out of the file: the allowance grows with them.
    ///
    /// # Errors
    /// More bytes than the limit of a file.
    pub fn read(&self, bytes: u64) -> Result<(), InputError> {
        self.grown(&self.read, bytes)
    }

    /// Bytes that came out of packed parts of the file. The limit is for the bytes of a file and for what it unpacks to, each alone: of
    /// the two the larger counts as read.
    ///
    /// # Errors
    /// More bytes than the limit of a file.
    pub fn unpacked(&self, bytes: u64) -> Result<(), InputError> {
        self.grown(&self.unpacked, bytes)
    }

    /// Whether no byte of a packed part, by its place in memory, was unpacked before: what comes out of a byte counts once, however
    /// many things in the file share it.
    ///
    /// # Errors
    /// The budget has no room for its place.
    pub fn is_new(&self, part: &[u8]) -> Result<bool, InputError> {
        let mut parts = self.parts.borrow_mut();
        let place = part.as_ptr_range();
        let (start, end) = (place.start.addr(), place.end.addr());
        // Parts that are known do not overlap, so that the last one before the end reaches farthest.
        let before = parts.range(..end).next_back();
        let is_new = before.is_none_or(|(_, known)| *known <= start);
        if is_new {
            self.hold(OF_PART, "the places of its packed parts")?;
            parts.insert(start, end);
        }
        Ok(is_new)
    }

    fn grown(&self, count: &Cell<u64>, bytes: u64) -> Result<(), InputError> {
        count.set(count.get().saturating_add(bytes));
        if count.get() > self.limit.file() {
            self.is_used_up.set(true);
            return Err(self.limit.exceeded(&self.file));
        }
        Ok(())
    }

    /// Bytes that are made and held, for `part` of the file in words: `the names of its columns`. Charge before making them.
    ///
    /// # Errors
    /// The part with which the allowance is used up.
    pub fn hold(&self, bytes: u64, part: &str) -> Result<(), InputError> {
        let held = self.held.get().saturating_add(bytes);
        let allowed = self.allowed(HELD_PER_BYTE);
        if held > allowed {
            let held = rounded(held);
            let problem = format!("{part} would take the memory to {held}");
            return Err(self.used_up(problem, &rounded(allowed)));
        }
        self.held.set(held);
        Ok(())
    }

    /// Bytes that may still be held: the bound of what a library is asked for that does not charge itself.
    pub fn left(&self) -> u64 {
        (self.allowed(HELD_PER_BYTE)).saturating_sub(self.held.get())
    }

    /// Adds an entry to a list, whose room is charged as it grows, for `part` of the file in words.
    ///
    /// # Errors
    /// The part with which the allowance is used up.
    pub fn push<T>(&self, list: &mut Vec<T>, entry: T, part: &str) -> Result<(), InputError> {
        self.reserve(list, 1, part)?;
        list.push(entry);
        Ok(())
    }

    /// Room for `count` more entries of a list: if it lacks, a quarter more than there is, or twice as much of a short list, of which
    /// less is then left behind. Doubling, as a vector does by itself, would use the whole limit of a text of short rows.
    ///
    /// # Errors
    /// As [`Budget::push`].
    pub fn reserve<T>(
        &self,
        list: &mut Vec<T>,
        count: usize,
        part: &str,
    ) -> Result<(), InputError> {
        let free = list.capacity() - list.len();
        if count > free {
            let is_short = list.capacity() * size_of::<T>() <= SHORT_LIST;
            let grown = list.capacity() / if is_short { 1 } else { 4 };
            let more = (count - free).max(grown).max(4);
            self.hold((more as u64).saturating_mul(size_of::<T>() as u64), part)?;
            list.reserve_exact(free + more);
        }
        Ok(())
    }

    /// Bytes that were held and are no longer.
    pub fn release(&self, bytes: u64) {
        self.held.set(self.held.get().saturating_sub(bytes));
    }

    /// Steps of work on `part` of the file, in words.
    ///
    /// # Errors
    /// The part with which the allowance is used up.
    pub fn work(&self, steps: u64, part: &str) -> Result<(), InputError> {
        let done = self.steps.get().saturating_add(steps);
        let allowed = self.allowed(STEPS_PER_BYTE);
        if done > allowed {
            let problem = format!("{part} would take more than {allowed} steps of work");
            return Err(self.used_up(problem, &format!("{allowed} steps")));
        }
        self.steps.set(done);
        Ok(())
    }

    /// Whether something was refused: an error of a part that others could stand for is then one of the file.
    pub fn is_used_up(&self) -> bool {
        self.is_used_up.get()
    }

    /// Bytes held now, and steps done so far.
    pub fn used(&self) -> (u64, u64) {
        (self.held.get(), self.steps.get())
    }

    fn allowed(&self, per_byte: u64) -> u64 {
        let grown = self.size().saturating_mul(per_byte);
        (self.limit.file() / FLOOR).saturating_add(grown)
    }

    /// Bytes that count as read.
    fn size(&self) -> u64 {
        self.read.get().max(self.unpacked.get())
    }

    fn used_up(&self, problem: String, allowed: &str) -> InputError {
        self.is_used_up.set(true);
        let problem = format!(
            "{problem}; the budget of its {} bytes is {allowed}",
            self.size()
        );
        self.limit.refused(&self.file, problem)
    }
}

fn rounded(bytes: u64) -> String {
    match bytes >> 20 {
        0 => format!("{} KiB", bytes.div_ceil(1 << 10)),
        whole => format!("{whole} MiB"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_allowance_grows_with_what_was_read_and_the_limit_raises_it() {
        let budget = Budget::new("a.mat", ReadLimit::new(8000));
        budget.hold(1000, "its names").unwrap();
        let error = budget.hold(1, "its names").unwrap_err().to_string();
        assert!(error.contains("its names"), "{error}");
        assert!(error.contains("--max-read"), "{error}");
        budget.read(10).unwrap();
        budget.hold(60, "its names").unwrap();
        assert!(budget.hold(1, "its names").is_err());
        budget.release(5);
        assert_eq!(budget.left(), 5);
        budget.hold(5, "its names").unwrap();
        assert!(budget.work(1081, "its links").is_err());
        // Of the file and what it unpacks to, the larger counts.
        budget.unpacked(7).unwrap();
        assert!(budget.hold(1, "its names").is_err());
        budget.unpacked(4).unwrap();
        budget.hold(6, "its names").unwrap();
        budget.unpacked(7989).unwrap();
        budget.read(7990).unwrap();
        assert!(budget.read(1).is_err() && budget.unpacked(1).is_err());
        let more = Budget::new("a.mat", ReadLimit::new(16000));
        more.hold(2000, "its names").unwrap();
    }

    #[test]
    fn a_packed_part_is_new_once_and_one_that_overlaps_it_is_not() {
        let budget = Budget::new("a.mf4", ReadLimit::new(8000));
        let bytes = [0; 100];
        let is_new = |from: usize, to: usize| budget.is_new(&bytes[from..to]).unwrap();
        assert!(is_new(20, 30));
        for (from, to) in [(20, 30), (0, 100), (25, 27), (10, 21), (29, 40)] {
            assert!(!is_new(from, to), "{from}..{to}");
        }
        assert!(is_new(30, 40) && is_new(10, 20) && is_new(60, 100));
        assert!(!is_new(0, 11) && !is_new(39, 61) && is_new(40, 60));
        assert_eq!(budget.used().0, 5 * OF_PART);
    }

    #[test]
    fn a_list_is_charged_with_the_room_that_it_has() {
        let budget = Budget::new("a.mat", ReadLimit::new(8_000_000));
        let mut list: Vec<u64> = Vec::new();
        while budget.push(&mut list, 1, "its arrays").is_ok() {
            assert_eq!(budget.used().0, 8 * list.capacity() as u64);
        }
        assert!((80_000..=125_000).contains(&list.len()), "{}", list.len());
    }

    #[test]
    fn no_charge_overflows() {
        let budget = Budget::new("a.mat", ReadLimit::default());
        assert!(budget.hold(u64::MAX, "its names").is_err());
        budget.work(7, "its links").unwrap();
        assert!(budget.work(u64::MAX, "its links").is_err());
        assert_eq!(budget.used(), (0, 7));
    }
}
