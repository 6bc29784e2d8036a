//! The rig controller on an {{mcu | upcase}}, on its own timer: README.md says how to wire it and run the first test.
//!
//! | file | what it is |
//! |---|---|
//! | `board.rs` | clocks and pins: begin here to change one |
//! | `converters.rs` | ADS8688, AD5761R and the pins that supervise the rig |
//! | `port.rs` | the serial port to the harness |
//! | `log.rs` | the log, which the debug probe reads |
//! | `handed.rs` | how a part gets from one to the other |
#![no_std]
#![no_main]

mod board;
mod converters;
mod handed;
mod log;
mod port;

mesh_damper_firmware::own_timer_image!(board::OwnBoard);
