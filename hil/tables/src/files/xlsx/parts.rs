//! The parts of a workbook: files of XML in a ZIP archive.

use std::collections::HashMap;
use std::io::{BufRead, BufReader, Cursor, Read as _};

use mesh_damper_output::error::InputError;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use zip::ZipArchive;

use super::NAME;
use crate::csv_text::found_wrong;
use crate::files::guard::damaged;
use crate::files::packed::{Packed, Part};
use crate::room::Room;

/// Bytes held for a file of an archive, besides its name: what the archive's reader keeps of it, and its place by its name.
const OF_FILE: u64 = 640;
/// Steps of work for an unpacked byte of XML.
const STEPS: u64 = 4;

/// The parts of a workbook.
pub(super) struct Parts<'b> {
    name: &'b str,
    bytes: &'b [u8],
    archive: ZipArchive<Cursor<&'b [u8]>>,
    /// Index of each file by its path in lower case, with `/`: some programs write `\`.
    places: HashMap<String, usize>,
    packed: &'b Packed,
}

impl<'b> Parts<'b> {
    /// Of the file `name` with these bytes.
    ///
    /// # Errors
    /// It is no archive, or the budget has no room for the list of its files.
    pub fn of(name: &'b str, bytes: &'b [u8], packed: &'b Packed) -> Result<Self, InputError> {
        let part = "the list of its files";
        packed.budget().hold(OF_FILE * stated_files(bytes), part)?;
        let archive = ZipArchive::new(Cursor::new(bytes));
        let archive = archive.map_err(|error| damaged(NAME, name, error))?;
        let mut places = HashMap::with_capacity(archive.len());
        for (index, path) in archive.file_names().enumerate() {
            let path = path.map_err(|error| damaged(NAME, name, error))?;
            packed.budget().hold(3 * path.len() as u64, part)?;
            places.insert(normal(&path), index);
        }
        Ok(Self {
            name,
            bytes,
            archive,
            places,
            packed,
        })
    }

    /// The place of a part in the archive.
    pub fn place(&self, path: &str) -> Option<usize> {
        self.places.get(&normal(path)).copied()
    }

    /// The part at a place.
    ///
    /// # Errors
    /// It cannot be unpacked.
    pub fn at(&mut self, place: usize) -> Result<Xml<'_>, InputError> {
        let broken = |error: &dyn std::fmt::Display| damaged(NAME, self.name, error);
        let file = self
            .archive
            .by_index(place)
            .map_err(|error| broken(&error))?;
        let stored = || {
            let from = usize::try_from(file.data_start()?).ok()?;
            let length = usize::try_from(file.compressed_size()).ok()?;
            self.bytes.get(from..from.checked_add(length)?)
        };
        let stored = stored().ok_or_else(|| broken(&"a part is cut"))?;
        let is_new = self.packed.budget().is_new(stored)?;
        let part = Part {
            from: file,
            packed: self.packed,
            is_new,
            steps: STEPS,
        };
        let mut from: Box<dyn BufRead + '_> = Box::new(BufReader::with_capacity(1 << 15, part));
        let head = from.fill_buf().map_err(|error| refused(self.name, error))?;
        if let Some((encoding, _)) = encoding_rs::Encoding::for_bom(head)
            && encoding != encoding_rs::UTF_8
        {
            let mut bytes = Vec::new();
            (from.read_to_end(&mut bytes)).map_err(|error| refused(self.name, error))?;
            // In UTF-16 it takes half as many bytes more, and its own are dropped.
            self.packed
                .budget()
                .hold(3 * bytes.len() as u64, "its parts in UTF-16")?;
            let (text, _, _) = encoding.decode(&bytes);
            from = Box::new(Cursor::new(text.into_owned().into_bytes()));
        }
        let mut reader = Reader::from_reader(from);
        let config = reader.config_mut();
        config.check_end_names = false;
        config.expand_empty_elements = true;
        Ok(Xml {
            name: self.name,
            reader,
            buffer: Vec::new(),
            room: Room::of(self.packed.budget()),
        })
    }

    /// The part at a path; `None` without one.
    ///
    /// # Errors
    /// It cannot be unpacked.
    pub fn find(&mut self, path: &str) -> Result<Option<Xml<'_>>, InputError> {
        match self.place(path) {
            Some(place) => self.at(place).map(Some),
            None => Ok(None),
        }
    }
}

fn normal(path: &str) -> String {
    path.replace('\\', "/").to_ascii_lowercase()
}

/// The largest number of files that the ends of an archive state: memory for as many is taken before they are read.
fn stated_files(bytes: &[u8]) -> u64 {
    /// Bytes of the end of an archive, and the longest comment behind it.
    const END: usize = 22;
    const COMMENT: usize = 1 << 16;
    /// Bytes of the place of the end in ZIP64, which lies before the end.
    const PLACE: usize = 20;
    let word = |at: usize, size: usize| {
        let bytes = bytes.get(at..at.checked_add(size)?)?;
        let word = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        Some(bytes.iter().rev().fold(0, word))
    };
    let first = bytes.len().saturating_sub(END + COMMENT);
    let ends = (first..bytes.len()).filter(|&at| bytes[at..].starts_with(b"PK\x05\x06"));
    let stated = ends.map(|end| {
        let short = word(end + 10, 2);
        let large = || {
            let place = end.checked_sub(PLACE)?;
            (bytes.get(place..place + 4)? == b"PK\x06\x07").then_some(())?;
            let end = usize::try_from(word(place + 8, 8)?).ok()?;
            word(end.checked_add(32)?, 8)
        };
        short.max(large()).unwrap_or_default()
    });
    // The archive's reader believes no more than one for each byte before the list.
    stated.max().unwrap_or_default().min(bytes.len() as u64)
}

/// A part that is read.
pub(super) struct Xml<'p> {
    name: &'p str,
    reader: Reader<Box<dyn BufRead + 'p>>,
    buffer: Vec<u8>,
    room: Room<'p>,
}

impl<'p> Xml<'p> {
    /// The file's name.
    pub fn name(&self) -> &'p str {
        self.name
    }

    /// For what is made of it.
    pub fn room(&self) -> Room<'p> {
        Room::of(self.room.budget())
    }

    /// The next event.
    ///
    /// # Errors
    /// The part is damaged, or unpacks to too much.
    pub fn next(&mut self) -> Result<Event<'_>, InputError> {
        // That of the last event: it is borrowed by the next.
        let held = self.buffer.capacity() as u64;
        self.room.at_least(held, "one of its elements")?;
        self.buffer.clear();
        let event = self.reader.read_event_into(&mut self.buffer);
        event.map_err(|error| wrong(self.name, error))
    }

    /// A damaged part of the file.
    pub fn damaged(&self, why: impl std::fmt::Display) -> InputError {
        damaged(NAME, self.name, why)
    }
}

fn wrong(name: &str, error: quick_xml::Error) -> InputError {
    match &error {
        quick_xml::Error::Io(error) => {
            found_wrong(error).unwrap_or_else(|| damaged(NAME, name, error))
        }
        error => damaged(NAME, name, error),
    }
}

fn refused(name: &str, error: std::io::Error) -> InputError {
    found_wrong(&error).unwrap_or_else(|| damaged(NAME, name, error))
}

/// The values of an element's attributes with these names, as written; a prefix before a name is left out.
///
/// # Errors
/// Attributes that are not well-formed, in words.
pub(super) fn attributes<'e, const N: usize>(
    element: &'e BytesStart,
    names: [&str; N],
) -> Result<[Option<std::borrow::Cow<'e, [u8]>>; N], String> {
    let mut values = [const { None }; N];
    for attribute in element.attributes().with_checks(false) {
        let attribute = attribute.map_err(|error| error.to_string())?;
        let key = attribute.key.local_name();
        let named = names.iter().zip(&mut values);
        for (_, value) in named.filter(|(name, _)| name.as_bytes() == key.as_ref()) {
            value.get_or_insert_with(|| attribute.value.clone());
        }
    }
    Ok(values)
}
