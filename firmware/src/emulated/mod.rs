//! Parts of a board in QEMU, in place of the link, the log, the converters and the interrupts of a real one.

mod beside;
mod clock;
mod converters;
mod file;
mod interrupts;
mod link;
mod memory;
mod register;
mod semihosting;
mod uart;
mod watchdog;

pub use beside::{BesideConverters, BesideSensors};
pub use clock::{CLOCK, clock, start_clock};
pub use converters::{Adc, Dac, Enable, SimulatedConverters};
pub use link::{Pipes, StandardError};
pub use memory::SharedMemory;
pub use semihosting::exit;
pub use uart::Uart;
pub use watchdog::Watchdog;

/// Some instructions that do nothing.
#[inline]
pub fn idle() {
    cortex_m::asm::delay(40);
}

/// Restarts the processor, and with it the image.
pub fn reset() -> ! {
    cortex_m::peripheral::SCB::sys_reset()
}
