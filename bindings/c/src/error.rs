//! Error codes with their names, and the details of a problem.

use core::ffi::{CStr, c_char};
use core::ptr;

use mesh_damper::error::ConfigError;
use mesh_damper::pack::{OLDEST, PackError, VERSION};
use mesh_damper::rig::{ClearRefused, StartRefused};

use crate::storage;
use crate::telemetry::TripCause;

/// Error codes of the calls. The numbers do not change.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Error {
    /// No error.
    None = 0,
    /// A pointer is null where it must not be.
    Null = 1,
    /// A pointer is not aligned for its type.
    Misaligned = 2,
    /// The memory was never initialised, or its initialisation was refused.
    NotInitialized = 3,
    /// The bytes do not begin like a pack.
    PackMagic = 10,
    /// The format version of the pack is too new or too old to be read.
    PackVersion = 11,
    /// The pack is for another tick rate.
    PackTickRate = 12,
    /// The pack is for another model.
    PackIdentity = 13,
    /// The revision of the pack is not above the required one.
    PackRevision = 14,
    /// The length differs from the length that the pack states.
    PackLength = 15,
    /// The pack's checksum does not match.
    PackChecksum = 16,
    /// The checksum of the pack matches, but its body cannot be read.
    PackBody = 17,
    /// The pack has version 6, which does not describe its contents.
    PackSilent = 18,
    /// The law of the pack is not passive: it can give out more energy than it takes.
    PackActive = 19,
    /// A field is NaN or infinite.
    NonFinite = 30,
    /// A field lies outside its range.
    OutOfRange = 31,
    /// The nodes of a grid do not increase.
    NotIncreasing = 32,
    /// There are more elements than there is room for.
    Full = 33,
    /// There is no element where one is needed.
    Empty = 34,
    /// A feature of an earlier version that this version does not have.
    Removed = 35,
    /// The controller is running.
    Running = 50,
    /// The command is still on its way back to 0.
    Moving = 51,
    /// The controller is stopped by a trip that was not cleared, or that occurred again.
    Faulted = 52,
    /// There is no trip to clear.
    NoFault = 53,
    /// A reason that this library has no code for.
    Other = 99,
}

/// The details of a problem. Fields that do not apply are 0 or null.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Problem {
    /// The code that the call returns.
    pub error: Error,
    /// The trip cause of a rig or an emulation, for `MD_ERROR_FAULTED`.
    pub trip: TripCause,
    /// The field's name. It does not end in NUL: print it with `"%.*s", (int)problem.field_length, problem.field`.
    pub field: *const c_char,
    /// Length of the name, bytes.
    pub field_length: usize,
    /// Value of the field, in its unit; NaN if a pack does not give it.
    pub value: f64,
    /// Smallest permitted value.
    pub low: f64,
    /// Largest permitted value.
    pub high: f64,
}

impl From<Error> for Problem {
    fn from(error: Error) -> Self {
        Self {
            error,
            trip: TripCause::None,
            field: ptr::null(),
            field_length: 0,
            value: 0.0,
            low: 0.0,
            high: 0.0,
        }
    }
}

impl Problem {
    fn of(error: Error, field: &'static str) -> Self {
        Self {
            field: field.as_ptr().cast(),
            field_length: field.len(),
            ..error.into()
        }
    }

    fn within(self, value: f64, low: f64, high: f64) -> Self {
        Self {
            value,
            low,
            high,
            ..self
        }
    }

    fn faulted(cause: mesh_damper::rig::TripCause) -> Self {
        Self {
            trip: cause.into(),
            ..Error::Faulted.into()
        }
    }
}

impl From<ConfigError> for Problem {
    fn from(error: ConfigError) -> Self {
        match error {
            ConfigError::NonFinite(field) => Self::of(Error::NonFinite, field),
            ConfigError::OutOfRange {
                field,
                value,
                low,
                high,
            } => Self::of(Error::OutOfRange, field).within(value, low, high),
            ConfigError::NotIncreasing(field) => Self::of(Error::NotIncreasing, field),
            ConfigError::Full { field, capacity } => {
                Self::of(Error::Full, field).within(0.0, 0.0, capacity as f64)
            }
            ConfigError::Empty(field) => Self::of(Error::Empty, field),
            ConfigError::Removed(what) => Self::of(Error::Removed, what),
            _ => Error::Other.into(),
        }
    }
}

impl From<PackError> for Problem {
    fn from(error: PackError) -> Self {
        match error {
            PackError::Magic => Error::PackMagic.into(),
            PackError::Version { found } => Self::of(Error::PackVersion, "version").within(
                f64::from(found),
                f64::from(OLDEST),
                f64::from(VERSION),
            ),
            PackError::TickRate { expected, found } => {
                let (found, expected) = (found.unwrap_or(f32::NAN), f64::from(expected));
                Self::of(Error::PackTickRate, "tick_rate").within(
                    f64::from(found),
                    expected,
                    expected,
                )
            }
            PackError::Identity { .. } => Self::of(Error::PackIdentity, "identity"),
            PackError::Revision { newer_than, found } => {
                let found = found.map_or(f64::NAN, f64::from);
                let least = f64::from(newer_than) + 1.0;
                Self::of(Error::PackRevision, "revision").within(found, least, f64::from(u32::MAX))
            }
            PackError::Length { expected, found } => Self::of(Error::PackLength, "length").within(
                found as f64,
                expected as f64,
                expected as f64,
            ),
            PackError::Checksum => Error::PackChecksum.into(),
            PackError::Body => Error::PackBody.into(),
            PackError::Active(active) => Self {
                value: active.value,
                ..Self::of(Error::PackActive, active.field)
            },
            PackError::Refused(error) => error.into(),
            _ => Error::Other.into(),
        }
    }
}

impl From<StartRefused> for Problem {
    fn from(refused: StartRefused) -> Self {
        match refused {
            StartRefused::Running => Error::Running.into(),
            StartRefused::Moving => Error::Moving.into(),
            StartRefused::Faulted(cause) => Self::faulted(cause),
        }
    }
}

impl From<ClearRefused> for Problem {
    fn from(refused: ClearRefused) -> Self {
        match refused {
            ClearRefused::NoFault => Error::NoFault.into(),
            ClearRefused::Moving => Error::Moving.into(),
            ClearRefused::Faulted(cause) => Self::faulted(cause),
        }
    }
}

/// The code for C. The details go to `problem`, if it is not null.
///
/// # Safety
/// `problem` is null or points to writable memory for a problem.
pub(crate) unsafe fn answer(result: Result<(), Problem>, problem: *mut Problem) -> Error {
    let refused = result.err().unwrap_or(Error::None.into());
    // Null means that the caller does not want the details.
    // SAFETY: guaranteed by the caller.
    let _ = unsafe { storage::write(problem, refused) };
    refused.error
}

/// The code of a call without further details.
pub(crate) fn code(result: Result<(), Error>) -> Error {
    result.err().unwrap_or(Error::None)
}

/// Each code, its name in C, and a remedy.
const CODES: [(Error, &CStr, &CStr); 26] = [
    (Error::None, c"MD_ERROR_NONE", c"nothing is wrong"),
    (
        Error::Null,
        c"MD_ERROR_NULL",
        c"a pointer is null: pass an address of the type that the header states",
    ),
    (
        Error::Misaligned,
        c"MD_ERROR_MISALIGNED",
        c"a pointer is not aligned: declare a variable of its type, or align by MD_..._ALIGN",
    ),
    (
        Error::NotInitialized,
        c"MD_ERROR_NOT_INITIALIZED",
        c"the memory is not initialised: call its md_..._init, and see that it returns MD_ERROR_NONE",
    ),
    (
        Error::PackMagic,
        c"MD_ERROR_PACK_MAGIC",
        c"these bytes are not a coefficient pack: pass the array of the exported .c file",
    ),
    (
        Error::PackVersion,
        c"MD_ERROR_PACK_VERSION",
        c"this format version is not read: export the model with the version of mesh-damper that this library was built from",
    ),
    (
        Error::PackTickRate,
        c"MD_ERROR_PACK_TICK_RATE",
        c"the pack is for another tick rate: export the model with --tick-rate",
    ),
    (
        Error::PackIdentity,
        c"MD_ERROR_PACK_IDENTITY",
        c"the pack is of another model: pass the pack of the model that is expected",
    ),
    (
        Error::PackRevision,
        c"MD_ERROR_PACK_REVISION",
        c"the pack is no newer than is required: export the model with a higher --revision",
    ),
    (
        Error::PackLength,
        c"MD_ERROR_PACK_LENGTH",
        c"there are more or fewer bytes than the pack says: pass all of it, with its own length",
    ),
    (
        Error::PackChecksum,
        c"MD_ERROR_PACK_CHECKSUM",
        c"bytes of the pack have changed: transfer it again",
    ),
    (
        Error::PackBody,
        c"MD_ERROR_PACK_BODY",
        c"the pack cannot be read: export the model again",
    ),
    (
        Error::PackSilent,
        c"MD_ERROR_PACK_SILENT",
        c"a pack of version 6 says nothing of itself: export the model again",
    ),
    (
        Error::PackActive,
        c"MD_ERROR_PACK_ACTIVE",
        c"the law can give more energy than it takes with the field that md_problem names: correct it, or set allow_active",
    ),
    (
        Error::NonFinite,
        c"MD_ERROR_NON_FINITE",
        c"a field is NaN or infinite: md_problem names it",
    ),
    (
        Error::OutOfRange,
        c"MD_ERROR_OUT_OF_RANGE",
        c"a field is outside its range: md_problem has its name, its value and its range",
    ),
    (
        Error::NotIncreasing,
        c"MD_ERROR_NOT_INCREASING",
        c"the nodes of a grid must increase: md_problem names it",
    ),
    (
        Error::Full,
        c"MD_ERROR_FULL",
        c"there are more elements than fit: md_problem has how many do",
    ),
    (
        Error::Empty,
        c"MD_ERROR_EMPTY",
        c"at least one element is needed: md_problem names of what",
    ),
    (
        Error::Removed,
        c"MD_ERROR_REMOVED",
        c"this version has that no more: export the model again",
    ),
    (
        Error::Running,
        c"MD_ERROR_RUNNING",
        c"it is running: stop it first",
    ),
    (
        Error::Moving,
        c"MD_ERROR_MOVING",
        c"the command is on its way back to 0: go on ticking, and ask again after stop_ticks and one",
    ),
    (
        Error::Faulted,
        c"MD_ERROR_FAULTED",
        c"it has tripped; md_problem names the cause: remove it, then clear the trip",
    ),
    (
        Error::NoFault,
        c"MD_ERROR_NO_FAULT",
        c"it has not tripped, so there is nothing to clear",
    ),
    (
        Error::Other,
        c"MD_ERROR_OTHER",
        c"it is refused for a reason for which this library has no code",
    ),
    // A number from C that is no code.
    (Error::Other, c"?", c"this number is no error code"),
];

/// The row of `code`, or the last one.
fn row(code: i32) -> (&'static CStr, &'static CStr) {
    let [rows @ .., (_, unknown, no_help)] = &CODES;
    rows.iter()
        .find(|(error, ..)| *error as i32 == code)
        .map_or((*unknown, *no_help), |(_, name, help)| (*name, *help))
}

/// The name of an error code as in this header, such as `"MD_ERROR_NULL"`; `"?"` for any other number. It ends in NUL and is never
/// null.
#[unsafe(no_mangle)]
pub extern "C" fn md_error_name(error: i32) -> *const c_char {
    row(error).0.as_ptr()
}

/// The remedy for an error code, in one sentence. It ends in NUL and is never null.
#[unsafe(no_mangle)]
pub extern "C" fn md_error_help(error: i32) -> *const c_char {
    row(error).1.as_ptr()
}
