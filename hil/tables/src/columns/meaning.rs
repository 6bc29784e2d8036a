//! What the columns of tables may be, which is found once for all choices among them.

use super::name::Name;
use super::taken::{self, Candidate, Control, Rank};
use super::unit_found::{ControlUnit, UnitFound};
use crate::channel::Channel;
use crate::files::{Column, Table};

/// What the columns of a file's tables may be, by their names and units.
pub struct Meanings<'t> {
    pub(super) tables: &'t [Table],
    pub(super) of: Vec<Vec<Meaning>>,
}

impl<'t> Meanings<'t> {
    /// Of the columns of these tables.
    pub fn of(tables: &'t [Table]) -> Self {
        let of_table = |table: &Table| table.columns.iter().map(Meaning::of).collect();
        Self {
            tables,
            of: tables.iter().map(of_table).collect(),
        }
    }

    /// The probable meaning of a column of a table, in words: `force in kN`; `None` without one.
    pub fn described(&self, table: usize, column: usize) -> Option<String> {
        let meaning = &self.of[table][column];
        let each = meaning.candidates.iter().map(|candidate| {
            let channel = candidate.channel.name();
            match &candidate.unit {
                UnitFound::Known(unit) => format!("{channel} in {}", unit.symbol),
                UnitFound::Unknown(unit) => format!("{channel} in an unknown unit {unit}"),
                UnitFound::Unclear(unit, _) => format!("{channel} in {unit}, which is not clear"),
                UnitFound::None => format!("{channel} without a unit"),
            }
        });
        let channels: Vec<String> = each.collect();
        if channels.is_empty() {
            let control = meaning.control(&self.tables[table].columns[column])?;
            let described = match &control.unit {
                ControlUnit::Known(unit) => format!("{}_{unit}", control.quantity),
                ControlUnit::Unclear(units, _) => {
                    format!("{} in {units}, which is not clear", control.quantity)
                }
            };
            return Some(format!("control input {described}"));
        }
        Some(channels.join(" or "))
    }

    /// Number of columns of a table with a probable meaning.
    pub fn described_of(&self, table: usize) -> usize {
        let described = |meaning: &&Meaning| !meaning.candidates.is_empty() || meaning.is_control;
        self.of[table].iter().filter(described).count()
    }
}

/// What one column may be.
#[derive(Clone, Debug, Default)]
pub(super) struct Meaning {
    /// The channels.
    pub candidates: Box<[Candidate]>,
    /// Whether it may be a control input, and whether the unit of that is clear.
    pub is_control: bool,
    pub is_clear_control: bool,
    /// Whether its name says that it is not a measurement.
    pub is_surely_other: bool,
    /// For each channel, by its place: whether the column has a unit of it, or none at all.
    has_unit: u8,
    has_none: u8,
}

fn bit(channel: Channel) -> u8 {
    1 << channel as u8
}

impl Meaning {
    fn of(column: &Column) -> Self {
        let name = Name::of(&column.name);
        let units = taken::units(column, &name);
        let candidates = taken::candidates_by(column, &units, column.is_numeric);
        let control = taken::control_by(column, &name, !candidates.is_empty());
        let (mut has_unit, mut has_none) = (0, 0);
        for (channel, (unit, _)) in Channel::ALL.into_iter().zip(&units) {
            let unit = match &candidates[..] {
                // A name of our own form says it.
                [own] if own.rank == Rank::Own && own.channel == channel => &own.unit,
                _ => unit,
            };
            match unit {
                UnitFound::Known(_) | UnitFound::Unclear(..) => has_unit |= bit(channel),
                UnitFound::None => has_none |= bit(channel),
                UnitFound::Unknown(_) => {}
            }
        }
        let is_clear = |control: &Control| matches!(control.unit, ControlUnit::Known(_));
        Self {
            candidates: candidates.into(),
            is_control: control.is_some(),
            is_clear_control: control.as_ref().is_some_and(is_clear),
            is_surely_other: name.words.is_surely_other(),
            has_unit,
            has_none,
        }
    }

    /// Whether it may be a channel.
    pub fn may_be(&self, channel: Channel) -> bool {
        self.candidates.iter().any(|each| each.channel == channel)
    }

    /// Whether it has a unit of a channel.
    pub fn has_unit(&self, channel: Channel) -> bool {
        self.has_unit & bit(channel) != 0
    }

    /// Whether it has no unit, nor a text that may be one of a channel.
    pub fn has_no_unit(&self, channel: Channel) -> bool {
        self.has_none & bit(channel) != 0
    }

    /// The control input that its `column` may be.
    pub fn control(&self, column: &Column) -> Option<Control> {
        let name = || Name::of(&column.name);
        let is_candidate = !self.candidates.is_empty();
        self.is_control
            .then(|| taken::control_by(column, &name(), is_candidate))
            .flatten()
    }
}
