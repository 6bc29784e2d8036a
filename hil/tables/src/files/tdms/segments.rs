//! The segments of a file: their objects, the properties of these, and the position of their values.

use std::collections::HashMap;

use super::Broken;
use crate::files::arrays::MOST_COLUMNS;
use crate::files::number::Kind;

/// Bytes before a segment's metadata.
const LEAD: usize = 28;
/// Meaning of the bits in a segment's second word.
const METADATA: u32 = 1 << 1;
const NEW_LIST: u32 = 1 << 2;
const RAW: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG: u32 = 1 << 6;
const DAQMX: u32 = 1 << 7;
/// The most times that an object may occur in segments, over the file. Convention: a thousand channels in fifty thousand segments,
/// which takes seconds.
const MOST_STEPS: usize = 50_000_000;

/// A property of an object.
#[derive(Clone, Debug)]
pub(super) enum Property {
    Number(f64),
    Text(String),
    /// In 2⁻⁶⁴ s.
    Date(i128),
    Other,
}

/// How a value is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Read {
    Number(Kind),
    /// A bit of a byte.
    Bit(u8),
    /// Seconds since 1904 and 2⁻⁶⁴ parts of one.
    Date,
}

impl Read {
    fn size(self) -> usize {
        match self {
            Self::Number(kind) => kind.size(),
            Self::Bit(_) => 1,
            Self::Date => 16,
        }
    }
}

/// Values at equal steps in each of several chunks.
#[derive(Clone, Copy, Debug)]
struct Piece {
    at: usize,
    step: usize,
    count: usize,
    chunk: usize,
    chunks: usize,
    is_little: bool,
}

/// Positions of the values of a channel.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    pub read: Option<Read>,
    pieces: Vec<Piece>,
}

impl Pieces {
    /// Number of values.
    pub fn count(&self) -> usize {
        let each = self
            .pieces
            .iter()
            .map(|piece| piece.count.saturating_mul(piece.chunks));
        each.fold(0, usize::saturating_add)
    }

    /// The values; NaN beyond the file's end.
    pub fn values(&self, bytes: &[u8]) -> Vec<f64> {
        let mut values = Vec::with_capacity(self.count());
        let mut first = None;
        for piece in &self.pieces {
            for chunk in 0..piece.chunks {
                let from = piece.at + chunk * piece.chunk;
                for index in 0..piece.count {
                    let at = from + index * piece.step;
                    values.push(match self.read {
                        Some(Read::Number(kind)) => kind.read(bytes, at, piece.is_little),
                        Some(Read::Bit(bit)) => bytes
                            .get(at)
                            .map_or(f64::NAN, |byte| f64::from(byte >> bit & 1)),
                        Some(Read::Date) => {
                            let date = date(bytes, at, piece.is_little);
                            let first = *first.get_or_insert(date);
                            seconds(date.wrapping_sub(first))
                        }
                        None => f64::NAN,
                    });
                }
            }
        }
        values
    }
}

/// Of 2⁻⁶⁴ s.
pub(super) fn seconds(parts: i128) -> f64 {
    parts as f64 / 2_f64.powi(64)
}

/// A date in 2⁻⁶⁴ s.
fn date(bytes: &[u8], at: usize, is_little: bool) -> i128 {
    let word = bytes.get(at..at.saturating_add(16));
    let word: [u8; 16] = word
        .and_then(|word| word.try_into().ok())
        .unwrap_or_default();
    if is_little {
        i128::from_le_bytes(word)
    } else {
        i128::from_be_bytes(word)
    }
}

/// A file, a group or a channel.
#[derive(Debug, Default)]
pub(super) struct Object {
    /// Names of the group and the channel; empty for the file.
    pub path: Vec<String>,
    pub properties: HashMap<String, Property>,
    /// Its raw values, by the number of the scale that takes them.
    pub raw: Vec<(u32, Pieces)>,
    /// Why it has no values, if it is not a channel of numbers.
    pub unread: Option<&'static str>,
    /// Time of its first sample, in 2⁻⁶⁴ s, if the file states it.
    pub start: Option<i128>,
    /// Whether its clock was restarted among its samples, at a time that does not agree with its steps.
    pub is_restarted: bool,
}

/// The contents of a file.
#[derive(Debug, Default)]
pub(super) struct File {
    pub objects: Vec<Object>,
    pub is_cut: bool,
    places: HashMap<String, usize>,
    /// The layout of each object's values in a chunk, as stated last.
    layouts: Vec<Option<Layout>>,
    /// The objects of the segments from here on, in the order of their values.
    list: Vec<usize>,
    steps: usize,
}

/// Layout of the values of an object in a chunk.
#[derive(Clone, Debug)]
enum Layout {
    Plain {
        /// `None` for values that are not numbers, such as texts.
        read: Option<Read>,
        count: usize,
        bytes: usize,
    },
    Daqmx {
        count: usize,
        /// Each with the scale that takes it, the card, and the byte in the card's row.
        scalers: Vec<(u32, Read, usize, usize)>,
        /// Bytes of a row of each card.
        widths: Vec<usize>,
    },
}

/// A position in the file's bytes.
struct Cursor<'b> {
    bytes: &'b [u8],
    at: usize,
    is_little: bool,
}

impl File {
    pub fn of(bytes: &[u8]) -> Result<Self, Broken> {
        let mut file = Self::default();
        let mut at = 0;
        while let Some(lead) = bytes.get(at..at + LEAD) {
            if !lead.starts_with(b"TDSm") {
                return Err(Broken("a segment does not begin where it should"));
            }
            let mut cursor = Cursor {
                bytes,
                at: at + 4,
                is_little: true,
            };
            let bits = cursor.u32()?;
            cursor.is_little = bits & BIG == 0;
            cursor.u32()?;
            let (next, raw) = (cursor.u64()?, cursor.u64()?);
            // A program that was interrupted has not written the length.
            let is_open = next == u64::MAX;
            let inside = |offset: u64| {
                let offset = usize::try_from(offset).unwrap_or(usize::MAX);
                offset.saturating_add(at + LEAD).min(bytes.len())
            };
            let end = if is_open { bytes.len() } else { inside(next) };
            file.is_cut |= is_open || next > (bytes.len() - at - LEAD) as u64;
            if bits & METADATA != 0 {
                if bits & NEW_LIST != 0 {
                    file.list.clear();
                }
                if let Err(broken) = file.metadata(&mut cursor) {
                    // In a segment that was being written the contents are unknown.
                    if is_open {
                        break;
                    }
                    return Err(broken);
                }
            }
            if bits & RAW != 0 {
                let raw = inside(raw).max(cursor.at);
                if raw < end {
                    file.values(raw, end, bits)?;
                }
            }
            at = end;
        }
        Ok(file)
    }

    fn metadata(&mut self, cursor: &mut Cursor<'_>) -> Result<(), Broken> {
        for _ in 0..cursor.u32()? {
            let path = cursor.text()?;
            let place = match self.places.get(&path) {
                Some(place) => *place,
                None => {
                    let place = self.objects.len();
                    if place > MOST_COLUMNS {
                        return Err(Broken("it has more channels than any test"));
                    }
                    self.objects.push(Object {
                        path: names(&path),
                        ..Object::default()
                    });
                    self.layouts.push(None);
                    self.places.insert(path, place);
                    place
                }
            };
            let header = cursor.u32()?;
            let layout = match header {
                0xffff_ffff => None,
                0 => self.layouts[place].clone(),
                // NI's documented values, and those that its programs write.
                0x1269 | 0x126a | 0x6912_0000 | 0x6913_0000 | 0x1369 => {
                    Some(cursor.daqmx(header == 0x126a || header == 0x1369)?)
                }
                _ => Some(cursor.plain()?),
            };
            self.steps += 1 + self.list.len() / 64;
            if header != 0xffff_ffff {
                self.layouts[place] = layout;
                if !self.list.contains(&place) {
                    self.list.push(place);
                }
            } else {
                self.list.retain(|&each| each != place);
            }
            if self.steps > MOST_STEPS {
                return Err(Broken("it has more segments than any test"));
            }
            for _ in 0..cursor.u32()? {
                let name = cursor.text()?;
                let value = cursor.property()?;
                self.objects[place].say(name, value);
            }
        }
        Ok(())
    }

    /// Adds the raw values between two positions.
    fn values(&mut self, from: usize, end: usize, bits: u32) -> Result<(), Broken> {
        self.steps += self.list.len();
        if self.steps > MOST_STEPS {
            return Err(Broken("it has more segments than any test"));
        }
        let is_little = bits & BIG == 0;
        if bits & DAQMX != 0 {
            return self.daqmx_values(from, end, is_little);
        }
        let mut chunk = 0_usize;
        let mut members = Vec::new();
        for &place in &self.list {
            if let Some(Layout::Plain { read, count, bytes }) = self.layouts[place] {
                members.push((place, read, count, bytes, chunk));
                chunk = chunk
                    .checked_add(bytes)
                    .ok_or(Broken("a chunk has no size"))?;
            }
        }
        if chunk == 0 {
            return Ok(());
        }
        let whole = (end - from) / chunk;
        self.is_cut |= !(end - from).is_multiple_of(chunk);
        let row: usize = members
            .iter()
            .filter_map(|(_, read, ..)| Some((*read)?.size()))
            .sum();
        let mut column = 0;
        for (place, read, count, _, at) in members {
            let Some(read) = read else {
                self.objects[place].unread = Some("texts or other things than numbers");
                continue;
            };
            let (at, step) = if bits & INTERLEAVED != 0 {
                column += read.size();
                (column - read.size(), row)
            } else {
                (at, read.size())
            };
            let piece = Piece {
                at: from + at,
                step,
                count,
                chunk,
                chunks: whole,
                is_little,
            };
            self.objects[place].piece(0, read, piece)?;
        }
        Ok(())
    }

    fn daqmx_values(&mut self, from: usize, end: usize, is_little: bool) -> Result<(), Broken> {
        // For each card: the number of its rows, and the bytes of one row.
        let mut cards: Vec<(usize, usize)> = Vec::new();
        for &place in &self.list {
            if let Some(Layout::Daqmx {
                count,
                scalers,
                widths,
            }) = &self.layouts[place]
            {
                cards.resize(cards.len().max(widths.len()), (0, 0));
                for (card, width) in cards.iter_mut().zip(widths) {
                    card.1 = *width;
                }
                for (_, _, card, _) in scalers {
                    let card = cards
                        .get_mut(*card)
                        .ok_or(Broken("the raw data width of a DAQmx buffer is missing"))?;
                    card.0 = card.0.max(*count);
                }
            }
        }
        let mut starts = Vec::new();
        let mut chunk = 0_usize;
        for (rows, width) in &cards {
            starts.push(chunk);
            let size = rows.checked_mul(*width);
            chunk = (size.and_then(|size| size.checked_add(chunk)))
                .ok_or(Broken("a chunk has no size"))?;
        }
        if chunk == 0 {
            return Ok(());
        }
        let whole = (end - from) / chunk;
        self.is_cut |= !(end - from).is_multiple_of(chunk);
        for place in self.list.clone() {
            let Some(Layout::Daqmx { count, scalers, .. }) = self.layouts[place].clone() else {
                continue;
            };
            for (scale, read, card, at) in scalers {
                let piece = Piece {
                    at: from + starts[card] + at,
                    step: cards[card].1,
                    count,
                    chunk,
                    chunks: whole,
                    is_little,
                };
                self.objects[place].piece(scale, read, piece)?;
            }
        }
        Ok(())
    }
}

impl Object {
    /// Sets a property from here on.
    fn say(&mut self, name: String, value: Property) {
        if let ("wf_start_time", Property::Date(now)) = (name.as_str(), &value) {
            let samples = self.raw.first().map_or(0, |(_, pieces)| pieces.count());
            match (self.start, self.properties.get("wf_increment")) {
                (Some(first), Some(Property::Number(step))) if samples > 0 => {
                    let off = seconds(now.wrapping_sub(first)) - step * samples as f64;
                    // Some programs repeat the first start in every segment.
                    self.is_restarted |= *now != first && off.abs() > 0.5 * step;
                }
                _ => self.start = Some(*now),
            }
        }
        self.properties.insert(name, value);
    }

    fn piece(&mut self, scale: u32, read: Read, piece: Piece) -> Result<(), Broken> {
        if piece.count == 0 || piece.chunks == 0 {
            return Ok(());
        }
        let pieces = match self.raw.iter_mut().position(|(known, _)| *known == scale) {
            Some(place) => &mut self.raw[place].1,
            None => {
                self.raw.push((scale, Pieces::default()));
                let last = self.raw.len() - 1;
                &mut self.raw[last].1
            }
        };
        if pieces.read.is_some_and(|known| known != read) {
            return Err(Broken("a channel changes its type"));
        }
        pieces.read = Some(read);
        pieces.pieces.push(piece);
        Ok(())
    }
}

/// The names in a path such as `/'Rig'/'Axial force'`, in which an apostrophe is written twice.
fn names(path: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut name: Option<String> = None;
    let mut characters = path.chars().peekable();
    while let Some(c) = characters.next() {
        match (c, &mut name) {
            ('\'', Some(inner)) if characters.peek() == Some(&'\'') => {
                characters.next();
                inner.push('\'');
            }
            ('\'', Some(_)) => names.extend(name.take()),
            ('\'', None) => name = Some(String::new()),
            (c, Some(inner)) => inner.push(c),
            (_, None) => {}
        }
    }
    names
}

/// The type of values for a code; `None` for values that are not numbers.
fn read(code: u32) -> Option<Read> {
    Some(Read::Number(match code {
        1 => Kind::I8,
        2 => Kind::I16,
        3 => Kind::I32,
        4 => Kind::I64,
        5 | 0x21 => Kind::U8,
        6 => Kind::U16,
        7 => Kind::U32,
        8 => Kind::U64,
        9 | 0x19 => Kind::F32,
        10 | 0x1a => Kind::F64,
        0x44 => return Some(Read::Date),
        _ => return None,
    }))
}

/// Bytes of a value that is not a number; `None` for a text, whose length is stated.
fn size_of_other(code: u32) -> Option<usize> {
    match code {
        11 | 0x1b | 0x0010_000d => Some(16),
        0x0008_000c => Some(8),
        _ => None,
    }
}

impl Cursor<'_> {
    fn take(&mut self, count: usize) -> Result<&[u8], Broken> {
        let end = self.at.checked_add(count);
        let taken = end.and_then(|end| self.bytes.get(self.at..end));
        let taken = taken.ok_or(Broken("a segment is cut"))?;
        self.at += count;
        Ok(taken)
    }

    fn number(&mut self, kind: Kind) -> Result<f64, Broken> {
        let (at, is_little, bytes) = (self.at, self.is_little, self.bytes);
        self.take(kind.size())?;
        Ok(kind.read(bytes, at, is_little))
    }

    fn u32(&mut self) -> Result<u32, Broken> {
        let is_little = self.is_little;
        let bytes = self.take(4)?.try_into().unwrap_or_default();
        Ok(if is_little {
            u32::from_le_bytes(bytes)
        } else {
            u32::from_be_bytes(bytes)
        })
    }

    fn u64(&mut self) -> Result<u64, Broken> {
        let is_little = self.is_little;
        let bytes = self.take(8)?.try_into().unwrap_or_default();
        Ok(if is_little {
            u64::from_le_bytes(bytes)
        } else {
            u64::from_be_bytes(bytes)
        })
    }

    fn count(&mut self) -> Result<usize, Broken> {
        usize::try_from(self.u64()?).map_err(|_| Broken("a count is too large"))
    }

    fn text(&mut self) -> Result<String, Broken> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?).into_owned())
    }

    fn property(&mut self) -> Result<Property, Broken> {
        let code = self.u32()?;
        if code == 0x20 {
            return Ok(Property::Text(self.text()?));
        }
        match read(code) {
            Some(Read::Number(kind)) => Ok(Property::Number(self.number(kind)?)),
            Some(Read::Date) => {
                let at = self.at;
                self.take(Read::Date.size())?;
                Ok(Property::Date(date(self.bytes, at, self.is_little)))
            }
            _ => {
                let size = size_of_other(code);
                self.take(size.ok_or(Broken("a property is of an unknown type"))?)?;
                Ok(Property::Other)
            }
        }
    }

    fn plain(&mut self) -> Result<Layout, Broken> {
        let code = self.u32()?;
        self.u32()?;
        let count = self.count()?;
        let read = read(code);
        let bytes = match (read, size_of_other(code)) {
            (Some(read), _) => count.checked_mul(read.size()),
            (None, Some(size)) => count.checked_mul(size),
            (None, None) if code == 0x20 => Some(self.count()?),
            (None, None) => return Err(Broken("a channel is of an unknown type")),
        };
        let bytes = bytes.ok_or(Broken("a count is too large"))?;
        Ok(Layout::Plain { read, count, bytes })
    }

    fn daqmx(&mut self, is_digital: bool) -> Result<Layout, Broken> {
        self.u32()?;
        self.u32()?;
        let count = self.count()?;
        let mut scalers = Vec::new();
        for _ in 0..self.u32()? {
            let kind = match self.u32()? {
                0 => Kind::U8,
                1 => Kind::I8,
                2 => Kind::U16,
                3 => Kind::I16,
                4 => Kind::U32,
                5 => Kind::I32,
                6 => Kind::U64,
                7 => Kind::I64,
                8 => Kind::F32,
                9 => Kind::F64,
                _ => return Err(Broken("a channel is of an unknown type")),
            };
            let (card, at) = (self.u32()? as usize, self.u32()? as usize);
            self.take(if is_digital { 1 } else { 4 })?;
            let scale = self.u32()?;
            let (read, at) = if is_digital {
                (Read::Bit((at % 8) as u8), at / 8)
            } else {
                (Read::Number(kind), at)
            };
            scalers.push((scale, read, card, at));
        }
        let mut widths = Vec::new();
        for _ in 0..self.u32()? {
            widths.push(self.u32()? as usize);
        }
        Ok(Layout::Daqmx {
            count,
            scalers,
            widths,
        })
    }
}
