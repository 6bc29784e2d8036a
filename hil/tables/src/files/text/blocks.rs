//! Words between the numbers of a text and after them: a repeated header, and a footer.

use mesh_damper_output::error::{InputError, Place};

use super::header::{bare, in_comment};
use super::layout::{FEW_ROWS, Layout};
use crate::budget::Budget;
use crate::columns;
use crate::room::Room;

/// The blocks of numbers of a text so far.
pub(super) struct Blocks<'b> {
    name: &'b str,
    layout: &'b Layout,
    budget: &'b Budget,
    after_blank: bool,
    /// The first line of numbers after the last blank line between them, and their number.
    apart: Option<(u64, usize)>,
    between: Option<Between>,
    again: Again,
    has_numbers: bool,
}

/// Rows of words after numbers.
struct Between {
    line: u64,
    rows: u64,
    /// Rows of numbers among them, and the line of the first.
    of_numbers: usize,
    numbers_line: u64,
    /// Rows of the header found in it.
    met: usize,
}

/// Number of rows after a blank line above which a note says that they are read. Convention: sums and means have fewer.
const FEW: usize = 4;
/// Steps of work for a comment that may name other columns, for a row of words, and for a cell of it.
const STEPS_OF_COMMENT: u64 = 32;
const STEPS_OF_WORDS: u64 = 100;
const STEPS_OF_CELL: u64 = 4;
/// Largest number of lines in a note.
const NAMED: usize = 3;

/// Blocks of rows below a repeated header.
#[derive(Default)]
pub(super) struct Again {
    /// The first lines above which the numbers paused.
    lines: Vec<u64>,
    count: usize,
}

impl Again {
    /// Another block begins below the words from `line` on.
    ///
    /// # Errors
    /// The times come from a rate, which does not say when the block begins.
    pub fn begins(&mut self, name: &str, line: u64, has_clock: bool) -> Result<(), InputError> {
        if has_clock {
            return Err(InputError::new(
                name,
                "a second block of rows begins, and no column has its times",
                "put it into a file of its own, or write a column of times",
            )
            .at(Place::Line(line)));
        }
        self.count += 1;
        if self.lines.len() < NAMED {
            self.lines.push(line);
        }
        Ok(())
    }

    /// That it is read as one recording, in words.
    pub fn note(&self) -> Option<String> {
        let lines: Vec<String> = self.lines.iter().map(u64::to_string).collect();
        let more = if self.count > NAMED { " and on" } else { "" };
        (self.count > 0).then(|| {
            format!(
                "the header is written again from line {}{more}: its {} blocks are read as one recording",
                lines.join(", "),
                self.count + 1
            )
        })
    }
}

impl<'b> Blocks<'b> {
    pub fn of(name: &'b str, layout: &'b Layout, budget: &'b Budget) -> Self {
        Self {
            name,
            layout,
            budget,
            after_blank: false,
            apart: None,
            between: None,
            again: Again::default(),
            has_numbers: false,
        }
    }

    /// A blank line.
    pub fn blank(&mut self) {
        self.after_blank = true;
    }

    /// Whether the numbers have paused: words are then not a damaged number.
    pub fn is_paused(&self) -> bool {
        self.has_words() || (self.after_blank && self.has_numbers)
    }

    /// Whether words follow the last numbers.
    pub fn has_words(&self) -> bool {
        self.between.is_some()
    }

    /// A comment, in a text with names in comments: other names or units in it mean other columns.
    pub fn comment(&self, line: u64, text: &str) -> Result<(), InputError> {
        let layout = self.layout;
        if !layout.is_named_in_comment {
            return Ok(());
        }
        self.budget.work(STEPS_OF_COMMENT, "its comments")?;
        let mut room = Room::of(self.budget);
        let cells = in_comment(text, layout.cells, layout.separator, &mut room)?;
        let Some(cells) = cells else {
            return Ok(());
        };
        let is_known = |known: &Vec<String>| *known == bare(&cells);
        let is_header = cells
            .iter()
            .any(|cell| columns::is_named(cell) || columns::spelling::is_unit(cell));
        if !is_header || layout.repeated.iter().any(is_known) {
            return Ok(());
        }
        Err(InputError::new(
            self.name,
            "a comment names other columns or units than that above the numbers",
            "put what follows into a file of its own",
        )
        .at(Place::Line(line)))
    }

    /// A row of words, or a row of numbers that does not have the form of those above.
    pub fn odd(
        &mut self,
        line: u64,
        cells: &[&str],
        is_of_numbers: bool,
    ) -> Result<(), InputError> {
        self.after_blank = false;
        let steps = STEPS_OF_WORDS + STEPS_OF_CELL * cells.len() as u64;
        self.budget.work(steps, "its rows of words")?;
        let between = self.between.get_or_insert(Between {
            line,
            rows: 0,
            of_numbers: 0,
            numbers_line: line,
            met: 0,
        });
        between.rows += 1;
        if is_of_numbers {
            if between.of_numbers == 0 {
                between.numbers_line = line;
            }
            between.of_numbers += 1;
        }
        if between.of_numbers >= FEW_ROWS {
            let (begin, first) = (between.numbers_line, self.layout.data_line);
            return Err(InputError::new(
                self.name,
                format!(
                    "another table begins here, with rows of numbers from line {begin} on; the one that is read begins in line {first}"
                ),
                "put each table into a file of its own",
            )
            .at(Place::Line(between.line)));
        }
        let row = bare(cells);
        let is = |known: &[String]| {
            known.len() == row.len() && known.iter().zip(row).all(|(known, cell)| same(known, cell))
        };
        if let Some(changed) =
            self.layout.fixed.iter().find(|known| {
                known.first().map(String::as_str) == row.first().copied() && !is(known)
            })
        {
            return Err(InputError::new(
                self.name,
                format!("{} is not what it is above", changed[0]),
                "put what follows into a file of its own",
            )
            .at(Place::Line(line)));
        }
        let expected = self.layout.repeated.get(between.met);
        if expected.is_some_and(|known| is(known)) {
            between.met += 1;
        } else if between.met > 0 && between.met < self.layout.repeated.len() {
            return Err(InputError::new(
                self.name,
                "the header is written again with other units or names",
                "put what follows into a file of its own",
            )
            .at(Place::Line(line)));
        }
        Ok(())
    }

    /// A row of numbers.
    pub fn numbers(&mut self, line: u64) -> Result<(), InputError> {
        let is_apart = std::mem::take(&mut self.after_blank) && self.has_numbers;
        self.apart = match self.apart {
            _ if is_apart => Some((line, 1)),
            Some((first, rows)) => Some((first, rows + 1)),
            None => None,
        };
        self.has_numbers = true;
        let Some(between) = self.between.take() else {
            return Ok(());
        };
        if between.met == 0 || between.met < self.layout.repeated.len() {
            return Err(InputError::new(
                self.name,
                format!("words stand between rows of numbers, which go on in line {line} without the header"),
                "remove the words, or put what follows into a file of its own",
            )
            .at(Place::Line(between.line)));
        }
        let (name, has_clock) = (self.name, self.layout.has_clock);
        self.again.begins(name, between.line, has_clock)
    }

    /// The parts left out, in words.
    pub fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = self.again.note().into_iter().collect();
        if let Some((line, rows)) = self.apart.filter(|&(_, rows)| rows < FEW) {
            let rows = if rows == 1 { "row" } else { "rows" };
            notes.push(format!(
                "the last {rows} of numbers, from line {line} on, after a blank line, are read as samples; if they are sums or statistics, delete them"
            ));
        }
        if let Some(between) = &self.between {
            let rows = if between.rows == 1 { "row" } else { "rows" };
            let of_numbers = match between.of_numbers {
                0 => String::new(),
                count => format!(", including {count} of numbers in another form"),
            };
            notes.push(format!(
                "{} {rows} of words at the end, from line {} on, are left out{of_numbers}",
                between.rows, between.line
            ));
        }
        notes
    }
}

/// Whether two cells are the same, apart from blanks and quotes.
fn same(known: &str, cell: &str) -> bool {
    let words = |text: &str| {
        text.replace("\"\"", "\"")
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
    };
    known == cell || words(known) == words(cell)
}
