//! A text's head consists of rows: cells, comments and blank lines.

use mesh_damper_output::error::InputError;

use super::lines::{QUOTED_LINES, Separator};
use crate::room::Room;

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

/// Steps of work for a line of the head.
const STEPS: u64 = 4;

/// The lines of the head: begin and end of each. `room` holds them.
///
/// # Errors
/// The budget has no room for them.
pub(super) fn lines(text: &str, room: &mut Room) -> Result<Vec<(usize, usize)>, InputError> {
    let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
    let most = 1 + text.bytes().filter(|byte| is_end(byte)).count();
    let size = size_of::<(usize, usize)>();
    room.more((size * most) as u64, "its first lines")?;
    let bytes = text.as_bytes();
    let mut lines = Vec::with_capacity(most);
    let mut start = 0;
    let mut at = 0;
    while at < bytes.len() {
        if is_end(&bytes[at]) {
            lines.push((start, at));
            at += usize::from(bytes[at] == b'\r' && bytes.get(at + 1) == Some(&b'\n'));
            start = at + 1;
        }
        at += 1;
    }
    if start < bytes.len() {
        lines.push((start, bytes.len()));
    }
    Ok(lines)
}

/// The rows of these lines of `text`. A quoted cell may span several lines. `room` holds the rows.
///
/// # Errors
/// The budget has no room for them.
pub(super) fn rows<'t>(
    text: &'t str,
    lines: &[(usize, usize)],
    separator: Separator,
    room: &mut Room,
) -> Result<Vec<Row<'t>>, InputError> {
    let part = "its first lines";
    room.more((size_of::<Row>() * lines.len()) as u64, part)?;
    (room.budget()).work(STEPS * lines.len() as u64, part)?;
    let mut rows = Vec::with_capacity(lines.len());
    let mut index = 0;
    while index < lines.len() {
        let (start, end) = lines[index];
        let mut last = index;
        if text[start..end].contains('"') && separator.is_open(&text[start..end], false) {
            let upto = lines.len().min(index + QUOTED_LINES);
            let closed = (index + 1..upto)
                .find(|&last| !separator.is_open(&text[lines[last].0..lines[last].1], true));
            last = closed.unwrap_or(index);
            // Without an end of the quotes, the lines are passed again one by one.
            let passed = lines[closed.unwrap_or(upto - 1)].1 - start;
            (room.budget()).work(passed as u64, "its quoted cells")?;
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
    Ok(rows)
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
