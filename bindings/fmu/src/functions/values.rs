//! Values of variables, and derivatives.

use std::ffi::{c_char, c_int};

use super::boundary::{call, items, write_all};
use crate::refusal::Refusal;
use crate::types::{Boolean, Component, FALSE, Status, TRUE, ValueReference};

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
        // All are read before any is written.
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

/// Values of texts, which stay valid until the instance is freed.
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

/// No integer can be set.
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

/// No Boolean can be set.
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

/// No text can be set.
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

/// Refuses the first of the references, because no variable has the type of `function`. Without references there is nothing to
/// refuse.
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

/// Not provided, as the description states.
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

/// First and second derivatives of inputs over time, for the next step, which extrapolates the inputs with them.
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
