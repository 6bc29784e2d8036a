//! JSON and XML that a terminal can show.

use std::fmt::Write as _;

use crate::terminal::is_obeyed;

/// JSON with `\u` escapes for what a terminal would obey. In JSON as a program writes it, such characters stand only inside of strings,
/// but for the ends of lines, and there the escapes mean the same.
pub(crate) fn json(text: &str) -> String {
    escaped(text, |letter, shown| {
        for unit in letter.encode_utf16(&mut [0; 2]) {
            // Writing to a string does not fail.
            let _ = write!(shown, "\\u{unit:04x}");
        }
    })
}

/// XML with character references for what a terminal would obey, in texts and attributes, where they mean the same.
pub fn xml(text: &str) -> String {
    escaped(text, |letter, shown| {
        let _ = write!(shown, "&#x{:x};", u32::from(letter));
    })
}

fn escaped(text: &str, escape: impl Fn(char, &mut String)) -> String {
    let mut shown = String::with_capacity(text.len());
    for letter in text.chars() {
        if letter != '\n' && is_obeyed(letter) {
            escape(letter, &mut shown);
        } else {
            shown.push(letter);
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    fn obeys_nothing(text: &str) -> bool {
        !text.contains(|letter| letter != '\n' && is_obeyed(letter))
    }

    #[test]
    fn json_means_the_same() {
        let text = "ü\u{1b}[2J\n\u{9b}\u{202e}\u{e0041}\u{7f}\"\\";
        let json = json(&serde_json::to_string_pretty(&[text]).unwrap());
        assert!(obeys_nothing(&json), "{json}");
        assert!(json.contains(r"\u009b\u202e\udb40\udc41\u007f"), "{json}");
        let read: Vec<String> = serde_json::from_str(&json).unwrap();
        assert_eq!(read, [text]);
    }

    #[test]
    fn xml_has_references() {
        let xml = xml("<a b=\"\u{202e}\">\n\u{9b}ü</a>");
        assert_eq!(xml, "<a b=\"&#x202e;\">\n&#x9b;ü</a>");
    }
}
