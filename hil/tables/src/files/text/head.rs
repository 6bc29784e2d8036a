//! The beginning of a text, by which it is recognized.

use encoding_rs::Encoding;
use mesh_damper_output::error::InputError;

use super::encoding;
use crate::budget::Budget;
use crate::csv_text::CsvText;
use crate::room::Room;

/// Size of the head in bytes. Convention: the longest preambles of test programs have some hundred lines.
const HEAD: usize = 1 << 18;

/// Bytes held for a byte of the head: in UTF-8, and decoded, when a character of one byte may take three.
const OF_BYTE: u64 = 1;
const OF_DECODED: u64 = 3;

/// The first lines of a text.
pub(super) struct Head<'b> {
    /// Complete lines, except that the text's last line may be incomplete.
    pub text: String,
    /// The encoding assumed, if it is not UTF-8 or uncertain, in words.
    pub encoding: Option<String>,
    /// Whether it is UTF-8, like our own files.
    pub is_utf8: bool,
    _room: Room<'b>,
}

impl Head<'_> {
    /// Whether there is a line that is neither blank nor a comment of our own format.
    pub fn has_lines(&self) -> bool {
        let mut lines = self.text.lines().map(str::trim);
        lines.any(|line| !line.is_empty() && !line.starts_with('#'))
    }
}

/// Reads ahead, and sets the encoding from then on. The head's text is held by `budget`, which is that of the file.
pub(super) fn of<'b>(text: &mut CsvText, budget: &'b Budget) -> Result<Head<'b>, InputError> {
    let mut wanted = HEAD;
    loop {
        let bytes = text.ahead(wanted)?;
        // Enough for a header of many columns and a row of numbers below it: a third line begins.
        let lines = bytes.split(|byte| matches!(byte, b'\n' | b'\r'));
        let is_enough = lines.filter(|line| !line.is_empty()).nth(2).is_some();
        if is_enough || bytes.len() < wanted {
            break;
        }
        wanted = wanted.saturating_mul(2);
    }
    let is_all = text.is_all_ahead();
    let bytes = text.ahead(0)?;
    let found = encoding::of(bytes, is_all);
    let mut room = Room::of(budget);
    let of_byte = found.encoding.map_or(OF_BYTE, |_| OF_DECODED);
    room.more(of_byte * bytes.len() as u64, "its first lines")?;
    let mut head = decoded(found.encoding, bytes);
    if !is_all {
        let end = head.rfind(['\n', '\r']).map_or(0, |at| at + 1);
        head.truncate(end);
    }
    text.decode(found.encoding);
    let encoding = found.encoding.map(|encoding| {
        let how = if found.is_guess {
            ", although the file does not state this"
        } else {
            ""
        };
        format!("its characters are read as {}{how}", encoding.name())
    });
    Ok(Head {
        text: head,
        is_utf8: encoding.is_none(),
        encoding,
        _room: room,
    })
}

fn decoded(encoding: Option<&'static Encoding>, bytes: &[u8]) -> String {
    let encoding = encoding.unwrap_or(encoding_rs::UTF_8);
    // Undecodable bytes are rejected or reported during reading.
    encoding.decode_with_bom_removal(bytes).0.into_owned()
}
