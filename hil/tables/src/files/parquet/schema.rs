//! A schema of Arrow, examined before its decoder copies it: its parts may be shared, so that copies take more than its bytes.

use arrow_ipc::{Field, KeyValue, Message, root_as_footer_with_opts, root_as_message_with_opts};
use flatbuffers::{ForwardsUOffset, InvalidFlatbuffer, Vector, VerifierOptions};
use mesh_damper_output::error::InputError;

use crate::budget::Budget;

/// How many times its size a message may have when each part is counted where it is used. Convention: programs share only what says
/// where the parts of a table lie, which doubles the size of a small one.
const SHARED: usize = 8;
/// Bytes held for a field, for an entry of its metadata, and for the text of either, in the schema and with its column.
const OF_FIELD: u64 = 512;
const OF_ENTRY: u64 = 128;
const COPIES: u64 = 2;
const PART: &str = "its schema";

/// The bounds within which a message of this size is believed.
fn bounds(size: usize) -> VerifierOptions {
    VerifierOptions {
        max_apparent_size: size.saturating_mul(SHARED).saturating_add(1 << 10),
        ..VerifierOptions::default()
    }
}

/// A message, whose bytes are examined.
pub(super) fn message(bytes: &[u8]) -> Result<Message<'_>, InvalidFlatbuffer> {
    root_as_message_with_opts(&bounds(bytes.len()), bytes)
}

/// The end of a file, whose bytes are examined.
pub(super) fn footer(bytes: &[u8]) -> Result<arrow_ipc::Footer<'_>, InvalidFlatbuffer> {
    root_as_footer_with_opts(&bounds(bytes.len()), bytes)
}

/// Charges for a schema. Returns the number of its fields, those within others included.
///
/// # Errors
/// The budget has no room for it.
pub(super) fn charge(schema: arrow_ipc::Schema, budget: &Budget) -> Result<u64, InputError> {
    entries(schema.custom_metadata(), budget)?;
    fields(schema.fields(), budget)
}

type List<'m, T> = Option<Vector<'m, ForwardsUOffset<T>>>;

fn fields(list: List<'_, Field<'_>>, budget: &Budget) -> Result<u64, InputError> {
    let mut count = 0;
    for field in list.into_iter().flatten() {
        let name = field.name().map_or(0, str::len) as u64;
        budget.hold(OF_FIELD + COPIES * name, PART)?;
        budget.work(OF_FIELD, PART)?;
        entries(field.custom_metadata(), budget)?;
        count += 1 + fields(field.children(), budget)?;
    }
    Ok(count)
}

fn entries(list: List<'_, KeyValue<'_>>, budget: &Budget) -> Result<(), InputError> {
    for entry in list.into_iter().flatten() {
        let texts = [entry.key(), entry.value()];
        let texts: usize = texts.into_iter().flatten().map(str::len).sum();
        budget.hold(OF_ENTRY + COPIES * texts as u64, PART)?;
    }
    Ok(())
}

/// The bytes that a text in base 64 stands for; `None` if it is none.
pub(super) fn from_base_64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text.strip_suffix(b"=").unwrap_or(text);
    let text = text.strip_suffix(b"=").unwrap_or(text);
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    for group in text.chunks(4) {
        let mut word = 0_u32;
        for sign in group {
            let six = match sign {
                b'A'..=b'Z' => sign - b'A',
                b'a'..=b'z' => sign - b'a' + 26,
                b'0'..=b'9' => sign - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            word = word << 6 | u32::from(six);
        }
        word <<= 6 * (4 - group.len());
        bytes.extend(&word.to_be_bytes()[1..group.len()]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base_64_is_read() {
        for (text, is) in [
            ("", Some(&b""[..])),
            ("TQ==", Some(b"M")),
            ("TWE=", Some(b"Ma")),
            ("TWFu", Some(b"Man")),
            ("//+AAA==", Some(b"\xff\xff\x80\0")),
            ("T\n", None),
        ] {
            assert_eq!(from_base_64(text.as_bytes()).as_deref(), is, "{text}");
        }
    }
}
