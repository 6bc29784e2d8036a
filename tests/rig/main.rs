//! The rig's controllers, their sensors and actuators, and what a programme is without a rig.

mod adc_dac;
#[cfg(feature = "async")]
mod asynchronous;
mod attacks;
mod closed_loop;
mod controller;
mod disturbed;
mod emulator;
mod observer;
mod simulation;
mod stream;
