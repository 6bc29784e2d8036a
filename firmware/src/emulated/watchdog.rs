//! The MPS2's watchdog: it restarts the board if no tick has done all of its work for too long.

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};

use super::register::write;

/// The APB watchdog of the Cortex-M System Design Kit.
const BASE: usize = 0x4000_8000;
const LOAD: usize = BASE;
const CONTROL: usize = BASE + 0x8;
const CLEAR: usize = BASE + 0xC;
const LOCK: usize = BASE + 0xC00;
/// Opens its registers.
const KEY: u32 = 0x1ACC_E551;
/// It interrupts, which counts as the restart here: the image restarts at an unexpected exception.
const ENABLED: u32 = 3;
/// 20 ms at 25 MHz: 200 ticks at 10 kHz. Within that time the actuator moves less than the limit of its speed permits for a
/// constant demand.
const PATIENCE: u32 = 500_000;

/// Its input, which has to toggle. It watches from the first edge on.
pub struct Watchdog {
    watching: bool,
}

impl Watchdog {
    /// Not watching yet.
    #[expect(clippy::new_without_default, reason = "one board has one")]
    pub fn new() -> Self {
        Self { watching: false }
    }

    fn edge(&mut self) {
        if !self.watching {
            write(LOCK, KEY);
            write(LOAD, PATIENCE);
            write(CONTROL, ENABLED);
            self.watching = true;
        }
        // Restarts the countdown.
        write(CLEAR, 1);
    }
}

impl ErrorType for Watchdog {
    type Error = Infallible;
}

impl OutputPin for Watchdog {
    #[inline]
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.edge();
        Ok(())
    }

    #[inline]
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.edge();
        Ok(())
    }
}
