//! The stack that one call takes.

use core::arch::asm;

use crate::stack::{PAINT, deepest, lowest};

/// Bytes below the caller's stack that are left unchanged: this function's own stack.
const MARGIN: u32 = 64;

/// Bytes of stack that `work` uses below its caller.
#[inline(never)]
pub fn stack_of(work: impl FnOnce()) -> u32 {
    let here: u32;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) here, options(nomem, nostack, preserves_flags)) };
    let end = (here - MARGIN) as *mut u32;
    let mut word = lowest();
    while word < end {
        // SAFETY: nobody uses the stack from the linker's end of the variables to well below this call.
        unsafe { word.write_volatile(PAINT) };
        word = word.wrapping_add(1);
    }
    work();
    here.wrapping_sub(deepest())
}
