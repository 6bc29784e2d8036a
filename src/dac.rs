//! The actuator's command through an Analog Devices AD5761R: 16 bits, ±10 V, with its own 2.5 V reference.
//!
//! Datasheet: Analog Devices AD5761R/AD5721R, "Multiple range, 16-/12-bit, bipolar/unipolar voltage output DACs with
//! 2 ppm/°C reference". SPI mode 1 (data is clocked in on the falling edge of SCLK), at most 50 MHz, 24-bit frames,
//! most significant bit and byte first: four bits without meaning, four of command, 16 of data. What a read command
//! asks for comes out in the frame after it.
//!
//! The output register is offset binary, as the control register's B2C bit stays 0: 0x0000 is −10 V, 0x8000 is 0 V,
//! 0xFFFF is one step below +10 V. The output changes where chip select rises (LDAC tied low).

#[cfg(feature = "async")]
mod asynchronous;

use core::fmt;

use embedded_hal::spi::{Mode, SpiDevice};

use crate::converter::{Code, Scale};

/// What the bus must be set to.
pub const SPI_MODE: Mode = embedded_hal::spi::MODE_1;

/// Output at full scale, V.
pub const OUTPUT_RANGE: f64 = 10.0;

const NO_OPERATION: u8 = 0x0;
const WRITE_AND_UPDATE: u8 = 0x3;
const WRITE_CONTROL: u8 = 0x4;
const READ_CONTROL: u8 = 0xC;
const FULL_RESET: u8 = 0xF;

/// Clears to midscale (bits 10–9 = 01), shuts down when overheated (bit 6), internal reference (bit 5), powers up at
/// midscale (bits 4–3 = 01), ±10 V (bits 2–0 = 000); no overrange, offset binary. Neither a reset nor a line that is held or
/// echoes leaves it there.
pub const CONTROL: u16 = 0x0200 | 0x0040 | 0x0020 | 0x0008;
/// The bits above are the part's own status: short circuit and brown-out.
const CONTROL_BITS: u16 = 0x07FF;

/// Why the part did not answer as it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DacError<E> {
    /// The bus failed.
    Bus(E),
    /// The control register did not hold what was written, [`CONTROL`]: no part, another one, or a line that is held.
    Control {
        /// What came back, without the status bits.
        read: u16,
    },
}

impl<E: fmt::Debug> fmt::Display for DacError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "the DAC's bus failed: {error:?}"),
            Self::Control { read } => write!(
                f,
                "the control register of the DAC reads {read:#06x} after {CONTROL:#06x} was written: is it an AD5761R, \
                 powered, on this chip select, and its data line connected?"
            ),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for DacError<E> {}

impl<E> From<E> for DacError<E> {
    fn from(error: E) -> Self {
        Self::Bus(error)
    }
}

/// The part on its bus.
#[derive(Debug)]
pub struct Ad5761<S> {
    spi: S,
    scale: Scale,
}

/// What sets the part, in this order, before the frame that brings the control register.
const SET_UP: [[u8; 3]; 3] = [
    frame(FULL_RESET, 0),
    frame(WRITE_CONTROL, CONTROL),
    frame(READ_CONTROL, 0),
];

/// Whether the control register is as it was written, by the frame after the one that asks for it.
fn held<E>([_, high, low]: [u8; 3]) -> Result<(), DacError<E>> {
    let read = u16::from_be_bytes([high, low]) & CONTROL_BITS;
    if read == CONTROL {
        Ok(())
    } else {
        Err(DacError::Control { read })
    }
}

impl<S> Ad5761<S> {
    /// The command at +10 V and its step.
    pub fn scale(&self) -> &Scale {
        &self.scale
    }

    /// The bus, when the part is no longer used.
    pub fn release(self) -> S {
        self.spi
    }
}

impl<S: SpiDevice> Ad5761<S> {
    /// Resets the part, sets its range and leaves the output at 0 V.
    ///
    /// * `scale`: the command at +10 V: mm, or kN for a damper emulator
    ///
    /// # Errors
    /// The bus's, or [`DacError::Control`].
    pub fn new(mut spi: S, scale: Scale) -> Result<Self, DacError<S::Error>> {
        for each in &SET_UP {
            spi.write(each)?;
        }
        let mut answer = frame(NO_OPERATION, 0);
        spi.transfer_in_place(&mut answer)?;
        held(answer)?;
        spi.write(&frame(WRITE_AND_UPDATE, crate::converter::MIDSCALE))?;
        Ok(Self { spi, scale })
    }

    /// Drives the output: one frame, 24 clocks. Returns the code written and whether it was clipped.
    ///
    /// # Errors
    /// The bus's.
    #[inline]
    pub fn write(&mut self, value: f32) -> Result<Code, S::Error> {
        let code = self.scale.encode(value);
        self.spi.write(&frame(WRITE_AND_UPDATE, code.code))?;
        Ok(code)
    }
}

#[inline(always)]
const fn frame(command: u8, data: u16) -> [u8; 3] {
    let [high, low] = data.to_be_bytes();
    [command, high, low]
}
