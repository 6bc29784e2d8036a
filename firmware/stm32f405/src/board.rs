//! The board of QEMU's netduinoplus2.

use mesh_damper_firmware::Board;
use mesh_damper_firmware::emulated::{Pipes, SimulatedConverters, StandardError, exit};

/// A board with an STM32F405, a Cortex-M4F.
pub struct Stm32f405;

impl Board for Stm32f405 {
    const SYSTICK: u32 = 168;
    type Link = Pipes;
    type Log = StandardError;
    type Converters = SimulatedConverters;

    fn exit(success: bool) -> ! {
        exit(success)
    }
}
