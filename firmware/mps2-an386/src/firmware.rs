//! The rig controller on an MPS2+.
#![no_std]
#![no_main]

mod board;

mesh_damper_firmware::rig_image!(board::Mps2An386);
