//! Link over the serial port of Arm's MPS2: the APB UART of the Cortex-M System Design Kit, asked byte by byte.

use core::ptr::{read_volatile, write_volatile};

use mesh_damper::frame::{Extent, extent};

use crate::board::Link;

/// UART 0, as the MPS2's memory map has it.
const BASE: usize = 0x4000_4000;
const DATA: *mut u32 = BASE as *mut u32;
const STATE: *mut u32 = (BASE + 0x4) as *mut u32;
const CONTROL: *mut u32 = (BASE + 0x8) as *mut u32;
const DIVIDER: *mut u32 = (BASE + 0x10) as *mut u32;
/// Bits of the state, and of the control register, which enables both ways.
const TRANSMIT_FULL: u32 = 1;
const RECEIVE_FULL: u32 = 2;
const BOTH: u32 = 3;
/// 25 MHz over 115 200 baud. The emulator takes any above 15.
const DIVISION: u32 = 217;
/// Times that the port is asked before a line counts as idle: longer than any gap between two bytes of a frame.
const IDLE: u32 = 2_000_000;

/// The port.
pub struct Serial(());

fn read(register: *mut u32) -> u32 {
    // SAFETY: a register of the board that is always there, and that nobody else uses.
    unsafe { read_volatile(register) }
}

fn write(register: *mut u32, value: u32) {
    // SAFETY: as above.
    unsafe { write_volatile(register, value) }
}

/// Drops the first `junk` of `came` bytes; how many are left.
fn drop_first(buffer: &mut [u8], came: usize, junk: usize) -> usize {
    let left = came.saturating_sub(junk);
    for at in 0..left {
        let next = buffer.get(at + junk).copied().unwrap_or_default();
        if let Some(place) = buffer.get_mut(at) {
            *place = next;
        }
    }
    left
}

impl Link for Serial {
    fn open() -> Self {
        write(DIVIDER, DIVISION);
        write(CONTROL, BOTH);
        // The emulator offers a byte only after a read of this register has said that there is room.
        read(DATA);
        Self(())
    }

    /// A frame; or what came before the line was idle, which is none.
    fn receive<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        let mut came = 0;
        let mut waited = 0;
        loop {
            if read(STATE) & RECEIVE_FULL == 0 {
                waited += u32::from(came > 0);
                if waited > IDLE {
                    break;
                }
                continue;
            }
            waited = 0;
            if let Some(place) = buffer.get_mut(came) {
                *place = read(DATA) as u8;
                came += 1;
            }
            match extent(buffer.get(..came).unwrap_or_default()) {
                Extent::More => {}
                Extent::Frame(_) => break,
                Extent::Junk(junk) => came = drop_first(buffer, came, junk),
            }
        }
        buffer.get(..came).unwrap_or_default()
    }

    fn send(&mut self, bytes: &[u8]) {
        for byte in bytes {
            while read(STATE) & TRANSMIT_FULL != 0 {}
            write(DATA, (*byte).into());
        }
    }
}
