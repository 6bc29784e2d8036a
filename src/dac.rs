//! The actuator's command through an Analog Devices AD5761R: 16 bits, ±10 V, with its own 2.5 V reference.
//!
//! Datasheet: Analog Devices AD5761R/AD5721R, "Multiple range, 16-/12-bit, bipolar/unipolar voltage output DACs with
//! 2 ppm/°C reference". SPI mode 1 (data is clocked in on the falling edge of SCLK), at most 50 MHz, 24-bit frames,
//! most significant bit and byte first: four bits without meaning, four of command, 16 of data. What a read command
//! asks for comes out in the frame after it. Of the control register that comes back, bit 12 says that a short circuit was
//! detected and bit 11 a brown-out, since it was written last.
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
const READ_OUTPUT: u8 = 0xB;
const READ_CONTROL: u8 = 0xC;
const FULL_RESET: u8 = 0xF;

/// Clears to midscale (bits 10–9 = 01), shuts down when overheated (bit 6), internal reference (bit 5), powers up at
/// midscale (bits 4–3 = 01), ±10 V (bits 2–0 = 000); no overrange, offset binary. Neither a reset nor a line that is held or
/// echoes leaves it there.
pub const CONTROL: u16 = 0x0200 | 0x0040 | 0x0020 | 0x0008;
const CONTROL_BITS: u16 = 0x07FF;
/// The part's own status: short circuit (bit 12) and brown-out (bit 11). The bits above have no meaning.
const STATUS_BITS: u16 = 0x1800;

/// Why the part did not answer as it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DacError<E> {
    /// The bus failed.
    Bus(E),
    /// The control register did not hold what was written, [`CONTROL`]: no part, another one, one that lost its supply since, or
    /// a line that is held.
    Control {
        /// What came back, without the status bits.
        read: u16,
    },
    /// The part says that its output was shorted or its supply too low since it was set up.
    Status {
        /// Bit 12: short circuit; bit 11: brown-out.
        read: u16,
    },
    /// The register of the output did not hold the code that was written last.
    Output {
        /// What was written.
        expected: u16,
        /// What came back.
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
            Self::Status { read } => write!(
                f,
                "the DAC reports {read:#06x}, a short circuit (0x1000) or a brown-out (0x0800): check its output and its supply, \
                 then set it up again"
            ),
            Self::Output { expected, read } => write!(
                f,
                "the output register of the DAC reads {read:#06x} after {expected:#06x} was written: did it lose its supply?"
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
    /// The code that the part took last.
    code: u16,
}

/// What sets the part, in this order, before the frame that brings the control register.
const SET_UP: [[u8; 3]; 3] = [
    frame(FULL_RESET, 0),
    frame(WRITE_CONTROL, CONTROL),
    frame(READ_CONTROL, 0),
];

/// The 16 bits that came in a frame.
fn data_of([_, high, low]: [u8; 3]) -> u16 {
    u16::from_be_bytes([high, low])
}

/// Whether the control register is as it was written, by the frame after the one that asks for it.
fn held<E>(answer: [u8; 3]) -> Result<(), DacError<E>> {
    let read = data_of(answer) & CONTROL_BITS;
    if read == CONTROL {
        Ok(())
    } else {
        Err(DacError::Control { read })
    }
}

/// Whether neither a short circuit nor a brown-out was detected, by the same frame.
fn sound<E>(answer: [u8; 3]) -> Result<(), DacError<E>> {
    match data_of(answer) & STATUS_BITS {
        0 => Ok(()),
        read => Err(DacError::Status { read }),
    }
}

/// Whether the output's register holds `expected`, by the frame after the one that asks for it.
fn drives<E>(expected: u16, answer: [u8; 3]) -> Result<(), DacError<E>> {
    match data_of(answer) {
        read if read == expected => Ok(()),
        read => Err(DacError::Output { expected, read }),
    }
}

impl<S> Ad5761<S> {
    /// A part that is yet to be set up, and will be at the command's 0.
    fn unset(spi: S, scale: Scale) -> Self {
        let code = scale.encode(0.0).code;
        Self { spi, scale, code }
    }

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
    /// Resets the part, sets its range and leaves the output at the command's 0, which is 0 V where the scale's zero is 0. The
    /// output is at 0 V on the way there.
    ///
    /// * `scale`: the command at +10 V: mm, or kN for a damper emulator
    ///
    /// # Errors
    /// The bus's, or [`DacError::Control`].
    pub fn new(spi: S, scale: Scale) -> Result<Self, DacError<S::Error>> {
        let mut part = Self::unset(spi, scale);
        part.set_up()?;
        Ok(part)
    }

    fn set_up(&mut self) -> Result<(), DacError<S::Error>> {
        for each in &SET_UP {
            self.spi.write(each)?;
        }
        held(self.transfer(NO_OPERATION)?)?;
        self.write(0.0)?;
        Ok(())
    }

    /// Sets the part up again as [`Ad5761::new`] does, where it does not hold what it should: after it lost its supply. A part
    /// that does is left as it is, so that its output does not pass through 0 V.
    ///
    /// # Errors
    /// The bus's, or [`DacError::Control`].
    pub fn restore(&mut self) -> Result<(), DacError<S::Error>> {
        match self.verify() {
            Ok(()) => Ok(()),
            Err(_) => self.set_up(),
        }
    }

    /// Reads back what the part holds, without a change of its output: three frames, 72 clocks. A part that lost its supply holds
    /// neither its control register nor the code.
    ///
    /// # Errors
    /// The bus's, [`DacError::Control`], [`DacError::Status`] or [`DacError::Output`].
    pub fn verify(&mut self) -> Result<(), DacError<S::Error>> {
        self.spi.write(&frame(READ_CONTROL, 0))?;
        let control = self.transfer(READ_OUTPUT)?;
        let output = self.transfer(NO_OPERATION)?;
        held(control)?;
        sound(control)?;
        drives(self.code, output)
    }

    /// A frame with a command without data, and what comes out in it.
    fn transfer(&mut self, command: u8) -> Result<[u8; 3], S::Error> {
        let mut frame = frame(command, 0);
        self.spi.transfer_in_place(&mut frame)?;
        Ok(frame)
    }

    /// Drives the output: one frame, 24 clocks. Returns the code written and whether it was clipped.
    ///
    /// # Errors
    /// The bus's.
    #[inline]
    pub fn write(&mut self, value: f32) -> Result<Code, S::Error> {
        let code = self.scale.encode(value);
        self.spi.write(&frame(WRITE_AND_UPDATE, code.code))?;
        self.code = code.code;
        Ok(code)
    }
}

#[inline(always)]
const fn frame(command: u8, data: u16) -> [u8; 3] {
    let [high, low] = data.to_be_bytes();
    [command, high, low]
}
