//! Assigns the columns of a file to channels.
//!
//! A name in the form of our own files (`force_kN`) is decisive. In other files words in several languages and units decide, and
//! the choice is reported. If two columns match equally well, the user is asked.

mod apart;
mod asked;
mod choose;
mod controls;
mod lexicon;
mod name;
mod scale;
pub(crate) mod spelling;
mod taken;
mod unit_chosen;
mod unit_found;
mod words;

pub use asked::shell;
pub use choose::{Chosen, ChosenControl, Used, choose, which_table};
pub use spelling::bare;
pub use taken::Rank;

use crate::channel::Channel;
use crate::files::Column;

/// Whether a name has the form of our own files, with a unit: `force_kN`.
pub fn is_own(name: &str) -> bool {
    taken::is_own(name)
}

/// Whether a name has a word for a quantity that recordings contain.
pub(crate) fn is_named(name: &str) -> bool {
    taken::is_named(name)
}

/// Whether a column may contain the times.
pub(crate) fn may_be_time(column: &Column) -> bool {
    let candidates = taken::candidates(column);
    (candidates.iter()).any(|candidate| candidate.channel == Channel::Time)
}

/// Number of words of a text for quantities that recordings contain.
pub(crate) fn known_words(text: &str) -> usize {
    let words = name::words(text);
    words.iter().filter(|word| words::is_known(word)).count()
}

/// Probable meaning of a column, in words: `force in kN`; `None` without one.
pub fn described(column: &Column) -> Option<String> {
    let candidates = taken::candidates(column);
    let each = candidates.iter().map(|candidate| {
        let channel = candidate.channel.name();
        match &candidate.unit {
            unit_found::UnitFound::Known(unit) => format!("{channel} in {}", unit.symbol),
            unit_found::UnitFound::Unknown(unit) => format!("{channel} in an unknown unit {unit}"),
            unit_found::UnitFound::Unclear(unit, _) => {
                format!("{channel} in {unit}, which is not clear")
            }
            unit_found::UnitFound::None => format!("{channel} without a unit"),
        }
    });
    let channels: Vec<String> = each.collect();
    if channels.is_empty() {
        let control = taken::control(column)?;
        let described = match &control.unit {
            unit_found::ControlUnit::Known(unit) => format!("{}_{unit}", control.quantity),
            unit_found::ControlUnit::Unclear(units, _) => {
                format!("{} in {units}, which is not clear", control.quantity)
            }
        };
        return Some(format!("control input {described}"));
    }
    Some(channels.join(" or "))
}

/// Whether a column contains times, according to its file or its name.
pub(crate) fn is_time(column: &Column) -> bool {
    taken::is_time(column)
}
