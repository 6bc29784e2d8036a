//! The functions of FMI 2.0 for co-simulation. Unsafe code stands here and in the folder alone: it reads and writes what a caller
//! points to, after a check for NULL.
//!
//! # Safety
//! Of every function: a pointer is NULL, or points to as much as the standard says, for as long as the call takes. Handles of
//! instances and states may be anything: they are numbers that are looked up.

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

/// The only category of log messages beside warnings.
pub const ERRORS: &CStr = c"logStatusError";
/// The category of warnings.
pub const WARNINGS: &CStr = c"logStatusWarning";

/// The platform that this library's types are of.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// The version of the standard.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// Turns warnings on or off, of the categories that are named, or of all where none is. Errors are always said.
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

/// An instance of the model in the resources; NULL where there can be none, which the logger is given the reason of.
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

/// Lets go of an instance and of its saved states. NULL and a handle that is none are ignored.
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

/// The inputs that follow are those at the start.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterInitializationMode(c: Component) -> Status {
    call(c, |shared| shared.instance().enter_initialization())
}

/// The first tick.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2ExitInitializationMode(c: Component) -> Status {
    call(c, |shared| shared.instance().exit_initialization())
}

/// No more steps.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Terminate(c: Component) -> Status {
    call(c, |shared| shared.instance().terminate())
}

/// As it was instantiated.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Reset(c: Component) -> Status {
    call(c, |shared| {
        shared.instance().reset();
        Ok(())
    })
}

/// A step from `point` by `size` s: the law is evaluated on each tick of it but that of `point`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(
    c: Component,
    point: f64,
    size: f64,
    _no_set_state_prior_to_point: Boolean,
) -> Status {
    call(c, |shared| shared.instance().step(point, size))
}
