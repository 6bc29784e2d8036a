//! A timer of the MPS2 that counts freely at 25 MHz.

use super::register::{read, write};

/// Its rate, Hz.
pub const CLOCK: u32 = 25_000_000;

/// Timer 0 of the Cortex-M System Design Kit, which counts down.
const BASE: usize = 0x4000_0000;
const CONTROL: usize = BASE;
const VALUE: usize = BASE + 0x4;
const RELOAD: usize = BASE + 0x8;
/// Enabled, without an interrupt.
const ENABLED: u32 = 1;

/// Starts counting.
pub fn start_clock() {
    write(RELOAD, u32::MAX);
    write(VALUE, u32::MAX);
    write(CONTROL, ENABLED);
}

/// Its count.
#[inline]
pub fn clock() -> u32 {
    !read(VALUE)
}
