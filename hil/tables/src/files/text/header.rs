//! The names of a text's columns, and their units, in the rows above the numbers.

use std::collections::{HashMap, HashSet};

use mesh_damper_output::error::{InputError, quoted};

use super::lines::{Cells, Separator};
use super::numbers;
use super::rows::{Row, RowKind};
use crate::budget::Budget;
use crate::columns;
use crate::room::Room;
use crate::write::unguarded;

/// Largest number of rows in a header: names, units, and additions of some programs.
const MOST_ROWS: usize = 4;
/// Largest number of blank lines between a header and its numbers.
const MOST_BLANK: usize = 2;

/// Steps of work for a cell that is looked up as a name and as a unit.
const STEPS_OF_NAME: u64 = 100;
/// Bytes held for a cell as a text of its own, besides its characters.
const OF_TEXT: u64 = 2 * size_of::<String>() as u64;

/// The rows above the numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Header {
    /// One name per column; empty for a column without a name.
    pub names: Vec<String>,
    /// One unit per column; empty for a column without a unit.
    pub units: Option<Vec<String>>,
    /// The line of the names, counted from 1; `None` without a header.
    pub line: Option<u64>,
    pub units_line: Option<u64>,
    /// The first line of both.
    pub first_line: Option<u64>,
    /// Whether the names are in a comment.
    pub is_comment: bool,
    /// Whether the number of names differs from the number of columns with contents.
    pub is_changed: bool,
    /// A row that looks like a header but has another number of cells, with its line.
    pub misfit: Option<(u64, usize)>,
    /// Rows of words below the names that are neither names nor units.
    pub passed: Vec<u64>,
    /// Number of names that mean a channel.
    pub named: usize,
    /// The rows of names and units as written.
    written: Vec<Vec<String>>,
}

/// A row of words.
struct Words {
    line: u64,
    cells: Vec<String>,
    /// Number of cells that mean a channel.
    named: usize,
    /// Whether it contains units: only units, or two of three cells and no name.
    is_of_units: bool,
}

impl Words {
    fn of(line: u64, cells: Vec<String>, budget: &Budget) -> Result<Self, InputError> {
        budget.work(STEPS_OF_NAME * cells.len() as u64, "its names")?;
        let (mut units, mut all, mut named, mut has_name) = (0, 0, 0, false);
        for cell in cells.iter().filter(|cell| !cell.is_empty()) {
            let (is_unit, is_named) = (columns::spelling::is_unit(cell), columns::is_named(cell));
            all += 1;
            units += usize::from(is_unit);
            named += usize::from(is_named);
            has_name |= is_named && !is_unit;
        }
        Ok(Self {
            line,
            cells,
            named,
            is_of_units: all > 0 && (units == all || (3 * units >= 2 * all && !has_name)),
        })
    }
}

impl Header {
    /// The header above the row of numbers at `first`, which has this many cells. `room` holds it.
    ///
    /// # Errors
    /// The budget has no room for it.
    pub fn above(
        rows: &[Row],
        first: usize,
        cells: usize,
        separator: Separator,
        room: &mut Room,
    ) -> Result<Self, InputError> {
        let mut texts: Vec<Words> = Vec::new();
        let mut comments: Vec<Words> = Vec::new();
        let mut misfit = None;
        let mut blank = 0;
        let mut figures = None;
        for row in rows[..first].iter().rev() {
            match row.kind {
                RowKind::Blank => {
                    blank += 1;
                    if blank > MOST_BLANK || !texts.is_empty() {
                        break;
                    }
                }
                RowKind::Comment => {
                    if texts.is_empty() && comments.len() < MOST_ROWS {
                        let words = in_comment(row.text, cells, separator, room)?;
                        let words = words.map(|words| Words::of(row.line, words, room.budget()));
                        comments.extend(words.transpose()?);
                    }
                }
                RowKind::Cells => {
                    let words = split(row.text, cells, separator, room)?;
                    if !is_wordy(&words) {
                        // Some programs write the rate of each column between its name and its unit.
                        let are_units = texts.iter().all(|row| row.is_of_units);
                        if figures.is_some()
                            || texts.is_empty()
                            || !are_units
                            || words.len() != cells
                        {
                            break;
                        }
                        figures = Some(row.line);
                        continue;
                    }
                    if !fits(words.len(), cells) {
                        let is_named = words.iter().any(|name| columns::is_named(name));
                        if texts.is_empty() && words.len() > 1 && is_named {
                            misfit = Some((row.line, words.len()));
                        }
                        break;
                    }
                    texts.push(Words::of(row.line, words, room.budget())?);
                    if texts.len() == MOST_ROWS {
                        break;
                    }
                }
            }
        }
        let is_comment = texts.is_empty() && misfit.is_none();
        let found = if is_comment { comments } else { texts };
        let mut header = Self::of(found);
        header.is_comment = is_comment && header.line.is_some();
        header
            .passed
            .extend(figures.filter(|&line| header.line.is_some_and(|names| names < line)));
        header.misfit = misfit;
        // The rows of names and of units are kept as written.
        let kept = header.written.iter().flatten();
        let kept = kept.map(|cell| OF_TEXT + cell.len() as u64).sum();
        room.more(kept, "its names")?;
        Ok(header)
    }

    /// Names and units among rows of words, the nearest to the numbers first.
    fn of(mut rows: Vec<Words>) -> Self {
        let units = rows.iter().position(|row| row.is_of_units);
        // In a single row single letters may be names as well: s and N.
        let is_sure = |index: &usize| {
            let mut cells = rows[*index].cells.iter();
            rows.len() > 1
                || cells.any(|unit| unit.chars().filter(|c| c.is_alphabetic()).count() > 1)
        };
        let units = units.filter(is_sure);
        let others = (0..rows.len()).filter(|&index| Some(index) != units);
        // The nearest of those with the most known names.
        let names = others.rev().max_by_key(|&index| rows[index].named);
        let is_below = |index: &usize| names.is_none_or(|names| *index < names);
        let passed = (0..rows.len())
            .rev()
            .filter(is_below)
            .filter(|&index| Some(index) != units);
        let passed = passed.map(|index| rows[index].line).collect();
        // Two rows of units contradict each other, so neither is used.
        let is_second = |index: &usize| Some(*index) != units && Some(*index) != names;
        let second = (0..rows.len()).filter(is_second);
        let second = second
            .map(|index| &rows[index])
            .find(|row| row.is_of_units)
            .map(|row| row.cells.clone());
        let line = |index: Option<usize>| index.map(|index| rows[index].line);
        let (names_line, units_line) = (line(names), line(units));
        let named = names.map_or(0, |index| rows[index].named);
        let mut taken =
            |index: Option<usize>| index.map(|index| std::mem::take(&mut rows[index].cells));
        let (names, mut units) = (taken(names), taken(units));
        if let (Some(units), Some(second)) = (&mut units, second) {
            for (unit, other) in units.iter_mut().zip(second) {
                if !other.is_empty() && *unit != other {
                    *unit = format!("{unit} beside {other}");
                }
            }
        }
        let written = [names.clone(), units.clone()]
            .into_iter()
            .flatten()
            .collect();
        // Units alone belong to columns without names.
        let nameless = || vec![String::new(); units.as_ref().map_or(0, Vec::len)];
        Self {
            names: names.unwrap_or_else(nameless),
            line: names_line.or(units_line),
            units_line,
            first_line: names_line.into_iter().chain(units_line).min(),
            units,
            passed,
            named,
            written,
            ..Self::default()
        }
    }

    /// Whether the names are in a separate line.
    pub fn is_line(&self) -> bool {
        self.line.is_some() && !self.is_comment
    }

    /// Adjusts the number of names to the number of cells in the rows, without nameless columns at the end that are `empty`.
    pub fn fit(&mut self, cells: usize, is_empty: &dyn Fn(usize) -> bool) {
        let written = self.names.len();
        if self.misfit.is_some() {
            return;
        }
        if self.line.is_some() && written < cells && !is_empty(cells - 1) {
            self.misfit = self.line.map(|line| (line, written));
            return;
        }
        self.names.resize(cells, String::new());
        if let Some(units) = &mut self.units {
            units.resize(cells, String::new());
        }
        while self.names.len() > 1
            && self.names.last().is_some_and(String::is_empty)
            && is_empty(self.names.len() - 1)
        {
            self.names.pop();
        }
        self.is_changed = written != self.names.len() || cells != self.names.len();
    }

    /// Number of names in the header as written.
    pub fn count(&self) -> usize {
        self.written.first().map_or(0, |names| bare(names).len())
    }

    /// The rows by which a repeated header is recognized.
    pub fn repeated(&self) -> Vec<Vec<String>> {
        self.written.iter().map(|row| bare(row).to_vec()).collect()
    }
}

/// A row without the empty cells at its end.
pub(super) fn bare<T: AsRef<str>>(cells: &[T]) -> &[T] {
    let is_full = |cell: &T| !cell.as_ref().is_empty();
    let count = cells.iter().rposition(is_full).map_or(0, |last| last + 1);
    &cells[..count]
}

/// Whether a row of this many cells may be above rows of `cells`: a row may end with one additional separator.
fn fits(count: usize, cells: usize) -> bool {
    count == cells || count + 1 == cells
}

/// The cells of a row of words above rows of `cells`, without additional empty ones at the end. `room` holds them.
fn split(
    text: &str,
    cells: usize,
    separator: Separator,
    room: &mut Room,
) -> Result<Vec<String>, InputError> {
    let mut split = Cells::of(room.budget());
    let words = split.split(separator, text)?;
    room.more(
        OF_TEXT * words.len() as u64 + text.len() as u64,
        "its names",
    )?;
    let mut words: Vec<String> = match separator {
        Separator::Blanks => at_blanks(text, words, cells, room)?,
        Separator::Sign(_) => words.iter().map(|word| cleaned(word)).collect(),
    };
    let is_more = |word: &String| word.is_empty() || word == super::lvm::REMARK;
    while words.len() > cells && words.last().is_some_and(is_more) {
        words.pop();
    }
    Ok(words)
}

/// A cell in one line, with doubled quotes made single.
fn cleaned(cell: &str) -> String {
    let cell = unguarded(cell);
    let words: Vec<&str> = cell.split_whitespace().collect();
    words.join(" ").replace("\"\"", "\"")
}

/// Names above columns of fixed width. A name is a single word, or has single blanks between its words, or ends with its unit in
/// brackets, or is a word followed by its unit.
fn at_blanks(
    text: &str,
    words: &[&str],
    cells: usize,
    room: &Room,
) -> Result<Vec<String>, InputError> {
    let all = || words.iter().map(|word| cleaned(word)).collect();
    if words.len() == cells {
        return Ok(all());
    }
    // Three more divisions of the text.
    let mut tried = Room::of(room.budget());
    let each = OF_TEXT * words.len() as u64 + text.len() as u64;
    tried.more(3 * each, "its names")?;
    let wide = text.replace('\t', "  ");
    let wide: Vec<String> = wide
        .split("  ")
        .map(cleaned)
        .filter(|name| !name.is_empty())
        .collect();
    if wide.len() == cells {
        return Ok(wide);
    }
    // A unit in brackets ends a name.
    let mut ended: Vec<String> = Vec::new();
    let mut is_ended = true;
    for word in words {
        match ended.last_mut() {
            Some(name) if !is_ended => {
                name.push(' ');
                name.push_str(word);
            }
            _ => ended.push((*word).to_owned()),
        }
        is_ended = word.ends_with([']', ')', '>', '}']);
    }
    if is_ended && ended.len() == cells {
        return Ok(ended);
    }
    let mut joined: Vec<String> = Vec::new();
    for word in words {
        match joined.last_mut() {
            Some(name) if word.starts_with(['[', '(', '<', '{', '/']) => {
                name.push(' ');
                name.push_str(word);
            }
            _ => joined.push((*word).to_owned()),
        }
    }
    Ok(match joined.len() == cells {
        true => joined,
        false => all(),
    })
}

/// The names in a comment, whose separator may differ from that of the numbers. `room` holds them.
///
/// # Errors
/// The budget has no room for them.
pub(super) fn in_comment(
    text: &str,
    cells: usize,
    separator: Separator,
    room: &mut Room,
) -> Result<Option<Vec<String>>, InputError> {
    // A cell takes a sign or a separator.
    if text.len() + 1 < cells {
        return Ok(None);
    }
    for separator in [separator].into_iter().chain(Separator::ALL) {
        let mut tried = Room::of(room.budget());
        let words = split(text, cells, separator, &mut tried)?;
        if words.len() == cells && is_wordy(&words) {
            room.take(tried);
            return Ok(Some(words));
        }
    }
    Ok(None)
}

fn is_wordy(cells: &[String]) -> bool {
    let (mut words, mut figures) = (0, 0);
    for cell in cells.iter().filter(|cell| !cell.is_empty()) {
        if numbers::is_number(cell, true) {
            figures += 1;
        } else {
            words += 1;
        }
    }
    words > figures
}

/// A name for each column: nameless columns are named by their index, and equal names are distinguished by a number.
pub(super) fn distinct(names: &[String], guesses: &mut Vec<String>) -> Vec<String> {
    let written: HashSet<&str> = names.iter().map(String::as_str).collect();
    let mut seen: HashMap<String, usize> = HashMap::new();
    let mut several = Vec::new();
    let mut all = Vec::with_capacity(names.len());
    for (index, name) in names.iter().enumerate() {
        let name = if name.is_empty() {
            format!("column {}", index + 1)
        } else {
            name.clone()
        };
        let count = seen.entry(name.clone()).or_insert(0);
        *count += 1;
        if *count == 1 {
            all.push(name);
            continue;
        }
        if *count == 2 {
            several.push(name.clone());
        }
        let mut other = format!("{name} #{count}");
        while written.contains(other.as_str()) {
            other.push('\'');
        }
        all.push(other);
    }
    if !several.is_empty() {
        let several: Vec<String> = several.iter().take(5).map(|name| quoted(name)).collect();
        guesses.push(format!(
            "several columns are called {}: the second is called {} here",
            several.join(", "),
            quoted(&format!("{} #2", several[0].trim_matches('"')))
        ));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::rows;
    use super::*;
    use crate::read_limit::ReadLimit;

    fn above(text: &str, cells: usize, separator: Separator) -> Header {
        let budget = Budget::new("a.txt", ReadLimit::default());
        let mut room = Room::of(&budget);
        let lines = rows::lines(text, &mut room).unwrap();
        let rows = rows::rows(text, &lines, separator, &mut room).unwrap();
        Header::above(&rows, rows.len() - 1, cells, separator, &mut room).unwrap()
    }

    #[test]
    fn names_and_units_are_found_above_the_numbers() {
        let tab = Separator::Sign('\t');
        for (text, cells, separator, names, units) in [
            (
                "Time\tDisp\ns\tmm\n0\t1",
                2,
                tab,
                ["Time", "Disp"],
                Some(["s", "mm"]),
            ),
            (
                "s\tmm\nTime\tDisp\n0\t1",
                2,
                tab,
                ["Time", "Disp"],
                Some(["s", "mm"]),
            ),
            (
                "a: b\tc\n\nTime\tDisp\n\n0\t1",
                2,
                tab,
                ["Time", "Disp"],
                None,
            ),
            (
                "\"Time\n[s]\"\tDisp\n0\t1",
                2,
                tab,
                ["Time [s]", "Disp"],
                None,
            ),
            ("# Time Disp\n0\t1", 2, tab, ["Time", "Disp"], None),
            (
                "Time [s]  Axial Force [kN]\n0 1",
                2,
                Separator::Blanks,
                ["Time [s]", "Axial Force [kN]"],
                None,
            ),
            (
                "Time [s] Load (N)\n0 1",
                2,
                Separator::Blanks,
                ["Time [s]", "Load (N)"],
                None,
            ),
            ("s\tmm\n0\t1", 2, tab, ["", ""], Some(["s", "mm"])),
        ] {
            let header = above(text, cells, separator);
            assert_eq!(header.names, names, "{text}");
            let units = units.map(|units| units.map(str::to_owned).to_vec());
            assert_eq!(header.units, units, "{text}");
        }
        assert_eq!(
            above("Time\tDisp\tForce\n0\t1", 2, tab).misfit,
            Some((1, 3))
        );
        assert_eq!(above("0\t0\n0\t1", 2, tab).line, None);
    }

    #[test]
    fn the_same_names_are_told_apart() {
        let names = ["F", "", "F", "F #2"].map(str::to_owned);
        let mut guesses = Vec::new();
        assert_eq!(
            distinct(&names, &mut guesses),
            ["F", "column 2", "F #2'", "F #2"]
        );
        assert_eq!(guesses.len(), 1);
    }
}
