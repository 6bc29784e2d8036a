//! Memory that C owns, and what of Rust is in it.

use core::mem::MaybeUninit;

use crate::error::{Error, Problem};

/// An opaque struct of C.
///
/// # Safety
/// `Held<Inner>` fits into the implementor; [`assert_fits`] holds it at compile time.
pub(crate) unsafe trait Storage: Sized {
    /// What is kept in it.
    type Inner;
    /// Marks memory that is initialised as this type: C's statics are all 0, so that what was never initialised is seen.
    const TAG: u32;
}

/// What is in the memory. The tag comes last: what every tick needs is within reach of a load's offset.
#[repr(C)]
pub(crate) struct Held<T> {
    value: MaybeUninit<T>,
    tag: u32,
}

/// Fewer bytes than this may a constant be above what is needed: it is a multiple of the alignment, of at most 16.
const SLACK: usize = 16;

/// Refuses to compile where `S` is too small, aligned too loosely, or wastes memory.
pub(crate) const fn assert_fits<S: Storage>() {
    let (needed, given) = (size_of::<Held<S::Inner>>(), size_of::<S>());
    assert!(needed <= given, "the size constant is too small");
    assert!(given - needed < SLACK, "the size constant is too large");
    assert!(
        align_of::<Held<S::Inner>>() <= align_of::<S>(),
        "the alignment constant is too small"
    );
}

/// The memory, where there is some that is aligned.
fn place<S: Storage>(storage: *mut S) -> Result<*mut Held<S::Inner>, Error> {
    let held = storage.cast::<Held<S::Inner>>();
    if held.is_null() {
        Err(Error::Null)
    } else if held.is_aligned() {
        Ok(held)
    } else {
        Err(Error::Misaligned)
    }
}

/// Writes what `make` gives into the memory; where it refuses, the memory counts as not initialised.
///
/// # Safety
/// `storage` is null, or points to writable memory of its type's size that nothing else uses.
#[inline(always)]
pub(crate) unsafe fn initialize<S: Storage>(
    storage: *mut S,
    make: impl FnOnce() -> Result<S::Inner, Problem>,
) -> Result<(), Problem> {
    let held = place(storage)?;
    // SAFETY: it is neither null nor misaligned, and the caller vouches for the rest.
    unsafe {
        (&raw mut (*held).tag).write(0);
        (&raw mut (*held).value).write(MaybeUninit::new(make()?));
        (&raw mut (*held).tag).write(S::TAG);
    }
    Ok(())
}

/// The memory counts as not initialised from now on. What is in it stays, for a controller that may still call it.
///
/// # Safety
/// As [`initialize`].
pub(crate) unsafe fn forget<S: Storage>(storage: *mut S) {
    if let Ok(held) = place(storage) {
        // SAFETY: it is neither null nor misaligned, and the caller vouches for the rest.
        unsafe { (&raw mut (*held).tag).write(0) };
    }
}

/// Where in the memory the value is. No reference is made on the way: the place may be kept, and is as good as C's own pointer.
///
/// # Errors
/// [`Error::Null`], [`Error::Misaligned`] or [`Error::NotInitialized`].
///
/// # Safety
/// `storage` is null, or points to memory of its type's size that nothing changes within this call.
#[inline(always)]
pub(crate) unsafe fn value_place<S: Storage>(storage: *mut S) -> Result<*mut S::Inner, Error> {
    let held = place(storage)?;
    // SAFETY: it is neither null nor misaligned.
    unsafe {
        if (&raw const (*held).tag).read() == S::TAG {
            Ok((&raw mut (*held).value).cast())
        } else {
            Err(Error::NotInitialized)
        }
    }
}

/// What is in the memory.
///
/// # Errors
/// As [`value_place`].
///
/// # Safety
/// `storage` is null, or points to memory of its type's size that nothing else uses as long as the reference lives.
#[inline(always)]
pub(crate) unsafe fn held<'a, S: Storage>(storage: *mut S) -> Result<&'a mut S::Inner, Error> {
    // SAFETY: the tag says that the value was written, and the caller vouches for the rest.
    unsafe { value_place(storage).map(|value| &mut *value) }
}

/// [`held`] of memory that is only read.
///
/// # Safety
/// `storage` is null, or points to memory of its type's size that nothing changes as long as the reference lives.
#[inline(always)]
pub(crate) unsafe fn held_const<'a, S: Storage>(storage: *const S) -> Result<&'a S::Inner, Error> {
    // SAFETY: the tag says that the value was written, and the caller vouches for the rest.
    unsafe { value_place(storage.cast_mut()).map(|value| &*value) }
}

/// What C points to, to be read.
///
/// # Safety
/// `pointer` is null, or points to a value that nothing changes as long as the reference lives.
#[inline(always)]
pub(crate) unsafe fn read<'a, T>(pointer: *const T) -> Result<&'a T, Error> {
    if pointer.is_null() {
        return Err(Error::Null);
    }
    if !pointer.is_aligned() {
        return Err(Error::Misaligned);
    }
    // SAFETY: it is neither null nor misaligned, and the caller vouches for the rest.
    Ok(unsafe { &*pointer })
}

/// Writes `value` where C points to, where it does.
///
/// # Safety
/// `pointer` is null, or points to writable memory for a `T`.
#[inline(always)]
pub(crate) unsafe fn write<T>(pointer: *mut T, value: T) -> Result<(), Error> {
    if pointer.is_null() {
        return Err(Error::Null);
    }
    if !pointer.is_aligned() {
        return Err(Error::Misaligned);
    }
    // SAFETY: it is neither null nor misaligned, and the caller vouches for the rest.
    unsafe { pointer.write(value) };
    Ok(())
}

/// The `length` values that C points to; none of them may be null.
///
/// # Safety
/// `pointer` is null, or points to `length` values that nothing changes as long as the slice lives.
#[inline(always)]
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T], Error> {
    if pointer.is_null() {
        return Err(Error::Null);
    }
    if !pointer.is_aligned() {
        return Err(Error::Misaligned);
    }
    // SAFETY: it is neither null nor misaligned, and the caller vouches for the rest.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}
