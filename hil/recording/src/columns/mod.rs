//! Which column of a file is which channel.
//!
//! A name of our own files (`force_kN`) says it. Of another file, words in several languages and units say it, and what is taken so is
//! said; two columns that could be meant equally well are asked for, never chosen.

mod apart;
mod asked;
mod choose;
mod controls;
mod lexicon;
mod name;
mod scale;
pub(crate) mod spelling;
mod taken;
mod unit_found;
mod words;

pub use asked::shell;
pub use choose::{Chosen, ChosenControl, Used, choose};
pub use taken::Rank;

use crate::channel::Channel;
use crate::files::Column;

/// Whether a name is one of our own files, with a unit: `force_kN`.
pub(crate) fn is_own(name: &str) -> bool {
    taken::is_own(name)
}

/// Whether a name has a word of a quantity that recordings hold.
pub(crate) fn is_named(name: &str) -> bool {
    taken::is_named(name)
}

/// Whether a column may be that of the times.
pub(crate) fn may_be_time(column: &Column) -> bool {
    let candidates = taken::candidates(column);
    (candidates.iter()).any(|candidate| candidate.channel == Channel::Time)
}

/// How many words of a text are of a quantity that recordings hold.
pub(crate) fn known_words(text: &str) -> usize {
    let words = name::words(text);
    words.iter().filter(|word| words::is_known(word)).count()
}

/// What a column might be taken for, in words: `force in kN`; none where it says nothing.
pub fn described(column: &Column) -> Option<String> {
    let candidates = taken::candidates(column);
    let each = candidates.iter().map(|candidate| {
        let channel = candidate.channel.name();
        match &candidate.unit {
            unit_found::UnitFound::Known(unit) => format!("{channel} in {}", unit.symbol),
            unit_found::UnitFound::Unknown(unit) => format!("{channel} in an unknown unit {unit}"),
            unit_found::UnitFound::Unclear(unit) => {
                format!("{channel} in {unit}, which is not clear")
            }
            unit_found::UnitFound::None => format!("{channel} without a unit"),
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
