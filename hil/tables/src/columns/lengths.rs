//! Lengths beside the displacement, such as the position of a slider that sets a stiffness: each may be a control input.
//!
//! A length that moves belongs to the motion: a second sensor, a command. One that stays where it was set is an input. Only its values
//! can tell, so these columns are read and then judged; see [`ControlChannel::set_beside`](crate::control::ControlChannel::set_beside).

use std::collections::HashSet;

use super::choose::{Choice, ChosenControl};
use super::name::Name;
use super::spelling::unit_of;
use super::unit_found::{UnitFound, unit_and_words};
use crate::channel::Channel;
use crate::control::PREDICTED;
use crate::files::Column;
use crate::units::Unit;

impl Choice<'_> {
    /// The columns with a unit of length that are in no use, each with its name as a control input: `slider_mm` for `Slider [mm]`.
    pub(super) fn lengths(&self, is_used: &HashSet<usize>) -> Vec<ChosenControl> {
        let (mut lengths, mut names) = (Vec::new(), HashSet::new());
        for (column, each) in self.table.columns.iter().enumerate() {
            if is_used.contains(&column) || !each.is_numeric || each.is_stamp {
                continue;
            }
            if let Some((name, unit)) = name_of(each)
                && names.insert(name.clone())
            {
                lengths.push(ChosenControl {
                    column,
                    name,
                    length: Some(unit),
                });
            }
        }
        lengths
    }
}

fn name_of(column: &Column) -> Option<(String, Unit)> {
    let parsed = Name::of(&column.name);
    let (UnitFound::Known(unit), _) = unit_and_words(column, &parsed, Channel::Displacement) else {
        return None;
    };
    let words = column.name.split(|c: char| !c.is_alphanumeric());
    let words =
        words.filter(|word| !word.is_empty() && unit_of(Channel::Displacement, word).is_none());
    let words: Vec<String> = words.map(str::to_lowercase).collect();
    let quantity = words.join("_");
    (!quantity.is_empty() && !quantity.starts_with(PREDICTED))
        .then(|| (format!("{quantity}_{}", unit.symbol), unit))
}
