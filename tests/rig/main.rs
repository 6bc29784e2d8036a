//! The rig's controllers, their sensors and actuators, and what a programme is without a rig.

mod adc_dac;
#[cfg(feature = "async")]
mod asynchronous;
mod attacks;
mod attacks_on_emulation;
mod closed_loop;
mod controller;
mod disturbed;
mod emulator;
mod observer;
mod simulation;
mod start;
mod stream;
#[cfg(feature = "async")]
mod supervision;

/// A timer that loses no tick, and counts them.
#[derive(Default)]
struct Ticks(u32);

impl Ticks {
    /// What its counter reads at the tick that comes.
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(1);
        self.0
    }
}
