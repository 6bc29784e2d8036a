//! Displacement and force through a Texas Instruments ADS8688 (ADS8684): 16 bits, ±10.24 V, 500 kSample/s.
//!
//! Datasheet: TI SBAS582, "ADS868x 16-bit, 500-kSPS, 4- and 8-channel, single-supply, SAR ADCs with bipolar input
//! ranges". SPI mode 1 (data changes on the rising edge of SCLK and is read on the falling one), at most 17 MHz, most
//! significant bit and byte first, chip select low throughout a frame.
//!
//! - Conversion frame, 32 bits: a 16-bit command goes in, then the 16-bit result of the channel that the *previous*
//!   command selected comes out. It is sampled where chip select falls.
//! - Register frame, 24 bits: 7 bits of address, 1 for writing, 8 of data; the last 8 bits out echo what was written.
//! - Results are offset binary: 0x0000 is −10.24 V, 0x8000 is 0 V, 0xFFFF is one step below +10.24 V.
//!
//! Displacement is on channel 0, force on channel 1. They are sampled one frame apart, 2 µs at 17 MHz. At 10 Hz that
//! turns force against displacement by 1.3e-4 rad, which is the error it makes in the loss factor.

use embedded_hal::spi::{Mode, SpiDevice};

use crate::converter::{Sample, Scale};

/// What the bus must be set to.
pub const SPI_MODE: Mode = embedded_hal::spi::MODE_1;

/// Input at full scale with the internal reference of 4.096 V, V: 2.5 times the reference.
pub const INPUT_RANGE: f64 = 10.24;

const RESET: u8 = 0x85;
const SELECT_DISPLACEMENT: u8 = 0xC0;
const SELECT_FORCE: u8 = 0xC4;
const RANGE_REGISTERS: [u8; 2] = [0x05, 0x06];
/// ±2.5 times the reference.
const RANGE_BIPOLAR: u8 = 0x00;
const WRITE: u8 = 1;

/// Why the part did not answer as it should.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AdcError<E> {
    /// The bus failed.
    Bus(E),
    /// A register did not echo what was written: no part, or another one.
    Register {
        /// Its address.
        address: u8,
        /// What came back.
        echo: u8,
    },
}

impl<E> From<E> for AdcError<E> {
    fn from(error: E) -> Self {
        Self::Bus(error)
    }
}

/// Both channels at one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// mm.
    pub displacement: Sample,
    /// kN.
    pub force: Sample,
}

/// The part on its bus.
#[derive(Debug)]
pub struct Ads8688<S> {
    spi: S,
    displacement: Scale,
    force: Scale,
    /// The part is known to convert displacement in the next frame.
    in_step: bool,
}

impl<S: SpiDevice> Ads8688<S> {
    /// Resets the part and sets the range of both channels.
    ///
    /// * `displacement`, `force`: mm and kN at +10.24 V
    ///
    /// # Errors
    /// The bus's, or [`AdcError::Register`].
    pub fn new(mut spi: S, displacement: Scale, force: Scale) -> Result<Self, AdcError<S::Error>> {
        spi.write(&[RESET, 0, 0, 0])?;
        for address in RANGE_REGISTERS {
            let mut frame = [address << 1 | WRITE, RANGE_BIPOLAR, 0];
            spi.transfer_in_place(&mut frame)?;
            let [_, _, echo] = frame;
            if echo != RANGE_BIPOLAR {
                return Err(AdcError::Register { address, echo });
            }
        }
        Ok(Self {
            spi,
            displacement,
            force,
            in_step: false,
        })
    }

    /// Samples displacement, then force: two frames, 64 clocks. The first call, and the first after a bus error, takes
    /// one frame more to select the channel, so that the two are never exchanged.
    ///
    /// # Errors
    /// The bus's.
    #[inline]
    pub fn read(&mut self) -> Result<Reading, S::Error> {
        if !self.in_step {
            self.convert(SELECT_DISPLACEMENT)?;
        }
        self.in_step = false;
        let displacement = self.convert(SELECT_FORCE)?;
        let force = self.convert(SELECT_DISPLACEMENT)?;
        self.in_step = true;
        Ok(Reading {
            displacement: self.displacement.decode(displacement),
            force: self.force.decode(force),
        })
    }

    /// The result of the channel selected before; `select` is the next one's command.
    #[inline]
    fn convert(&mut self, select: u8) -> Result<u16, S::Error> {
        let mut frame = [select, 0, 0, 0];
        self.spi.transfer_in_place(&mut frame)?;
        let [_, _, high, low] = frame;
        Ok(u16::from_be_bytes([high, low]))
    }

    /// Of displacement and force.
    pub fn scales(&self) -> (&Scale, &Scale) {
        (&self.displacement, &self.force)
    }

    /// The bus, when the part is no longer used.
    pub fn release(self) -> S {
        self.spi
    }
}
