//! How much of the stack was used.

use core::arch::asm;

/// What cortex-m-rt fills the stack with before `main`.
const PAINT: u32 = 0xCCCC_CCCC;
/// Bytes below the caller's own that are left as they are: what this file's functions take themselves.
const MARGIN: u32 = 64;

unsafe extern "C" {
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Most bytes of stack used since the start.
pub fn used() -> u32 {
    // SAFETY: the linker's symbol has an address.
    let top = &raw const _stack_start;
    (top as u32).wrapping_sub(deepest())
}

/// Bytes of stack that `work` takes below its caller.
#[inline(never)]
pub fn of(work: impl FnOnce()) -> u32 {
    let here: u32;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) here, options(nomem, nostack, preserves_flags)) };
    let end = (here - MARGIN) as *mut u32;
    // SAFETY: from the linker's end of the variables to well below this call the stack is nobody's.
    unsafe { paint((&raw const _stack_end).cast_mut(), end) };
    work();
    here.wrapping_sub(deepest())
}

/// Where the paint ends.
fn deepest() -> u32 {
    let mut word = &raw const _stack_end;
    let top = &raw const _stack_start;
    // SAFETY: from the linker's end of the variables to the beginning of the stack it is memory of nobody else.
    while word < top && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    word as u32
}

/// Fills the words from `first` to before `end`.
///
/// # Safety
/// They are nobody's.
unsafe fn paint(first: *mut u32, end: *mut u32) {
    let mut word = first;
    while word < end {
        // SAFETY: by the caller's promise.
        unsafe { word.write_volatile(PAINT) };
        word = word.wrapping_add(1);
    }
}
