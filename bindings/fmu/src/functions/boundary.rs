//! The common work of all functions at the boundary: they find the instance, catch panics, and send the reason for a refusal to the
//! logger.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::{ERRORS, WARNINGS};
use crate::contents::Contents;
use crate::handles;
use crate::instance::Instance;
use crate::location::folder;
use crate::refusal::Refusal;
use crate::types::{Boolean, Callbacks, Component, FALSE, Logger, Status, ValueReference};
use crate::variables::{Kind, variables};

/// `fmi2CoSimulation`
const CO_SIMULATION: c_int = 1;
/// Most items of one call: more than there are variables, or bytes of a state.
const MOST_ITEMS: usize = 1 << 24;

/// An instance with the data from the master.
#[derive(Debug)]
pub struct Shared {
    instance: Mutex<Instance>,
    log: Log,
    /// Whether warnings are logged.
    pub(super) warns: AtomicBool,
    /// Constants, as C has them.
    texts: BTreeMap<ValueReference, CString>,
}

/// The destination of messages.
#[derive(Debug)]
struct Log {
    logger: Option<Logger>,
    /// The address of the caller's environment, which is passed back unchanged.
    environment: usize,
    instance_name: CString,
}

impl Shared {
    pub(super) fn instance(&self) -> MutexGuard<'_, Instance> {
        // An instance that panicked is not called again: see `call`.
        self.instance.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A constant text; NULL if there is none.
    pub(super) fn kept_text(&self, reference: ValueReference) -> *const c_char {
        let text = self.texts.get(&reference);
        text.map_or(std::ptr::null(), |text| text.as_ptr())
    }
}

impl Log {
    /// Sends `message` to the logger, with `%` and `#` escaped.
    fn say(&self, status: Status, category: &CStr, message: &str) {
        let Some(logger) = self.logger else { return };
        let message = message.replace('%', "%%").replace('#', "##");
        let Ok(message) = CString::new(message.replace('\0', "")) else {
            return;
        };
        // SAFETY: the logger was passed to fmi2Instantiate, and the standard keeps it valid until the instance is freed; all
        // strings end in NUL, and the format has no argument.
        unsafe {
            logger(
                pointer(self.environment),
                self.instance_name.as_ptr(),
                status as c_int,
                category.as_ptr(),
                message.as_ptr(),
            );
        }
    }
}

/// Calls `f` with the instance of a handle. Sends a refusal to the logger after the instance is unlocked.
pub(super) fn call(c: Component, f: impl FnOnce(&Shared) -> Result<(), Refusal>) -> Status {
    // Without an instance there is no logger.
    let Some(shared) = handles::get(c.addr()) else {
        return Status::Error;
    };
    if shared.instance.is_poisoned() {
        return Status::Fatal;
    }
    let result = catch_unwind(AssertUnwindSafe(|| f(&shared)));
    match result {
        Ok(Ok(())) => {
            if shared.instance().take_left_range() && shared.warns.load(Ordering::Relaxed) {
                let message = "the motion left the operating range that the model was fitted on: the force is extrapolated";
                shared.log.say(Status::Warning, WARNINGS, message);
            }
            Status::Ok
        }
        Ok(Err(refusal)) => {
            shared.log.say(refusal.status, ERRORS, &refusal.message);
            refusal.status
        }
        Err(_) => {
            let message = "an internal error of the FMU: free the instance, and report this";
            shared.log.say(Status::Fatal, ERRORS, message);
            Status::Fatal
        }
    }
}

/// [`fmi2Instantiate`](super::fmi2Instantiate).
///
/// # Safety
/// As its module says.
pub(super) unsafe fn start(
    instance_name: *const c_char,
    fmu_type: c_int,
    guid: *const c_char,
    resources: *const c_char,
    callbacks: *const Callbacks,
    logging_on: Boolean,
) -> Component {
    // SAFETY: as the caller vouches; NULL gives none.
    let callbacks = unsafe { callbacks.as_ref() };
    let name = match instance_name.is_null() {
        true => CString::default(),
        // SAFETY: it is not null, and ends in NUL as the caller vouches.
        false => unsafe { CStr::from_ptr(instance_name) }.to_owned(),
    };
    let log = Log {
        logger: callbacks.and_then(|callbacks| callbacks.logger),
        environment: callbacks.map_or(0, |callbacks| callbacks.environment.expose_provenance()),
        instance_name: name,
    };
    let made = catch_unwind(|| {
        // SAFETY: as the caller vouches.
        let (_, guid, resources) = unsafe {
            (
                text("instanceName", instance_name)?,
                text("fmuGUID", guid)?,
                text("fmuResourceLocation", resources)?,
            )
        };
        if fmu_type != CO_SIMULATION {
            return Err(Refusal::new(
                "fmuType",
                fmu_type,
                "this FMU is for co-simulation alone",
                "give fmi2CoSimulation, 1",
            ));
        }
        let contents = Contents::read(&folder(&resources)?, &guid)?;
        let mut texts = BTreeMap::new();
        for variable in variables(&contents)? {
            if let Kind::Text(value) = variable.kind {
                let text = CString::new(value).unwrap_or_default();
                texts.insert(variable.reference, text);
            }
        }
        Ok((Instance::new(contents)?, texts))
    });
    match made {
        Ok(Ok((instance, texts))) => pointer(handles::keep(Shared {
            instance: Mutex::new(instance),
            log,
            warns: AtomicBool::new(logging_on != FALSE),
            texts,
        })),
        Ok(Err(refusal)) => {
            log.say(Status::Error, ERRORS, &refusal.message);
            std::ptr::null_mut()
        }
        Err(_) => {
            let message = "an internal error of the FMU: report this with its resources";
            log.say(Status::Fatal, ERRORS, message);
            std::ptr::null_mut()
        }
    }
}

/// The contents of a caller's string.
///
/// # Errors
/// NULL.
///
/// # Safety
/// It is null, or ends in NUL.
pub(super) unsafe fn text<'a>(field: &str, text: *const c_char) -> Result<Cow<'a, str>, Refusal> {
    if text.is_null() {
        return Err(Refusal::null(field));
    }
    // SAFETY: as the caller vouches.
    Ok(unsafe { CStr::from_ptr(text) }.to_string_lossy())
}

/// Checks that `count` items are permitted and present.
fn check_items<T>(field: &str, first: *const T, count: usize) -> Result<(), Refusal> {
    if count > MOST_ITEMS {
        return Err(Refusal::new(
            field,
            format_args!("{count} items"),
            format_args!("{MOST_ITEMS} at most"),
            "give their number",
        ));
    }
    if count > 0 && first.is_null() {
        return Err(Refusal::null(field));
    }
    Ok(())
}

/// A caller's `count` items.
///
/// # Errors
/// NULL with one item or more.
///
/// # Safety
/// It is null, or there are that many items.
pub(super) unsafe fn items<'a, T>(
    field: &str,
    first: *const T,
    count: usize,
) -> Result<&'a [T], Refusal> {
    check_items(field, first, count)?;
    if count == 0 {
        return Ok(&[]);
    }
    // SAFETY: not null, and the caller guarantees the number of items.
    Ok(unsafe { std::slice::from_raw_parts(first, count) })
}

/// Writes `values` to the caller's memory.
///
/// # Errors
/// As [`items`].
///
/// # Safety
/// It is null, or there is room for that many.
pub(super) unsafe fn write_all<T: Copy>(
    field: &str,
    first: *mut T,
    values: &[T],
) -> Result<(), Refusal> {
    check_items(field, first.cast_const(), values.len())?;
    if !values.is_empty() {
        // SAFETY: not null, and the caller guarantees the room; `values` belong to this library, and do not overlap the caller's
        // memory.
        unsafe { std::ptr::copy_nonoverlapping(values.as_ptr(), first, values.len()) };
    }
    Ok(())
}

/// Reads a value from the caller's memory.
///
/// # Errors
/// NULL.
///
/// # Safety
/// It is null, or points to a value.
pub(super) unsafe fn read<T: Copy>(field: &str, place: *const T) -> Result<T, Refusal> {
    if place.is_null() {
        return Err(Refusal::null(field));
    }
    // SAFETY: not null, and the caller guarantees the value.
    Ok(unsafe { place.read() })
}

/// Writes `value` to the caller's memory.
///
/// # Errors
/// NULL.
///
/// # Safety
/// It is null, or there is room for one.
pub(super) unsafe fn write<T>(field: &str, place: *mut T, value: T) -> Result<(), Refusal> {
    if place.is_null() {
        return Err(Refusal::null(field));
    }
    // SAFETY: not null, and the caller guarantees the room.
    unsafe { place.write(value) };
    Ok(())
}

/// A number in the form of a C handle.
pub(super) fn pointer(number: usize) -> *mut c_void {
    std::ptr::without_provenance_mut(number)
}
