//! The board of QEMU's microbit.

use mesh_damper_firmware::Board;
use mesh_damper_firmware::emulated::{Pipes, SimulatedConverters, StandardError, exit};

/// BBC micro:bit with an nRF51822, a Cortex-M0.
pub struct Microbit;

impl Board for Microbit {
    const SYSTICK: u32 = 16;
    type Link = Pipes;
    type Log = StandardError;
    type Converters = SimulatedConverters;

    fn exit(success: bool) -> ! {
        exit(success)
    }
}
