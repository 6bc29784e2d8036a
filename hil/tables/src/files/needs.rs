//! Requirements on a recording, and assumptions about it.

use crate::channel::Channel;
use crate::units::Units;

/// Requirements on a recording for its use, and assumptions about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Needs {
    /// The required channels.
    pub channels: Vec<Channel>,
    /// The control inputs to read, in this order, by their names in a recording: `current_A`. Each is required. If none are named,
    /// all that are found are read.
    pub inputs: Option<Vec<String>>,
    /// The unit of a channel for which none is stated.
    pub unmarked: Unmarked,
}

/// The unit of a channel for which neither the user nor its column states one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Unmarked {
    /// None: the column is rejected.
    #[default]
    Refused,
    /// One of these, which the user named for such columns.
    Stated(Units),
    /// One of these, by assumption. The recording then says so.
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

    /// Time and displacement, for uses that need only the motion.
    pub fn motion() -> Self {
        Self::of([Channel::Time, Channel::Displacement])
    }

    pub(crate) fn has(&self, channel: Channel) -> bool {
        self.channels.contains(&channel)
    }
}
