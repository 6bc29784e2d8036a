//! The lines of a text, and the cells of a line.

use std::io::{self, BufRead, BufReader, Read};
use std::rc::Rc;

use mesh_damper_output::error::InputError;

use crate::budget::Budget;
use crate::csv_text::{CsvText, found_wrong};
use crate::room::Room;

/// Largest number of lines in a quoted cell.
pub(super) const QUOTED_LINES: usize = 16;

/// Separator of the cells in a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    /// A character.
    Sign(char),
    /// Any number of blanks and tabs.
    Blanks,
}

impl Separator {
    /// The separators to try, the most distinctive first.
    pub const ALL: [Self; 5] = [
        Self::Sign('\t'),
        Self::Sign(';'),
        Self::Sign('|'),
        Self::Sign(','),
        Self::Blanks,
    ];

    /// Its name in messages.
    pub fn name(self) -> String {
        match self {
            Self::Sign('\t') => "a tab".into(),
            Self::Sign(';') => "a semicolon".into(),
            Self::Sign(',') => "a comma".into(),
            Self::Sign('|') => "a bar |".into(),
            Self::Sign(' ') | Self::Blanks => "blanks".into(),
            Self::Sign(sign) => format!("{sign:?}"),
        }
    }

    /// Puts the cells of a line into `cells`, without the blanks around them and the quotes about them. The quote of a cell that
    /// the line does not end is an ordinary character.
    pub fn split<'t>(self, line: &'t str, cells: &mut Vec<&'t str>) {
        cells.clear();
        let sign = match self {
            Self::Sign(sign) => sign,
            Self::Blanks => return split_at_blanks(line, cells),
        };
        if !line.contains('"') {
            cells.extend(line.split(sign).map(str::trim));
            return;
        }
        let mut rest = line;
        loop {
            let begin = rest.trim_start_matches(|c: char| c != sign && c.is_whitespace());
            let quoted = begin.strip_prefix('"').and_then(|inner| {
                let end = closing(inner)?;
                let behind = &inner[end + 1..];
                let stop = behind.find(sign).unwrap_or(behind.len());
                behind[..stop]
                    .trim()
                    .is_empty()
                    .then_some((&inner[..end], &behind[stop..]))
            });
            let (cell, behind) = quoted.unwrap_or_else(|| {
                let stop = rest.find(sign).unwrap_or(rest.len());
                (rest[..stop].trim(), &rest[stop..])
            });
            cells.push(cell.trim());
            match behind.strip_prefix(sign) {
                Some(behind) => rest = behind,
                None => return,
            }
        }
    }

    /// The largest number of cells that a line may have.
    pub fn most_cells(self, line: &str) -> usize {
        match self {
            Self::Sign(sign) => 1 + line.matches(sign).count(),
            Self::Blanks => line.split_whitespace().count(),
        }
    }

    /// Whether a quoted cell begins in the line and does not end in it; or, if one `was_open` before it, whether it is open after it.
    pub fn is_open(self, line: &str, was_open: bool) -> bool {
        let Self::Sign(sign) = self else { return false };
        let mut rest = line;
        if was_open {
            match closing(line) {
                Some(end) => rest = &line[end + 1..],
                None => return true,
            }
        }
        loop {
            let Some(at) = rest.find('"') else {
                return false;
            };
            let before = rest[..at].trim_end_matches(|c: char| c != sign && c.is_whitespace());
            let begins = before.is_empty() || before.ends_with(sign);
            let inner = &rest[at + 1..];
            if !begins {
                rest = inner;
                continue;
            }
            match closing(inner) {
                Some(end) => rest = &inner[end + 1..],
                None => return true,
            }
        }
    }
}

/// Position of the quote that ends a cell; two quotes are one within it.
fn closing(inner: &str) -> Option<usize> {
    let bytes = inner.as_bytes();
    let mut at = 0;
    while let Some(next) = bytes[at..].iter().position(|&byte| byte == b'"') {
        at += next;
        if bytes.get(at + 1) != Some(&b'"') {
            return Some(at);
        }
        at += 2;
    }
    None
}

fn split_at_blanks<'t>(line: &'t str, cells: &mut Vec<&'t str>) {
    let mut rest = line.trim();
    while !rest.is_empty() {
        let quoted = rest.strip_prefix('"').and_then(|inner| {
            let end = closing(inner)?;
            let behind = &inner[end + 1..];
            (behind.is_empty() || behind.starts_with(char::is_whitespace))
                .then_some((&inner[..end], behind))
        });
        let (cell, behind) = quoted.unwrap_or_else(|| {
            let stop = rest.find(char::is_whitespace).unwrap_or(rest.len());
            rest.split_at(stop)
        });
        cells.push(cell.trim());
        rest = behind.trim_start();
    }
}

/// The cells of one line after the other.
pub(super) struct Cells<'t, 'b> {
    cells: Vec<&'t str>,
    room: Room<'b>,
}

/// Bytes of a line up to which its cells are not charged: they are less than a buffer of the file.
const SHORT: usize = 1 << 12;
/// Bytes held for a cell of a line.
pub(super) const OF_CELL: u64 = size_of::<&str>() as u64;
/// Bytes held for a byte of a row, in a buffer that doubles as it grows.
const OF_LINE: u64 = 2;
/// Steps of work for a cell that is examined, and for a line.
const STEPS_OF_CELL: u64 = 2;
const STEPS_OF_LINE: u64 = 4;

impl<'t, 'b> Cells<'t, 'b> {
    pub fn of(budget: &'b Budget) -> Self {
        Self {
            cells: Vec::new(),
            room: Room::of(budget),
        }
    }

    /// The cells of a line, which are examined.
    ///
    /// # Errors
    /// The budget has no room for them.
    pub fn split(&mut self, separator: Separator, line: &'t str) -> Result<&[&'t str], InputError> {
        if line.len() > SHORT {
            let most = separator.most_cells(line);
            let part = "the cells of its longest row";
            self.room.at_least(OF_CELL * most as u64, part)?;
            self.cells.clear();
            self.cells.reserve_exact(most);
        }
        separator.split(line, &mut self.cells);
        let steps = STEPS_OF_LINE + STEPS_OF_CELL * self.cells.len() as u64;
        self.room
            .budget()
            .work(steps, "the cells of its first rows")?;
        Ok(&self.cells)
    }
}

/// The lines of a text, one after the other.
pub(super) struct Lines<R> {
    from: BufReader<R>,
    budget: Rc<Budget>,
    /// Number of lines so far.
    count: u64,
    after_return: bool,
    bytes: Vec<u8>,
    /// Bytes held for the longest line so far, and for the cells of the longest row.
    of_line: u64,
    of_cells: u64,
}

/// A line that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Line {
    /// Counted from 1.
    pub number: u64,
    /// Whether it has a line end: a line at the end of the file without one may have been cut.
    pub has_end: bool,
}

impl<'a> Lines<CsvText<'a>> {
    /// Appends the next line, or the lines of a quoted cell, to `text`; `None` at the end.
    pub fn row(
        &mut self,
        separator: Separator,
        text: &mut String,
    ) -> Result<Option<Line>, InputError> {
        text.clear();
        let Some(mut line) = self.next(text)? else {
            return Ok(None);
        };
        let mut more = 1;
        let mut is_open = text.contains('"') && separator.is_open(text, false);
        while is_open && more < QUOTED_LINES {
            text.push('\n');
            let begin = text.len();
            match self.next(text)? {
                Some(next) => line.has_end = next.has_end,
                None => break,
            }
            is_open = separator.is_open(&text[begin..], true);
            more += 1;
        }
        self.charge(separator, text)?;
        Ok(Some(line))
    }

    /// Charges for the cells of a row, if it is the longest so far.
    fn charge(&mut self, separator: Separator, row: &str) -> Result<(), InputError> {
        if row.len() > SHORT {
            // A vector of them doubles as it grows.
            let takes = 2 * OF_CELL * separator.most_cells(row) as u64;
            let more = takes.saturating_sub(self.of_cells);
            self.of_cells += more;
            self.budget.hold(more, "the cells of its longest row")?;
        }
        Ok(())
    }

    fn next(&mut self, text: &mut String) -> Result<Option<Line>, InputError> {
        self.read(text).map_err(|error| {
            let path = || self.from.get_ref().name();
            found_wrong(&error).unwrap_or_else(|| InputError::io(path().as_ref(), "read", &error))
        })
    }

    /// Passes over lines.
    pub fn skip(&mut self, count: u64) -> Result<(), InputError> {
        let mut text = String::new();
        while self.count < count && self.next(&mut text)?.is_some() {
            text.clear();
        }
        Ok(())
    }

    /// The text from which they were read.
    pub fn into_text(self) -> CsvText<'a> {
        self.from.into_inner()
    }

    /// The same, during reading.
    pub fn text(&self) -> &CsvText<'a> {
        self.from.get_ref()
    }
}

impl<R: Read> Lines<R> {
    /// Those of a text, which is taken in parts of `buffer` bytes.
    pub fn of(from: R, buffer: usize, budget: Rc<Budget>) -> Self {
        Self {
            from: BufReader::with_capacity(buffer, from),
            budget,
            count: 0,
            after_return: false,
            bytes: Vec::new(),
            of_line: 0,
            of_cells: 0,
        }
    }

    /// Appends the next line to `text`. A line ends with a line feed, a carriage return, or both.
    fn read(&mut self, text: &mut String) -> io::Result<Option<Line>> {
        self.bytes.clear();
        let mut has_end = false;
        while !has_end {
            let mut buffer = self.from.fill_buf()?;
            if buffer.is_empty() {
                break;
            }
            if std::mem::take(&mut self.after_return) && buffer[0] == b'\n' {
                self.from.consume(1);
                continue;
            }
            let end = buffer.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            if let Some(end) = end {
                self.after_return = buffer[end] == b'\r';
                buffer = &buffer[..end];
                has_end = true;
            }
            self.bytes.extend_from_slice(buffer);
            let taken = buffer.len() + usize::from(has_end);
            self.from.consume(taken);
            let long = text.len() + 2 * self.bytes.len();
            if long > SHORT {
                let takes = OF_LINE * long as u64;
                let more = takes.saturating_sub(self.of_line);
                self.of_line += more;
                (self.budget.hold(more, "its longest row")).map_err(io::Error::other)?;
            }
        }
        if self.bytes.is_empty() && !has_end {
            return Ok(None);
        }
        // The text arrives in whole characters.
        text.push_str(&String::from_utf8_lossy(&self.bytes));
        self.count += 1;
        Ok(Some(Line {
            number: self.count,
            has_end,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read_limit::ReadLimit;

    fn split(separator: Separator, line: &str) -> Vec<&str> {
        let mut cells = Vec::new();
        separator.split(line, &mut cells);
        cells
    }

    #[test]
    fn cells_are_divided_and_quotes_taken_off() {
        let comma = Separator::Sign(',');
        assert_eq!(split(comma, "1, 2 ,3"), ["1", "2", "3"]);
        assert_eq!(
            split(comma, "\"1,5\", \"a \"\"b\"\"\" ,"),
            ["1,5", "a \"\"b\"\"", ""]
        );
        assert_eq!(split(comma, "Gauge 5\", 3"), ["Gauge 5\"", "3"]);
        assert_eq!(split(comma, "\"open, 3"), ["\"open", "3"]);
        assert_eq!(split(comma, ""), [""]);
        assert_eq!(split(Separator::Sign('\t'), "a\t\tb\t"), ["a", "", "b", ""]);
        assert_eq!(
            split(Separator::Blanks, "  1.5\t 2 \"a b\" "),
            ["1.5", "2", "a b"]
        );
        assert!(comma.is_open("1,\"a", false));
        assert!(!comma.is_open("5\" x,2", false));
        assert!(!comma.is_open("\"a\"\"b\",2", false));
        // The next lines of a quoted cell.
        assert!(comma.is_open("b\"\"", true));
        assert!(!comma.is_open("b\",2", true));
        assert!(comma.is_open("b\",\"2", true));
    }

    #[test]
    fn each_line_end_ends_one_line() {
        let budget = Budget::new("a.csv", ReadLimit::default());
        let mut lines = Lines::of(&b"a\r\nb\rc\n\nd"[..], 4, Rc::new(budget));
        let mut all = Vec::new();
        let mut text = String::new();
        while let Some(line) = lines.read(&mut text).unwrap() {
            all.push((std::mem::take(&mut text), line.number, line.has_end));
        }
        let expected = [
            ("a", true),
            ("b", true),
            ("c", true),
            ("", true),
            ("d", false),
        ];
        for (index, (text, has_end)) in expected.into_iter().enumerate() {
            assert_eq!(all[index], (text.to_owned(), index as u64 + 1, has_end));
        }
        assert_eq!(all.len(), 5);
    }
}
