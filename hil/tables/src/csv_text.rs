//! Text and cells of the CSV files given to the harness.

use std::collections::HashMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use mesh_damper_output::error::{InputError, Place, quoted};

use crate::budget::Budget;
use crate::read_limit::{ReadLimit, open};
use records::Records;

mod records;

/// The first two bytes of every gzip member (RFC 1952, 2.3.1).
const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];
/// Bytes that some programs write before the text.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();
/// Number of bytes read at a time.
const CHUNK: usize = 1 << 16;
/// Steps of work for a byte of text: it is unpacked and checked, and searched for the ends of cells and lines.
const STEPS: u64 = 2;
/// Bytes held for a byte that is read ahead, in a buffer that doubles as it grows.
const OF_AHEAD: u64 = 2;

/// The text of a CSV file as it is read: unzipped if it is gzip, without a byte order mark, and never held as a whole.
///
/// An error in the file comes out of [`Read::read`] as an [`InputError`] within an [`io::Error`]; [`broken_csv`] extracts it.
pub struct CsvText<'a> {
    path: PathBuf,
    budget: Rc<Budget>,
    source: Box<dyn Read + 'a>,
    is_gzip: bool,
    /// Whether the source was made of bytes that were counted before.
    is_made: bool,
    /// Number of bytes since the last line end, which count as read when their line ends: a line without an end takes no more than
    /// may be held before a byte is read.
    unended: u64,
    /// Unpacked bytes that were read ahead, the number of them already taken, and the number of bytes held for them.
    ahead: Vec<u8>,
    taken: usize,
    of_ahead: u64,
    /// Decoder to UTF-8; `None` if the bytes are UTF-8.
    decoder: Option<encoding_rs::Decoder>,
    /// Whether bytes that are not UTF-8 are taken for Windows-1252, if all before were ASCII.
    may_guess: bool,
    /// The first line for which they were.
    guessed_from: Option<u64>,
    is_ascii: bool,
    /// Text read and not handed on. After its first `whole` bytes an incomplete character begins.
    chunk: Vec<u8>,
    next: usize,
    whole: usize,
    /// Number of bytes handed on.
    handed: u64,
    last: Option<u8>,
    has_ended: bool,
    records: Records,
}

impl<'a> CsvText<'a> {
    /// Opens a file.
    ///
    /// # Errors
    /// The file and why it cannot be read: it does not exist, or is a folder.
    pub fn open(path: &Path, limit: ReadLimit) -> Result<Self, InputError> {
        let budget = Budget::new(path.display().to_string(), limit);
        Self::of(path, open(path)?, Rc::new(budget))
    }

    /// The text of `source`; `path` is its name in errors.
    pub(crate) fn of(
        path: &Path,
        mut source: impl Read + 'a,
        budget: Rc<Budget>,
    ) -> Result<Self, InputError> {
        let mut head = Vec::new();
        (source.by_ref().take(GZIP_MAGIC.len() as u64))
            .read_to_end(&mut head)
            .map_err(|error| InputError::io(path, "read", &error))?;
        let named_gzip = path.extension().is_some_and(|extension| extension == "gz");
        let is_gzip = head == GZIP_MAGIC || (named_gzip && !head.is_empty());
        let whole = io::Cursor::new(head).chain(source);
        Ok(if is_gzip {
            let source = Box::new(flate2::read::MultiGzDecoder::new(whole));
            Self {
                is_gzip,
                ..Self::from(path, source, budget)
            }
        } else {
            Self::from(path, Box::new(whole), budget)
        })
    }

    /// A text that was made of the contents of a file, whose bytes are counted already.
    pub(crate) fn made(path: &Path, text: Vec<u8>, budget: Rc<Budget>) -> Self {
        Self {
            is_made: true,
            ..Self::from(path, Box::new(io::Cursor::new(text)), budget)
        }
    }

    fn from(path: &Path, source: Box<dyn Read + 'a>, budget: Rc<Budget>) -> Self {
        Self {
            path: path.to_owned(),
            budget,
            source,
            is_gzip: false,
            is_made: false,
            unended: 0,
            ahead: Vec::new(),
            taken: 0,
            of_ahead: 0,
            decoder: None,
            may_guess: false,
            guessed_from: None,
            is_ascii: true,
            chunk: Vec::new(),
            next: 0,
            whole: 0,
            handed: 0,
            last: None,
            has_ended: false,
            records: Records::default(),
        }
    }

    /// The file as the user named it.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// What reading the file may cost.
    pub(crate) fn budget(&self) -> &Rc<Budget> {
        &self.budget
    }

    /// Keeps the comments of the text that is read from here on.
    pub(crate) fn keep_comments(&mut self) {
        self.records.keep_comments();
    }

    /// Its rows for [`next_row`], also those of different lengths; comment lines are left out.
    pub fn rows(mut self) -> csv::Reader<Self> {
        self.records.hold_rows();
        csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .has_headers(false)
            .flexible(true)
            .buffer_capacity(CHUNK)
            .from_reader(self)
    }

    /// The lines read so far that begin with `#`, outside quoted cells.
    pub fn comments(self) -> Vec<String> {
        self.records.into_comments()
    }

    /// The first unpacked bytes, before any is handed on: `count` of them, or all.
    ///
    /// # Errors
    /// An error of the file system, damaged gzip, or a file beyond the limit.
    pub(crate) fn ahead(&mut self, count: usize) -> Result<&[u8], InputError> {
        while self.ahead.len() < count && !self.has_ended {
            let mut bytes = std::mem::take(&mut self.ahead);
            let more = self.unpack(&mut bytes);
            self.ahead = bytes;
            self.has_ended = more? == 0;
            let held = OF_AHEAD * self.ahead.len() as u64;
            self.budget.hold(held - self.of_ahead, "its first lines")?;
            self.of_ahead = held;
        }
        if self.has_ended {
            // A workbook may have thousands of sheets, which are all open: none has more room than text.
            self.ahead.shrink_to_fit();
        }
        Ok(&self.ahead)
    }

    /// Bytes of a buffer from which its lines are taken: no more than it has, if all of it was read ahead.
    pub(crate) fn of_buffer(&self) -> usize {
        match self.has_ended {
            true => self.ahead.len().clamp(64, CHUNK),
            false => CHUNK,
        }
    }

    /// Whether [`CsvText::ahead`] returned the whole file.
    pub(crate) fn is_all_ahead(&self) -> bool {
        self.has_ended
    }

    /// Sets the encoding. Without one the bytes are UTF-8, and Windows-1252 from the first byte that is not UTF-8, if all before
    /// were ASCII.
    pub(crate) fn decode(&mut self, encoding: Option<&'static encoding_rs::Encoding>) {
        self.decoder = encoding.map(encoding_rs::Encoding::new_decoder_with_bom_removal);
        self.may_guess = encoding.is_none();
    }

    /// The line from which the text was taken for Windows-1252.
    pub(crate) fn guessed_from(&self) -> Option<u64> {
        self.guessed_from
    }

    /// Whether the whole file was read.
    fn is_read(&self) -> bool {
        self.has_ended && self.taken == self.ahead.len()
    }

    /// Reads on, and takes the bytes up to their last complete character.
    fn fill(&mut self) -> Result<(), InputError> {
        self.chunk.drain(..self.whole);
        (self.next, self.whole) = (0, 0);
        while self.whole == 0 && !self.is_read() {
            self.more()?;
            if self.handed == 0 && self.chunk.starts_with(BYTE_ORDER_MARK) {
                self.chunk.drain(..BYTE_ORDER_MARK.len());
            }
            let error = std::str::from_utf8(&self.chunk).err();
            self.whole = error.map_or(self.chunk.len(), |error| error.valid_up_to());
            self.is_ascii &= self.chunk[..self.whole].is_ascii();
            let mut is_broken = error.is_some_and(|error| error.error_len().is_some())
                || (self.is_read() && self.whole < self.chunk.len());
            if is_broken && self.may_guess && self.is_ascii {
                self.guess();
                is_broken = false;
            }
            let text = &self.chunk[..self.whole];
            self.budget.work(STEPS * text.len() as u64, "its text")?;
            self.records.pass(text, &self.budget)?;
            if is_broken {
                let line = 1 + self.records.ends;
                return Err(InputError::new(
                    self.name(),
                    "not UTF-8 text",
                    "save the file as UTF-8 CSV",
                )
                .at(Place::Line(line)));
            }
        }
        if self.is_read() {
            self.records.end(&self.budget)?;
        }
        Ok(())
    }

    /// Takes the bytes from the first that is not UTF-8 for Windows-1252.
    fn guess(&mut self) {
        let ends = self.chunk[..self.whole].iter().filter(|&&b| b == b'\n');
        self.guessed_from = Some(1 + self.records.ends + ends.count() as u64);
        self.may_guess = false;
        self.decoder = Some(encoding_rs::WINDOWS_1252.new_decoder_without_bom_handling());
        let rest = self.chunk.split_off(self.whole);
        self.append(&rest, self.is_read());
        self.whole = self.chunk.len();
    }

    /// Some more text of the file, or its end.
    fn more(&mut self) -> Result<(), InputError> {
        if self.taken < self.ahead.len() {
            // The bytes read ahead are taken in the parts in which a file is read.
            let end = self.ahead.len().min(self.taken + CHUNK);
            let ahead = std::mem::take(&mut self.ahead);
            let from = std::mem::replace(&mut self.taken, end);
            self.append(&ahead[from..end], self.has_ended && end == ahead.len());
            if end < ahead.len() {
                self.ahead = ahead;
            } else {
                self.taken = 0;
                self.budget.release(std::mem::take(&mut self.of_ahead));
            }
            return Ok(());
        }
        if self.decoder.is_none() {
            let mut chunk = std::mem::take(&mut self.chunk);
            let count = self.unpack(&mut chunk);
            self.chunk = chunk;
            self.has_ended = count? == 0;
            return Ok(());
        }
        let mut bytes = Vec::new();
        self.has_ended = self.unpack(&mut bytes)? == 0;
        self.append(&bytes, self.has_ended);
        Ok(())
    }

    /// Appends the text of `bytes` to the chunk.
    fn append(&mut self, bytes: &[u8], is_last: bool) {
        let Some(decoder) = &mut self.decoder else {
            self.chunk.extend_from_slice(bytes);
            return;
        };
        let most = decoder.max_utf8_buffer_length(bytes.len());
        let held = self.chunk.len();
        self.chunk
            .resize(held + most.unwrap_or(3 * bytes.len() + 16), 0);
        // There is room for all of it, and malformed bytes become a replacement character.
        let (_, _, written, _) = decoder.decode_to_utf8(bytes, &mut self.chunk[held..], is_last);
        self.chunk.truncate(held + written);
    }

    /// Appends some more unpacked bytes of the file; none at its end.
    fn unpack(&mut self, to: &mut Vec<u8>) -> Result<usize, InputError> {
        let held = to.len();
        to.resize(held + CHUNK, 0);
        let count = loop {
            match self.source.read(&mut to[held..]) {
                Ok(count) => break count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(self.failed(&error)),
            }
        };
        to.truncate(held + count);
        if !self.is_made {
            self.count(&to[held..])?;
        }
        Ok(count)
    }

    /// Counts these bytes as read, up to their last line end; at the end of the file, where there are none, all before.
    fn count(&mut self, bytes: &[u8]) -> Result<(), InputError> {
        let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
        let ended = match bytes.iter().rposition(is_end) {
            Some(end) => end + 1,
            None if bytes.is_empty() => 0,
            None => {
                self.unended += bytes.len() as u64;
                return Ok(());
            }
        };
        let rest = (bytes.len() - ended) as u64;
        let before = std::mem::replace(&mut self.unended, rest);
        self.budget.read(before + ended as u64)
    }

    fn failed(&self, error: &io::Error) -> InputError {
        // An error in the gzip has no error number of the operating system.
        if !self.is_gzip || error.raw_os_error().is_some() {
            return InputError::io(&self.path, "read", error);
        }
        InputError::new(
            self.name(),
            format!("not valid gzip: {error}"),
            "copy the file again, or unpack it and name the CSV",
        )
    }
}

impl Read for CsvText<'_> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        if self.next == self.whole && !self.is_read() {
            self.fill().map_err(io::Error::other)?;
        }
        let count = to.len().min(self.whole - self.next);
        let from = &self.chunk[self.next..self.next + count];
        to[..count].copy_from_slice(from);
        self.last = from.last().copied().or(self.last);
        self.next += count;
        self.handed += count as u64;
        Ok(count)
    }
}

/// Whether the last record has no line end, so that its last cell may have been cut.
pub fn is_cut(rows: &csv::Reader<CsvText>) -> bool {
    let text = rows.get_ref();
    let has_end = matches!(text.last, Some(b'\n' | b'\r'));
    // A record without a line end counts only once the text is complete.
    text.is_read() && !has_end && rows.position().byte() == text.handed
}

/// Reads a row, and whether there is one. Its cells are trimmed here, because a reader that trims copies each row.
///
/// # Errors
/// As [`csv::Reader::read_record`].
pub fn next_row(
    rows: &mut csv::Reader<CsvText<'_>>,
    row: &mut csv::StringRecord,
) -> csv::Result<bool> {
    let is_there = rows.read_record(row)?;
    if row.as_slice().contains(char::is_whitespace) {
        row.trim();
    }
    Ok(is_there)
}

/// The first name that a header contains twice, with both of its columns, counted from 0.
pub fn doubled(header: &csv::StringRecord) -> Option<(&str, usize, usize)> {
    let mut known = HashMap::with_capacity(header.len());
    (header.iter().enumerate()).find_map(|(index, name)| {
        let first = *known.entry(name).or_insert(index);
        (first != index).then_some((name, first, index))
    })
}

/// The finite number in a cell.
///
/// # Errors
/// Its error, and its correction.
pub fn number(cell: &str) -> Result<f64, (String, &'static str)> {
    const MEND: &str = "remove the row or correct the value";
    if cell.is_empty() {
        return Err(("the cell is empty".into(), MEND));
    }
    let value: f64 = cell.parse().map_err(|_| {
        (
            format!("{} is not a number", quoted(cell)),
            "write a decimal number with a point, such as -0.125 or 1e-3",
        )
    })?;
    if value.is_nan() {
        return Err((format!("{} is not a number", quoted(cell)), MEND));
    }
    if value.is_infinite() {
        return Err((format!("{} is not finite", quoted(cell)), MEND));
    }
    Ok(value)
}

/// Words of programs for a missing number.
const BLANK: [&str; 12] = [
    "-",
    "--",
    "---",
    "na",
    "n/a",
    "#n/a",
    "null",
    "none",
    "nan(ind)",
    "-nan(ind)",
    "1.#qnan",
    "1.#ind",
];

/// Whether a cell means a missing number.
pub fn is_blank(cell: &str) -> bool {
    cell.is_empty()
        || BLANK.iter().any(|blank| cell.eq_ignore_ascii_case(blank))
        || cell.parse().is_ok_and(f64::is_nan)
}

/// The error that [`CsvText`] found in the file, if that is the cause.
pub(crate) fn found_wrong(error: &io::Error) -> Option<InputError> {
    error.get_ref()?.downcast_ref::<InputError>().cloned()
}

/// The error of the CSV reader, with its line, or the error in the file that [`CsvText`] found.
pub fn broken_csv(file: &str, error: &csv::Error) -> InputError {
    if let csv::ErrorKind::Io(error) = error.kind()
        && let Some(found) = found_wrong(error)
    {
        return found;
    }
    let broken = InputError::new(
        file,
        format!("not readable as CSV: {error}"),
        "write comma-separated rows",
    );
    match error.position() {
        Some(position) => broken.at(Place::Line(position.line())),
        None => broken,
    }
}
