//! Why a controller does not start, or does not clear its trip.

use core::fmt;

use super::fault::TripCause;
use super::state::State;

/// Why a controller does not start. It continues as before, or trips if it must not start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum StartRefused {
    /// It is running.
    Running,
    /// It has stopped, and the command is not yet back at 0.
    Moving,
    /// It has tripped for this cause, which was not cleared, or trips at this start: the stop input is active, the last reading
    /// does not permit a start, or the enable line did not rise.
    Faulted(TripCause),
}

impl StartRefused {
    /// Reason of a controller in this state, for a start without effect.
    pub(super) fn of(state: State) -> Self {
        match state {
            State::Running => Self::Running,
            State::Idle | State::Done => Self::Moving,
            State::Faulted(cause) => Self::Faulted(cause),
        }
    }
}

impl fmt::Display for StartRefused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Running => f.write_str("it is running: stop it first"),
            Self::Moving => f.write_str(MOVING),
            Self::Faulted(cause) => {
                write!(
                    f,
                    "it has tripped ({cause:?}): remove the cause, then clear the trip"
                )
            }
        }
    }
}

impl core::error::Error for StartRefused {}

/// Why a controller does not clear its trip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ClearRefused {
    /// It has not tripped.
    NoFault,
    /// The command is not yet back at 0.
    Moving,
    /// It stays tripped for this cause: the external trip is active, the enable line does not drop, or a part cannot be set up
    /// again. The trip cause stays.
    Faulted(TripCause),
}

impl ClearRefused {
    /// Reason of a controller in this state, for a clear without effect.
    pub(super) fn of(state: State) -> Self {
        match state {
            State::Faulted(_) => Self::Moving,
            State::Idle | State::Running | State::Done => Self::NoFault,
        }
    }
}

impl fmt::Display for ClearRefused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoFault => f.write_str("it has not tripped, so there is nothing to clear"),
            Self::Moving => f.write_str(MOVING),
            Self::Faulted(cause) => write!(
                f,
                "the trip cause {cause:?} is still present: remove it, then clear again"
            ),
        }
    }
}

impl core::error::Error for ClearRefused {}

const MOVING: &str =
    "the command is on its way back to 0: go on ticking, and ask again after stop_ticks and one";

#[cfg(test)]
mod tests {
    extern crate std;

    use std::string::ToString as _;

    use super::*;

    #[test]
    fn each_refusal_says_what_to_do() {
        assert_eq!(
            StartRefused::Running.to_string(),
            "it is running: stop it first"
        );
        assert_eq!(
            StartRefused::Faulted(TripCause::ForceLimit).to_string(),
            "it has tripped (ForceLimit): remove the cause, then clear the trip"
        );
        assert_eq!(
            ClearRefused::NoFault.to_string(),
            "it has not tripped, so there is nothing to clear"
        );
        assert_eq!(
            ClearRefused::Faulted(TripCause::EnableLine).to_string(),
            "the trip cause EnableLine is still present: remove it, then clear again"
        );
        let moving = StartRefused::Moving.to_string();
        assert!(moving.contains("after stop_ticks and one"), "{moving}");
        assert_eq!(ClearRefused::Moving.to_string(), moving);
    }
}
