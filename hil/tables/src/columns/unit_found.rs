//! Information about a column's unit in its name and in the file.

use mesh_damper_output::error::quoted;

use super::name::Name;
use super::spelling::{Spelt, bare, control_unit, control_unit_like, unit_of};
use super::taken::own_name;
use super::words::Words;
use crate::channel::Channel;
use crate::files::Column;
use crate::units::Unit;

/// Information about the unit of a channel in a column's name and unit.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum UnitFound {
    /// One of the channel's.
    Known(Unit),
    /// The file states a unit that the channel cannot have, or that is unknown.
    Unknown(String),
    /// The file states two, or an ambiguous one: the statement, and the units that it may mean, if they are known.
    Unclear(String, Vec<&'static str>),
    /// None is stated.
    None,
}

/// The file's statement about a column's unit, for one channel.
pub(super) fn unit_for(column: &Column, channel: Channel) -> UnitFound {
    match own_name(&column.name) {
        Some((own, symbol)) if own == channel => own_unit(column, channel, symbol),
        _ => unit_and_words(column, &Name::of(&column.name), channel).0,
    }
}

/// The text in the brackets of a name, if it may be a unit and is not a known one: `Zaman (sn)`.
pub(super) fn unknown_unit(column: &Column) -> Option<String> {
    let name = Name::of(&column.name);
    let written = name.bracketed?;
    let words = Words::of(&written);
    let is_word = words.is_other() || words.are_understood();
    (!is_word || words.has_letter()).then_some(written)
}

/// Information about the unit of a control input.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ControlUnit {
    Known(&'static str),
    /// Two statements differ: both, `mA beside A`, and the units among them; the first is that beside the name, if there is one.
    Unclear(String, Vec<&'static str>),
}

/// The unit that a column states for a control input, beside its name or in it, and the words of the name without it; `None` without
/// a unit that is read. `means` are words for the quantity.
///
/// Every other statement in the name must be the same. One that the quantity cannot have is none: the port of `Pressure A`.
pub(super) fn control_unit_and_words(
    column: &Column,
    name: &Name,
    means: Words,
) -> Option<(ControlUnit, Words)> {
    let read = control_unit;
    let rows = || row_units(column);
    let marked = name.marked.as_deref();
    let (written, unit, words) = match rows().next().or(marked) {
        Some(written) => (written, read(written)?, name.words),
        None => (name.tails.iter()).find_map(|tail| {
            let unit = tail.spelt?.of_control(&tail.text)?;
            Some((&*tail.text, unit, tail.before))
        })?,
    };
    let is_possible = |unit: Option<&str>| unit.is_some_and(|unit| means.may_have(unit));
    let in_brackets = marked.or(name.bracketed.as_deref());
    let in_brackets =
        in_brackets.filter(|text| is_possible(read(text).or(control_unit_like(text))));
    // `Current_ma` in A. `Volt` may be the word for the quantity, and the A of `Druck pA` is a port.
    let tails = name.tails.iter().map(|tail| &*tail.text);
    let tails = tails.filter(|tail| {
        let folded = read(tail).filter(|_| !Words::of(tail).is_control() && !is_port(tail));
        is_possible(control_unit_like(tail).or(folded))
    });
    // `Current [A] mA`, `Current_mA_1`; a single letter may number the column: `Current [A] B`.
    let parts = column.name.split(|c: char| !c.is_alphanumeric());
    let parts = parts.filter(|part| part.len() > 1 && is_possible(control_unit_like(part)));
    let others = name.others.iter().map(String::as_str);
    let others = others
        .filter(|other| other.len() > 1 && is_possible(read(other).or(control_unit_like(other))));
    let in_name = in_brackets
        .into_iter()
        .chain(tails)
        .chain(parts)
        .chain(others);
    let mut stated = in_name.chain(rows());
    let found = match stated.find(|other| read(other) != Some(unit)) {
        Some(other) => {
            let either = [Some(unit), read(other)];
            let either = either.into_iter().flatten().collect();
            ControlUnit::Unclear(format!("{other} beside {written}"), either)
        }
        None => ControlUnit::Known(unit),
    };
    Some((found, words))
}

/// Whether a text is a small letter for a quantity and a capital for a port.
fn is_port(text: &str) -> bool {
    let mut letters = text.chars();
    let (small, capital) = (letters.next(), letters.next());
    let is_pair = small.is_some_and(char::is_lowercase) && capital.is_some_and(char::is_uppercase);
    is_pair && letters.next().is_none()
}

pub(super) fn own_unit(column: &Column, channel: Channel, symbol: &str) -> UnitFound {
    if column.is_stamp {
        return of_stamps();
    }
    let known = channel.units().iter().find(|unit| unit.symbol == symbol);
    match known {
        Some(unit) => beside(column, channel, *unit, symbol),
        None if symbol.is_empty() => unit_and_words(column, &Name::default(), channel).0,
        None => UnitFound::Unknown(symbol.to_owned()),
    }
}

/// The unit of dates and times of day, whatever the name says: `Time (ms)`, `Time [hh:mm:ss]`.
fn of_stamps() -> UnitFound {
    UnitFound::Known(Channel::Time.unit_in(&crate::units::Units::SI))
}

/// A unit in the name, when the file states one elsewhere too.
fn beside(column: &Column, channel: Channel, unit: Unit, written: &str) -> UnitFound {
    let is_other = |other: &&str| unit_of(channel, other).is_none_or(|other| !other.is_same(unit));
    match row_units(column).find(is_other) {
        Some(other) => {
            let either = either(unit, unit_of(channel, other));
            UnitFound::Unclear(format!("{written} beside {other}"), either)
        }
        None => UnitFound::Known(unit),
    }
}

/// The units that the file states outside the name: several, if it contradicts itself.
pub(super) fn row_units(column: &Column) -> impl Iterator<Item = &str> + Clone {
    let said = column.unit.iter().chain(&column.other_units);
    said.map(|unit| bare(unit)).filter(|unit| !unit.is_empty())
}

/// The statement about the unit for a channel, and the words of the name without it.
pub(super) fn unit_and_words(column: &Column, name: &Name, channel: Channel) -> (UnitFound, Words) {
    // `Load_N`, and not `Load_Cell`.
    let mut tails = name.tails.iter();
    let is_unit = |spelt: &Spelt, text| spelt.of(channel, text).is_some();
    let tail = tails.find(|tail| tail.spelt.is_some_and(|spelt| is_unit(spelt, &tail.text)));
    let words = tail.map_or(name.words, |tail| tail.before);
    if column.is_stamp && channel == Channel::Time {
        return (of_stamps(), words);
    }
    let written = (name.marked.as_deref()).or(tail.map(|tail| tail.text.as_str()));
    let Some(written) = written.or_else(|| row_units(column).next()) else {
        return (UnitFound::None, words);
    };
    let found = if is_lost_in_capitals(channel, &column.name, written) {
        let either = alike(channel, written).collect();
        UnitFound::Unclear(format!("{written} in a name of capitals"), either)
    } else if let Some(unit) = unit_of(channel, written) {
        let mut others = name.others.iter();
        match others.find(|other| is_another(channel, unit, other)) {
            Some(other) => UnitFound::Unclear(
                format!("{written} beside {other}"),
                either(unit, unit_of(channel, other)),
            ),
            None => beside(column, channel, unit, written),
        }
    } else {
        UnitFound::Unknown(written.to_owned())
    };
    match (&name.scale, found) {
        (Some(scale), UnitFound::Known(_)) => {
            let unclear = format!("{written} with the factor {}", quoted(scale));
            (UnitFound::Unclear(unclear, Vec::new()), words)
        }
        (_, found) => (found, words),
    }
}

/// Whether a word next to a unit is another unit of the channel; a single letter is one only in the form of our own files.
fn is_another(channel: Channel, unit: Unit, written: &str) -> bool {
    let is_letter = written.chars().count() == 1;
    let own = || channel.units().iter().any(|unit| unit.symbol == written);
    (!is_letter || own()) && unit_of(channel, written).is_some_and(|other| !other.is_same(unit))
}

/// Whether a unit that is ambiguous in capitals, as MN for mN, stands in a name that is all in capitals.
fn is_lost_in_capitals(channel: Channel, name: &str, written: &str) -> bool {
    let letters = || name.chars().filter(|c| c.is_alphabetic());
    alike(channel, written).count() > 1
        && letters().all(char::is_uppercase)
        && letters().count() > 3
}

/// The units that differ from the written one in capitals only.
fn alike(channel: Channel, written: &str) -> impl Iterator<Item = &'static str> {
    let units = channel.units().iter().map(|unit| unit.symbol);
    units.filter(move |symbol| symbol.eq_ignore_ascii_case(written))
}

/// Both units of a name with two.
fn either(one: Unit, other: Option<Unit>) -> Vec<&'static str> {
    other.map_or_else(Vec::new, |other| vec![one.symbol, other.symbol])
}
