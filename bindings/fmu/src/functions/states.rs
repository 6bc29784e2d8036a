//! Saved states, their restoration, and their bytes.

use super::boundary::{call, items, pointer, read, write, write_all};
use crate::refusal::Refusal;
use crate::types::{Component, SavedState, Status};

/// Saves everything that changes in the instance, in an earlier saved state or in a new one.
///
/// # Safety
/// As the module says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: Component, saved: *mut SavedState) -> Status {
    call(c, |shared| {
        // SAFETY: as the caller vouches; by the standard it is NULL or a saved state.
        let over = unsafe { read("FMUstate", saved) }?;
        let number = shared.instance().save(over.addr())?;
        // SAFETY: as the caller vouches.
        unsafe { write("FMUstate", saved, pointer(number)) }
    })
}

/// Returns to a saved state.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetFMUstate(c: Component, saved: SavedState) -> Status {
    call(c, |shared| shared.instance().restore(saved.addr()))
}

/// Releases a saved state. NULL is ignored, as the standard requires.
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

/// The number of bytes of a saved state.
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

/// Saves a state from its bytes.
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
