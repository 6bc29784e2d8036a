//! The board of QEMU's mps2-an386 and mps2-an500.

use core::marker::PhantomData;

use mesh_damper_firmware::emulated::{Pipes, SimulatedConverters, StandardError, exit, reset};
use mesh_damper_firmware::{Board, Link};

/// Arm MPS2+ with a Cortex-M4F or a Cortex-M7, over the link `L`.
pub struct Mps2An386<L = Pipes>(PhantomData<L>);

impl<L: Link + 'static> Board for Mps2An386<L> {
    const SYSTICK: u32 = 25;
    type Link = L;
    type Log = StandardError;
    type Converters = SimulatedConverters;

    fn exit(success: bool) -> ! {
        exit(success)
    }

    fn reset() -> ! {
        reset()
    }
}
