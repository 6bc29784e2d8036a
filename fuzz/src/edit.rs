//! Good files with damage: an input is a script of edits, so that few of its bytes fall on places that no reader examines.

/// One of `good` after the edits of `script`, or the script itself.
///
/// The first byte selects the file. Each four bytes after it are an edit: its kind, its place (two bytes) and its value. `words` are
/// the tokens of the format.
pub fn edited(good: &[Vec<u8>], words: &[&str], script: &[u8]) -> Vec<u8> {
    let Some((&which, rest)) = script.split_first() else {
        return Vec::new();
    };
    let Some(chosen) = good.get(usize::from(which) % (good.len() + 1)) else {
        return rest.to_vec();
    };
    let mut bytes = chosen.clone();
    for edit in rest.chunks_exact(4) {
        let &[what, high, low, with] = edit else {
            continue;
        };
        let place = usize::from(u16::from_be_bytes([high, low])) % (bytes.len() + 1);
        let end = (place + 1 + usize::from(with)).min(bytes.len());
        match what % 8 {
            0 => {
                if let Some(byte) = bytes.get_mut(place) {
                    *byte ^= 1 << (with % 8);
                }
            }
            1 => {
                if let Some(byte) = bytes.get_mut(place) {
                    *byte = with;
                }
            }
            2 => drop(bytes.drain(place..end)),
            3 => {
                let again = bytes[place..end].to_vec();
                bytes.splice(place..place, again);
            }
            4 => bytes.truncate(place),
            5 => bytes.insert(place, with),
            // A word that replaces the bytes there, or is inserted before them.
            kind => {
                let word = words[usize::from(with) % words.len()].bytes();
                let end = if kind == 6 { place } else { word.len() + place };
                bytes.splice(place..end.min(bytes.len()), word);
            }
        }
    }
    bytes
}
