//! The words, texts and properties in a segment's metadata.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use super::layout::{Layout, Plain, Read, Scaler, Scalers, date};
use crate::budget::Budget;
use crate::files::number::Kind;
use crate::files::refused::Refused;

const PART: &str = "its channels and their properties";

/// A property of an object.
#[derive(Clone, Debug)]
pub(super) enum Property {
    Number(f64),
    Text(Rc<str>),
    /// In 2⁻⁶⁴ s.
    Date(i128),
    Other,
}

/// The properties of an object, by their names.
pub(super) type Properties = HashMap<Rc<str>, Property>;

/// Texts, each of which is held once: many channels have the same units, and properties of the same names.
pub(super) struct Texts<'b> {
    pub budget: &'b Budget,
    known: HashSet<Rc<str>>,
}

impl<'b> Texts<'b> {
    pub fn new(budget: &'b Budget) -> Self {
        Self {
            budget,
            known: HashSet::new(),
        }
    }

    pub fn once(&mut self, text: &str) -> Result<Rc<str>, Refused> {
        self.budget.work(8 + text.len() as u64, PART)?;
        if let Some(known) = self.known.get(text) {
            return Ok(known.clone());
        }
        let size = text.len() + 2 * size_of::<Rc<str>>() + 16;
        self.budget.hold(size as u64, PART)?;
        let text: Rc<str> = text.into();
        self.known.insert(text.clone());
        Ok(text)
    }
}

/// A position in the file's bytes.
pub(super) struct Cursor<'b> {
    pub bytes: &'b [u8],
    pub at: usize,
    pub is_little: bool,
}

impl<'b> Cursor<'b> {
    pub fn take(&mut self, count: usize) -> Result<&'b [u8], Refused> {
        let end = self.at.checked_add(count);
        let taken = end.and_then(|end| self.bytes.get(self.at..end));
        let taken = taken.ok_or("a segment is cut")?;
        self.at += count;
        Ok(taken)
    }

    fn number(&mut self, kind: Kind) -> Result<f64, Refused> {
        let at = self.at;
        self.take(kind.size())?;
        Ok(kind.read(self.bytes, at, self.is_little))
    }

    pub fn u32(&mut self) -> Result<u32, Refused> {
        let bytes = self.take(4)?.try_into().unwrap_or_default();
        Ok(if self.is_little {
            u32::from_le_bytes(bytes)
        } else {
            u32::from_be_bytes(bytes)
        })
    }

    pub fn u64(&mut self) -> Result<u64, Refused> {
        let bytes = self.take(8)?.try_into().unwrap_or_default();
        Ok(if self.is_little {
            u64::from_le_bytes(bytes)
        } else {
            u64::from_be_bytes(bytes)
        })
    }

    fn count(&mut self) -> Result<usize, Refused> {
        usize::try_from(self.u64()?).map_err(|_| "a count is too large".into())
    }

    pub fn text(&mut self) -> Result<Cow<'b, str>, Refused> {
        let length = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(length)?))
    }

    pub fn property(&mut self, texts: &mut Texts<'_>) -> Result<Property, Refused> {
        let code = self.u32()?;
        if code == 0x20 {
            return Ok(Property::Text(texts.once(&self.text()?)?));
        }
        match Read::of(code) {
            Some(Read::Number(kind)) => Ok(Property::Number(self.number(kind)?)),
            Some(Read::Date) => {
                let at = self.at;
                self.take(Read::Date.size())?;
                Ok(Property::Date(date(self.bytes, at, self.is_little)))
            }
            _ => {
                let size = size_of_other(code);
                self.take(size.ok_or("a property is of an unknown type")?)?;
                Ok(Property::Other)
            }
        }
    }

    /// The layout of a channel whose values lie one after the other.
    pub fn plain(&mut self) -> Result<Layout, Refused> {
        let code = self.u32()?;
        self.u32()?;
        let count = self.count()?;
        let read = Read::of(code);
        let bytes = match (read, size_of_other(code)) {
            (Some(read), _) => count.checked_mul(read.size()),
            (None, Some(size)) => count.checked_mul(size),
            (None, None) if code == 0x20 => Some(self.count()?),
            (None, None) => return Err("a channel is of an unknown type".into()),
        };
        let bytes = bytes.ok_or("a count is too large")?;
        Ok(Layout::Plain(Plain { read, count, bytes }))
    }

    /// The layout of a channel of DAQmx, whose values lie in the rows of cards.
    pub fn daqmx(&mut self, is_digital: bool, budget: &Budget) -> Result<Layout, Refused> {
        self.u32()?;
        self.u32()?;
        let count = self.count()?;
        let mut scalers = Vec::new();
        let mut by_scale = HashMap::new();
        for _ in 0..self.u32()? {
            let size = size_of::<Scaler>() + size_of::<(u32, usize)>();
            budget.hold(2 * size as u64, PART)?;
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
                _ => return Err("a channel is of an unknown type".into()),
            };
            let (card, at) = (self.u32()? as usize, self.u32()? as usize);
            self.take(if is_digital { 1 } else { 4 })?;
            let scale = self.u32()?;
            let (read, at) = if is_digital {
                (Read::Bit((at % 8) as u8), at / 8)
            } else {
                (Read::Number(kind), at)
            };
            by_scale.entry(scale).or_insert(scalers.len());
            scalers.push(Scaler {
                scale,
                read,
                card,
                at,
            });
        }
        let mut widths = Vec::new();
        for _ in 0..self.u32()? {
            budget.hold(2 * size_of::<usize>() as u64, PART)?;
            widths.push(self.u32()? as usize);
        }
        Ok(Layout::Daqmx(Rc::new(Scalers {
            count,
            all: scalers,
            by_scale,
            widths,
        })))
    }
}

/// Bytes of a value that is not a number; `None` for a text, whose length is stated.
fn size_of_other(code: u32) -> Option<usize> {
    match code {
        11 | 0x1b | 0x0010_000d => Some(16),
        0x0008_000c => Some(8),
        _ => None,
    }
}
