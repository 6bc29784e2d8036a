//! The bytes of a text.

use super::corpus::{Column, Dialect, MM, N, Outcome, S, rows};

const UM: Column = MM.of(1e-3, 2);

/// The bytes of a text in an encoding: UTF-16 in either byte order, with or without a byte order mark.
pub fn utf16(text: &str, big: bool, marked: bool) -> Vec<u8> {
    let mark = marked.then_some(0xfeff);
    let units = mark.into_iter().chain(text.encode_utf16());
    units
        .flat_map(|unit| {
            if big {
                unit.to_be_bytes()
            } else {
                unit.to_le_bytes()
            }
        })
        .collect()
}

pub fn dialects() -> Vec<Dialect> {
    let german = format!(
        "Prüfzeit [s];Weg [µm];Prüfkraft [N]\r\n{}",
        rows(&[S, UM, N], ";", ',', "\r\n")
    );
    let dialect = |name, bytes: Vec<u8>, said: &[&'static str]| Dialect {
        family: "encoding",
        name,
        bytes,
        columns: [S, UM, N],
        outcome: Outcome::Read(said.to_vec()),
    };
    let coded = |text: &str, encoding: &'static encoding_rs::Encoding| {
        let (bytes, _, lossy) = encoding.encode(text);
        assert!(!lossy, "{text}");
        bytes.into_owned()
    };
    let named = |names: [&str; 3]| names.join("\t") + "\n" + &rows(&[S, UM, N], "\t", '.', "\n");
    let mut zip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut zip, &utf16(&german, false, true)).expect("to memory");
    // A one-byte sign far behind the part that the reader examines first.
    let late = {
        let pad = ("# ".to_owned() + &"x".repeat(98) + "\n").repeat(4000);
        let rows = rows(&[S, UM, N], ";", ',', "\n");
        let (first, second) = rows.split_at(rows.find('\n').map_or(0, |end| end + 1));
        let text = format!("Time [s];Disp [um];Load [N]\n{first}{pad}{second}");
        let mut bytes = text.into_bytes();
        bytes.extend(b"\n20 \xb0C in the room\n");
        bytes
    };
    vec![
        dialect("UTF-8", german.clone().into_bytes(), &["a semicolon"]),
        dialect(
            "UTF-8 with a byte order mark",
            format!("\u{feff}{german}").into_bytes(),
            &["a semicolon"],
        ),
        dialect(
            "UTF-16LE with a byte order mark",
            utf16(&german, false, true),
            &["UTF-16LE"],
        ),
        dialect(
            "UTF-16BE with a byte order mark",
            utf16(&german, true, true),
            &["UTF-16BE"],
        ),
        dialect(
            "UTF-16LE by its zeros",
            utf16(&german, false, false),
            &["UTF-16LE, although the file does not state this"],
        ),
        dialect(
            "UTF-16BE by its zeros",
            utf16(&german, true, false),
            &["UTF-16BE, although the file does not state this"],
        ),
        dialect(
            "UTF-16LE, gzipped",
            zip.finish().expect("to memory"),
            &["UTF-16LE"],
        ),
        dialect(
            "Windows-1252",
            coded(&german, encoding_rs::WINDOWS_1252),
            &["windows-1252, although the file does not state this"],
        ),
        dialect(
            "Windows-1251, Russian",
            coded(
                &named(["Время, с", "Перемещение, мкм", "Усилие, Н"]),
                encoding_rs::WINDOWS_1251,
            ),
            &["windows-1251"],
        ),
        dialect(
            "GBK, Chinese",
            coded(
                &named(["时间 (s)", "位移 (um)", "试验力 (N)"]),
                encoding_rs::GBK,
            ),
            &["GBK"],
        ),
        dialect(
            "Shift_JIS, Japanese",
            coded(
                &named(["時間 (s)", "変位 (um)", "荷重 (N)"]),
                encoding_rs::SHIFT_JIS,
            ),
            &["Shift_JIS"],
        ),
        dialect(
            "a sign that is no UTF-8 far behind",
            late,
            &["is read as windows-1252", "left out"],
        ),
    ]
}
