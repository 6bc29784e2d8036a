//! One-bit lines: the one that connects the valve to the servo amplifier, and those that supervise it.

use std::cell::Cell;
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};

/// The crate's end of a line that it sets.
#[derive(Debug)]
pub struct SimulatedEnable {
    level: Rc<Cell<bool>>,
    stuck: Rc<Cell<bool>>,
}

/// A line at low level: the crate's end, and the level for the actuator's end.
pub fn enable_line() -> (SimulatedEnable, Rc<Cell<bool>>) {
    let level = Rc::new(Cell::new(false));
    let line = SimulatedEnable {
        level: level.clone(),
        stuck: Rc::default(),
    };
    (line, level)
}

impl SimulatedEnable {
    /// While this is set, the line silently keeps its level.
    pub fn stuck(&self) -> Rc<Cell<bool>> {
        self.stuck.clone()
    }

    fn set(&self, high: bool) {
        if !self.stuck.get() {
            self.level.set(high);
        }
    }
}

impl ErrorType for SimulatedEnable {
    type Error = Infallible;
}

impl OutputPin for SimulatedEnable {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.set(false);
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.set(true);
        Ok(())
    }
}

/// The crate's end of a line that it reads, high where the cell is set.
#[derive(Debug)]
pub struct SimulatedInput(pub Rc<Cell<bool>>);

impl ErrorType for SimulatedInput {
    type Error = Infallible;
}

impl InputPin for SimulatedInput {
    #[inline]
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0.get())
    }
    #[inline]
    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.get())
    }
}
