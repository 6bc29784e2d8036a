//! The rig controller on an MPS2+, linked through its serial port.
#![no_std]
#![no_main]

mod board;

use mesh_damper_firmware::PortLink;
use mesh_damper_firmware::emulated::Uart;

mesh_damper_firmware::rig_image!(board::Mps2An386<PortLink<Uart>>);
