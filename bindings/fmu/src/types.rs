//! The types of the headers `fmi2TypesPlatform.h` and `fmi2FunctionTypes.h`, with Rust names.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// `fmi2Component`: a number that identifies an instance. It is not the address of anything.
pub type Component = *mut c_void;
/// `fmi2FMUstate`: a number that identifies a saved state of an instance. It is not the address of anything.
pub type SavedState = *mut c_void;
/// `fmi2ValueReference`
pub type ValueReference = c_uint;
/// `fmi2Boolean`: 0 is false.
pub type Boolean = c_int;

/// `fmi2True`
pub const TRUE: Boolean = 1;
/// `fmi2False`
pub const FALSE: Boolean = 0;

/// `fmi2Status`
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// `fmi2OK`
    Ok = 0,
    /// `fmi2Warning`
    Warning = 1,
    /// `fmi2Discard`
    Discard = 2,
    /// `fmi2Error`
    Error = 3,
    /// `fmi2Fatal`
    Fatal = 4,
    /// `fmi2Pending`
    Pending = 5,
}

/// `fmi2CallbackLogger`: environment, name of the instance, status, category, message as a `printf` format.
pub type Logger =
    unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...);

/// `fmi2CallbackFunctions`
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Callbacks {
    /// Receives messages.
    pub logger: Option<Logger>,
    /// Not used: the library allocates its own memory.
    pub allocate_memory: Option<unsafe extern "C" fn(usize, usize) -> *mut c_void>,
    /// Not used.
    pub free_memory: Option<unsafe extern "C" fn(*mut c_void)>,
    /// Not used: no step is asynchronous.
    pub step_finished: Option<unsafe extern "C" fn(*mut c_void, c_int)>,
    /// Passed back to the logger.
    pub environment: *mut c_void,
}
