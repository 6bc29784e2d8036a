//! The rig controller on an MPS2+ whose link is memory that the harness sees too.
#![no_std]
#![no_main]

mod board;

use mesh_damper_firmware::emulated::SharedMemory;

mesh_damper_firmware::rig_image!(board::Mps2An386<SharedMemory>);
