//! Text to the emulator's standard output, and the image's end with an exit status.

use core::arch::asm;
use core::fmt;

const SYS_WRITE0: usize = 0x04;
const SYS_EXIT: usize = 0x18;
/// Reasons that [`SYS_EXIT`] takes on a 32-bit core.
const APPLICATION_EXIT: usize = 0x2_0026;
const RUN_TIME_ERROR: usize = 0x2_0023;

fn call(operation: usize, argument: usize) {
    // SAFETY: the emulator reads what `argument` points to and changes r0 alone.
    unsafe {
        asm!("bkpt #0xab", inout("r0") operation => _, in("r1") argument, options(nostack));
    }
}

/// Standard output.
pub struct Output;

impl fmt::Write for Output {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for part in text.as_bytes().chunks(63) {
            // Ends with a zero.
            let mut buffer = [0; 64];
            buffer[..part.len()].copy_from_slice(part);
            call(SYS_WRITE0, buffer.as_ptr() as usize);
        }
        Ok(())
    }
}

/// Ends the emulator, with status 0 or 1.
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
