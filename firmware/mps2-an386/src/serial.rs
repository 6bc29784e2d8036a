//! The rig controller on an MPS2+ whose link is its serial port.
#![no_std]
#![no_main]

use mesh_damper_firmware::Board;
use mesh_damper_firmware::emulated::{Serial, SimulatedConverters, StandardError, exit, reset};

/// Arm MPS2+ with a Cortex-M4F.
struct SerialMps2An386;

impl Board for SerialMps2An386 {
    const SYSTICK: u32 = 25;
    type Link = Serial;
    type Log = StandardError;
    type Converters = SimulatedConverters;

    fn exit(success: bool) -> ! {
        exit(success)
    }

    fn reset() -> ! {
        reset()
    }
}

mesh_damper_firmware::rig_image!(SerialMps2An386);
