//! What a rig is doing, as a machine of states: one table says what becomes of each at each event.
//!
//! The diagram stands at [`super`].
//!
//! Moving is the command's way back to 0, which ends after `stop_ticks` whatever happens on it; the enable line is high while
//! running and low in every other state, from the very tick of the event. From a fault nothing leads back but the explicit
//! clear, and that only at rest. An event that a state has no arrow for changes nothing: a trip while faulted leaves the first
//! cause, a start while moving is refused.

use super::fault::TripCause;

/// What a rig is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum State {
    /// Enable line low, command at 0 or on its way there.
    Idle,
    /// Enable line high, command as controlled.
    Running,
    /// The programme is over; otherwise as [`State::Idle`].
    Done,
    /// Stopped for this cause, until cleared; otherwise as [`State::Idle`].
    Faulted(TripCause),
}

/// What happens to a rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Happening {
    /// It is asked to run.
    Start,
    /// It is asked to stop.
    Stop,
    /// The programme is over.
    Finish,
    /// Something is wrong.
    Trip(TripCause),
    /// The command is back at 0.
    AtRest,
    /// It is told that what was wrong has been seen.
    Clear,
}

/// A state, and whether the command is back at 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Machine {
    pub(super) state: State,
    pub(super) resting: bool,
}

impl Machine {
    /// Idle. The command counts as moving until it is seen to be at 0.
    pub(super) const NEW: Self = Self {
        state: State::Idle,
        resting: false,
    };

    /// The table.
    pub(super) fn after(self, happening: Happening) -> Self {
        use Happening::{AtRest, Clear, Finish, Start, Stop, Trip};
        use State::{Done, Faulted, Idle, Running};
        let (state, resting) = match (self.state, self.resting, happening) {
            (Idle | Done, true, Start) => (Running, false),
            (Running, _, Stop) => (Idle, false),
            (Running, _, Finish) => (Done, false),
            (Idle | Done, resting, Trip(fault)) => (Faulted(fault), resting),
            (Running, _, Trip(fault)) => (Faulted(fault), false),
            (Idle | Done | Faulted(_), false, AtRest) => (self.state, true),
            (Faulted(_), true, Clear) => (Idle, true),
            (state, resting, _) => (state, resting),
        };
        Self { state, resting }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::Happening::{AtRest, Clear, Finish, Start, Stop, Trip};
    use super::State::{Done, Faulted, Idle, Running};
    use super::*;

    const FIRST: TripCause = TripCause::AdcBus;
    const OTHER: TripCause = TripCause::ForceLimit;

    const fn at(state: State, resting: bool) -> Machine {
        Machine { state, resting }
    }

    /// Every state.
    const STATES: [Machine; 7] = [
        at(Idle, false),
        at(Idle, true),
        at(Running, false),
        at(Done, false),
        at(Done, true),
        at(Faulted(FIRST), false),
        at(Faulted(FIRST), true),
    ];
    const HAPPENINGS: [Happening; 6] = [Start, Stop, Finish, Trip(OTHER), AtRest, Clear];

    /// Each state's row, in the order of [`HAPPENINGS`], written out; a dash is where nothing changes.
    #[test]
    fn every_transition_is_that_of_the_diagram() {
        let tripped = |resting| Some(at(Faulted(OTHER), resting));
        let rows: [[Option<Machine>; 6]; 7] = [
            [None, None, None, tripped(false), Some(at(Idle, true)), None],
            [
                Some(at(Running, false)),
                None,
                None,
                tripped(true),
                None,
                None,
            ],
            [
                None,
                Some(at(Idle, false)),
                Some(at(Done, false)),
                tripped(false),
                None,
                None,
            ],
            [None, None, None, tripped(false), Some(at(Done, true)), None],
            [
                Some(at(Running, false)),
                None,
                None,
                tripped(true),
                None,
                None,
            ],
            [None, None, None, None, Some(at(Faulted(FIRST), true)), None],
            [None, None, None, None, None, Some(at(Idle, true))],
        ];
        for (state, row) in STATES.into_iter().zip(rows) {
            for (happening, expected) in HAPPENINGS.into_iter().zip(row) {
                let expected = expected.unwrap_or(state);
                assert_eq!(state.after(happening), expected, "{state:?}, {happening:?}");
            }
        }
    }

    /// Of all ways of six events from all states: only a start at rest leads to running, and only a clear at rest out of a
    /// fault.
    #[test]
    fn nothing_but_a_clear_leads_out_of_a_fault() {
        let mut reached: Vec<Machine> = STATES.to_vec();
        for _ in 0..6 {
            let mut next = Vec::new();
            for state in &reached {
                for happening in HAPPENINGS {
                    let after = state.after(happening);
                    assert!(STATES.contains(&after) || after.state == Faulted(OTHER));
                    if after.state == Running && state.state != Running {
                        assert!(happening == Start && state.resting);
                    }
                    if let Faulted(_) = state.state
                        && after.state != state.state
                    {
                        assert!(happening == Clear && state.resting);
                        assert_eq!(after, at(Idle, true));
                    }
                    if !next.contains(&after) {
                        next.push(after);
                    }
                }
            }
            reached = next;
        }
        assert!(reached.len() >= STATES.len());
    }
}
