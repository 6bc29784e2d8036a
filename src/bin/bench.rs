//! Counts instructions in an emulator: one line for each measurement, to the emulator's standard output.
#![no_std]
#![no_main]

#[path = "bench/counter.rs"]
mod counter;
#[path = "bench/effects.rs"]
mod effects;
#[path = "bench/known.rs"]
mod known;
#[path = "bench/naive.rs"]
mod naive;
#[path = "bench/power.rs"]
mod power;
#[path = "bench/rig.rs"]
mod rig;
#[path = "bench/semihosting.rs"]
mod semihosting;
#[path = "bench/suite.rs"]
mod suite;
#[path = "bench/tick.rs"]
mod tick;

use core::fmt::Write as _;
use core::panic::PanicInfo;

use cortex_m_rt::entry;

#[entry]
fn main() -> ! {
    let Some(peripherals) = cortex_m::Peripherals::take() else {
        semihosting::exit(false)
    };
    let mut counter = counter::Counter::new(peripherals.SYST);
    known::run(&mut counter);
    power::run(&mut counter);
    let done = tick::run(&mut counter).is_ok()
        && effects::run(&mut counter).is_ok()
        && rig::run(&mut counter).is_ok();
    semihosting::exit(done)
}

#[panic_handler]
fn panic(fault: &PanicInfo) -> ! {
    let _ = writeln!(semihosting::Output, "{fault}");
    semihosting::exit(false)
}
