//! LZF, h5py's own compression.

use crate::budget::Budget;
use crate::files::refused::Refused;

/// The filter's number among those that are registered with HDF5.
pub(super) const LZF: u16 = 32000;
/// Bytes that a byte of LZF gives at most: a copy of 264 takes three.
const RATIO: usize = 88;

/// The bytes that LZF packed, at most `most`. They are charged as unpacked and as held.
pub(super) fn inflated(
    packed: &[u8],
    most: usize,
    budget: &Budget,
    part: &str,
) -> Result<Vec<u8>, Refused> {
    let most = most.min(packed.len().saturating_mul(RATIO));
    budget.hold(most as u64, part)?;
    budget.work((packed.len() + most) as u64, part)?;
    let bytes = unpacked(packed, most);
    let bytes = bytes.ok_or("LZF: a packed chunk is damaged")?;
    budget.release((most - bytes.len()) as u64);
    if budget.is_new(packed)? {
        budget.unpacked(bytes.len() as u64)?;
    }
    Ok(bytes)
}

/// Literal bytes, and copies of earlier bytes.
fn unpacked(mut packed: &[u8], most: usize) -> Option<Vec<u8>> {
    let mut bytes: Vec<u8> = Vec::with_capacity(most);
    while let Some((&control, rest)) = packed.split_first() {
        packed = rest;
        if control < 32 {
            let (run, rest) = packed.split_at_checked(usize::from(control) + 1)?;
            if run.len() > most - bytes.len() {
                return None;
            }
            bytes.extend_from_slice(run);
            packed = rest;
        } else {
            let mut length = usize::from(control >> 5);
            if length == 7 {
                let (&more, rest) = packed.split_first()?;
                length += usize::from(more);
                packed = rest;
            }
            let (&low, rest) = packed.split_first()?;
            packed = rest;
            let back = (usize::from(control & 0x1f) << 8 | usize::from(low)) + 1;
            let from = bytes.len().checked_sub(back)?;
            if length + 2 > most - bytes.len() {
                return None;
            }
            // A copy may overlap its own output.
            for at in from..from + length + 2 {
                bytes.push(bytes[at]);
            }
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::unpacked;

    #[test]
    fn a_copy_may_reach_into_itself() {
        assert_eq!(unpacked(&[1, b'a', b'b'], 9).unwrap(), b"ab");
        // Two bytes, and five from two before.
        assert_eq!(
            unpacked(&[1, b'a', b'b', 3 << 5, 1], 9).unwrap(),
            b"abababa"
        );
        assert_eq!(unpacked(&[0, b'a', 7 << 5, 4, 0], 99).unwrap(), [b'a'; 14]);
        assert_eq!(unpacked(&[0, b'a', 7 << 5, 4, 0], 9), None);
        assert_eq!(unpacked(&[3 << 5, 1], 9), None);
        assert_eq!(unpacked(&[4, b'a'], 9), None);
    }
}
