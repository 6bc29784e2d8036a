//! The functions of FMI 2.0 for co-simulation. Only this file and the folder contain unsafe code: it reads and writes the caller's
//! memory, after a check for NULL.
//!
//! # Safety
//! For every function: a pointer is NULL, or points to the amount of data that the standard requires, for the duration of the call.
//! Handles of instances and states may have any value: they are numbers that are looked up.

mod boundary;
mod states;
mod status;
mod values;

pub use boundary::Shared;
pub use states::*;
pub use status::*;
pub use values::*;

use std::ffi::{CStr, c_char, c_int};
use std::sync::atomic::Ordering;

use boundary::{call, items, start, text};

use crate::handles;
use crate::refusal::Refusal;
use crate::types::{Boolean, Callbacks, Component, FALSE, Status};

/// The only category of log messages in addition to warnings.
pub const ERRORS: &CStr = c"logStatusError";
/// The category of warnings.
pub const WARNINGS: &CStr = c"logStatusWarning";

/// The platform of this library's types.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Turns warnings on or off, for the named categories, or for all if none is named. Errors are always logged.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: Component,
    logging_on: Boolean,
    count: usize,
    categories: *const *const c_char,
) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches.
        let categories = unsafe { items("categories", categories, count) }?;
        let mut is_warning = categories.is_empty();
        for &category in categories {
            // SAFETY: as the caller vouches.
            let category = unsafe { text("category", category) }?;
            match category {
                _ if category.as_bytes() == WARNINGS.to_bytes() => is_warning = true,
                _ if category.as_bytes() == ERRORS.to_bytes() => {}
                _ => {
                    return Err(Refusal::new(
                        "category",
                        category,
                        "there is no such",
                        "give logStatusError or logStatusWarning",
                    ));
                }
            }
        }
        if is_warning {
            shared.warns.store(logging_on != FALSE, Ordering::Relaxed);
        }
        Ok(())
    })
}

/// An instance of the model in the resources; NULL on failure, with the reason sent to the logger.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instance_name: *const c_char,
    fmu_type: c_int,
    guid: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    _visible: Boolean,
    logging_on: Boolean,
) -> Component {
    // SAFETY: as the caller vouches.
    unsafe {
        start(
            instance_name,
            fmu_type,
            guid,
            resources,
            callbacks,
            logging_on,
        )
    }
}

/// Releases an instance and its saved states. NULL and invalid handles are ignored.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(c: Component) {
    drop(handles::remove(c.addr()));
}

/// Start and end of a simulation, s. The tolerance is not used: a step has no error of its own.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetupExperiment(
    c: Component,
    _tolerance_defined: Boolean,
    _tolerance: f64,
    start_time: f64,
    stop_time_defined: Boolean,
    stop_time: f64,
) -> Status {
    call(c, |shared| {
        let stop = (stop_time_defined != FALSE).then_some(stop_time);
        shared.instance().set_up(start_time, stop)
    })
}

/// The following inputs are those at the start.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterInitializationMode(c: Component) -> Status {
    call(c, |shared| shared.instance().enter_initialization())
}

/// The first tick.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2ExitInitializationMode(c: Component) -> Status {
    call(c, |shared| shared.instance().exit_initialization())
}

/// Ends the steps.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Terminate(c: Component) -> Status {
    call(c, |shared| shared.instance().terminate())
}

/// Returns to the state after instantiation.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Reset(c: Component) -> Status {
    call(c, |shared| {
        shared.instance().reset();
        Ok(())
    })
}

/// A step from `point` by `size` s: it evaluates the law at each tick of the step except that of `point`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(
    c: Component,
    point: f64,
    size: f64,
    _no_set_state_prior_to_point: Boolean,
) -> Status {
    call(c, |shared| shared.instance().step(point, size))
}
