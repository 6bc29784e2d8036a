//! Nesting depth of the fields of a Parquet file, checked before its decoder follows them by nested calls.

/// The deepest nesting that is read. Convention: deeper than any table of measurements, and within any stack.
pub(super) const DEEPEST: usize = 32;

/// Bytes of Thrift's compact protocol.
struct Thrift<'b> {
    bytes: &'b [u8],
}

/// The depth of the schema at the end of a file; `None` if it is incomplete, which the decoder reports.
pub(super) fn depth(file: &[u8]) -> Option<usize> {
    let rest = file.strip_suffix(b"PAR1")?;
    let (rest, length) = rest.split_last_chunk::<4>()?;
    let from = rest
        .len()
        .checked_sub(u32::from_le_bytes(*length) as usize)?;
    let mut thrift = Thrift {
        bytes: &rest[from..],
    };
    let mut deepest = 0;
    let mut field = 0;
    while let Some((kind, number)) = thrift.field(field)? {
        field = number;
        if field != 2 || kind != 9 {
            thrift.skip(kind, DEEPEST)?;
            continue;
        }
        // For the fields around the next element: the number of elements still to come.
        let mut open: Vec<u64> = Vec::new();
        for _ in 0..thrift.list()?.1 {
            let mut children = 0;
            let mut field = 0;
            while let Some((kind, number)) = thrift.field(field)? {
                field = number;
                match (field, kind) {
                    (5, 4..=6) => children = zigzag(thrift.number()?),
                    _ => thrift.skip(kind, DEEPEST)?,
                }
            }
            while open.last() == Some(&0) {
                open.pop();
            }
            if let Some(last) = open.last_mut() {
                *last -= 1;
            }
            if children > 0 {
                open.push(children);
            }
            deepest = deepest.max(open.len());
            if deepest > DEEPEST {
                return Some(deepest);
            }
        }
    }
    Some(deepest)
}

/// A count; 0 for a negative one.
fn zigzag(word: u64) -> u64 {
    if word & 1 == 0 { word >> 1 } else { 0 }
}

impl Thrift<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (&byte, rest) = self.bytes.split_first()?;
        self.bytes = rest;
        Some(byte)
    }

    fn number(&mut self) -> Option<u64> {
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

    fn take(&mut self, count: u64) -> Option<()> {
        let count = usize::try_from(count).ok()?;
        (_, self.bytes) = self.bytes.split_at_checked(count)?;
        Some(())
    }

    /// The type and the number of the next field of a structure, after field `last`; `None` at its end.
    fn field(&mut self, last: u64) -> Option<Option<(u8, u64)>> {
        let head = self.byte()?;
        let (kind, more) = (head & 0xf, head >> 4);
        if kind == 0 {
            return Some(None);
        }
        let number = if more == 0 {
            zigzag(self.number()?)
        } else {
            last + u64::from(more)
        };
        Some(Some((kind, number)))
    }

    /// The type of a list's elements, and their number.
    fn list(&mut self) -> Option<(u8, u64)> {
        let head = self.byte()?;
        let count = match head >> 4 {
            15 => self.number()?,
            count => u64::from(count),
        };
        Some((head & 0xf, count))
    }

    fn skip(&mut self, kind: u8, depth: usize) -> Option<()> {
        let deeper = depth.checked_sub(1)?;
        match kind {
            1 | 2 => {}
            3 => self.take(1)?,
            4..=6 => _ = self.number()?,
            7 => self.take(8)?,
            8 => {
                let length = self.number()?;
                self.take(length)?;
            }
            9 | 10 => {
                let (kind, count) = self.list()?;
                for _ in 0..count {
                    // A boolean takes a byte here, and none in a structure.
                    let kind = if kind <= 2 { 3 } else { kind };
                    self.skip(kind, deeper)?;
                }
            }
            12 => {
                let mut last = 0;
                while let Some((kind, number)) = self.field(last)? {
                    last = number;
                    self.skip(kind, deeper)?;
                }
            }
            _ => return None,
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The end of a file with nested fields.
    fn file(deep: usize) -> Vec<u8> {
        // Elements of a name and one child each.
        let element = [0x48, 1, b'a', 0x15, 2, 0];
        let mut schema = vec![0x15, 4, 0x19, 0xfc];
        let mut count = deep;
        while count > 0x7f {
            schema.push(count as u8 & 0x7f | 0x80);
            count >>= 7;
        }
        schema.push(count as u8);
        (0..deep).for_each(|_| schema.extend(element));
        schema.push(0);
        let length = (schema.len() as u32).to_le_bytes();
        [b"PAR1", &schema[..], &length, b"PAR1"].concat()
    }

    #[test]
    fn fields_too_deep_are_seen_before_they_are_followed() {
        for deep in [1, 5, DEEPEST] {
            assert_eq!(depth(&file(deep)), Some(deep));
        }
        assert_eq!(depth(&file(100_000)), Some(DEEPEST + 1));
        assert_eq!(depth(b"PAR1"), None);
    }
}
