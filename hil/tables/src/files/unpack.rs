//! Unpacking, charged while the bytes are made: what a packed part says about its size is not believed.

use std::borrow::Cow;

use flate2::{Decompress, FlushDecompress, Status};

use super::refused::Refused;
use crate::budget::Budget;

/// Bytes that are unpacked before the next are charged. Convention: more than a usual block, so that it is made at once, and much less
/// than the budget.
const PIECE: usize = 1 << 22;
/// Bytes that a byte of a zlib stream gives at most, by the format: 258 for two bits.
pub(super) const RATIO: usize = 1032;

/// The bytes of a zlib stream, at most `most`. They are charged as unpacked and as held, for `part` of the file in words; whoever
/// takes them releases them.
///
/// # Errors
/// A damaged stream, one with more than `most` bytes, or a budget that is used up.
pub(super) fn inflated(
    packed: &[u8],
    most: usize,
    budget: &Budget,
    part: &str,
) -> Result<Vec<u8>, Refused> {
    let damaged = |why: &str| Refused::Damaged(format!("a packed part {why}").into());
    let mut stream = Decompress::new(true);
    let mut bytes = Vec::new();
    budget.work(packed.len() as u64, part)?;
    let is_new = budget.is_new(packed)?;
    loop {
        if bytes.len() == bytes.capacity() {
            let room = PIECE
                .min(packed.len().saturating_mul(RATIO))
                .max(bytes.len() / 4);
            // One byte more than there should be shows that there are too many.
            let room = room.max(1).min(most.saturating_add(1) - bytes.len());
            budget.hold(room as u64, part)?;
            bytes.reserve_exact(room);
        }
        let (before, taken) = (bytes.len(), stream.total_in() as usize);
        let rest = packed.get(taken..).unwrap_or_default();
        let status = stream
            .decompress_vec(rest, &mut bytes, FlushDecompress::None)
            .map_err(|_| damaged("is damaged"))?;
        let made = bytes.len() - before;
        if is_new {
            budget.unpacked(made as u64)?;
        }
        budget.work(made as u64, part)?;
        if bytes.len() > most {
            return Err(damaged(&format!("holds more than its {most} bytes")));
        }
        match status {
            Status::StreamEnd => break,
            _ if made == 0 && stream.total_in() as usize == taken => {
                return Err(damaged("is cut"));
            }
            _ => {}
        }
    }
    budget.release((bytes.capacity() - bytes.len()) as u64);
    bytes.shrink_to_fit();
    Ok(bytes)
}

/// What is held for bytes of a file, or for some that were made of them.
#[expect(clippy::ptr_arg, reason = "the bytes alone do not say who holds them")]
pub(super) fn held(bytes: &Cow<'_, [u8]>) -> u64 {
    match bytes {
        Cow::Borrowed(_) => 0,
        Cow::Owned(bytes) => bytes.len() as u64,
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use flate2::Compression;
    use flate2::write::ZlibEncoder;

    use super::*;
    use crate::read_limit::ReadLimit;

    /// What the place of a packed part takes.
    const OF_PLACE: u64 = 32;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn what_is_unpacked_is_charged_as_it_is_made() {
        let bytes: Vec<u8> = (0..3 * PIECE / 2).map(|index| (index / 7) as u8).collect();
        let zeros = packed(&vec![0; 1 << 22]);
        let budget = Budget::new("a.mf4", ReadLimit::default());
        let stream = packed(&bytes);
        for times in 1..3 {
            let done = inflated(&stream, bytes.len(), &budget, "its values");
            assert!(matches!(done, Ok(done) if done == bytes));
            assert_eq!(budget.used().0, times * bytes.len() as u64 + OF_PLACE);
        }
        // They count once, however often they are unpacked.
        let rest = ReadLimit::default().file() - bytes.len() as u64;
        budget.unpacked(rest).unwrap();
        assert!(budget.unpacked(1).is_err());
        // Far less is held than the stream would unpack to.
        let small = Budget::new("a.mf4", ReadLimit::new(1 << 20));
        let done = inflated(&zeros, 1 << 22, &small, "its values");
        assert!(matches!(done, Err(Refused::Said(_))));
        assert_eq!(small.used().0, OF_PLACE);
    }

    #[test]
    fn a_stream_of_another_length_is_damaged() {
        let bytes = vec![7; 1000];
        let stream = packed(&bytes);
        let budget = Budget::new("a.mf4", ReadLimit::default());
        let refused = |packed: &[u8], most: usize| {
            let done = inflated(packed, most, &budget, "its values");
            matches!(done, Err(Refused::Damaged(_)))
        };
        assert!(refused(&stream, 999));
        assert!(refused(&stream[..stream.len() / 2], 1000));
        assert!(refused(&[1, 2, 3], 1000));
        assert!(!refused(&stream, 1000));
        assert!(!refused(&stream, 2000));
        assert!(!refused(&packed(&[]), 0));
    }
}
