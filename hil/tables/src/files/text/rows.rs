//! A text's head consists of rows: cells, comments and blank lines.

use super::lines::{QUOTED_LINES, Separator};

/// A row of the head.
pub(super) struct Row<'t> {
    /// Its first line, counted from 1.
    pub line: u64,
    /// Without the comment sign.
    pub text: &'t str,
    pub kind: RowKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowKind {
    Blank,
    Comment,
    Cells,
}

/// The rows of the head. A quoted cell may span several lines.
pub(super) fn rows(text: &str, separator: Separator) -> Vec<Row<'_>> {
    let lines = physical(text);
    let mut rows = Vec::new();
    let mut index = 0;
    while index < lines.len() {
        let (start, end) = lines[index];
        let mut last = index;
        if text[start..end].contains('"') && separator.is_open(&text[start..end]) {
            let upto = lines.len().min(index + QUOTED_LINES);
            let closed =
                (index + 1..upto).find(|&last| !separator.is_open(&text[start..lines[last].1]));
            last = closed.unwrap_or(index);
        }
        let whole = &text[start..lines[last].1];
        let (text, kind) = kind_of(whole, separator);
        rows.push(Row {
            line: index as u64 + 1,
            text,
            kind,
        });
        index = last + 1;
    }
    rows
}

/// Begin and end of each line.
fn physical(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let mut lines = Vec::new();
    let mut start = 0;
    let mut at = 0;
    while at < bytes.len() {
        if matches!(bytes[at], b'\n' | b'\r') {
            lines.push((start, at));
            at += usize::from(bytes[at] == b'\r' && bytes.get(at + 1) == Some(&b'\n'));
            start = at + 1;
        }
        at += 1;
    }
    if start < bytes.len() {
        lines.push((start, bytes.len()));
    }
    lines
}

/// Whether a line is blank or a comment, and its text.
pub(super) fn kind_of(line: &str, separator: Separator) -> (&str, RowKind) {
    let bare = line.trim();
    if bare.is_empty() {
        return (bare, RowKind::Blank);
    }
    for sign in ["#", "%", "//", ";"] {
        // A line that begins with the separator begins with an empty cell.
        let divides = sign == ";" && separator == Separator::Sign(';');
        if !divides && let Some(comment) = bare.strip_prefix(sign) {
            return (comment.trim_start_matches(sign).trim(), RowKind::Comment);
        }
    }
    (line, RowKind::Cells)
}
