//! The rig controller on an MPS2+'s own timer, at its serial port, with a specimen simulated outside the emulator.
#![no_std]
#![no_main]

mod board;

use mesh_damper_firmware::PortLink;
use mesh_damper_firmware::emulated::{BesideConverters, Uart};

mesh_damper_firmware::own_timer_image!(board::Mps2An386<PortLink<Uart>, BesideConverters>);
