//! LZF, h5py's own compression.

use hdf5_reader::FilterRegistry;
use hdf5_reader::error::Error;

/// The filter's number among those that are registered with HDF5.
const LZF: u16 = 32000;

/// Registers the unpacking of chunks that LZF packed, to at most `most` bytes each.
pub(super) fn register(filters: &mut FilterRegistry, most: usize) {
    let unpack = move |_: &_, packed: &[u8], _: usize| {
        unpacked(packed, most).ok_or_else(|| Error::InvalidData("LZF: a chunk is damaged".into()))
    };
    filters.register(LZF, Box::new(unpack));
}

/// Literal bytes, and copies of earlier bytes.
fn unpacked(mut packed: &[u8], most: usize) -> Option<Vec<u8>> {
    let mut bytes: Vec<u8> = Vec::new();
    while let Some((&control, rest)) = packed.split_first() {
        packed = rest;
        if control < 32 {
            let (run, rest) = packed.split_at_checked(usize::from(control) + 1)?;
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
            // A copy may overlap its own output.
            for at in from..from + length + 2 {
                bytes.push(bytes[at]);
            }
        }
        if bytes.len() > most {
            return None;
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
