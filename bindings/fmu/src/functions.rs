//! The functions of FMI 2.0 for co-simulation. Unsafe code stands here and in the file beside this one alone: it reads and writes what
//! a caller points to, after a check for NULL.
//!
//! # Safety
//! Of every function: a pointer is NULL, or points to as much as the standard says, for as long as the call takes. Handles of
//! instances and states may be anything: they are numbers that are looked up.

mod boundary;

pub use boundary::Shared;

use std::ffi::{CStr, c_char, c_int, c_void};
use std::sync::atomic::Ordering;

use boundary::{call, items, read, start, text, write, write_all};

use crate::refusal::Refusal;
use crate::types::{
    Boolean, Callbacks, Component, FALSE, SavedState, Status, TRUE, ValueReference,
};
use crate::{handles, state::Phase};

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

/// Values of real variables.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(
    c: Component,
    references: *const ValueReference,
    count: usize,
    values: *mut f64,
) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches.
        let references = unsafe { items("vr", references, count) }?;
        let instance = shared.instance();
        // All of them before any is written.
        let found: Vec<f64> = references
            .iter()
            .map(|reference| instance.real(*reference))
            .collect::<Result<_, _>>()?;
        // SAFETY: as the caller vouches.
        unsafe { write_all("value", values, &found) }
    })
}

/// No variable is an integer.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(
    c: Component,
    references: *const ValueReference,
    count: usize,
    _values: *mut c_int,
) -> Status {
    // SAFETY: as the caller vouches.
    unsafe { none_of_type(c, "fmi2GetInteger", references, count) }
}

/// Values of Boolean variables.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBoolean(
    c: Component,
    references: *const ValueReference,
    count: usize,
    values: *mut Boolean,
) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches.
        let references = unsafe { items("vr", references, count) }?;
        let instance = shared.instance();
        let found: Vec<Boolean> = references
            .iter()
            .map(|reference| {
                Ok(if instance.boolean(*reference)? {
                    TRUE
                } else {
                    FALSE
                })
            })
            .collect::<Result<_, Refusal>>()?;
        // SAFETY: as the caller vouches.
        unsafe { write_all("value", values, &found) }
    })
}

/// Values of texts, which stay until the instance is freed.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetString(
    c: Component,
    references: *const ValueReference,
    count: usize,
    values: *mut *const c_char,
) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches.
        let references = unsafe { items("vr", references, count) }?;
        let instance = shared.instance();
        let found: Vec<*const c_char> = references
            .iter()
            .map(|reference| {
                instance.text(*reference)?;
                Ok(shared.kept_text(*reference))
            })
            .collect::<Result<_, Refusal>>()?;
        // SAFETY: as the caller vouches.
        unsafe { write_all("value", values, &found) }
    })
}

/// Sets inputs and parameters: all of them, or none.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(
    c: Component,
    references: *const ValueReference,
    count: usize,
    values: *const f64,
) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches.
        let (references, values) = unsafe {
            (
                items("vr", references, count)?,
                items("value", values, count)?,
            )
        };
        let pairs = references.iter().copied().zip(values.iter().copied());
        shared.instance().set_reals(pairs)
    })
}

/// No integer is to be set.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(
    c: Component,
    references: *const ValueReference,
    count: usize,
    _values: *const c_int,
) -> Status {
    // SAFETY: as the caller vouches.
    unsafe { none_of_type(c, "fmi2SetInteger", references, count) }
}

/// No Boolean is to be set.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetBoolean(
    c: Component,
    references: *const ValueReference,
    count: usize,
    _values: *const Boolean,
) -> Status {
    // SAFETY: as the caller vouches.
    unsafe { none_of_type(c, "fmi2SetBoolean", references, count) }
}

/// No text is to be set.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetString(
    c: Component,
    references: *const ValueReference,
    count: usize,
    _values: *const *const c_char,
) -> Status {
    // SAFETY: as the caller vouches.
    unsafe { none_of_type(c, "fmi2SetString", references, count) }
}

/// Refuses the first of the references, as no variable is of the type of `function`; of none there is nothing to refuse.
///
/// # Safety
/// As the module says.
unsafe fn none_of_type(
    c: Component,
    function: &str,
    references: *const ValueReference,
    count: usize,
) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches.
        match unsafe { items("vr", references, count) }?.first() {
            None => Ok(()),
            Some(first) => Err(shared.instance().none_of_type(function, *first)),
        }
    })
}

/// Saves all that changes in the instance, in a state that was saved before or in a further one.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: Component, saved: *mut SavedState) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches; the standard has it NULL or a saved state.
        let over = unsafe { read("FMUstate", saved) }?;
        let number = shared.instance().save(over.addr())?;
        // SAFETY: as the caller vouches.
        unsafe { write("FMUstate", saved, pointer(number)) }
    })
}

/// Goes back to a saved state.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetFMUstate(c: Component, saved: SavedState) -> Status {
    call(c, |shared| shared.instance().restore(saved.addr()))
}

/// Lets go of a saved state. NULL is ignored, as the standard has it.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: Component, saved: *mut SavedState) -> Status {
    call(c, |shared| {
        if saved.is_null() {
            return Ok(());
        }
        // SAFETY: as the caller vouches.
        let number = unsafe { read("FMUstate", saved) }?.addr();
        if number == 0 {
            return Ok(());
        }
        shared.instance().free_saved(number)?;
        // SAFETY: as the caller vouches.
        unsafe { write("FMUstate", saved, std::ptr::null_mut()) }
    })
}

/// How many bytes a saved state has.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(
    c: Component,
    saved: SavedState,
    size: *mut usize,
) -> Status {
    call(c, |shared| {
        let bytes = shared.instance().serialized(saved.addr())?;
        // SAFETY: as the caller vouches.
        unsafe { write("size", size, bytes.len()) }
    })
}

/// Writes the bytes of a saved state.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: Component,
    saved: SavedState,
    bytes: *mut u8,
    size: usize,
) -> Status {
    call(c, |shared| {
        let found = shared.instance().serialized(saved.addr())?;
        if size < found.len() {
            return Err(Refusal::new(
                "size",
                size,
                format_args!("the state has {} bytes", found.len()),
                "ask fmi2SerializedFMUstateSize",
            ));
        }
        // SAFETY: as the caller vouches, of no fewer bytes.
        unsafe { write_all("serializedState", bytes, &found) }
    })
}

/// Saves a state that was written as bytes.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: Component,
    bytes: *const u8,
    size: usize,
    saved: *mut SavedState,
) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches.
        let bytes = unsafe { items("serializedState", bytes, size) }?;
        if saved.is_null() {
            return Err(Refusal::null("FMUstate"));
        }
        let number = shared.instance().deserialize(bytes)?;
        // SAFETY: as the caller vouches.
        unsafe { write("FMUstate", saved, pointer(number)) }
    })
}

fn pointer(number: usize) -> *mut c_void {
    std::ptr::without_provenance_mut(number)
}

/// Not provided, as the description says.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetDirectionalDerivative(
    c: Component,
    _unknowns: *const ValueReference,
    _unknown_count: usize,
    _knowns: *const ValueReference,
    _known_count: usize,
    _known_differentials: *const f64,
    _unknown_differentials: *mut f64,
) -> Status {
    call(c, |_| {
        Err(Refusal::new(
            "providesDirectionalDerivative",
            false,
            "friction has none where it turns",
            "take differences of saved states",
        ))
    })
}

/// First and second derivatives of inputs over time, for the next step: it extrapolates the inputs by them.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: Component,
    references: *const ValueReference,
    count: usize,
    orders: *const c_int,
    values: *const f64,
) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches.
        let (references, orders, values) = unsafe {
            (
                items("vr", references, count)?,
                items("order", orders, count)?,
                items("value", values, count)?,
            )
        };
        let all = references.iter().zip(orders).zip(values);
        let all = all.map(|((reference, order), value)| (*reference, *order, *value));
        shared.instance().set_slopes(all)
    })
}

/// Not provided: `maxOutputDerivativeOrder` is 0.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetRealOutputDerivatives(
    c: Component,
    _references: *const ValueReference,
    count: usize,
    _orders: *const c_int,
    _values: *mut f64,
) -> Status {
    call(c, |_| match count {
        0 => Ok(()),
        _ => Err(Refusal::new(
            "maxOutputDerivativeOrder",
            0,
            "outputs have no derivatives here",
            "take differences of their values",
        )),
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

/// Refused: no step is under way when another call comes.
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

/// Of a step that is pending: none is.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetStatus(c: Component, kind: c_int, _value: *mut c_int) -> Status {
    not_pending(c, kind)
}

/// `fmi2LastSuccessfulTime`: where the last step ended, s.
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

/// Of a step that is pending: none is.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetIntegerStatus(c: Component, kind: c_int, _value: *mut c_int) -> Status {
    not_pending(c, kind)
}

/// `fmi2Terminated`: whether the FMU itself wants to end, which it never does.
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

/// Of a step that is pending: none is.
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
