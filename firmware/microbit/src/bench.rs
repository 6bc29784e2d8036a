//! Counts instructions on a micro:bit's Cortex-M0.
#![no_std]
#![no_main]

mod board;

mesh_damper_firmware::bench_image!(board::Microbit);
