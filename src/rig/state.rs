//! The state machine of a rig: one table gives the next state for each state and event.
//!
//! The diagram is at [`super`].
//!
//! Moving is the return of the command to 0, which ends after `stop_ticks` whatever happens meanwhile. The enable line is high
//! while running and low in every other state, from the very tick of the event. Only an explicit clear ends the state
//! [`State::Faulted`], and only at rest. An event for which a state has no arrow changes nothing: a trip while faulted keeps the
//! first cause, and a start while moving is refused.

use super::fault::TripCause;

/// State of a rig.
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
    /// Tripped by this cause, until cleared; otherwise as [`State::Idle`].
    Faulted(TripCause),
}

/// Event for the state machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Happening {
    /// Request to start.
    Start,
    /// Request to stop.
    Stop,
    /// The programme is over.
    Finish,
    /// A trip cause.
    Trip(TripCause),
    /// The command is back at 0.
    AtRest,
    /// Request to clear the trip.
    Clear,
}

/// A state, and whether the command is back at 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Machine {
    pub(super) state: State,
    pub(super) resting: bool,
}

impl Machine {
    /// Idle. The command counts as moving until it is known to be at 0.
    pub(super) const NEW: Self = Self {
        state: State::Idle,
        resting: false,
    };

    /// The transition table.
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

    /// Each state's row, in the order of [`HAPPENINGS`], written out; a dash means no change.
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

    /// For all sequences of six events from all states: only a start at rest leads to running, and only a clear at rest leaves a
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
