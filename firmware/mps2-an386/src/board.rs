//! The board of QEMU's mps2-an386 and mps2-an500.

use core::marker::PhantomData;

use mesh_damper_firmware::emulated::{
    CLOCK, Pipes, SimulatedConverters, StandardError, Uart, clock, exit, idle, reset, start_clock,
};
use mesh_damper_firmware::{Board, Converters, Link, OwnTimer};

/// Arm MPS2+ with a Cortex-M4F or a Cortex-M7, over the link `L`, with the converters `C`.
pub struct Mps2An386<L = Pipes, C = SimulatedConverters>(PhantomData<(L, C)>);

impl<L: Link + 'static, C: Converters + 'static> Board for Mps2An386<L, C> {
    const SYSTICK: u32 = 25;
    type Link = L;
    type Log = StandardError;
    type Converters = C;

    fn exit(success: bool) -> ! {
        exit(success)
    }

    fn reset() -> ! {
        reset()
    }
}

impl<L: Link + 'static, C: Converters + 'static> OwnTimer for Mps2An386<L, C> {
    type Port = Uart;
    const CLOCK: u32 = CLOCK;

    fn start_clock() {
        start_clock();
    }

    fn clock() -> u32 {
        clock()
    }

    /// If the emulator's time follows the instructions, it jumps over every second interrupt of SysTick while the processor sleeps.
    fn wait() {
        idle();
    }
}
