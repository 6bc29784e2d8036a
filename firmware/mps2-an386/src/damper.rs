//! The size of damper, on an MPS2+.
#![no_std]
#![no_main]

mod board;

mesh_damper_firmware::size_image!(board::Mps2An386, damper);
