//! The position of the numbers in a text, and the rows above them.

use super::decimals;
use super::declared::Declared;
use super::head::Head;
use super::header::{self, Header};
use super::lines::{QUOTED_LINES, Separator};
use super::lvm;
use super::metadata;
use super::numbers::{self, Cell, Numbers};
use super::stamps::{Since, Stamp};
use crate::columns;
use crate::error::{InputError, Place, quoted};
use crate::files::{Column, Reading, Table};

/// Rows of numbers that make a table. Its header is used even if other numbers have more rows, and below other numbers it is not a
/// footer. Convention: statistics have fewer rows.
pub(super) const FEW_ROWS: usize = 8;
/// Largest number of columns in a text. Convention: ten times the number in the largest loggers' files; our own format may have
/// more.
const MOST_COLUMNS: usize = 100_000;

/// Largest number of bytes in a row of numbers: splitting a row takes many times its size.
const LONGEST: usize = 10 * MOST_COLUMNS;

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

/// Kind of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Numbers,
    /// Dates or times of day, read as seconds from the first.
    Stamps,
    Words,
}

/// Layout of a text.
pub(super) struct Layout {
    pub separator: Separator,
    pub numbers: Numbers,
    /// The line in which the numbers begin.
    pub data_line: u64,
    /// Number of cells in a row, including those at its end that are always empty.
    pub cells: usize,
    pub kinds: Vec<Kind>,
    /// The cells of the rows of names and of units as written, by which repetitions are recognized.
    pub repeated: Vec<Vec<String>>,
    /// Whether the names are in a comment.
    pub is_named_in_comment: bool,
    /// Lines that must be the same wherever one with the same first cell occurs.
    pub fixed: Vec<Vec<String>>,
    /// Columns whose cells must equal those of another: a second column of the same times.
    pub same: Vec<(usize, usize)>,
    pub comments: Vec<String>,
    /// Whether a row may have one more cell, a remark that is not read.
    pub has_remarks: bool,
    /// Whether the times come from outside of the table.
    pub has_clock: bool,
    /// Whether it differs from our own format only in names.
    pub is_plain: bool,
    pub table: Table,
}

/// Consecutive rows of numbers with equally many cells.
struct Block {
    /// Index of the first one among the rows.
    first: usize,
    rows: Vec<usize>,
    cells: usize,
    /// Number of rows of numbers in longer runs above it.
    passed: usize,
    /// Number of cells that are neither numbers nor empty, and number of cells that are not empty.
    words: usize,
    all: usize,
}

/// Determines the layout of a text.
///
/// # Errors
/// The text has no table of numbers, an ambiguous decimal sign, or a comma as separator and decimal sign.
pub(super) fn find(name: &str, head: &Head, reading: &Reading) -> Result<Layout, InputError> {
    find_as(name, head, reading, Declared::of(&head.text))
}

/// [`find`] for a text whose declarations are known.
///
/// # Errors
/// As [`find`].
pub(super) fn find_as(
    name: &str,
    head: &Head,
    reading: &Reading,
    declared: Declared,
) -> Result<Layout, InputError> {
    let separators: Vec<Separator> = match declared.separator {
        Some(separator) => vec![separator],
        None => Separator::ALL.to_vec(),
    };
    let mut best: Option<(Separator, Vec<Row>, Block)> = None;
    for separator in separators {
        let rows = rows(&head.text, separator);
        let block = if declared.is_lvm {
            lvm_block(&rows, separator)
        } else {
            block(&rows, separator)
        };
        let Some(block) = block else {
            continue;
        };
        let is_better = best.as_ref().is_none_or(|(_, _, known)| {
            // Fewer words among the numbers are better; then more rows.
            let (mine, other) = (block.words * known.all, known.words * block.all);
            mine < other || (mine == other && block.rows.len() > known.rows.len())
        });
        if is_better {
            best = Some((separator, rows, block));
        }
    }
    let Some((separator, rows, block)) = best else {
        return Err(no_table(name, &declared));
    };
    let found = Found {
        name,
        head,
        declared: &declared,
        reading,
        separator,
        rows: &rows,
        block: &block,
    };
    found.layout()
}

fn no_table(name: &str, declared: &Declared) -> InputError {
    let divided = match declared.separator {
        Some(separator) => format!("separated by {}, as it states", separator.name()),
        None => "separated by commas, semicolons, tabs, bars or blanks".into(),
    };
    InputError::new(
        name,
        format!("holds no rows of at least two numbers {divided}"),
        "check that it is the right file; a recording has a header such as time_s,displacement_mm,force_kN and samples below it",
    )
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

/// Counts of numbers and words in a row, if it is a row of numbers.
fn counted(cells: &[&str], separator: Separator) -> Option<(usize, usize)> {
    let may_group = !matches!(separator, Separator::Blanks | Separator::Sign(','));
    let (mut figures, mut words) = (0, 0);
    for cell in cells {
        if numbers::is_blank(cell) {
            continue;
        }
        if numbers::is_number(cell, may_group) || Stamp::of(cell).is_some() {
            figures += 1;
        } else {
            words += 1;
        }
    }
    (cells.len() >= 2 && figures > 0 && figures >= words).then_some((figures, words))
}

/// The table of a text: the first rows of numbers below a header with names of channels, else the longest run of rows.
fn block(rows: &[Row], separator: Separator) -> Option<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut cells = Vec::new();
    let mut is_broken = true;
    for (index, row) in rows.iter().enumerate() {
        if row.kind != RowKind::Cells {
            continue;
        }
        if row.text.len() > LONGEST {
            is_broken = true;
            continue;
        }
        separator.split(row.text, &mut cells);
        let Some((figures, words)) = counted(&cells, separator) else {
            is_broken = true;
            continue;
        };
        let last = blocks
            .last_mut()
            .filter(|last| !is_broken && last.cells == cells.len());
        is_broken = false;
        match last {
            Some(block) => {
                block.rows.push(index);
                block.words += words;
                block.all += figures + words;
            }
            None => blocks.push(Block {
                first: index,
                rows: vec![index],
                cells: cells.len(),
                passed: 0,
                words,
                all: figures + words,
            }),
        }
    }
    blocks.retain(|block| block.cells <= MOST_COLUMNS);
    let is_headed = |block: &Block| {
        let header = Header::above(rows, block.first, block.cells, separator);
        header.named() >= 2
    };
    let headed = blocks
        .iter()
        .position(|block| block.rows.len() >= FEW_ROWS && is_headed(block));
    let longest = || {
        let length = |index: &usize| blocks[*index].rows.len();
        (0..blocks.len()).rev().max_by_key(length)
    };
    let index = headed.or_else(longest)?;
    let lengths = blocks[..index].iter().map(|block| block.rows.len());
    let passed = lengths.filter(|&rows| rows >= WORTH_SAYING).sum();
    let mut block = blocks.swap_remove(index);
    block.passed = passed;
    Some(block)
}

/// The rows of numbers of a LabVIEW measurement file: those below the names, which follow the header of a segment. A row may have a
/// remark after its numbers.
fn lvm_block(rows: &[Row], separator: Separator) -> Option<Block> {
    let is_end = |row: &Row| row.text.trim_start().starts_with(lvm::END);
    let ends = rows.iter().enumerate().filter(|(_, row)| is_end(row));
    let mut ends = ends.map(|(index, _)| index);
    let file = ends.next()?;
    let begin = ends.next().unwrap_or(file);
    let is_full = |&index: &usize| rows[index].kind == RowKind::Cells;
    let mut full = (begin + 1..rows.len()).filter(is_full);
    let names = full.next()?;
    let first = full.next()?;
    let mut cells = Vec::new();
    separator.split(rows[names].text, &mut cells);
    let count = cells.len() - usize::from(cells.last() == Some(&lvm::REMARK));
    let rows_of_numbers = full.take_while(|&index| {
        !is_end(&rows[index]) && {
            separator.split(rows[index].text, &mut cells);
            counted(&cells, separator).is_some()
        }
    });
    Some(Block {
        first,
        rows: [first].into_iter().chain(rows_of_numbers).collect(),
        cells: count,
        passed: 0,
        words: 0,
        all: 1,
    })
}

/// Number of rows of numbers above the table for which a note is given. Convention: fewer are settings of a program.
const WORTH_SAYING: usize = 3;

/// Findings about a text.
struct Found<'f> {
    name: &'f str,
    head: &'f Head,
    declared: &'f Declared,
    reading: &'f Reading,
    separator: Separator,
    rows: &'f [Row<'f>],
    block: &'f Block,
}

impl Found<'_> {
    fn layout(&self) -> Result<Layout, InputError> {
        let mut header = Header::above(
            self.rows,
            self.block.first,
            self.block.cells,
            self.separator,
        );
        let samples = self.samples();
        let is_empty = |column: usize| {
            let mut cells = samples.iter().map(|(_, row)| row.get(column));
            cells.all(|cell| cell.is_none_or(|cell| cell.is_empty()))
        };
        header.fit(self.block.cells, &is_empty);
        self.check_header(&header, &samples)?;
        let numbers = self.numbers(&samples)?;
        let kinds = kinds(&samples, self.block.cells, numbers);
        let lvm = self
            .declared
            .is_lvm
            .then(|| lvm::Segment::of(self.rows, header.line, self.separator));
        let mut guesses: Vec<String> = self.head.encoding.iter().cloned().collect();
        let mut columns = self.columns(&header, &kinds, &samples, numbers, &mut guesses);
        let mut same = Vec::new();
        if let Some(lvm) = &lvm {
            same = lvm.apply(&mut columns);
        }
        let comments = metadata::of(
            self.rows,
            header.first_line,
            self.block.first,
            self.separator,
        );
        let mut table = Table {
            header_line: Some(header.line.unwrap_or(self.data_line())),
            is_nameless: header.line.is_none(),
            columns,
            ..Table::default()
        };
        let has_times = self.reading.channels.iter().any(|(of, _)| of == "time")
            || (table.columns.iter()).any(columns::may_be_time);
        if self.reading.rate.is_none() && !has_times {
            let given = match &lvm {
                Some(lvm) => lvm.clock(numbers),
                None => metadata::clock(self.name, &comments, numbers)?,
            };
            if let Some((clock, said)) = given {
                table.clock = Some(clock);
                guesses.push(said);
            }
        }
        let has_preamble = (self.rows.iter()).any(|row| {
            row.kind == RowKind::Cells && header.first_line.is_some_and(|line| row.line < line)
        });
        let is_plain = self.separator == Separator::Sign(',')
            && numbers == Numbers::POINT
            && self.head.is_utf8
            && header.is_line()
            && header.units.is_none()
            && !has_preamble
            && self.block.passed == 0
            && header.passed.is_empty()
            && !header.is_changed
            && !self.declared.is_said()
            && !kinds.contains(&Kind::Stamps)
            && lvm.is_none();
        if !is_plain {
            guesses.extend(self.said(numbers, &header));
        }
        guesses.extend(self.first_is_whole(&samples, &kinds));
        table.guesses = guesses;
        Ok(Layout {
            separator: self.separator,
            numbers,
            data_line: self.data_line(),
            cells: self.block.cells,
            kinds,
            repeated: header.repeated(),
            is_named_in_comment: header.is_comment,
            fixed: lvm.map(|lvm| lvm.fixed).unwrap_or_default(),
            same,
            has_remarks: self.declared.is_lvm,
            comments: comments.into_iter().map(|each| each.text).collect(),
            has_clock: table.clock.is_some() || self.reading.rate.is_some(),
            is_plain,
            table,
        })
    }

    fn data_line(&self) -> u64 {
        self.rows[self.block.first].line
    }

    /// The rows of numbers with their lines.
    fn samples(&self) -> Vec<(u64, Vec<&str>)> {
        let rows = self.block.rows.iter().map(|&index| {
            let row = &self.rows[index];
            let mut cells = Vec::new();
            self.separator.split(row.text, &mut cells);
            cells.truncate(self.block.cells);
            (row.line, cells)
        });
        rows.collect()
    }

    fn numbers(&self, samples: &[(u64, Vec<&str>)]) -> Result<Numbers, InputError> {
        if let Some(decimal) = self.reading.decimal {
            return Ok(decimals::said(samples, decimal));
        }
        if let Some(decimal) = self.declared.decimal {
            return Ok(Numbers {
                decimal,
                ..Numbers::POINT
            });
        }
        decimals::of(samples, self.separator).map_err(|asked| asked.refused(self.name))
    }

    /// Note that the first row of numbers may not be a sample, if it alone has only whole numbers: offsets or factors of the
    /// columns.
    fn first_is_whole(&self, samples: &[(u64, Vec<&str>)], kinds: &[Kind]) -> Option<String> {
        let numbers_of = |row: &[&str]| -> Vec<bool> {
            let each = row.iter().zip(kinds);
            let each =
                each.filter(|(cell, kind)| **kind == Kind::Numbers && !numbers::is_blank(cell));
            each.map(|(cell, _)| cell.bytes().all(|byte| b"+-0123456789".contains(&byte)))
                .collect()
        };
        let [(line, first), rest @ ..] = samples else {
            return None;
        };
        let whole = numbers_of(first);
        let is_alone = whole.len() > 1
            && whole.iter().all(|is_whole| *is_whole)
            && rest.len() >= FEW_ROWS
            && rest.iter().all(|(_, row)| !numbers_of(row).contains(&true));
        is_alone.then(|| {
            format!(
                "the first row of numbers, line {line}, is read as a sample, although only it has no decimals; if it holds offsets or factors, delete it"
            )
        })
    }

    /// Rejects a header with fewer names than the rows have cells.
    fn check_header(
        &self,
        header: &Header,
        samples: &[(u64, Vec<&str>)],
    ) -> Result<(), InputError> {
        let Some((line, names)) = header.misfit else {
            if self.separator == Separator::Sign(',') && self.is_comma_both(samples, header.count())
            {
                return Err(self.comma_both(self.data_line()));
            }
            return Ok(());
        };
        if self.separator == Separator::Sign(',') && self.is_comma_both(samples, names) {
            return Err(self.comma_both(self.data_line()));
        }
        let (cells, separator) = (self.block.cells, self.separator.name());
        Err(InputError::new(
            self.name,
            format!(
                "the header has {names} cells where the rows from line {} on have {cells}, separated by {separator}",
                self.data_line()
            ),
            "give every column one name, in quotes if it contains the separator",
        )
        .at(Place::Line(line)))
    }

    /// Whether commas separate both the cells and the decimals: only whole numbers, more than there are names or with leading
    /// zeros.
    fn is_comma_both(&self, samples: &[(u64, Vec<&str>)], names: usize) -> bool {
        let cells = || samples.iter().flat_map(|(_, row)| row);
        let is_whole = |cell: &&&str| {
            let digits = cell.trim_start_matches(['-', '+']);
            digits.bytes().all(|byte| byte.is_ascii_digit())
        };
        let is_quoted = self
            .block
            .rows
            .iter()
            .any(|&row| self.rows[row].text.contains('"'));
        !is_quoted
            && cells().all(|cell| is_whole(&cell))
            && (cells().any(|cell| numbers::is_padded(cell))
                || (names > 0 && self.block.cells > names))
    }

    fn comma_both(&self, line: u64) -> InputError {
        InputError::new(
            self.name,
            "the comma separates the cells and is also the decimal sign, so every number is ambiguous",
            "export it again with a semicolon or a tab between the cells, or with a decimal point",
        )
        .at(Place::Line(line))
    }

    fn columns(
        &self,
        header: &Header,
        kinds: &[Kind],
        samples: &[(u64, Vec<&str>)],
        numbers: Numbers,
        guesses: &mut Vec<String>,
    ) -> Vec<Column> {
        let names = header::distinct(&header.names, guesses);
        let each = names.into_iter().enumerate().map(|(index, name)| {
            let kind = kinds.get(index).copied().unwrap_or(Kind::Words);
            let cells = samples.iter().map(|(_, row)| row.get(index).copied().unwrap_or_default());
            let is_word = |cell: &&str| {
                matches!(numbers.read(cell), Cell::Words) && Stamp::of(cell).is_none()
            };
            let words = (kind == Kind::Words).then(|| cells.clone().find(is_word)).flatten();
            let mut unit = (header.units.as_ref())
                .and_then(|units| units.get(index))
                .filter(|unit| !unit.is_empty())
                .cloned();
            if kind == Kind::Stamps {
                guesses.push(format!(
                    "column {} holds dates or times of day; they are read as seconds after the first",
                    quoted(&name)
                ));
                unit = Some("s".into());
            }
            Column {
                is_numeric: kind != Kind::Words,
                is_stamp: kind == Kind::Stamps,
                words: words.map(str::to_owned),
                first: first(cells, kind, numbers),
                name,
                unit,
                ..Column::default()
            }
        });
        each.collect()
    }

    /// The findings, in words.
    fn said(&self, numbers: Numbers, header: &Header) -> Vec<String> {
        let sign = if numbers.decimal == ',' {
            "comma"
        } else {
            "point"
        };
        let mut said = Vec::new();
        let is_shown = self.reading.decimal.is_some() || !numbers.is_open;
        let thousands = if numbers.has_thousands && self.reading.decimal.is_none() {
            let other = if numbers.decimal == ',' {
                "a point"
            } else {
                "a comma"
            };
            format!(", and {other} separates thousands")
        } else {
            String::new()
        };
        let by = self.separator.name();
        if !self.declared.is_sheet {
            said.push(if is_shown {
                format!("cells are separated by {by}, the decimal sign is a {sign}{thousands}")
            } else {
                format!("cells are separated by {by}")
            });
        }
        if let Some(line) = header.line {
            let below = match header.units_line {
                Some(units) => format!(", the units in line {units}"),
                None => String::new(),
            };
            let how = if header.is_comment {
                ", which is a comment"
            } else {
                ""
            };
            if line > 1 || header.units_line.is_some() || header.is_comment {
                said.push(format!("the names are in line {line}{how}{below}"));
            }
        }
        if !header.passed.is_empty() {
            let lines: Vec<String> = header.passed.iter().map(u64::to_string).collect();
            said.push(format!(
                "words below the names are not read: line {}",
                lines.join(", ")
            ));
        }
        if self.block.passed > 0 {
            said.push(format!(
                "{} rows of numbers above line {} are not read",
                self.block.passed,
                self.data_line()
            ));
        }
        said
    }
}

/// Kinds of the columns, from the rows of the head.
fn kinds(samples: &[(u64, Vec<&str>)], cells: usize, numbers: Numbers) -> Vec<Kind> {
    let kind = |column: usize| {
        let (mut figures, mut stamps, mut words) = (0, 0, 0);
        for (_, row) in samples {
            let cell = row.get(column).copied().unwrap_or_default();
            match numbers.read(cell) {
                Cell::Blank => {}
                Cell::Words if Stamp::of(cell).is_some() => stamps += 1,
                Cell::Words => words += 1,
                Cell::Number(_) | Cell::NotFinite | Cell::OtherSign => figures += 1,
            }
        }
        if stamps > figures + words {
            Kind::Stamps
        } else if words > figures {
            Kind::Words
        } else {
            Kind::Numbers
        }
    };
    (0..cells).map(kind).collect()
}

fn first<'c>(cells: impl Iterator<Item = &'c str>, kind: Kind, numbers: Numbers) -> Vec<f64> {
    let mut since = None;
    let value = |cell: &'c str| match kind {
        Kind::Stamps => {
            let stamp = Stamp::of(cell)?;
            let since = since.get_or_insert_with(|| Since::of(&stamp));
            since.seconds(&stamp).ok()
        }
        Kind::Numbers | Kind::Words => match numbers.read(cell) {
            Cell::Number(value) => Some(value),
            _ => None,
        },
    };
    let values = cells.take(Column::FIRST).map(value);
    values.map(|value| value.unwrap_or(f64::NAN)).collect()
}
