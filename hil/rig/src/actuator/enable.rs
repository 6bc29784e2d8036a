//! The line that connects the valve to the servo amplifier.

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::digital::{ErrorType, OutputPin};

/// The crate's end of the line.
#[derive(Debug)]
pub struct SimulatedEnable(Rc<Cell<bool>>);

/// A line at low level: the crate's end, and the level for the actuator's.
pub fn enable_line() -> (SimulatedEnable, Rc<Cell<bool>>) {
    let level = Rc::new(Cell::new(false));
    (SimulatedEnable(level.clone()), level)
}

impl ErrorType for SimulatedEnable {
    type Error = Infallible;
}

impl OutputPin for SimulatedEnable {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set(false);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set(true);
        Ok(())
    }
}
