//! Texts in a CSV that a spreadsheet would take for a formula.
//!
//! A spreadsheet computes a cell that begins with `=`, and with some other signs, and a formula can send the sheet's contents away or
//! start a program. Names come from files of others. So an apostrophe stands before such a text in every CSV that is written, and the
//! readers of CSV take it off.

use std::borrow::Cow;

/// The signs with which a formula begins: those of Excel and LibreOffice, and their wide forms.
const BEGINS: [char; 10] = [
    '=', '+', '-', '@', '\t', '\r', '\u{ff1d}', '\u{ff0b}', '\u{ff0d}', '\u{ff20}',
];
/// The signs at which a cell may end: which one does, is a setting of the spreadsheet.
const ENDS: [char; 5] = [',', ';', '\t', '\n', '\r'];
/// The sign in which a cell may stand, which begins behind it.
const QUOTE: char = '"';
const GUARD: char = '\'';

/// `text` for a cell or a comment of a CSV: with an apostrophe before each part that a spreadsheet would take for a formula. A number is
/// none.
///
/// ```
/// use mesh_damper_tables::write::{guarded, unguarded};
///
/// assert_eq!(guarded("=1+2"), "'=1+2");
/// assert_eq!(guarded("-1.5"), "-1.5");
/// assert_eq!(unguarded("'=1+2"), "=1+2");
/// ```
pub fn guarded(text: &str) -> Cow<'_, str> {
    let mut whole = String::new();
    let mut copied = 0;
    for (begin, _) in formulas(text) {
        whole += &text[copied..begin];
        whole.push(GUARD);
        copied = begin;
    }
    if whole.is_empty() {
        return text.into();
    }
    (whole + &text[copied..]).into()
}

/// The text that [`guarded`] made `text` of.
pub fn unguarded(text: &str) -> Cow<'_, str> {
    let mut whole = String::new();
    let mut copied = 0;
    for (begin, _) in formulas(text).filter(|(_, guards)| *guards > 0) {
        whole += &text[copied..begin];
        copied = begin + GUARD.len_utf8();
    }
    if copied == 0 {
        return text.into();
    }
    (whole + &text[copied..]).into()
}

/// A comment line of a CSV, with its end.
pub fn comment_line(comment: &str) -> String {
    let line = format!("# {}", comment.replace(['\n', '\r'], " "));
    format!("{}\n", guarded(&line))
}

/// Where a cell may begin that is a formula behind apostrophes, and how many those are.
fn formulas(text: &str) -> impl Iterator<Item = (usize, usize)> {
    let ends = text.match_indices(ENDS);
    let begins = std::iter::once(0).chain(ends.map(|(at, sign)| at + sign.len()));
    begins.filter_map(|begin| {
        let cell = &text[begin..];
        let bare = cell.trim_start_matches(GUARD);
        let inner = bare.trim_start_matches(QUOTE);
        (inner.starts_with(BEGINS) && !is_number(inner)).then(|| (begin, cell.len() - bare.len()))
    })
}

/// Whether all of a text is a number: what follows one may be a part of its formula.
fn is_number(text: &str) -> bool {
    let number = text.replacen(',', ".", 1);
    number.parse().is_ok_and(f64::is_finite)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a sheet whose cells end at `sign` has a formula in a line. A sign alone is none.
    fn computes(line: &str, sign: u8) -> bool {
        let mut rows = csv::ReaderBuilder::new();
        rows.has_headers(false).flexible(true).delimiter(sign);
        let is_formula = |cell: &str| {
            cell.starts_with(BEGINS) && cell.chars().count() > 1 && !is_number(cell.trim())
        };
        let mut rows = rows.from_reader(line.as_bytes());
        (rows.records()).any(|row| row.unwrap().iter().any(is_formula))
    }

    #[test]
    fn a_formula_is_guarded_wherever_a_cell_may_begin() {
        for (text, written) in [
            ("", ""),
            ("force_kN", "force_kN"),
            ("-0.125", "-0.125"),
            ("+1e-3", "+1e-3"),
            ("-1,5", "-1,5"),
            ("a, -b", "a, -b"),
            ("=HYPERLINK(\"http://a\")", "'=HYPERLINK(\"http://a\")"),
            ("-2+3", "'-2+3"),
            ("-1,5+cmd|' /C calc'!A0", "'-1,5+cmd|' /C calc'!A0"),
            ("-1;2", "'-1;2"),
            ("-", "'-"),
            ("-inf", "'-inf"),
            ("@SUM(A1)", "'@SUM(A1)"),
            ("\tx", "'\tx"),
            ("\r=x", "'\r'=x"),
            ("\u{ff1d}1", "'\u{ff1d}1"),
            ("it's", "it's"),
            ("'=x", "''=x"),
            ("'quoted'", "'quoted'"),
            ("a.csv;=b.csv", "a.csv;'=b.csv"),
            ("a,b,+c;''@d", "a,b,'+c;'''@d"),
            ("a,\"=x\"", "a,'\"=x\""),
            ("a;'\"\"=x", "a;''\"\"=x"),
        ] {
            assert_eq!(guarded(text), written);
            assert_eq!(unguarded(written), text);
        }
    }

    #[test]
    fn a_comment_is_one_line_without_a_formula() {
        assert_eq!(comment_line("ring 3, =x,=y\n-z"), "# ring 3, =x,'=y -z\n");
        let comment = "note,\"=HYPERLINK(\"\"http://a\"\")\"";
        assert!(computes(comment, b','));
        assert_eq!(comment_line(comment), format!("# {}\n", guarded(comment)));
    }

    /// All texts of up to five of these signs, alone and as comments.
    #[test]
    fn what_is_guarded_is_no_formula_and_is_read_back() {
        const SIGNS: [char; 9] = ['-', '\'', '"', '=', '1', ',', ';', '\t', 'a'];
        let mut texts = vec![String::new()];
        for _ in 0..5 {
            let longer = texts
                .iter()
                .flat_map(|text| SIGNS.map(|sign| format!("{text}{sign}")));
            texts = std::iter::once(String::new()).chain(longer).collect();
            for text in &texts {
                let written = guarded(text);
                let mut formulas = formulas(&written);
                assert!(formulas.all(|(_, guards)| guards > 0), "{written:?}");
                assert_eq!(unguarded(&written), *text);
                for line in [&*written, &comment_line(text)] {
                    assert!(
                        ![b',', b';', b'\t'].iter().any(|&sign| computes(line, sign)),
                        "{line:?}"
                    );
                }
            }
        }
    }
}
