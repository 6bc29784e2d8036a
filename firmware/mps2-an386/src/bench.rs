//! Counts instructions on an MPS2+'s Cortex-M4F.
#![no_std]
#![no_main]

mod board;

mesh_damper_firmware::bench_image!(board::Mps2An386);
