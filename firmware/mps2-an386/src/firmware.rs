//! The rig controller on an MPS2+, linked to the harness through shared memory.
#![no_std]
#![no_main]

mod board;

use mesh_damper_firmware::emulated::SharedMemory;

mesh_damper_firmware::rig_image!(board::Mps2An386<SharedMemory>);
