//! Displacement and force through a Texas Instruments ADS8688 (ADS8684): 16 bits, ±10.24 V, 500 kSample/s.
//!
//! Datasheet: TI SBAS582, "ADS868x 16-bit, 500-kSPS, 4- and 8-channel, single-supply, SAR ADCs with bipolar input
//! ranges". SPI mode 1 (data changes on the rising edge of SCLK and is read on the falling one), at most 17 MHz, most
//! significant bit and byte first, chip select low throughout a frame.
//!
//! - Conversion frame, 32 bits: a 16-bit command goes in, then the 16-bit result of the channel that the *previous* command
//!   selected comes out. The part samples where chip select falls.
//! - Register frame, 24 bits: 7 bits of address, 1 bit (1 writes, 0 reads), 8 bits of data, and 8 bits in which a read register
//!   comes out.
//! - Results are offset binary: 0x0000 is −10.24 V, 0x8000 is 0 V, 0xFFFF is one step below +10.24 V.
//!
//! Displacement is on channel 0, force on channel 1. The part samples them one frame apart, 2 µs at 17 MHz. At 10 Hz this delay is
//! a phase of 1.3e-4 rad between force and displacement, and the error of the loss factor is as large.

use core::fmt;

use embedded_hal::spi::{Mode, SpiDevice};

use crate::converter::Scale;
use crate::effects::CONTROLS;
#[cfg(feature = "async")]
use crate::forms::later;
use crate::forms::now;
use crate::rig::Reading;

/// SPI mode that the bus must use.
pub const SPI_MODE: Mode = embedded_hal::spi::MODE_1;

/// Input at full scale with the internal reference of 4.096 V, V: 2.5 times the reference.
pub const INPUT_RANGE: f64 = 10.24;

const RESET: u8 = 0x85;
const SELECT_DISPLACEMENT: u8 = 0xC0;
const SELECT_FORCE: u8 = 0xC4;
/// Range registers of channels 0 and 1, and the values written to them, in this order. The first two values are ones that neither a
/// reset nor a stuck or echoing line leaves there, with each bit once 0 and once 1: 0…2.5 and ±0.625 times the reference. The last
/// two are the range in use: ±2.5 times the reference.
const RANGES: [(u8, u8); 4] = [(0x05, 0x05), (0x06, 0x02), (0x05, 0x00), (0x06, 0x00)];
const WRITE: u8 = 1;

/// Why the part did not answer correctly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum AdcError<E> {
    /// The bus failed.
    Bus(E),
    /// A register did not hold the value written to it: the part is absent, is another one, or a line is stuck.
    Register {
        /// Its address.
        address: u8,
        /// Value written.
        expected: u8,
        /// Value read.
        found: u8,
    },
}

impl<E: fmt::Debug> fmt::Display for AdcError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "the ADC's bus failed: {error:?}"),
            Self::Register {
                address,
                expected,
                found,
            } => write!(
                f,
                "register {address:#04x} of the ADC reads {found:#04x} after {expected:#04x} was written: is it an ADS8688, \
                 powered, on this chip select, and its data line connected?"
            ),
        }
    }
}

impl<E: fmt::Debug> core::error::Error for AdcError<E> {}

impl<E> From<E> for AdcError<E> {
    fn from(error: E) -> Self {
        Self::Bus(error)
    }
}

/// The part on its bus.
#[derive(Debug)]
pub struct Ads8688<S> {
    spi: S,
    displacement: Scale,
    force: Scale,
    /// The next frame is known to convert displacement.
    in_step: bool,
}

impl<S> Ads8688<S> {
    /// Scales of displacement and force.
    pub fn scales(&self) -> [Scale; 2] {
        [self.displacement, self.force]
    }

    /// Releases the bus.
    pub fn release(self) -> S {
        self.spi
    }

    /// A part that has not been checked and set up yet.
    fn unset(spi: S, displacement: Scale, force: Scale) -> Self {
        Self {
            spi,
            displacement,
            force,
            in_step: false,
        }
    }

    /// Reading from the codes of both channels.
    #[inline]
    fn reading(&self, displacement: u16, force: u16) -> Reading {
        Reading {
            displacement: self.displacement.decode(displacement),
            force: self.force.decode(force),
            controls: [0.0; CONTROLS],
        }
    }
}

/// Frame that reads the result of the channel selected before, and selects the next one.
#[inline(always)]
fn conversion_frame(select: u8) -> [u8; 4] {
    [select, 0, 0, 0]
}

/// Result in an answer to a conversion frame.
#[inline(always)]
fn result_of([_, _, high, low]: [u8; 4]) -> u16 {
    u16::from_be_bytes([high, low])
}

/// Frame that writes `value` to a register, and frame that reads it.
fn register_frames(address: u8, value: u8) -> [[u8; 3]; 2] {
    [[address << 1 | WRITE, value, 0], [address << 1, 0, 0]]
}

/// Checks that the register at `address` holds `expected`, from the answer to the frame that reads it.
fn held<E>(address: u8, expected: u8, [_, _, found]: [u8; 3]) -> Result<(), AdcError<E>> {
    if found == expected {
        Ok(())
    } else {
        Err(AdcError::Register {
            address,
            expected,
            found,
        })
    }
}

/// The part's frames in the form of `$wait`.
macro_rules! ads8688 {
    (
        $over:literal, $bus:path, $new:ident, $restore:ident, $read:ident, $convert:ident, $wait:ident $(, $async:tt)?
    ) => {
        impl<S: $bus> Ads8688<S> {
            /// Resets the part, checks by its registers that it is there, and sets the range of both channels.
            ///
            /// * `displacement`, `force`: mm and kN at +10.24 V
            ///
            #[doc = $over]
            ///
            /// # Errors
            /// An error of the bus, or [`AdcError::Register`].
            pub $($async)? fn $new(spi: S, displacement: Scale, force: Scale) -> Result<Self, AdcError<S::Error>> {
                let mut part = Self::unset(spi, displacement, force);
                $wait!(part.$restore())?;
                Ok(part)
            }

            /// Sets the part up again as [`Ads8688::new`] does, after a loss of its supply.
            ///
            #[doc = $over]
            ///
            /// # Errors
            /// An error of the bus, or [`AdcError::Register`].
            pub $($async)? fn $restore(&mut self) -> Result<(), AdcError<S::Error>> {
                self.in_step = false;
                $wait!(self.spi.write(&[RESET, 0, 0, 0]))?;
                for (address, value) in RANGES {
                    let [write, mut read] = register_frames(address, value);
                    $wait!(self.spi.write(&write))?;
                    $wait!(self.spi.transfer_in_place(&mut read))?;
                    held(address, value, read)?;
                }
                Ok(())
            }

            /// Samples displacement, then force: two frames, 64 clocks. The first call, and the first after a bus error, takes one more
            /// frame to select the channel, so that the two channels are never exchanged.
            ///
            #[doc = $over]
            ///
            /// # Errors
            /// An error of the bus.
            #[inline]
            pub $($async)? fn $read(&mut self) -> Result<Reading, S::Error> {
                if !self.in_step {
                    $wait!(self.$convert(SELECT_DISPLACEMENT))?;
                }
                self.in_step = false;
                let displacement = $wait!(self.$convert(SELECT_FORCE))?;
                let force = $wait!(self.$convert(SELECT_DISPLACEMENT))?;
                self.in_step = true;
                Ok(self.reading(displacement, force))
            }

            /// Result of the channel selected before; `select` is the command that selects the next one.
            #[inline]
            $($async)? fn $convert(&mut self, select: u8) -> Result<u16, S::Error> {
                let mut frame = conversion_frame(select);
                $wait!(self.spi.transfer_in_place(&mut frame))?;
                Ok(result_of(frame))
            }
        }
    };
}

ads8688!("", SpiDevice, new, restore, read, convert, now);
#[cfg(feature = "async")]
ads8688!(
    " Over an asynchronous bus: dropping the call before it completes has the effect of a bus error.",
    embedded_hal_async::spi::SpiDevice,
    new_async,
    restore_async,
    read_async,
    convert_async,
    later,
    async
);
