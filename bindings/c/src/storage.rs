//! Memory that C owns, with Rust values in it.

use core::mem::MaybeUninit;

use crate::error::{Error, Problem};

/// An opaque struct of C.
///
/// # Safety
/// `Held<Inner>` fits into the implementor; [`assert_fits`] checks this at compile time.
pub(crate) unsafe trait Storage: Sized {
    /// The type of the value in it.
    type Inner;
    /// Marks memory that is initialised as this type. C's statics are all 0, so memory that was never initialised is detected.
    const TAG: u32;
    /// A size constant may exceed the needed size by fewer bytes than this: it is a multiple of the alignment, which is at most 16.
    const SLACK: usize = 16;
}

/// The contents of the memory. The tag comes last, so that the values of every tick are within reach of a load's offset.
#[repr(C)]
pub(crate) struct Held<T> {
    value: MaybeUninit<T>,
    tag: u32,
}

/// Fails to compile if `S` is too small, aligned too loosely, or wastes memory.
pub(crate) const fn assert_fits<S: Storage>() {
    let (needed, given) = (size_of::<Held<S::Inner>>(), size_of::<S>());
    assert!(
        needed <= given,
        "the size constant is too small: raise it by 8 until this compiles; 32-bit targets have a constant of their own"
    );
    assert!(
        given - needed < S::SLACK,
        "the size constant is too large: lower it by 8 until this compiles; 32-bit targets have a constant of their own"
    );
    assert!(
        align_of::<Held<S::Inner>>() <= align_of::<S>(),
        "the alignment constant is too small"
    );
}

/// The memory, if the pointer is not null and is aligned.
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

/// Writes the value of `make` into the memory. If it fails, the memory counts as not initialised.
///
/// # Safety
/// `storage` is null, or points to writable memory of its type's size that nothing else uses.
#[inline(always)]
pub(crate) unsafe fn initialize<S: Storage>(
    storage: *mut S,
    make: impl FnOnce() -> Result<S::Inner, Problem>,
) -> Result<(), Problem> {
    let held = place(storage)?;
    // SAFETY: it is neither null nor misaligned; the caller guarantees the rest.
    unsafe {
        (&raw mut (*held).tag).write(0);
        (&raw mut (*held).value).write(MaybeUninit::new(make()?));
        (&raw mut (*held).tag).write(S::TAG);
    }
    Ok(())
}

/// Marks the memory as not initialised. Its value stays, for a controller that may still call it.
///
/// # Safety
/// As [`initialize`].
pub(crate) unsafe fn forget<S: Storage>(storage: *mut S) {
    if let Ok(held) = place(storage) {
        // SAFETY: it is neither null nor misaligned; the caller guarantees the rest.
        unsafe { (&raw mut (*held).tag).write(0) };
    }
}

/// The address of the value in the memory. No reference is made on the way, so the address may be kept and is as good as C's own
/// pointer.
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

/// The value in the memory.
///
/// # Errors
/// As [`value_place`].
///
/// # Safety
/// `storage` is null, or points to memory of its type's size that nothing else uses as long as the reference lives.
#[inline(always)]
pub(crate) unsafe fn held<'a, S: Storage>(storage: *mut S) -> Result<&'a mut S::Inner, Error> {
    // SAFETY: the tag shows that the value was written; the caller guarantees the rest.
    unsafe { value_place(storage).map(|value| &mut *value) }
}

/// [`held`] for memory that is only read.
///
/// # Safety
/// `storage` is null, or points to memory of its type's size that nothing changes as long as the reference lives.
#[inline(always)]
pub(crate) unsafe fn held_const<'a, S: Storage>(storage: *const S) -> Result<&'a S::Inner, Error> {
    // SAFETY: the tag shows that the value was written; the caller guarantees the rest.
    unsafe { value_place(storage.cast_mut()).map(|value| &*value) }
}

/// The value that C points to, for reading.
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
    // SAFETY: it is neither null nor misaligned; the caller guarantees the rest.
    Ok(unsafe { &*pointer })
}

/// Writes `value` to the memory that C points to, if the pointer is valid.
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
    // SAFETY: it is neither null nor misaligned; the caller guarantees the rest.
    unsafe { pointer.write(value) };
    Ok(())
}

/// The `length` values that C points to; the pointer must not be null.
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
    // SAFETY: it is neither null nor misaligned; the caller guarantees the rest.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}
