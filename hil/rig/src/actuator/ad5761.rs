//! The AD5761R on the bus as its datasheet describes it: 24-bit frames, control register, readback in the next frame.

use std::cell::Cell;
use std::rc::Rc;

use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};

use super::ads8688::{Words, one_frame};

const REFERENCE: f64 = 2.5;

/// The part's analogue side, shared with the part that it drives.
#[derive(Debug, Default)]
pub struct DacPins {
    /// Output voltage, V.
    pub volts: Cell<f64>,
    /// While set, every transaction fails as an overrun.
    pub bus_failing: Cell<bool>,
    /// While set, the part has no supply: from its next frame on it drives 0 V, answers with a low data line, and has lost its
    /// registers.
    pub unpowered: Cell<bool>,
}

/// The part's digital side.
#[derive(Debug)]
pub struct SimulatedAd5761 {
    pins: Rc<DacPins>,
    control: Option<u16>,
    input: u16,
    output: u16,
    /// Answer in the next frame.
    answer: u16,
}

/// Gain and offset of ±10 V, in units of the reference.
const BIPOLAR: (f64, f64) = (8.0, 4.0);

fn volts(code: u16, gain: f64, offset: f64) -> f64 {
    REFERENCE * (gain * f64::from(code) / 65536.0 - offset)
}

/// The voltage of `code` in the range that the crate's driver sets.
pub fn dac_volts(code: u16) -> f64 {
    let (gain, offset) = BIPOLAR;
    volts(code, gain, offset)
}

impl SimulatedAd5761 {
    /// State after power-up: the output is clamped to ground until the control register is written.
    pub fn new(pins: Rc<DacPins>) -> Self {
        Self {
            pins,
            control: None,
            input: 0,
            output: 0,
            answer: 0,
        }
    }

    fn reset(&mut self) {
        self.control = None;
        self.input = 0;
        self.output = 0;
        self.answer = 0;
    }

    #[inline]
    fn drive(&self) {
        let Some(control) = self.control else {
            self.pins.volts.set(0.0);
            return;
        };
        // Gain and offset of the output ranges, in units of the reference.
        let (gain, offset) = match control & 0x7 {
            0 => BIPOLAR,
            1 => (4.0, 0.0),
            2 => (4.0, 2.0),
            3 => (2.0, 0.0),
            4 => (4.0, 1.0),
            5 => (2.4, 1.2),
            6 => (6.4, 0.0),
            _ => (8.0, 0.0),
        };
        let twos_complement = control & 0x80 != 0;
        let code = self.output ^ if twos_complement { 0x8000 } else { 0 };
        self.pins.volts.set(volts(code, gain, offset));
    }

    #[inline]
    fn frame(&mut self, sent: Words, length: usize) -> Words {
        let [command, high, low, _] = sent;
        if self.pins.unpowered.get() {
            self.reset();
            self.drive();
            return Words::default();
        }
        if length != 3 {
            return Words::default();
        }
        let [answer_high, answer_low] = std::mem::take(&mut self.answer).to_be_bytes();
        let data = u16::from_be_bytes([high, low]);
        match command & 0xF {
            0x1 => self.input = data,
            0x2 => self.output = self.input,
            0x3 => {
                self.input = data;
                self.output = data;
            }
            0x4 => {
                if self.control.is_none() {
                    self.output = match data >> 3 & 0x3 {
                        0 => 0x0000,
                        1 => 0x8000,
                        _ => 0xFFFF,
                    };
                }
                self.control = Some(data & 0x07FF);
            }
            0xB => self.answer = self.output,
            0xC => self.answer = self.control.unwrap_or(0),
            0xF => self.reset(),
            _ => {}
        }
        self.drive();
        [0, answer_high, answer_low, 0]
    }
}

impl ErrorType for SimulatedAd5761 {
    type Error = ErrorKind;
}

impl SpiDevice for SimulatedAd5761 {
    #[inline]
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        if self.pins.bus_failing.get() {
            return Err(ErrorKind::Overrun);
        }
        one_frame(operations, |sent, length| self.frame(sent, length))
    }
}
