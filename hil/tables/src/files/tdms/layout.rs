//! Where the values of channels lie: in each chunk of a segment, and in all segments.

use std::collections::HashMap;
use std::rc::Rc;

use crate::budget::Budget;
use crate::files::number::Kind;
use crate::files::refused::Refused;

const PART: &str = "the places of its values";

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
    /// The type of values for a code; `None` for values that are not numbers.
    pub fn of(code: u32) -> Option<Self> {
        Some(Self::Number(match code {
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
            0x44 => return Some(Self::Date),
            _ => return None,
        }))
    }

    pub fn size(self) -> usize {
        match self {
            Self::Number(kind) => kind.size(),
            Self::Bit(_) => 1,
            Self::Date => 16,
        }
    }
}

/// Of 2⁻⁶⁴ s.
pub(super) fn seconds(parts: i128) -> f64 {
    parts as f64 / 2_f64.powi(64)
}

/// A date in 2⁻⁶⁴ s.
pub(super) fn date(bytes: &[u8], at: usize, is_little: bool) -> i128 {
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

/// Layout of the values of an object in a chunk, as the file states it. Segments that repeat it share it.
#[derive(Clone, Debug)]
pub(super) enum Layout {
    Plain(Plain),
    Daqmx(Rc<Scalers>),
}

/// Values one after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Plain {
    /// `None` for values that are not numbers, such as texts.
    pub read: Option<Read>,
    pub count: usize,
    pub bytes: usize,
}

/// Values in the rows of cards.
#[derive(Debug, PartialEq)]
pub(super) struct Scalers {
    pub count: usize,
    pub all: Vec<Scaler>,
    /// The first for each scale.
    pub by_scale: HashMap<u32, usize>,
    /// Bytes of a row of each card.
    pub widths: Vec<usize>,
}

/// Raw values of DAQmx: the scale that takes them, the card, and the byte in the card's row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scaler {
    pub scale: u32,
    pub read: Read,
    pub card: usize,
    pub at: usize,
}

/// Values at equal steps in a chunk.
#[derive(Clone, Debug, PartialEq)]
enum Values {
    Plain {
        read: Read,
        at: usize,
        step: usize,
        count: usize,
    },
    Daqmx(Rc<Scalers>),
}

/// The chunks of segments: what is where in them.
#[derive(Debug, PartialEq)]
pub(super) struct Plan {
    /// By the objects, which are sorted.
    members: Vec<(usize, Values)>,
    /// Objects with other values than numbers.
    pub others: Vec<usize>,
    /// The first byte of each card, and the bytes of its rows.
    cards: Vec<(usize, usize)>,
    /// Bytes of a chunk.
    pub size: usize,
    is_little: bool,
}

/// The number of values of a channel in a chunk, and how they are read by the scale that takes them.
pub(super) struct Member<'p> {
    pub object: usize,
    pub count: usize,
    values: &'p Values,
}

impl Member<'_> {
    /// The scales that take raw values of the channel, in their order, and how these are read.
    pub fn reads(&self) -> impl Iterator<Item = (u32, Read)> {
        let (one, all) = match self.values {
            Values::Plain { read, .. } => (Some((0, *read)), &[][..]),
            Values::Daqmx(scalers) => (None, &scalers.all[..]),
        };
        let all = all.iter().map(|scaler| (scaler.scale, scaler.read));
        one.into_iter().chain(all)
    }

    /// Whether the layout is that of an earlier chunk of the channel.
    pub fn is_of(&self, known: Option<&Rc<Scalers>>) -> bool {
        match (self.values, known) {
            (Values::Daqmx(scalers), Some(known)) => Rc::ptr_eq(scalers, known),
            _ => false,
        }
    }

    /// The layout, if it is of DAQmx.
    pub fn scalers(&self) -> Option<&Rc<Scalers>> {
        match self.values {
            Values::Plain { .. } => None,
            Values::Daqmx(scalers) => Some(scalers),
        }
    }
}

impl Plan {
    /// The plan of chunks with the values of some objects, in their order.
    pub fn plain(
        list: impl Iterator<Item = (usize, Plain)> + Clone,
        is_interleaved: bool,
        is_little: bool,
        budget: &Budget,
    ) -> Result<Self, Refused> {
        let row: usize = (list.clone())
            .filter_map(|(_, plain)| Some(plain.read?.size()))
            .fold(0, usize::saturating_add);
        let (mut size, mut column) = (0_usize, 0);
        let (mut members, mut others) = (Vec::new(), Vec::new());
        for (object, plain) in list {
            let at = size;
            let next = size.checked_add(plain.bytes);
            size = next.ok_or("a chunk has no size")?;
            budget.hold(2 * size_of::<(usize, Values)>() as u64, PART)?;
            let Some(read) = plain.read else {
                others.push(object);
                continue;
            };
            let (at, step) = match is_interleaved {
                true => (column, row),
                false => (at, read.size()),
            };
            column += read.size();
            let count = plain.count;
            members.push((
                object,
                Values::Plain {
                    read,
                    at,
                    step,
                    count,
                },
            ));
        }
        members.sort_by_key(|(object, _)| *object);
        Ok(Self {
            members,
            others,
            cards: Vec::new(),
            size,
            is_little,
        })
    }

    /// The same for channels of DAQmx.
    pub fn daqmx(
        list: impl Iterator<Item = (usize, Rc<Scalers>)>,
        is_little: bool,
        budget: &Budget,
    ) -> Result<Self, Refused> {
        let mut members = Vec::new();
        // For each card: the number of its rows, and the bytes of one row.
        let mut rows: Vec<(usize, usize)> = Vec::new();
        for (object, scalers) in list {
            let widths = scalers.widths.len();
            budget.work((widths + scalers.all.len()) as u64, PART)?;
            budget.hold(2 * size_of::<(usize, Values)>() as u64, PART)?;
            if widths > rows.len() {
                let more = (widths - rows.len()) * size_of::<(usize, usize)>();
                budget.hold(3 * more as u64, PART)?;
                rows.resize(widths, (0, 0));
            }
            for (card, width) in rows.iter_mut().zip(&scalers.widths) {
                card.1 = *width;
            }
            for scaler in &scalers.all {
                let missing = "the raw data width of a DAQmx buffer is missing";
                let card = rows.get_mut(scaler.card).ok_or(missing)?;
                card.0 = card.0.max(scalers.count);
            }
            members.push((object, Values::Daqmx(scalers)));
        }
        let (mut cards, mut size) = (Vec::with_capacity(rows.len()), 0_usize);
        for (rows, width) in rows {
            cards.push((size, width));
            let card = rows.checked_mul(width);
            size = (card.and_then(|card| card.checked_add(size))).ok_or("a chunk has no size")?;
        }
        members.sort_by_key(|(object, _)| *object);
        Ok(Self {
            members,
            others: Vec::new(),
            cards,
            size,
            is_little,
        })
    }

    /// Bytes that are held for it.
    pub fn held(&self) -> u64 {
        let members = 2 * self.members.len() * size_of::<(usize, Values)>();
        (members + 3 * self.cards.len() * size_of::<(usize, usize)>()) as u64
    }

    /// The channels with values in a chunk.
    pub fn members(&self) -> impl Iterator<Item = Member<'_>> {
        self.members.iter().map(|(object, values)| Member {
            object: *object,
            count: count(values),
            values,
        })
    }

    /// The number of values of an object in a chunk.
    pub fn count(&self, object: usize) -> usize {
        self.of(object).map_or(0, count)
    }

    fn of(&self, object: usize) -> Option<&Values> {
        let at = (self.members).binary_search_by_key(&object, |(object, _)| *object);
        Some(&self.members[at.ok()?].1)
    }
}

fn count(values: &Values) -> usize {
    match values {
        Values::Plain { count, .. } => *count,
        Values::Daqmx(scalers) if scalers.all.is_empty() => 0,
        Values::Daqmx(scalers) => scalers.count,
    }
}

/// Segments of one plan: where the chunks of each begin, and how many it has.
#[derive(Debug)]
pub(super) struct Run {
    pub plan: Rc<Plan>,
    pub segments: Vec<(usize, usize)>,
    /// The chunks of all of them.
    pub chunks: usize,
}

/// The raw values of an object that the scale `number` takes, `rows` of them; NaN beyond the file's end, and where segments have none.
pub(super) fn raw(runs: &[Run], object: usize, number: u32, rows: usize, bytes: &[u8]) -> Vec<f64> {
    let mut values = Vec::with_capacity(rows);
    let mut first = None;
    for run in runs {
        let plan = &run.plan;
        let Some(found) = plan.of(object) else {
            continue;
        };
        let count = count(found);
        if count == 0 {
            continue;
        }
        let place = match found {
            Values::Plain { read, at, step, .. } => Some((*read, *at, *step)),
            Values::Daqmx(scalers) => scalers.by_scale.get(&number).map(|&place| {
                let scaler = scalers.all[place];
                let (start, width) = plan.cards[scaler.card];
                (scaler.read, start + scaler.at, width)
            }),
        };
        for (from, chunks) in &run.segments {
            for chunk in 0..*chunks {
                let from = from + chunk * plan.size;
                let Some((read, at, step)) = place else {
                    values.extend(std::iter::repeat_n(f64::NAN, count));
                    continue;
                };
                let places = (0..count).map(|index| from + at + index * step);
                match read {
                    Read::Number(kind) => {
                        kind.read_each(bytes, places, plan.is_little, |value| values.push(value));
                    }
                    Read::Bit(bit) => values.extend(places.map(|at| {
                        let byte = bytes.get(at);
                        byte.map_or(f64::NAN, |byte| f64::from(byte >> bit & 1))
                    })),
                    Read::Date => values.extend(places.map(|at| {
                        let date = date(bytes, at, plan.is_little);
                        let first = *first.get_or_insert(date);
                        seconds(date.wrapping_sub(first))
                    })),
                }
            }
        }
    }
    values
}
