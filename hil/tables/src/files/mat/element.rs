//! The elements of a MAT file: a type, a size, and that many bytes.

use std::sync::Arc;

use crate::files::number::Kind;
use crate::files::refused::Refused;

type Parsed<T> = Result<T, Refused>;

/// A run of bytes, and the reading position.
#[derive(Clone, Debug)]
pub(in crate::files) struct Bytes {
    all: Arc<Vec<u8>>,
    at: usize,
    end: usize,
    is_little: bool,
}

/// One element.
#[derive(Clone, Debug)]
pub(super) enum Element {
    Numbers(Numbers),
    Matrix(Bytes),
    Compressed(Bytes),
    /// Texts in Unicode, and elements of later versions.
    Other(u32, Bytes),
}

/// Numbers of one type.
#[derive(Clone, Debug)]
pub(in crate::files) struct Numbers {
    pub kind: Kind,
    pub bytes: Bytes,
}

/// The type of an element's numbers.
fn kind(code: u32) -> Option<Kind> {
    Some(match code {
        1 => Kind::I8,
        2 => Kind::U8,
        3 => Kind::I16,
        4 => Kind::U16,
        5 => Kind::I32,
        6 => Kind::U32,
        7 => Kind::F32,
        9 => Kind::F64,
        12 => Kind::I64,
        13 => Kind::U64,
        _ => return None,
    })
}

impl Bytes {
    pub fn new(all: Arc<Vec<u8>>, at: usize, is_little: bool) -> Self {
        let end = all.len();
        Self {
            all,
            at: at.min(end),
            end,
            is_little,
        }
    }

    /// The next bytes, without reading them.
    pub fn part(mut self, count: usize, is_little: bool) -> Parsed<Self> {
        let taken = self.take(count)?;
        Ok(Self { is_little, ..taken })
    }

    pub fn slice(&self) -> &[u8] {
        &self.all[self.at..self.end]
    }

    fn take(&mut self, count: usize) -> Parsed<Self> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.end);
        let end = end.ok_or("it ends in the middle of a variable")?;
        let taken = Self {
            at: self.at,
            end,
            ..self.clone()
        };
        self.at = end;
        Ok(taken)
    }

    fn u32(&mut self) -> Parsed<u32> {
        let word = self.take(4)?;
        let bytes = <[u8; 4]>::try_from(word.slice()).unwrap_or_default();
        Ok(if self.is_little {
            u32::from_le_bytes(bytes)
        } else {
            u32::from_be_bytes(bytes)
        })
    }

    /// The next element; `None` at the end.
    pub(super) fn next(&mut self) -> Parsed<Option<Element>> {
        // Some programs fill the end with less than an element's head.
        if self.end - self.at < 8 {
            return Ok(None);
        }
        let first = self.u32()?;
        let (code, bytes) = if first >> 16 == 0 {
            let size = self.u32()? as usize;
            let bytes = self.take(size)?;
            // All but packed ones are padded to multiples of eight; the last one may lack the padding.
            if first != 15 {
                let fill = (8 - size % 8) % 8;
                self.at = (self.at + fill).min(self.end);
            }
            (first, bytes)
        } else {
            // Up to four bytes are stored in the size field.
            let (code, size) = (first & 0xffff, (first >> 16) as usize);
            if size > 4 {
                return Err("a short element is longer than four bytes".into());
            }
            let mut place = self.take(4)?;
            (code, place.take(size)?)
        };
        Ok(Some(match (kind(code), code) {
            (Some(kind), _) => Element::Numbers(Numbers { kind, bytes }),
            (None, 14) => Element::Matrix(bytes),
            (None, 15) => Element::Compressed(bytes),
            (None, _) => Element::Other(code, bytes),
        }))
    }

    /// The next element, which has to be numbers.
    pub fn numbers(&mut self) -> Parsed<Numbers> {
        match self.next()? {
            Some(Element::Numbers(numbers)) => Ok(numbers),
            _ => Err("a variable lacks its numbers".into()),
        }
    }
}

impl Numbers {
    /// What only other copies of these numbers have: where they are, and how they are read.
    pub fn key(&self) -> [usize; 2] {
        let kind = 2 * self.kind as usize + usize::from(self.bytes.is_little);
        [self.bytes.slice().as_ptr().addr(), kind]
    }

    pub fn len(&self) -> usize {
        self.bytes.slice().len() / self.kind.size()
    }

    /// The number at an index, NaN beyond the last.
    pub fn get(&self, index: usize) -> f64 {
        let at = index.saturating_mul(self.kind.size());
        let bytes = self.bytes.slice();
        self.kind.read(bytes, at, self.bytes.is_little)
    }

    /// All of them as text, one or two bytes each.
    pub fn text(&self) -> String {
        let codes = (0..self.len()).map(|index| self.get(index) as u16);
        match self.kind {
            Kind::I8 | Kind::U8 => String::from_utf8_lossy(self.bytes.slice()).into_owned(),
            _ => char::decode_utf16(codes)
                .map(|code| code.unwrap_or(char::REPLACEMENT_CHARACTER))
                .collect(),
        }
    }
}
