//! The status of a step: nothing is pending, because every step ends before its call returns.

use std::ffi::{c_char, c_int};

use super::boundary::{call, write};
use crate::refusal::Refusal;
use crate::state::Phase;
use crate::types::{Boolean, Component, FALSE, Status};

/// Refused: no step is in progress during another call.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2CancelStep(c: Component) -> Status {
    call(c, |_| {
        Err(Refusal::new(
            "canRunAsynchronuously",
            false,
            "no step is under way",
            "go back to a saved state instead",
        ))
    })
}

/// The status of a pending step: there is none.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetStatus(c: Component, kind: c_int, _value: *mut c_int) -> Status {
    not_pending(c, kind)
}

/// `fmi2LastSuccessfulTime`: the end of the last step, s.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: Component, kind: c_int, value: *mut f64) -> Status {
    if kind != LAST_SUCCESSFUL_TIME {
        return not_pending(c, kind);
    }
    call(c, |shared| {
        let time = shared.instance().time();
        // SAFETY: as the caller vouches.
        unsafe { write("value", value, time) }
    })
}

/// The status of a pending step: there is none.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetIntegerStatus(c: Component, kind: c_int, _value: *mut c_int) -> Status {
    not_pending(c, kind)
}

/// `fmi2Terminated`: whether the FMU itself wants to end, which never happens.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(
    c: Component,
    kind: c_int,
    value: *mut Boolean,
) -> Status {
    if kind != TERMINATED {
        return not_pending(c, kind);
    }
    // SAFETY: as the caller vouches.
    call(c, |_| unsafe { write("value", value, FALSE) })
}

/// The status of a pending step: there is none.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetStringStatus(
    c: Component,
    kind: c_int,
    _value: *mut *const c_char,
) -> Status {
    not_pending(c, kind)
}

/// `fmi2LastSuccessfulTime`
const LAST_SUCCESSFUL_TIME: c_int = 2;
/// `fmi2Terminated`
const TERMINATED: c_int = 3;

fn not_pending(c: Component, kind: c_int) -> Status {
    call(c, |shared| {
        let phase: Phase = shared.instance().phase();
        let problem = format!("no step is pending when {phase:?}");
        Err(Refusal::new(
            "fmi2StatusKind",
            kind,
            problem,
            "every step ends before fmi2DoStep returns: take the status that it returns",
        )
        .discarded())
    })
}
