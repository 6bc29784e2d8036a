//! The size of one_effect_pack, on an MPS2+.
#![no_std]
#![no_main]

mod board;

mesh_damper_firmware::size_image!(board::Mps2An386, one_effect_pack);
