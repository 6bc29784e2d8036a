//! Registers of the emulated MPS2.

use core::ptr::{
    read_volatile, with_exposed_provenance, with_exposed_provenance_mut, write_volatile,
};

/// The value of the register at `address`.
#[inline]
pub fn read(address: usize) -> u32 {
    // SAFETY: the given addresses are registers of the board that always exist, and each is used by one file here.
    unsafe { read_volatile(with_exposed_provenance(address)) }
}

/// Writes the register at `address`.
#[inline]
pub fn write(address: usize, value: u32) {
    // SAFETY: as above.
    unsafe { write_volatile(with_exposed_provenance_mut(address), value) }
}
