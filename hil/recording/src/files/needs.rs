//! What a recording must have, and what is taken for granted of it.

use crate::channel::Channel;
use crate::units::Units;

/// What a recording must have for what is done with it, and what is taken for granted of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Needs {
    /// The channels that must be there.
    pub channels: Vec<Channel>,
    /// The control inputs that are read, in this order, by their names in a recording: `current_A`. Each must be there. Where none are
    /// named, all that are found are read.
    pub inputs: Option<Vec<String>>,
    /// The unit of a channel of which nothing says it.
    pub unmarked: Unmarked,
}

/// The unit of a channel of which neither the user nor its column says it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Unmarked {
    /// There is none: the column is refused.
    #[default]
    Refused,
    /// One of these, which the user named for such columns.
    Said(Units),
    /// One of these, which nobody named. [`Recording::assumed`](crate::Recording::assumed) says so.
    Assumed(Units),
}

impl Default for Needs {
    /// Time, displacement and force.
    fn default() -> Self {
        Self::of(Channel::ALL.into_iter().filter(|each| each.is_required()))
    }
}

impl Needs {
    /// These channels and no more.
    pub fn of(channels: impl IntoIterator<Item = Channel>) -> Self {
        Self {
            channels: channels.into_iter().collect(),
            inputs: None,
            unmarked: Unmarked::Refused,
        }
    }

    /// Time and displacement, because only the motion counts.
    pub fn motion() -> Self {
        Self::of([Channel::Time, Channel::Displacement])
    }

    pub(crate) fn has(&self, channel: Channel) -> bool {
        self.channels.contains(&channel)
    }
}
