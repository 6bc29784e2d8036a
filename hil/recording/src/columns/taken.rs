//! What a column of a file may be taken for.

use super::name::Name;
use super::spelling::{control_unit, unit_of};
use super::words::{self, Certainty};
use crate::channel::Channel;
use crate::control::{UNITS, is_control};
use crate::files::Column;
use crate::units::Unit;

/// How surely a column is a channel's; the greater is the surer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// By nothing but a unit of the channel.
    Unit,
    /// By a short word with a unit of it: `x [mm]`.
    Weak,
    /// By a word for the channel: `Kraft [kN]`.
    Word,
    /// By a name of our own files: `force_kN`.
    Own,
    /// The user said so.
    Said,
}

/// A channel that a column may be.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Candidate {
    pub channel: Channel,
    pub rank: Rank,
    /// What is known of its unit.
    pub unit: UnitFound,
}

/// What a column's name and unit say about the unit of a channel.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum UnitFound {
    /// One of the channel's.
    Known(Unit),
    /// The file says a unit that the channel cannot have, or that is unknown.
    Unknown(String),
    /// None is said.
    None,
}

/// The channels that a column may be, by its own name and unit.
pub(super) fn candidates(column: &Column) -> Vec<Candidate> {
    if let Some((channel, symbol)) = own_name(&column.name) {
        let unit = own_unit(column, channel, symbol);
        return vec![Candidate {
            channel,
            rank: Rank::Own,
            unit,
        }];
    }
    if !column.is_numeric {
        return Vec::new();
    }
    let name = Name::of(&column.name);
    if words::is_not_measured(&name.words) {
        return Vec::new();
    }
    if column.is_time {
        let unit = unit_found(column, &name, Channel::Time);
        return vec![Candidate {
            channel: Channel::Time,
            rank: Rank::Word,
            unit,
        }];
    }
    let meanings = words::meanings(&name.words);
    let mut found = Vec::new();
    for (channel, certainty) in meanings {
        let unit = unit_found(column, &name, channel);
        let is_known = matches!(unit, UnitFound::Known(_));
        let rank = match certainty {
            Certainty::Strong => Rank::Word,
            Certainty::Weak if is_known => Rank::Weak,
            Certainty::Weak => continue,
        };
        found.push(Candidate {
            channel,
            rank,
            unit,
        });
    }
    // `Force displacement` says nothing, `displacement of load cell [mm]` says it by the unit.
    let known = |each: &Candidate| matches!(each.unit, UnitFound::Known(_));
    if found.len() > 1 && found.iter().any(known) {
        found.retain(known);
    }
    if found.is_empty() && !words::is_of_control(&name.words) {
        let by_unit = Channel::ALL.into_iter().filter_map(|channel| {
            let unit = unit_found(column, &name, channel);
            let rank = Rank::Unit;
            matches!(unit, UnitFound::Known(_)).then_some(Candidate {
                channel,
                rank,
                unit,
            })
        });
        found.extend(by_unit);
    }
    found
}

/// Whether a column is of times, by what its file or a word of its name says, a unit beside it or not.
pub(super) fn is_time(column: &Column) -> bool {
    let is_named = || {
        let words = Name::of(&column.name).words;
        let mut meanings = words::meanings(&words).into_iter();
        meanings.any(|(channel, _)| channel == Channel::Time) && !words::is_not_measured(&words)
    };
    column.is_numeric && (column.is_time || is_named())
}

/// What the file says of a column's unit, for one channel.
pub(super) fn unit_for(column: &Column, channel: Channel) -> UnitFound {
    match own_name(&column.name) {
        Some((own, symbol)) if own == channel => own_unit(column, channel, symbol),
        _ => unit_found(column, &Name::of(&column.name), channel),
    }
}

/// The name that a control input's column has in a recording, and whether it has it in the file already.
pub(super) fn control_name(column: &Column) -> Option<(String, bool)> {
    if is_control(&column.name) && column.unit.is_none() {
        return Some((column.name.clone(), true));
    }
    let name = Name::of(&column.name);
    let is_channel = !words::meanings(&name.words).is_empty() && !words::is_of_control(&name.words);
    if is_channel || !column.is_numeric || words::is_not_measured(&name.words) {
        return None;
    }
    let written = column.unit.as_deref().or(name.marked.as_deref());
    let written = written.or_else(|| name.tails.first().map(String::as_str));
    let unit = control_unit(written?, UNITS)?;
    // A word for it is needed: a unit alone may be of anything that a test rig writes too.
    let word = words::control(&name.words, unit)?;
    Some((format!("{word}_{unit}"), false))
}

/// The unit that a control input's column has.
pub(super) fn control_unit_of(column: &Column) -> Option<&'static str> {
    let name = Name::of(&column.name);
    let written = column.unit.as_deref().or(name.marked.as_deref());
    let written = written.or_else(|| name.tails.first().map(String::as_str));
    control_unit(written?, UNITS)
}

fn own_unit(column: &Column, channel: Channel, symbol: &str) -> UnitFound {
    let known = channel.units().iter().find(|unit| unit.symbol == symbol);
    match known {
        Some(unit) => match column
            .unit
            .as_deref()
            .map(|said| (said, unit_of(channel, bare(said))))
        {
            // A name that was kept while the values were converted.
            Some((said, Some(other))) if other.to_code(1.0) != unit.to_code(1.0) => {
                UnitFound::Unknown(format!(
                    "{symbol} by its name and {} by the file",
                    bare(said)
                ))
            }
            _ => UnitFound::Known(*unit),
        },
        None if symbol.is_empty() => unit_found(column, &Name::default(), channel),
        None => UnitFound::Unknown(symbol.to_owned()),
    }
}

fn unit_found(column: &Column, name: &Name, channel: Channel) -> UnitFound {
    let said = column
        .unit
        .as_deref()
        .map(bare)
        .filter(|unit| !unit.is_empty());
    if let Some(written) = said.or(name.marked.as_deref()) {
        return match unit_of(channel, written) {
            Some(unit) => UnitFound::Known(unit),
            None => UnitFound::Unknown(written.to_owned()),
        };
    }
    let mut tails = name.tails.iter();
    match tails.find_map(|tail| unit_of(channel, tail)) {
        Some(unit) => UnitFound::Known(unit),
        None => UnitFound::None,
    }
}

/// A unit without the brackets that a row of units puts around it.
fn bare(unit: &str) -> &str {
    unit.trim().trim_matches(|c| "[](){}<>".contains(c)).trim()
}

/// The channel and the unit's symbol that a name of our own files says: `force_kN`.
///
/// A further word between the two, as in `force_command_kN`, makes it another column.
fn own_name(name: &str) -> Option<(Channel, &str)> {
    let channel = Channel::ALL
        .into_iter()
        .find(|channel| name.starts_with(channel.name()))?;
    let rest = &name[channel.name().len()..];
    if rest.is_empty() {
        return Some((channel, ""));
    }
    let symbol = rest.strip_prefix('_')?;
    let known = channel.units().iter().any(|unit| unit.symbol == symbol);
    (known || !symbol.contains('_')).then_some((channel, symbol))
}
