//! Files of the emulator's host, through Arm's semihosting.

use core::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use super::semihosting::call;

const SYS_OPEN: usize = 0x01;
const SYS_WRITE: usize = 0x05;
const SYS_READ: usize = 0x06;

/// Mode for opening a file, as C's `fopen`.
pub enum Mode {
    /// `rb`
    Read = 1,
    /// `wb`
    Write = 5,
}

/// An open file.
pub struct File(usize);

#[inline]
fn call_with(operation: usize, arguments: &[usize]) -> usize {
    call(operation, arguments.as_ptr() as usize)
}

impl File {
    /// The file at `path`, which ends with a zero. A file that cannot be opened fails at its first use.
    pub fn open(path: &core::ffi::CStr, mode: Mode) -> Self {
        let length = path.count_bytes();
        let arguments = [path.as_ptr() as usize, mode as usize, length];
        Self(call_with(SYS_OPEN, &arguments))
    }

    /// The file at `path`, opened once for all users of this `handle`, which is [`usize::MAX`] before.
    pub fn shared(handle: &AtomicUsize, path: &core::ffi::CStr, mode: Mode) -> Self {
        if handle.load(Relaxed) == usize::MAX {
            handle.store(Self::open(path, mode).0, Relaxed);
        }
        Self(handle.load(Relaxed))
    }

    /// Waits for bytes and returns those that arrived; none at the end of the file.
    #[inline]
    pub fn read<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        let arguments = [self.0, buffer.as_mut_ptr() as usize, buffer.len()];
        let missing = call_with(SYS_READ, &arguments);
        let came = buffer.len().saturating_sub(missing);
        buffer.get(..came).unwrap_or_default()
    }

    /// Writes all of `bytes`, or reports that it could not.
    #[inline]
    pub fn write(&mut self, bytes: &[u8]) -> bool {
        let arguments = [self.0, bytes.as_ptr() as usize, bytes.len()];
        call_with(SYS_WRITE, &arguments) == 0
    }
}
