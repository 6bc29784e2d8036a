//! The actuator's command through an Analog Devices AD5761R: 16 bits, ±10 V, with its own 2.5 V reference.
//!
//! Datasheet: Analog Devices AD5761R/AD5721R, "Multiple range, 16-/12-bit, bipolar/unipolar voltage output DACs with 2 ppm/°C
//! reference". SPI mode 1 (data is clocked in on the falling edge of SCLK), at most 50 MHz, 24-bit frames, most significant bit and
//! byte first: four bits without meaning, four of command, 16 of data. The answer to a read command comes out in the next frame. In
//! the control register read back, bit 12 reports a short circuit and bit 11 a brown-out since the register was last written.
//!
//! The output register is offset binary, because the control register's B2C bit stays 0: 0x0000 is −10 V, 0x8000 is 0 V, 0xFFFF is
//! one step below +10 V. The output changes where chip select rises (LDAC tied low).

use core::fmt;

use embedded_hal::spi::{Mode, SpiDevice};

use crate::converter::{Code, Scale};
#[cfg(feature = "async")]
use crate::forms::later;
use crate::forms::now;

/// SPI mode that the bus must use.
pub const SPI_MODE: Mode = embedded_hal::spi::MODE_1;

/// Output at full scale, V.
pub const OUTPUT_RANGE: f64 = 10.0;

const NO_OPERATION: u8 = 0x0;
const WRITE_AND_UPDATE: u8 = 0x3;
const WRITE_CONTROL: u8 = 0x4;
const READ_OUTPUT: u8 = 0xB;
const READ_CONTROL: u8 = 0xC;
const FULL_RESET: u8 = 0xF;

/// Clears to midscale (bits 10–9 = 01), shuts down when overheated (bit 6), uses the internal reference (bit 5), powers up at
/// midscale (bits 4–3 = 01), ±10 V (bits 2–0 = 000); no overrange, offset binary. Neither a reset nor a stuck or echoing line
/// leaves this value.
pub const CONTROL: u16 = 0x0200 | 0x0040 | 0x0020 | 0x0008;
const CONTROL_BITS: u16 = 0x07FF;
/// The part's own status: short circuit (bit 12) and brown-out (bit 11). The bits above have no meaning.
const STATUS_BITS: u16 = 0x1800;

/// Why the part did not answer correctly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum DacError<E> {
    /// The bus failed.
    Bus(E),
    /// The control register did not hold the value written to it, [`CONTROL`]: the part is absent, is another one or lost its
    /// supply since, or a line is stuck.
    Control {
        /// Value read back, without the status bits.
        read: u16,
    },
    /// The part reports that its output was shorted or its supply too low since it was set up.
    Status {
        /// Bit 12: short circuit; bit 11: brown-out.
        read: u16,
    },
    /// The output register did not hold the code written last.
    Output {
        /// Code written.
        expected: u16,
        /// Code read back.
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
    /// Code that the part accepted last.
    code: u16,
}

/// Frames that set the part up, in this order. The frame that reads the control register follows them.
const SET_UP: [[u8; 3]; 3] = [
    frame(FULL_RESET, 0),
    frame(WRITE_CONTROL, CONTROL),
    frame(READ_CONTROL, 0),
];

/// The 16 data bits received in a frame.
fn data_of([_, high, low]: [u8; 3]) -> u16 {
    u16::from_be_bytes([high, low])
}

/// Checks that the control register is as written, from the frame after the one that requests it.
fn held<E>(answer: [u8; 3]) -> Result<(), DacError<E>> {
    let read = data_of(answer) & CONTROL_BITS;
    if read == CONTROL {
        Ok(())
    } else {
        Err(DacError::Control { read })
    }
}

/// Checks that neither a short circuit nor a brown-out was detected, from the same frame.
fn sound<E>(answer: [u8; 3]) -> Result<(), DacError<E>> {
    match data_of(answer) & STATUS_BITS {
        0 => Ok(()),
        read => Err(DacError::Status { read }),
    }
}

/// Checks that the output register holds `expected`, from the frame after the one that requests it.
fn drives<E>(expected: u16, answer: [u8; 3]) -> Result<(), DacError<E>> {
    match data_of(answer) {
        read if read == expected => Ok(()),
        read => Err(DacError::Output { expected, read }),
    }
}

impl<S> Ad5761<S> {
    /// A part that has not been set up yet, whose output will be at the command's 0.
    fn unset(spi: S, scale: Scale) -> Self {
        let code = scale.encode(0.0).code;
        Self { spi, scale, code }
    }

    /// Scale of the command: its value at +10 V, and its zero.
    pub fn scale(&self) -> &Scale {
        &self.scale
    }

    /// Releases the bus.
    pub fn release(self) -> S {
        self.spi
    }
}

#[inline(always)]
const fn frame(command: u8, data: u16) -> [u8; 3] {
    let [high, low] = data.to_be_bytes();
    [command, high, low]
}

/// The part's frames in the form of `$wait`.
macro_rules! ad5761 {
    (
        $over:literal, $bus:path, $new:ident, $set_up:ident, $restore:ident, $verify:ident, $transfer:ident, $write:ident,
        $wait:ident $(, $async:tt)?
    ) => {
        impl<S: $bus> Ad5761<S> {
            /// Resets the part, sets its range and leaves the output at the command's 0, which is 0 V where the scale's zero is 0. The
            /// output passes through 0 V meanwhile.
            ///
            /// * `scale`: the command at +10 V: mm, or kN for a damper emulation
            ///
            #[doc = $over]
            ///
            /// # Errors
            /// An error of the bus, or [`DacError::Control`].
            pub $($async)? fn $new(spi: S, scale: Scale) -> Result<Self, DacError<S::Error>> {
                let mut part = Self::unset(spi, scale);
                $wait!(part.$set_up())?;
                Ok(part)
            }

            $($async)? fn $set_up(&mut self) -> Result<(), DacError<S::Error>> {
                for each in &SET_UP {
                    $wait!(self.spi.write(each))?;
                }
                held($wait!(self.$transfer(NO_OPERATION))?)?;
                $wait!(self.$write(0.0))?;
                Ok(())
            }

            /// Sets the part up again as [`Ad5761::new`] does, if it lost its settings with its supply. A part that still holds them is
            /// left as it is, so that its output does not pass through 0 V.
            ///
            #[doc = $over]
            ///
            /// # Errors
            /// An error of the bus, or [`DacError::Control`].
            pub $($async)? fn $restore(&mut self) -> Result<(), DacError<S::Error>> {
                match $wait!(self.$verify()) {
                    Ok(()) => Ok(()),
                    Err(_) => $wait!(self.$set_up()),
                }
            }

            /// Reads back the part's registers without changing its output: three frames, 72 clocks. After a loss of its supply the part
            /// holds neither its control register nor the code.
            ///
            #[doc = $over]
            ///
            /// # Errors
            /// An error of the bus, [`DacError::Control`], [`DacError::Status`] or [`DacError::Output`].
            pub $($async)? fn $verify(&mut self) -> Result<(), DacError<S::Error>> {
                $wait!(self.spi.write(&frame(READ_CONTROL, 0)))?;
                let control = $wait!(self.$transfer(READ_OUTPUT))?;
                let output = $wait!(self.$transfer(NO_OPERATION))?;
                held(control)?;
                sound(control)?;
                drives(self.code, output)
            }

            /// Sends a command without data, and returns the bits that come out in the same frame.
            $($async)? fn $transfer(&mut self, command: u8) -> Result<[u8; 3], S::Error> {
                let mut frame = frame(command, 0);
                $wait!(self.spi.transfer_in_place(&mut frame))?;
                Ok(frame)
            }

            /// Drives the output: one frame, 24 clocks. Returns the code written and whether it was clipped.
            ///
            #[doc = $over]
            ///
            /// # Errors
            /// An error of the bus.
            #[inline]
            pub $($async)? fn $write(&mut self, value: f32) -> Result<Code, S::Error> {
                let code = self.scale.encode(value);
                $wait!(self.spi.write(&frame(WRITE_AND_UPDATE, code.code)))?;
                self.code = code.code;
                Ok(code)
            }
        }
    };
}

ad5761!(
    "", SpiDevice, new, set_up, restore, verify, transfer, write, now
);
#[cfg(feature = "async")]
ad5761!(
    " Over an asynchronous bus.",
    embedded_hal_async::spi::SpiDevice,
    new_async,
    set_up_async,
    restore_async,
    verify_async,
    transfer_async,
    write_async,
    later,
    async
);
