//! The rows of a comma-separated text as they pass: its comments, and the memory that its longest row takes.

use mesh_damper_output::error::{InputError, Place};

use crate::budget::Budget;
use crate::write::unguarded;

/// Bytes held for a byte of a row and for a cell of it: the reader of rows holds a row, and again without blanks around its cells, in
/// buffers that double as they grow.
const OF_BYTE: u64 = 3;
const OF_CELL: u64 = 24;
/// Bytes held for a comment besides its text, and for a byte of the one that is still read.
const OF_COMMENT: u64 = 64;
const OF_OPEN_COMMENT: u64 = 2;

/// What has passed of a text.
#[derive(Default)]
pub(super) struct Records {
    /// Number of line ends.
    pub ends: u64,
    keeps_comments: bool,
    holds_rows: bool,
    within: Within,
    /// Bytes and separators of this row so far.
    bytes: u64,
    cells: u64,
    /// Bytes held for the longest row so far, and for the longest comment while it was read.
    of_row: u64,
    of_comment: u64,
    comments: Vec<String>,
    comment: Vec<u8>,
}

/// The part of a row in which the next byte stands, as the reader of rows takes it.
#[derive(Clone, Copy, Default, PartialEq)]
enum Within {
    /// Before a row.
    #[default]
    None,
    /// Before a cell.
    Row,
    Cell,
    Quotes,
    /// After a quote in quotes, which ends the cell or is the first of two.
    Quote,
    Comment,
}

impl Records {
    /// Keeps the lines from here on that begin with `#`, outside quoted cells.
    pub fn keep_comments(&mut self) {
        self.keeps_comments = true;
    }

    /// Charges for the rows from here on, because a reader holds them one by one.
    pub fn hold_rows(&mut self) {
        self.keeps_comments = true;
        self.holds_rows = true;
    }

    pub fn into_comments(self) -> Vec<String> {
        self.comments
    }

    /// Passes `text`, which is about to be read.
    ///
    /// # Errors
    /// A row or a comment for which the budget has no room, with its line.
    pub fn pass(&mut self, text: &[u8], budget: &Budget) -> Result<(), InputError> {
        if !self.keeps_comments {
            self.ends += text.iter().filter(|&&byte| byte == b'\n').count() as u64;
            return Ok(());
        }
        let mut begin = 0;
        for (at, &byte) in text.iter().enumerate() {
            let is_ended = matches!(byte, b'\n' | b'\r');
            self.within = match self.within {
                Within::Comment => {
                    if byte == b'\n' {
                        self.end(budget)?;
                        begin = at + 1;
                        Within::None
                    } else {
                        self.comment.push(byte);
                        Within::Comment
                    }
                }
                Within::Quotes => match byte {
                    b'"' => Within::Quote,
                    _ => Within::Quotes,
                },
                Within::None if byte == b'#' => Within::Comment,
                _ if is_ended => {
                    self.bytes += (at - begin) as u64;
                    begin = at + 1;
                    self.row(budget)?;
                    (self.bytes, self.cells) = (0, 0);
                    Within::None
                }
                Within::None | Within::Row | Within::Quote if byte == b'"' => Within::Quotes,
                _ if byte == b',' => {
                    self.cells += 1;
                    Within::Row
                }
                _ => Within::Cell,
            };
            self.ends += u64::from(byte == b'\n');
        }
        match self.within {
            Within::Comment => {
                let open = OF_OPEN_COMMENT * self.comment.len() as u64;
                let held = self.placed(budget.hold(open.saturating_sub(self.of_comment), COMMENTS));
                self.of_comment = self.of_comment.max(open);
                held
            }
            _ => {
                self.bytes += (text.len() - begin) as u64;
                self.row(budget)
            }
        }
    }

    /// Charges for a row, as far as it has passed.
    fn row(&mut self, budget: &Budget) -> Result<(), InputError> {
        let takes = OF_BYTE * self.bytes + OF_CELL * self.cells;
        if !self.holds_rows || takes <= self.of_row {
            return Ok(());
        }
        let more = takes - self.of_row;
        self.of_row = takes;
        self.placed(budget.hold(more, "its longest row"))
    }

    /// Ends a comment, if one is open.
    ///
    /// # Errors
    /// The budget has no room for it.
    pub fn end(&mut self, budget: &Budget) -> Result<(), InputError> {
        if self.within != Within::Comment {
            return Ok(());
        }
        self.within = Within::None;
        self.placed(budget.hold(OF_COMMENT + self.comment.len() as u64, COMMENTS))?;
        // As the line was written, with its sign.
        let line = format!("#{}", String::from_utf8_lossy(&self.comment));
        let line = unguarded(&line);
        let text = line.strip_prefix('#').unwrap_or(&line);
        self.comments.push(text.trim().replace('\r', " "));
        self.comment.clear();
        Ok(())
    }

    fn placed(&self, held: Result<(), InputError>) -> Result<(), InputError> {
        held.map_err(|error| error.at(Place::Line(1 + self.ends)))
    }
}

const COMMENTS: &str = "its comments";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_limit::ReadLimit;

    fn passed(text: &str, limit: u64, parts: usize) -> Result<(Vec<String>, u64), String> {
        let budget = Budget::new("a.csv", ReadLimit::new(limit));
        let mut records = Records::default();
        records.hold_rows();
        let mut pass = || {
            for part in text.as_bytes().chunks(parts) {
                records.pass(part, &budget)?;
            }
            records.end(&budget)
        };
        pass().map_err(|error| error.to_string())?;
        Ok((records.into_comments(), budget.used().0))
    }

    #[test]
    fn comments_stand_outside_of_quotes_however_the_text_arrives() {
        let text = "# a \n1,2 # b\n\"\n# c\",5\"\n#d\r\n#\n\"x\"\"\n#e\",\n # f\n#g";
        for parts in [1, 2, 3, 100] {
            let (comments, _) = passed(text, 1 << 20, parts).unwrap();
            assert_eq!(comments, ["a", "d", "", "g"], "{parts}");
        }
    }

    #[test]
    fn a_row_and_a_comment_are_charged_once_at_their_longest() {
        let row = |cells: usize| ",".repeat(cells) + "\n";
        let held = |text: &str| passed(text, 1 << 20, 7).unwrap().1;
        assert_eq!(held(&row(100)), 100 * (OF_BYTE + OF_CELL));
        assert_eq!(held(&(row(100) + &row(90) + &row(100))), held(&row(100)));
        // The lines of a quoted cell are one row.
        let quoted = "\"".to_owned() + &"\n".repeat(50) + "\"\n";
        assert_eq!(held(&quoted), 52 * OF_BYTE);
        assert_eq!(held("#abcd\n"), OF_COMMENT + 4);
        // Of one that is longer than what is read at a time, the part before is held too.
        assert_eq!(held("#abcdefgh\n"), OF_COMMENT + 8 + OF_OPEN_COMMENT * 6);
    }

    #[test]
    fn what_takes_too_much_is_refused_with_its_line() {
        let many = "#\n".repeat(10_000);
        let long = "1,2\n".to_owned() + &",".repeat(10_000);
        for (text, part, line) in [(many, "its comments", 2048), (long, "its longest row", 2)] {
            let error = passed(&text, 8 * OF_COMMENT * 2047, 1 << 10).unwrap_err();
            assert!(error.contains(part), "{error}");
            assert!(error.contains(&format!("line {line}")), "{error}");
        }
    }
}
