//! Counts the instructions of a call.
//!
//! Under `-icount shift=10` an instruction takes 2¹⁰ ns of the emulator's time, in which the core's SysTick timer runs: at f MHz it
//! falls by 1.024·f in one instruction. So the nearest whole number of instructions is the exact one.

use core::fmt::{self, Write as _};
use core::hint::black_box;

use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

use super::output::Output;
use super::suite::tally::{Meter, Region, Tally};
use crate::board::{Board, Link as _};

/// Values of the timer, which counts down.
const PERIOD: u32 = 1 << 24;

/// A region without the type of its context.
type Erased = extern "C" fn(*mut (), f32, f32) -> f32;

/// Counts each call of a region.
pub struct Counter<B: Board> {
    output: Output<B::Link>,
    /// Instructions of a call of an empty region.
    overhead: u32,
}

impl<B: Board> Counter<B> {
    /// Starts the timer.
    pub fn new(mut timer: SYST) -> Self {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(PERIOD - 1);
        timer.clear_current();
        timer.enable_counter();
        let mut new = Self {
            output: Output(B::Link::open()),
            overhead: 0,
        };
        let (overhead, _) = new.call(empty, &mut (), 0.0, 0.0);
        new.overhead = overhead;
        new
    }
}

extern "C" fn empty(_: &mut (), a: f32, _: f32) -> f32 {
    a
}

impl<B: Board> Meter for Counter<B> {
    fn call<C>(&mut self, region: Region<C>, context: &mut C, a: f32, b: f32) -> (u32, f32) {
        // SAFETY: a reference to a sized type is passed like a pointer, and the function receives the reference that it expects.
        let erased = unsafe { core::mem::transmute::<Region<C>, Erased>(region) };
        let (ticks, result) = timed(black_box(erased), (&raw mut *context).cast(), a, b);
        let per_instruction = B::SYSTICK * 128;
        let instructions = (ticks * 125 + per_instruction / 2) / per_instruction;
        (instructions - self.overhead, result)
    }

    fn report(&mut self, name: impl fmt::Display, when: &str, tally: &Tally) {
        let Tally {
            calls,
            sum,
            least,
            most,
            checksum,
        } = tally;
        let _ = writeln!(
            self.output,
            "{name} {when} {calls} {sum} {least} {most} {checksum:08x}"
        );
    }
}

/// Ticks of the timer during one call. One function serves all regions, so that all have the same overhead.
#[inline(never)]
fn timed(region: Erased, context: *mut (), a: f32, b: f32) -> (u32, f32) {
    let start = SYST::get_current();
    let result = region(context, a, b);
    let end = SYST::get_current();
    (start.wrapping_sub(end) % PERIOD, result)
}
