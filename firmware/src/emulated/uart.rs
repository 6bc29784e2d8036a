//! The serial port of Arm's MPS2: the APB UART of the Cortex-M System Design Kit.

use super::register::{read, write};
use crate::board::Port;

/// UART 0, from the MPS2's memory map.
const BASE: usize = 0x4000_4000;
const DATA: usize = BASE;
const STATE: usize = BASE + 0x4;
const CONTROL: usize = BASE + 0x8;
const DIVIDER: usize = BASE + 0x10;
/// Bits of the state, and of the control register, which enables both directions.
const TRANSMIT_FULL: u32 = 1;
const RECEIVE_FULL: u32 = 2;
const BOTH: u32 = 3;
/// 25 MHz over 115 200 baud. The emulator takes any above 15.
const DIVISION: u32 = 217;

/// The port.
pub struct Uart(());

impl Port for Uart {
    fn open() -> Self {
        write(DIVIDER, DIVISION);
        write(CONTROL, BOTH);
        // The emulator offers a byte only after a read of this register has reported room.
        read(DATA);
        Self(())
    }

    fn take(&mut self) -> Option<u8> {
        (read(STATE) & RECEIVE_FULL != 0).then(|| read(DATA) as u8)
    }

    fn put(&mut self, byte: u8) -> bool {
        let room = read(STATE) & TRANSMIT_FULL == 0;
        if room {
            write(DATA, byte.into());
        }
        room
    }
}
