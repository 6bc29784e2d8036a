//! The beginning of a text, by which it is recognized.

use encoding_rs::Encoding;
use mesh_damper_output::error::InputError;

use super::encoding;
use crate::csv_text::CsvText;
use crate::read_limit::ReadLimit;

/// Size of the head in bytes. Convention: the longest preambles of test programs have some hundred lines.
const HEAD: usize = 1 << 18;

/// The first lines of a text.
pub(super) struct Head {
    /// Complete lines, except that the text's last line may be incomplete.
    pub text: String,
    /// The encoding assumed, if it is not UTF-8 or uncertain, in words.
    pub encoding: Option<String>,
    /// Whether it is UTF-8, like our own files.
    pub is_utf8: bool,
}

impl Head {
    /// Whether there is a line that is neither blank nor a comment of our own format.
    pub fn has_lines(&self) -> bool {
        let mut lines = self.text.lines().map(str::trim);
        lines.any(|line| !line.is_empty() && !line.starts_with('#'))
    }
}

/// Reads ahead, and sets the encoding from then on.
pub(super) fn of(text: &mut CsvText, limit: ReadLimit) -> Result<Head, InputError> {
    let mut wanted = HEAD;
    let longest = usize::try_from(limit.line()).unwrap_or(usize::MAX);
    loop {
        let bytes = text.ahead(wanted)?;
        // Enough for a header of many columns and a row of numbers below it, but limited for lines that are too long in any case.
        let ends = bytes.iter().filter(|&&byte| byte == b'\n').take(2).count();
        if ends == 2 || bytes.len() < wanted || bytes.len() > longest.saturating_mul(2) {
            break;
        }
        wanted = wanted.saturating_mul(2);
    }
    let is_all = text.is_all_ahead();
    let bytes = text.ahead(0)?;
    let found = encoding::of(bytes, is_all);
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
    })
}

fn decoded(encoding: Option<&'static Encoding>, bytes: &[u8]) -> String {
    let encoding = encoding.unwrap_or(encoding_rs::UTF_8);
    // Undecodable bytes are rejected or reported during reading.
    encoding.decode_with_bom_removal(bytes).0.into_owned()
}
