//! Parts of a board in QEMU: what stands in for the link, the log, the converters and the interrupts of a real one.

mod converters;
mod file;
mod interrupts;
mod link;
mod memory;
mod semihosting;
mod uart;

pub use converters::{Adc, Dac, Enable, SimulatedConverters};
pub use link::{Pipes, StandardError};
pub use memory::SharedMemory;
pub use semihosting::exit;
pub use uart::Serial;

/// Restarts the processor, and with it the image.
pub fn reset() -> ! {
    cortex_m::peripheral::SCB::sys_reset()
}
