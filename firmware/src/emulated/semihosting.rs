//! Calls of the emulator's host by Arm's semihosting, and an image's end.

use core::arch::asm;

const SYS_EXIT: usize = 0x18;
/// Reasons that [`SYS_EXIT`] takes on a 32-bit core.
const APPLICATION_EXIT: usize = 0x2_0026;
const RUN_TIME_ERROR: usize = 0x2_0023;

/// The host's `operation` on what `argument` is or points to, and what it gives.
#[inline]
pub fn call(operation: usize, argument: usize) -> usize {
    let result;
    // SAFETY: the emulator reads what `argument` points to, writes to the buffer named there, and changes r0.
    unsafe {
        asm!("bkpt #0xab", inout("r0") operation => result, in("r1") argument, options(nostack));
    }
    result
}

/// Ends the emulator, with status 0 or 1.
#[cold]
#[inline(never)]
pub fn exit(success: bool) -> ! {
    call(
        SYS_EXIT,
        if success {
            APPLICATION_EXIT
        } else {
            RUN_TIME_ERROR
        },
    );
    loop {
        core::hint::spin_loop();
    }
}
