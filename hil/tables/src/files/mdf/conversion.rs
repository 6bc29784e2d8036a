//! Conversions from raw to measured values. Each is built once, however many channels and other conversions use it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;

use falcon_mdf::blocks::{CcBlock, ConversionType, Expr};

use super::blocks::Blocks;
use crate::files::DEEPEST;
use crate::files::refused::Refused;

const PART: &str = "its conversions";
/// The most operations and brackets of a formula, which the library follows by nested calls. Convention: ten times as many as a
/// sensor's conversion has, and within the stack.
const DEEPEST_FORMULA: usize = 500;
/// Bytes that the library takes for each sign of a formula.
const OF_SIGN: u64 = 128;

/// A conversion.
#[derive(Debug)]
pub(super) struct Conversion {
    kind: Kind,
    /// Steps for a value.
    cost: u64,
}

#[derive(Debug)]
enum Kind {
    Same,
    Linear {
        offset: f64,
        factor: f64,
    },
    Rational([f64; 6]),
    /// With its number of signs, which is that of its operations at most.
    Formula(Expr, u64),
    /// From keys to values, on lines between them or to the nearest.
    Table {
        keys: Keys,
        values: Vec<f64>,
        is_line: bool,
    },
    Ranges {
        lower: Keys,
        upper: Keys,
        to: Vec<To>,
        default: To,
    },
    Values {
        keys: Keys,
        to: Vec<To>,
        default: To,
    },
    /// From texts to numbers.
    OfTexts {
        numbers: HashMap<Rc<str>, f64>,
        default: f64,
    },
    /// To texts.
    Texts,
    /// Not read, and why.
    Unread(&'static str),
}

/// The keys of a table. They are searched by halves if they are sorted.
#[derive(Debug)]
struct Keys {
    all: Vec<f64>,
    is_sorted: bool,
}

impl Keys {
    fn new(all: impl Iterator<Item = f64>) -> Self {
        let all: Vec<f64> = all.collect();
        let is_sorted = all.is_sorted();
        Self { all, is_sorted }
    }

    /// Steps of a search.
    fn cost(&self) -> u64 {
        match self.is_sorted {
            true => 4 + u64::from(self.all.len().max(1).ilog2()),
            false => self.all.len() as u64,
        }
    }

    /// The first key that is not less than `x`.
    fn first_from(&self, x: f64) -> usize {
        self.all.partition_point(|key| *key < x)
    }
}

/// What an entry of a table gives.
#[derive(Clone, Debug)]
enum To {
    Number(f64),
    By(Rc<Conversion>),
}

impl Conversion {
    /// Why its channel is not read, if it is not.
    pub fn unread(&self) -> Option<&'static str> {
        match &self.kind {
            Kind::Texts => Some("texts"),
            Kind::Unread(why) => Some(why),
            _ => None,
        }
    }

    /// Whether it takes texts.
    pub fn is_of_texts(&self) -> bool {
        matches!(self.kind, Kind::OfTexts { .. })
    }

    /// Steps for a value.
    pub fn cost(&self) -> u64 {
        self.cost
    }

    /// The number of a text.
    pub fn of_text(&self, text: &str) -> f64 {
        match &self.kind {
            Kind::OfTexts { numbers, default } => numbers.get(text).copied().unwrap_or(*default),
            _ => f64::NAN,
        }
    }

    /// Converts values; `is_float` says whether they were stored as floats.
    pub fn convert(&self, values: &mut [f64], is_float: bool) {
        match &self.kind {
            Kind::Same => {}
            Kind::Linear { offset, factor } => {
                for value in values {
                    *value = factor * *value + offset;
                }
            }
            _ => {
                for value in values {
                    *value = self.of(*value, is_float);
                }
            }
        }
    }

    fn of(&self, x: f64, is_float: bool) -> f64 {
        match &self.kind {
            Kind::Same => x,
            Kind::Linear { offset, factor } => factor * x + offset,
            Kind::Rational([a, b, c, d, e, f]) => (a * x * x + b * x + c) / (d * x * x + e * x + f),
            Kind::Formula(formula, _) => formula.eval(x),
            Kind::Table {
                keys,
                values,
                is_line,
            } => match is_line {
                true => on_line(keys, values, x),
                false => nearest(keys, values, x),
            },
            Kind::Ranges {
                lower,
                upper,
                to,
                default,
            } => {
                let found = range(lower, upper, x, is_float).and_then(|at| to.get(at));
                found.unwrap_or(default).of(x, is_float)
            }
            Kind::Values { keys, to, default } => {
                let at = match keys.is_sorted {
                    true => Some(keys.first_from(x)).filter(|&at| keys.all.get(at) == Some(&x)),
                    false => keys.all.iter().position(|&key| key == x),
                };
                let found = at.and_then(|at| to.get(at));
                found.unwrap_or(default).of(x, is_float)
            }
            Kind::OfTexts { .. } | Kind::Texts | Kind::Unread(_) => f64::NAN,
        }
    }
}

impl To {
    fn of(&self, x: f64, is_float: bool) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::By(conversion) => conversion.of(x, is_float),
        }
    }

    fn cost(&self) -> u64 {
        match self {
            Self::Number(_) => 0,
            Self::By(conversion) => conversion.cost,
        }
    }
}

/// The last range that has `x`. The upper end of a range of floats belongs to the next, that of another to both.
fn range(lower: &Keys, upper: &Keys, x: f64, is_float: bool) -> Option<usize> {
    let has = |at: &usize| {
        let (from, to) = (lower.all[*at], upper.all[*at]);
        x >= from && (x < to || (x == to && !is_float))
    };
    if lower.is_sorted && upper.is_sorted {
        let after = lower.all.partition_point(|from| *from <= x);
        return after.checked_sub(1).filter(has);
    }
    (0..lower.all.len()).rev().find(has)
}

/// Between two keys on the line through their values, and constant beyond the ends.
fn on_line(keys: &Keys, values: &[f64], x: f64) -> f64 {
    let all = &keys.all;
    let last = all.len() - 1;
    if x <= all[0] {
        return values[0];
    }
    if x >= all[last] {
        return values[last];
    }
    let at = match keys.is_sorted {
        true => keys.first_from(x).checked_sub(1).filter(|&at| at < last),
        false => (0..last).find(|&at| x >= all[at] && x <= all[at + 1]),
    };
    let Some(at) = at.filter(|_| !x.is_nan()) else {
        return x;
    };
    let span = all[at + 1] - all[at];
    if span == 0.0 {
        return values[at];
    }
    values[at] + (x - all[at]) / span * (values[at + 1] - values[at])
}

/// The value of the nearest key, the first of several.
fn nearest(keys: &Keys, values: &[f64], x: f64) -> f64 {
    let all = &keys.all;
    let places = match keys.is_sorted {
        true => {
            let after = keys.first_from(x);
            let before = all.get(after.saturating_sub(1));
            before.map_or(0, |&key| keys.first_from(key))..(after + 1).min(all.len())
        }
        false => 0..all.len(),
    };
    let mut best = 0;
    let mut least = f64::MAX;
    for at in places {
        let off = (x - all[at]).abs();
        if off < least {
            (best, least) = (at, off);
        }
    }
    values[best]
}

/// The conversions that were built.
pub(super) struct Conversions {
    built: RefCell<HashMap<u64, Rc<Conversion>>>,
}

impl Conversions {
    pub fn new() -> Self {
        Self {
            built: RefCell::default(),
        }
    }

    /// The conversion at a link.
    pub fn at(&self, blocks: &Blocks, link: u64) -> Result<Rc<Conversion>, Refused> {
        self.nested(blocks, link, DEEPEST)
    }

    fn nested(&self, blocks: &Blocks, link: u64, depth: usize) -> Result<Rc<Conversion>, Refused> {
        if let Some(built) = self.built.borrow().get(&link) {
            return Ok(built.clone());
        }
        let entry = 2 * (size_of::<(u64, Rc<Conversion>)>() + size_of::<Conversion>());
        blocks.budget.hold(entry as u64, PART)?;
        // Until it is built, a way back to it leads to nothing.
        let nothing = Conversion {
            kind: Kind::Texts,
            cost: 1,
        };
        self.built.borrow_mut().insert(link, Rc::new(nothing));
        let kind = match link {
            0 => Kind::Same,
            _ => self.kind(blocks, &blocks.block(link)?, depth)?,
        };
        let cost = match &kind {
            Kind::Formula(_, signs) => 1 + signs,
            Kind::Table { keys, .. } => keys.cost(),
            Kind::Values { keys, to, default } => keys.cost() + nested(to, default),
            Kind::Ranges {
                lower,
                upper,
                to,
                default,
            } => lower.cost().max(upper.cost()) + nested(to, default),
            _ => 1,
        };
        let built = Rc::new(Conversion { kind, cost });
        self.built.borrow_mut().insert(link, built.clone());
        Ok(built)
    }

    fn kind(&self, blocks: &Blocks, block: &CcBlock, depth: usize) -> Result<Kind, Refused> {
        let (values, links) = (&block.values, &block.references);
        let size = size_of::<f64>() * values.len() + size_of::<To>() * links.len();
        blocks.budget.hold(2 * size as u64, PART)?;
        let few = Kind::Unread("a conversion without its numbers");
        let every = |from: usize, step: usize| values.iter().skip(from).step_by(step).copied();
        Ok(match block.conversion_type {
            ConversionType::Identity => Kind::Same,
            ConversionType::Linear => match values[..] {
                [offset, factor, ..] if offset == 0.0 && factor == 1.0 => Kind::Same,
                [offset, factor, ..] => Kind::Linear { offset, factor },
                _ => few,
            },
            ConversionType::Rational => match values.first_chunk() {
                Some(numbers) => Kind::Rational(*numbers),
                None => few,
            },
            ConversionType::Algebraic => {
                let text = blocks.text(links.first().copied().unwrap_or(0))?;
                formula(blocks, &text)?
            }
            ConversionType::TabInterpolation | ConversionType::TabLookup => {
                let count = values.len() / 2;
                match count {
                    0 => few,
                    _ => Kind::Table {
                        keys: Keys::new(every(0, 2).take(count)),
                        values: every(1, 2).collect(),
                        is_line: block.conversion_type == ConversionType::TabInterpolation,
                    },
                }
            }
            ConversionType::TabRangeLookup => {
                let count = values.len() / 3;
                let default = (values.len() % 3 == 1)
                    .then(|| values.last().copied())
                    .flatten();
                match (count, default) {
                    (0, None) => few,
                    _ => Kind::Ranges {
                        lower: Keys::new(every(0, 3).take(count)),
                        upper: Keys::new(every(1, 3).take(count)),
                        to: every(2, 3).take(count).map(To::Number).collect(),
                        default: To::Number(default.unwrap_or(f64::NAN)),
                    },
                }
            }
            ConversionType::TabValueToText => {
                match self.entries(blocks, links, values.len(), depth)? {
                    Some((to, default)) => Kind::Values {
                        keys: Keys::new(values.iter().copied()),
                        to,
                        default,
                    },
                    None => Kind::Texts,
                }
            }
            ConversionType::TabRangeToText => {
                let count = values.len() / 2;
                match self.entries(blocks, links, count, depth)? {
                    Some((to, default)) => Kind::Ranges {
                        lower: Keys::new(every(0, 2).take(count)),
                        upper: Keys::new(every(1, 2)),
                        to,
                        default,
                    },
                    None => Kind::Texts,
                }
            }
            ConversionType::TabTextToValue => {
                if values.len() < links.len() {
                    return Ok(few);
                }
                let mut numbers = HashMap::new();
                for (&link, &value) in links.iter().zip(values) {
                    numbers.entry(blocks.text(link)?).or_insert(value);
                }
                let default = values.get(links.len()).copied().unwrap_or(f64::NAN);
                Kind::OfTexts { numbers, default }
            }
            ConversionType::TabTextToText | ConversionType::BitfieldToText => Kind::Texts,
            ConversionType::Unknown(_) => Kind::Unread("an unknown conversion"),
        })
    }

    /// What the entries of a table give, and what it gives for other values; `None` if one of them is a text.
    fn entries(
        &self,
        blocks: &Blocks,
        links: &[u64],
        count: usize,
        depth: usize,
    ) -> Result<Option<(Vec<To>, To)>, Refused> {
        let Some(depth) = depth.checked_sub(1) else {
            return Ok(None);
        };
        let mut to = Vec::new();
        for place in 0..=count {
            let link = links.get(place).copied().unwrap_or(0);
            let is_default = place == count;
            let is_conversion =
                || Ok::<_, Refused>(link != 0 && &blocks.head(link)?.block_type == b"##CC");
            match is_conversion() {
                Ok(true) => to.push(To::By(self.nested(blocks, link, depth)?)),
                Ok(false) if is_default && link == 0 => to.push(To::Number(f64::NAN)),
                Ok(false) | Err(Refused::Damaged(_) | Refused::Unread(..)) => return Ok(None),
                Err(why) => return Err(why),
            }
        }
        Ok(to.pop().map(|default| (to, default)))
    }
}

/// Steps of the longest of nested conversions.
fn nested(to: &[To], default: &To) -> u64 {
    let costs = to.iter().chain([default]).map(To::cost);
    costs.max().unwrap_or_default()
}

fn formula(blocks: &Blocks, text: &str) -> Result<Kind, Refused> {
    let signs = text.bytes().filter(|byte| b"+-*/^(".contains(byte)).count();
    if signs > DEEPEST_FORMULA {
        return Ok(Kind::Unread("a formula of too many operations"));
    }
    blocks.budget.work(text.len() as u64, PART)?;
    blocks.budget.hold(OF_SIGN * text.len() as u64, PART)?;
    Ok(match Expr::parse(text) {
        Ok(formula) => Kind::Formula(formula, signs as u64),
        Err(_) => Kind::Unread("a formula that is not known here"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn conversion(kind: Kind) -> Conversion {
        Conversion { kind, cost: 1 }
    }

    fn keys(all: &[f64]) -> Keys {
        Keys::new(all.iter().copied())
    }

    /// The same table with sorted keys, which are searched by halves, and with its first key once more at the end.
    #[test]
    fn a_table_gives_the_same_however_it_is_searched() {
        let (sorted, values) = ([-2.0, 0.0, 0.0, 3.0, 7.0], [5.0, 1.0, 2.0, -4.0, 8.0]);
        let plain = Keys {
            all: sorted.to_vec(),
            is_sorted: false,
        };
        assert!(keys(&sorted).is_sorted && !keys(&[1.0, 0.0]).is_sorted);
        for x in [
            -9.0,
            -2.0,
            -1.5,
            0.0,
            0.4,
            1.5,
            2.9,
            3.0,
            6.9,
            7.0,
            70.0,
            f64::NAN,
        ] {
            let same = |a: f64, b: f64| a == b || (a.is_nan() && b.is_nan());
            let line = on_line(&keys(&sorted), &values, x);
            assert!(same(line, on_line(&plain, &values, x)), "{x}: {line}");
            let near = nearest(&keys(&sorted), &values, x);
            assert!(same(near, nearest(&plain, &values, x)), "{x}: {near}");
        }
        assert_eq!(on_line(&keys(&sorted), &values, 1.5), -1.0);
        assert_eq!(on_line(&keys(&[1.0]), &[4.0], 9.0), 4.0);
        // Of two keys as near as each other the first counts.
        assert_eq!(nearest(&keys(&[0.0, 2.0]), &[1.0, 5.0], 1.0), 1.0);
    }

    #[test]
    fn the_end_of_a_range_belongs_to_the_next_of_floats_and_to_the_later_of_others() {
        let ranges = |lower: &[f64], upper: &[f64]| {
            conversion(Kind::Ranges {
                lower: keys(lower),
                upper: keys(upper),
                to: vec![To::Number(1.0), To::Number(2.0), To::Number(3.0)],
                default: To::Number(f64::NAN),
            })
        };
        let (from, to) = ([1.0, 3.0, 8.0], [3.0, 5.0, 9.0]);
        // The same with the first range at the end.
        let turned = ranges(&[3.0, 8.0, 1.0], &[5.0, 9.0, 3.0]);
        for (x, is_float, number) in [
            (1.0, true, Some(1.0)),
            (3.0, true, Some(2.0)),
            (3.0, false, Some(2.0)),
            (5.0, false, Some(2.0)),
            (5.0, true, None),
            (6.0, false, None),
            (0.0, false, None),
        ] {
            let found = ranges(&from, &to).of(x, is_float);
            assert_eq!(Some(found).filter(|x| !x.is_nan()), number, "{x}");
            if x != 3.0 {
                let other = turned.of(x, is_float);
                let number = number.map(|number| if number == 1.0 { 3.0 } else { number - 1.0 });
                assert_eq!(Some(other).filter(|x| !x.is_nan()), number, "{x}");
            }
        }
    }

    #[test]
    fn entries_may_be_conversions_themselves() {
        let twice = Rc::new(conversion(Kind::Linear {
            offset: 1.0,
            factor: 2.0,
        }));
        let values = conversion(Kind::Values {
            keys: keys(&[1.0, 4.0]),
            to: vec![To::By(twice.clone()), To::Number(7.0)],
            default: To::By(twice),
        });
        assert_eq!(
            [1.0, 4.0, 5.0].map(|x| values.of(x, false)),
            [3.0, 7.0, 11.0]
        );
        let rational = conversion(Kind::Rational([1.0, 2.0, 3.0, 0.0, 0.0, 2.0]));
        assert_eq!(rational.of(2.0, false), 5.5);
    }
}
