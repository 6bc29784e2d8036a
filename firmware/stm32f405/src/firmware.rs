//! The rig controller on an STM32F405.
#![no_std]
#![no_main]

mod board;

mesh_damper_firmware::rig_image!(board::Stm32f405);
