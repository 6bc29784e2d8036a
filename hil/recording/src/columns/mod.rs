//! Which column of a file is which channel.
//!
//! A name of our own files (`force_kN`) says it. Of another file, words in several languages and units say it, and what is taken so is
//! said; two columns that could be meant equally well are asked for, never chosen.

mod apart;
mod choose;
mod name;
pub(crate) mod spelling;
mod taken;
mod words;

pub use choose::{Chosen, ChosenControl, Used, choose};
pub use taken::Rank;

use crate::files::Column;

/// What a column might be taken for, in words: `force in kN`; none where it says nothing.
pub fn described(column: &Column) -> Option<String> {
    let candidates = taken::candidates(column);
    let each = candidates.iter().map(|candidate| {
        let channel = candidate.channel.name();
        match &candidate.unit {
            taken::UnitFound::Known(unit) => format!("{channel} in {}", unit.symbol),
            taken::UnitFound::Unknown(unit) => format!("{channel} in an unknown unit {unit}"),
            taken::UnitFound::None => format!("{channel} without a unit"),
        }
    });
    let channels: Vec<String> = each.collect();
    if channels.is_empty() {
        let control = taken::control_name(column);
        return control.map(|(name, _)| format!("control input {name}"));
    }
    Some(channels.join(" or "))
}

/// Whether a column is of times, by what its file or its name says.
pub(crate) fn is_time(column: &Column) -> bool {
    taken::is_time(column)
}
