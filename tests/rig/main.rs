//! The rig's controllers, their sensors and actuators, and a simulation of a programme without a rig.

mod adc_dac;
#[cfg(feature = "async")]
mod asynchronous;
mod attacks;
mod attacks_on_emulation;
mod causes;
mod closed_loop;
mod control_inputs;
mod controller;
mod disturbed;
mod emulator;
mod observer;
mod on_chip;
mod scale;
mod simulation;
mod start;
mod stream;
#[cfg(feature = "async")]
mod supervision;
mod support;
