//! Text to the emulator's standard output.

use core::fmt;

use super::semihosting::call;

const SYS_WRITE0: usize = 0x04;

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
