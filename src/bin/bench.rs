//! Counts instructions in an emulator: one line for each measurement, to the emulator's standard output.
//!
//! ```text
//! name moment calls instructions least most checksum
//! ```
//!
//! `instructions` is the sum over all calls, `checksum` that of their results; `moment` tells the calls apart that have
//! different work to do.
#![no_std]
#![no_main]

#[path = "bench/counter.rs"]
mod counter;
#[path = "bench/known.rs"]
mod known;
#[path = "bench/output.rs"]
mod output;
#[path = "emulated/semihosting.rs"]
mod semihosting;
#[path = "bench/suite/mod.rs"]
mod suite;

use core::fmt::Write as _;
use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, entry, exception};

#[entry]
fn main() -> ! {
    let Some(peripherals) = cortex_m::Peripherals::take() else {
        semihosting::exit(false)
    };
    let mut counter = counter::Counter::new(peripherals.SYST);
    known::run(&mut counter);
    let counted = if cfg!(target_abi = "eabihf") {
        suite::cortex_m4f(&mut counter)
    } else {
        suite::cortex_m0(&mut counter)
    };
    semihosting::exit(counted.is_ok())
}

#[panic_handler]
fn panic(fault: &PanicInfo) -> ! {
    let _ = writeln!(output::Output, "{fault}");
    semihosting::exit(false)
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    let _ = writeln!(output::Output, "hard fault at {:#x}", frame.pc());
    semihosting::exit(false)
}
