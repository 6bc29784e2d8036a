//! Bytes of Thrift's compact protocol.

use crate::files::DEEPEST;

/// Bytes that are read one after the other.
pub(super) struct Thrift<'b> {
    bytes: &'b [u8],
    /// Number of elements of the lists that were passed over.
    pub passed: u64,
}

/// The types of the protocol that are told apart here.
pub(super) const BINARY: u8 = 8;
pub(super) const LIST: u8 = 9;
pub(super) const STRUCTURE: u8 = 12;

impl<'b> Thrift<'b> {
    pub fn of(bytes: &'b [u8]) -> Self {
        Self { bytes, passed: 0 }
    }

    /// Number of bytes that are left.
    pub fn left(&self) -> usize {
        self.bytes.len()
    }

    fn byte(&mut self) -> Option<u8> {
        let (&byte, rest) = self.bytes.split_first()?;
        self.bytes = rest;
        Some(byte)
    }

    fn word(&mut self) -> Option<u64> {
        let mut number = 0_u64;
        for place in 0..10 {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << (7 * place).min(63);
            if byte & 0x80 == 0 {
                return Some(number);
            }
        }
        None
    }

    /// An integer.
    pub fn integer(&mut self) -> Option<i64> {
        let word = self.word()?;
        Some((word >> 1) as i64 ^ -((word & 1) as i64))
    }

    /// An integer of 32 bits, as the decoder takes it, that is a count or a size.
    pub fn count(&mut self) -> Option<u64> {
        u64::try_from(self.integer()? as i32).ok()
    }

    fn take(&mut self, count: u64) -> Option<&'b [u8]> {
        let count = usize::try_from(count).ok()?;
        let (taken, rest) = self.bytes.split_at_checked(count)?;
        self.bytes = rest;
        Some(taken)
    }

    /// A text, or other bytes.
    pub fn binary(&mut self) -> Option<&'b [u8]> {
        let length = self.word()?;
        self.take(length)
    }

    /// The type and the number of the next field of a structure, after field `last`; `None` at its end.
    pub fn field(&mut self, last: i16) -> Option<Option<(u8, i16)>> {
        let head = self.byte()?;
        let (kind, more) = (head & 0xf, head >> 4);
        if kind == 0 {
            return Some(None);
        }
        let number = match more {
            0 => self.integer()? as i16,
            more => last.checked_add(i16::from(more))?,
        };
        Some(Some((kind, number)))
    }

    /// The type of a list's elements, and their number: each takes a byte at least, except in a file that is damaged.
    pub fn list(&mut self) -> Option<(u8, u64)> {
        let head = self.byte()?;
        let count = match head >> 4 {
            15 => self.word()?,
            count => u64::from(count),
        };
        (count <= self.bytes.len() as u64).then_some((head & 0xf, count))
    }

    /// Passes over a value of this type.
    pub fn skip(&mut self, kind: u8) -> Option<()> {
        self.skip_within(kind, DEEPEST)
    }

    fn skip_within(&mut self, kind: u8, depth: usize) -> Option<()> {
        let deeper = depth.checked_sub(1)?;
        match kind {
            1 | 2 => {}
            3 => _ = self.byte()?,
            4..=6 => _ = self.word()?,
            7 => _ = self.take(8)?,
            BINARY => _ = self.binary()?,
            LIST | 10 => {
                let (kind, count) = self.list()?;
                self.passed = self.passed.saturating_add(count);
                for _ in 0..count {
                    // A boolean takes a byte here, and none in a structure.
                    let kind = if kind <= 2 { 3 } else { kind };
                    self.skip_within(kind, deeper)?;
                }
            }
            STRUCTURE => {
                let mut last = 0;
                while let Some((kind, number)) = self.field(last)? {
                    last = number;
                    self.skip_within(kind, deeper)?;
                }
            }
            _ => return None,
        }
        Some(())
    }
}
