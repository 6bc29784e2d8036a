//! Assigns the columns of a file to channels.
//!
//! A name in the form of our own files (`force_kN`) is decisive. In other files words in several languages and units decide, and
//! the choice is reported. If two columns match equally well, the user is asked.

mod apart;
mod asked;
mod choose;
mod controls;
mod lengths;
mod lexicon;
mod listed;
mod meaning;
mod name;
mod scale;
pub(crate) mod spelling;
mod taken;
mod unit_chosen;
mod unit_found;
mod words;

pub use choose::{Chosen, ChosenControl, Used, choose, which_table};
pub use meaning::Meanings;
pub use spelling::bare;
pub(crate) use taken::OfTimes;
pub use taken::Rank;
pub(crate) use words::each_word;

use crate::files::Column;

/// Whether a name has the form of our own files, with a unit: `force_kN`.
pub fn is_own(name: &str) -> bool {
    taken::is_own(name)
}

/// Whether a name has a word for a quantity that recordings contain.
pub(crate) fn is_named(name: &str) -> bool {
    taken::is_named(name)
}

/// Steps of finding what the names of columns mean, which is charged before it is done.
pub(crate) fn steps<'c>(columns: impl Iterator<Item = &'c Column>) -> u64 {
    columns.map(|column| name::steps(&column.name)).sum()
}

/// What a column may be in respect of times.
pub(crate) fn of_times(column: &Column) -> OfTimes {
    taken::of_times(column)
}

/// Whether a column may contain the times.
pub(crate) fn may_be_time(column: &Column) -> bool {
    of_times(column).may_be_time
}

/// Whether a column contains times, according to its file or its name.
pub(crate) fn is_time(column: &Column) -> bool {
    of_times(column).is_time
}

/// Number of words of a text for quantities that recordings contain.
pub(crate) fn known_words(text: &str) -> usize {
    words::Words::of(text).known()
}
