//! The board of QEMU's mps2-an386 and mps2-an500.

use mesh_damper_firmware::Board;
use mesh_damper_firmware::emulated::{Pipes, SimulatedConverters, StandardError, exit};

/// Arm MPS2+ with a Cortex-M4F or a Cortex-M7.
pub struct Mps2An386;

impl Board for Mps2An386 {
    const SYSTICK: u32 = 25;
    type Link = Pipes;
    type Log = StandardError;
    type Converters = SimulatedConverters;

    fn exit(success: bool) -> ! {
        exit(success)
    }
}
