//! Converters and an enable line that answer as in their datasheets, and fail on request.

use std::cell::Cell;
use std::rc::Rc;

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::spi::{self, ErrorKind, Operation, SpiDevice};

/// The state of a rig's wires.
#[derive(Debug, Default)]
pub struct Wires {
    /// Codes of the ADC's channels.
    pub channels: [Cell<u16>; 2],
    /// Code of the DAC.
    pub driven: Cell<u16>,
    /// Level of the enable line.
    pub enabled: Cell<bool>,
    pub adc_fails: Cell<bool>,
    pub dac_fails: Cell<bool>,
    pub line_fails: Cell<bool>,
}

fn answer(failing: bool) -> Result<(), ErrorKind> {
    if failing {
        Err(ErrorKind::Other)
    } else {
        Ok(())
    }
}

/// An ADS8688.
#[derive(Debug)]
pub struct Adc {
    pub wires: Rc<Wires>,
    /// The channel that the next frame converts.
    pub selected: usize,
    pub registers: [u8; 128],
}

impl spi::ErrorType for Adc {
    type Error = ErrorKind;
}

impl SpiDevice for Adc {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        answer(self.wires.adc_fails.get())?;
        match operations {
            [Operation::TransferInPlace([command, _, high, low])] => {
                [*high, *low] = self.wires.channels[self.selected].get().to_be_bytes();
                self.selected = usize::from(*command >> 2 & 1);
            }
            [Operation::Write([address, value, _])] if address & 1 != 0 => {
                self.registers[usize::from(address >> 1)] = *value;
            }
            [Operation::TransferInPlace([address, _, value])] => {
                *value = self.registers[usize::from(*address >> 1)];
            }
            _ => {}
        }
        Ok(())
    }
}

/// An AD5761R.
#[derive(Debug)]
pub struct Dac {
    pub wires: Rc<Wires>,
    pub control: u16,
    /// The answer that the next frame clocks out.
    pub answer: u16,
}

impl spi::ErrorType for Dac {
    type Error = ErrorKind;
}

impl SpiDevice for Dac {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        answer(self.wires.dac_fails.get())?;
        match operations {
            [Operation::Write([0x3, high, low])] => {
                self.wires.driven.set(u16::from_be_bytes([*high, *low]));
            }
            [Operation::Write([0x4, high, low])] => {
                self.control = u16::from_be_bytes([*high, *low]);
            }
            [Operation::Write([0xC, ..])] => self.answer = self.control,
            [Operation::TransferInPlace([command, high, low])] => {
                [*high, *low] = self.answer.to_be_bytes();
                if *command == 0xB {
                    self.answer = self.wires.driven.get();
                }
            }
            _ => {}
        }
        Ok(())
    }
}

/// The line that enables the actuator.
#[derive(Debug)]
pub struct Line(pub Rc<Wires>);

impl Line {
    fn set(&self, high: bool) -> Result<(), ErrorKind> {
        answer(self.0.line_fails.get())?;
        self.0.enabled.set(high);
        Ok(())
    }
}

impl digital::ErrorType for Line {
    type Error = LineError;
}

/// The line could not be set.
#[derive(Debug)]
pub struct LineError;

impl digital::Error for LineError {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

impl OutputPin for Line {
    fn set_low(&mut self) -> Result<(), LineError> {
        self.set(false).map_err(|_| LineError)
    }
    fn set_high(&mut self) -> Result<(), LineError> {
        self.set(true).map_err(|_| LineError)
    }
}
