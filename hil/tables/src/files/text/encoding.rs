//! The character encoding of a text.

use encoding_rs::{
    BIG5, EUC_KR, Encoding, GBK, SHIFT_JIS, UTF_16BE, UTF_16LE, WINDOWS_1250, WINDOWS_1251,
    WINDOWS_1252,
};

use crate::columns::known_words;

/// Encoding of the bytes of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// `None` for UTF-8.
    pub encoding: Option<&'static Encoding>,
    /// Whether nothing in the file confirms it.
    pub is_guess: bool,
}

/// Encodings with one or two bytes per character for a text that is not UTF-8. The first is the most common; the others are used
/// only if they give more known words in the text.
const OTHERS: [&Encoding; 7] = [
    WINDOWS_1252,
    WINDOWS_1251,
    WINDOWS_1250,
    GBK,
    SHIFT_JIS,
    EUC_KR,
    BIG5,
];
/// Part of a text that is searched for words: the part before the numbers is seldom longer.
const SEARCHED: usize = 1 << 16;

/// The encoding of a text that begins with `head`; `is_all` if that is the whole text.
pub(super) fn of(head: &[u8], is_all: bool) -> Found {
    let sure = |encoding| Found {
        encoding,
        is_guess: false,
    };
    if let Some((encoding, _)) = Encoding::for_bom(head) {
        return sure((encoding != encoding_rs::UTF_8).then_some(encoding));
    }
    let guess = |encoding| Found {
        encoding: Some(encoding),
        is_guess: true,
    };
    if let Some(encoding) = by_zeros(head) {
        return guess(encoding);
    }
    let Err(error) = std::str::from_utf8(head) else {
        return sure(None);
    };
    // The head ends within a character.
    if error.error_len().is_none() && !is_all {
        return sure(None);
    }
    // UTF-8 with an invalid sequence is rejected at that position.
    let (mut broken, mut whole) = (0, 0);
    for chunk in head.utf8_chunks() {
        broken += usize::from(!chunk.invalid().is_empty());
        whole += chunk.valid().chars().filter(|c| !c.is_ascii()).count();
    }
    if broken > whole {
        return guess(by_words(head));
    }
    sure(None)
}

/// UTF-16 without a mark: every second byte of its digits and separators is zero.
fn by_zeros(head: &[u8]) -> Option<&'static Encoding> {
    let pairs = head.chunks_exact(2);
    let count = pairs.len();
    let (mut first, mut second) = (0, 0);
    for pair in pairs {
        first += usize::from(pair[0] == 0);
        second += usize::from(pair[1] == 0);
    }
    let many = |zeros: usize| 2 * zeros > count;
    let few = |zeros: usize| 100 * zeros < count;
    if many(second) && few(first) {
        return Some(UTF_16LE);
    }
    (many(first) && few(second)).then_some(UTF_16BE)
}

/// The encoding with the most words for channels in a text.
fn by_words(head: &[u8]) -> &'static Encoding {
    let head = &head[..head.len().min(SEARCHED)];
    let words = |encoding: &'static Encoding| {
        let (text, _) = encoding.decode_without_bom_handling(head);
        known_words(&text)
    };
    let mut best = (OTHERS[0], words(OTHERS[0]));
    for encoding in &OTHERS[1..] {
        let count = words(encoding);
        if count > best.1 {
            best = (encoding, count);
        }
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_say_their_encoding() {
        let text = "Zeit [s];Weg [µm];Prüfkraft [kN]\n0;0,1;0,2\n";
        let utf16 = |big: bool| -> Vec<u8> {
            let unit = |unit: u16| {
                if big {
                    unit.to_be_bytes()
                } else {
                    unit.to_le_bytes()
                }
            };
            text.encode_utf16().flat_map(unit).collect()
        };
        let named = |bytes: &[u8]| {
            let found = of(bytes, true);
            (found.encoding.map(Encoding::name), found.is_guess)
        };
        assert_eq!(named(text.as_bytes()), (None, false));
        assert_eq!(named(&utf16(false)), (Some("UTF-16LE"), true));
        assert_eq!(named(&utf16(true)), (Some("UTF-16BE"), true));
        let marked = [vec![0xff, 0xfe], utf16(false)].concat();
        assert_eq!(named(&marked), (Some("UTF-16LE"), false));
        for (text, encoding) in [
            (text, WINDOWS_1252),
            ("Время [с];Перемещение [мм];Усилие [кН]\n", WINDOWS_1251),
            ("时间 (s),位移 (mm),力 (kN)\n", GBK),
            ("時間 (s),変位 (mm),荷重 (kN)\n", SHIFT_JIS),
        ] {
            let (bytes, _, lossy) = encoding.encode(text);
            assert!(!lossy);
            assert_eq!(named(&bytes), (Some(encoding.name()), true), "{text}");
        }
        // A character that is cut, at the end of the head and at the end of the file.
        assert_eq!(of(&text.as_bytes()[..16], false).encoding, None);
        assert_eq!(of(b"1,2,\xb0", true).encoding, Some(WINDOWS_1252));
    }
}
