//! The ADS8688 as its datasheet (TI SBAS582) describes it on the bus: conversion frames, register frames, ranges.

use std::cell::Cell;
use std::rc::Rc;

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};

const CHANNELS: usize = 8;
const REFERENCE: f64 = 4.096;

/// The part's analogue side, shared with whatever drives it.
#[derive(Debug, Default)]
pub struct AdcPins {
    /// Input voltages, V.
    pub volts: [Cell<f64>; CHANNELS],
    /// While set, every transaction fails as an overrun.
    pub bus_failing: Cell<bool>,
}

/// The part's digital side.
#[derive(Debug)]
pub struct SimulatedAds8688 {
    pins: Rc<AdcPins>,
    registers: [u8; 64],
    /// The channel that the next conversion frame converts; none after a reset.
    selected: Option<usize>,
}

const RANGE_REGISTER: usize = 0x05;

impl SimulatedAds8688 {
    /// As after power-up.
    pub fn new(pins: Rc<AdcPins>) -> Self {
        Self {
            pins,
            registers: [0; 64],
            selected: None,
        }
    }

    /// The code of `channel` as its range register says: offset binary over the range, saturated.
    fn convert(&self, channel: usize) -> u16 {
        let (low, span) = match self.registers[RANGE_REGISTER + channel] & 0x7 {
            0 => (-2.5, 5.0),
            1 => (-1.25, 2.5),
            2 => (-0.625, 1.25),
            5 => (0.0, 2.5),
            _ => (0.0, 1.25),
        };
        let part = (self.pins.volts[channel].get() / REFERENCE - low) / span;
        // The cast saturates.
        (part * 65536.0).round() as u16
    }

    /// What comes out while `sent` goes in, chip select low from first byte to last.
    fn frame(&mut self, sent: &[u8], received: &mut [u8]) {
        received.fill(0);
        let &[first, second, ..] = sent else { return };
        let result = self.selected.map_or(0, |channel| self.convert(channel));
        if first & 0x80 != 0 || first == 0 {
            for (out, byte) in received.iter_mut().skip(2).zip(result.to_be_bytes()) {
                *out = byte;
            }
            match first {
                0x85 => {
                    self.registers.fill(0);
                    self.selected = None;
                }
                0xC0..=0xDC if first & 0x3 == 0 => {
                    self.selected = Some(usize::from(first >> 2 & 0x7));
                }
                _ => {}
            }
        } else {
            let register = &mut self.registers[usize::from(first >> 1 & 0x3F)];
            if first & 1 != 0 {
                *register = second;
            }
            if let Some(out) = received.get_mut(2) {
                *out = *register;
            }
        }
    }
}

impl ErrorType for SimulatedAds8688 {
    type Error = ErrorKind;
}

impl SpiDevice for SimulatedAds8688 {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        if self.pins.bus_failing.get() {
            return Err(ErrorKind::Overrun);
        }
        one_frame(operations, |sent, received| self.frame(sent, received))
    }
}

/// Largest frame of either part, bytes.
const FRAME: usize = 4;

/// Runs a transaction of one operation as one frame. More than one operation, or a longer frame, is not what these
/// parts' drivers do: [`ErrorKind::Other`].
pub(super) fn one_frame(
    operations: &mut [Operation<'_, u8>],
    frame: impl FnOnce(&[u8], &mut [u8]),
) -> Result<(), ErrorKind> {
    let mut received = [0; FRAME];
    match operations {
        [Operation::Write(words)] if words.len() <= FRAME => {
            frame(words, &mut received[..words.len()]);
        }
        [Operation::TransferInPlace(words)] if words.len() <= FRAME => {
            let received = &mut received[..words.len()];
            frame(words, received);
            words.copy_from_slice(received);
        }
        _ => return Err(ErrorKind::Other),
    }
    Ok(())
}
