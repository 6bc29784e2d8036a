//! Calls to the emulator's host through Arm's semihosting, and the end of an image.

use core::arch::asm;

const SYS_EXIT: usize = 0x18;
/// Reasons that [`SYS_EXIT`] takes on a 32-bit core.
const APPLICATION_EXIT: usize = 0x2_0026;
const RUN_TIME_ERROR: usize = 0x2_0023;

/// Calls the host's `operation` with `argument`, a value or an address, and returns its result.
#[inline]
pub fn call(operation: usize, argument: usize) -> usize {
    let result;
    // SAFETY: the emulator reads the data at `argument`, writes to the buffer named there, and changes r0.
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
