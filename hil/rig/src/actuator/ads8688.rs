//! The ADS8688 on the bus as its datasheet (TI SBAS582) describes it: conversion frames, register frames, ranges.

use std::cell::Cell;
use std::rc::Rc;

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};

const CHANNELS: usize = 8;
const REFERENCE: f64 = 4.096;

/// The part's analogue side, shared with the parts that drive it.
#[derive(Debug, Default)]
pub struct AdcPins {
    /// Input voltages, V.
    pub volts: [Cell<f64>; CHANNELS],
    /// While set, every transaction fails as an overrun.
    pub bus_failing: Cell<bool>,
    /// While set, the part has no supply: it answers with a low data line, and from its next frame on has lost its registers.
    pub unpowered: Cell<bool>,
}

/// The part's digital side.
#[derive(Debug)]
pub struct SimulatedAds8688 {
    pins: Rc<AdcPins>,
    registers: [u8; 64],
    /// The channel that the next conversion frame converts; `None` after a reset.
    selected: Option<usize>,
}

/// ±2.5 times the reference: codes per reference, and the code of 0 V.
const BIPOLAR: (f64, f64) = (65536.0 / 5.0, 32768.0);
const RANGE_REGISTER: usize = 0x05;

/// The code of `volts`, with `gain` codes per reference and the code `zero` for 0 V.
fn code(volts: f64, gain: f64, zero: f64) -> u16 {
    let code = volts * (1.0 / REFERENCE) * gain + zero;
    // To the nearest; the cast truncates and saturates.
    (code + 0.5) as u16
}

/// The code of `volts` in the range that the crate's driver sets.
pub fn adc_code(volts: f64) -> u16 {
    let (gain, zero) = BIPOLAR;
    code(volts, gain, zero)
}

impl SimulatedAds8688 {
    /// State after power-up.
    pub fn new(pins: Rc<AdcPins>) -> Self {
        Self {
            pins,
            registers: [0; 64],
            selected: None,
        }
    }

    /// The code of `channel` in its register's range: offset binary over the range, saturated.
    #[inline]
    fn convert(&self, channel: usize) -> u16 {
        let (gain, zero) = match self.registers[RANGE_REGISTER + channel] & 0x7 {
            0 => BIPOLAR,
            1 => (65536.0 / 2.5, 32768.0),
            2 => (65536.0 / 1.25, 32768.0),
            5 => (65536.0 / 2.5, 0.0),
            _ => (65536.0 / 1.25, 0.0),
        };
        code(self.pins.volts[channel].get(), gain, zero)
    }

    fn reset(&mut self) {
        self.registers.fill(0);
        self.selected = None;
    }

    /// The bytes that come out while `sent` goes in, `length` bytes between the edges of chip select.
    #[inline]
    fn frame(&mut self, sent: Words, length: usize) -> Words {
        let [first, second, ..] = sent;
        if self.pins.unpowered.get() {
            self.reset();
            return [0; FRAME];
        }
        if length < 2 {
            return [0; FRAME];
        }
        let result = self.selected.map_or(0, |channel| self.convert(channel));
        if first & 0x80 != 0 || first == 0 {
            match first {
                0x85 => self.reset(),
                0xC0..=0xDC if first & 0x3 == 0 => {
                    self.selected = Some(usize::from(first >> 2 & 0x7));
                }
                _ => {}
            }
            let [high, low] = result.to_be_bytes();
            [0, 0, high, low]
        } else {
            let register = &mut self.registers[usize::from(first >> 1 & 0x3F)];
            if first & 1 != 0 {
                *register = second;
            }
            [0, 0, *register, 0]
        }
    }
}

impl ErrorType for SimulatedAds8688 {
    type Error = ErrorKind;
}

impl SpiDevice for SimulatedAds8688 {
    #[inline]
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        if self.pins.bus_failing.get() {
            return Err(ErrorKind::Overrun);
        }
        one_frame(operations, |sent, length| self.frame(sent, length))
    }
}

/// Largest frame of either part, bytes.
const FRAME: usize = 4;

/// A frame of any length, followed by zeros.
pub(super) type Words = [u8; FRAME];

/// Runs a transaction of one operation as one frame. These parts' drivers use neither several operations nor a longer frame:
/// [`ErrorKind::Other`].
#[inline]
pub(super) fn one_frame(
    operations: &mut [Operation<'_, u8>],
    frame: impl FnOnce(Words, usize) -> Words,
) -> Result<(), ErrorKind> {
    match operations {
        [Operation::Write(words)] if words.len() <= FRAME => {
            frame(padded(words), words.len());
        }
        [Operation::TransferInPlace(words)] if words.len() <= FRAME => {
            let received = frame(padded(words), words.len());
            words.copy_from_slice(&received[..words.len()]);
        }
        _ => return Err(ErrorKind::Other),
    }
    Ok(())
}

#[inline]
fn padded(words: &[u8]) -> Words {
    let mut all = [0; FRAME];
    all[..words.len()].copy_from_slice(words);
    all
}
