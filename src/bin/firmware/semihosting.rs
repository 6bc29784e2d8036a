//! Files of the emulator's host, by Arm's semihosting.

use core::arch::asm;

const SYS_OPEN: usize = 0x01;
const SYS_WRITE: usize = 0x05;
const SYS_READ: usize = 0x06;
const SYS_EXIT: usize = 0x18;
/// Reasons that [`SYS_EXIT`] takes on a 32-bit core.
const APPLICATION_EXIT: usize = 0x2_0026;
const RUN_TIME_ERROR: usize = 0x2_0023;

/// Way to open a file, as C's `fopen`.
pub enum Mode {
    /// `rb`
    Read = 1,
    /// `wb`
    Write = 5,
}

/// A file that is open.
pub struct File(usize);

#[inline]
fn call(operation: usize, argument: usize) -> usize {
    let result;
    // SAFETY: the emulator reads what `argument` points to, writes to the buffer named there, and changes r0.
    unsafe {
        asm!("bkpt #0xab", inout("r0") operation => result, in("r1") argument, options(nostack));
    }
    result
}

#[inline]
fn call_with(operation: usize, arguments: &[usize]) -> usize {
    call(operation, arguments.as_ptr() as usize)
}

impl File {
    /// The file at `path`, which ends with a zero. One that cannot be opened fails when it is used.
    pub fn open(path: &core::ffi::CStr, mode: Mode) -> Self {
        let length = path.count_bytes();
        let arguments = [path.as_ptr() as usize, mode as usize, length];
        Self(call_with(SYS_OPEN, &arguments))
    }

    /// Waits for bytes and gives those that came; none at the file's end.
    #[inline]
    pub fn read<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        let arguments = [self.0, buffer.as_mut_ptr() as usize, buffer.len()];
        let missing = call_with(SYS_READ, &arguments);
        let came = buffer.len().saturating_sub(missing);
        buffer.get(..came).unwrap_or_default()
    }

    /// Writes all of `bytes`, or says that it could not.
    #[inline]
    pub fn write(&mut self, bytes: &[u8]) -> bool {
        let arguments = [self.0, bytes.as_ptr() as usize, bytes.len()];
        call_with(SYS_WRITE, &arguments) == 0
    }
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
