//! What a pack says of itself beside its law, and what a load may require of that.

use core::fmt;

use super::PackError;
use crate::error::ConfigError;
use crate::frame::{Reader, Writer};
use crate::limits;
use crate::operating_range::OperatingRange;
use crate::real::in_range;

/// Most bytes of a name.
pub const NAME: usize = 32;
/// Most bytes that a [`PackInfo`] takes in a pack: tick rate, operating range, density, amplitude, revision, identity, name.
pub(super) const LARGEST_INFO: usize = 4 + (1 + 16) + (1 + 4) + (1 + 4) + 4 + 8 + (1 + NAME);
/// Two tick rates are the same where they differ by no more than this part. Derived: above what rounding both to f32 makes of one
/// rate, 1.2e-7, and far below what changes an effect.
const SAME_RATE: f32 = 1e-6;
/// Tick rates for which effects can be made, Hz.
const TICK_RATES: [f64; 2] = [1e-3, 1e7];
/// Largest density, g/cm³. Convention: above any metal's.
pub const DENSITY_MOST: f64 = 25.0;

/// Which model a law is of: the first bytes of a hash that the host computes. All 0 where the law is of no model file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity(pub [u8; 8]);

/// Sixteen hexadecimal digits.
impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// What a pack says of itself beside its law.
#[derive(Clone, Debug, PartialEq)]
pub struct PackInfo {
    /// Ticks per second that the law was made for, Hz, 1e-3…1e7: effects hold numbers that are true for one tick only.
    pub tick_rate: f32,
    /// The motion that the law was fitted on, without a margin, where it was fitted.
    pub operating_range: Option<OperatingRange<f32>>,
    /// Density of the specimen, g/cm³, 0…25, where it is known.
    pub density: Option<f32>,
    /// Amplitude that the law was taken at, mm, 0…1e4, where its coefficients change with it.
    pub amplitude: Option<f32>,
    /// Goes up from pack to pack of one specimen, so that an older one is not loaded over a newer one.
    pub revision: u32,
    /// Of the model.
    pub identity: Identity,
    /// Of the model, for people.
    pub name: heapless::String<NAME>,
}

impl PackInfo {
    /// Of a law for `tick_rate` Hz, of which nothing else is known.
    pub const fn at(tick_rate: f32) -> Self {
        Self {
            tick_rate,
            operating_range: None,
            density: None,
            amplitude: None,
            revision: 0,
            identity: Identity([0; 8]),
            name: heapless::String::new(),
        }
    }

    /// The same with a name.
    ///
    /// # Errors
    /// [`ConfigError::Full`] for more than [`NAME`] bytes of UTF-8.
    pub fn named(mut self, name: &str) -> Result<Self, ConfigError> {
        self.name = heapless::String::try_from(name).map_err(|_| ConfigError::Full {
            field: "name",
            capacity: NAME,
        })?;
        Ok(self)
    }

    /// # Errors
    /// The field that is not finite or out of range.
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        let [slowest, fastest] = TICK_RATES;
        in_range("tick_rate", self.tick_rate, slowest, fastest)?;
        if let Some(density) = self.density {
            in_range("density", density, 0.0, DENSITY_MOST)?;
        }
        if let Some(amplitude) = self.amplitude {
            in_range("amplitude", amplitude, 0.0, limits::DISPLACEMENT)?;
        }
        Ok(())
    }

    /// Writes all fields.
    pub(super) fn write(&self, writer: &mut Writer<'_>) {
        writer.f32(self.tick_rate);
        writer.u8(u8::from(self.operating_range.is_some()));
        if let Some(range) = &self.operating_range {
            let ends = [range.displacement(), range.velocity()];
            for end in ends.as_flattened() {
                writer.f32(*end);
            }
        }
        for number in [self.density, self.amplitude] {
            writer.u8(u8::from(number.is_some()));
            if let Some(number) = number {
                writer.f32(number);
            }
        }
        writer.u32(self.revision);
        writer.bytes(&self.identity.0);
        // At most NAME, so that it is one byte.
        writer.u8(self.name.len() as u8);
        writer.bytes(self.name.as_bytes());
    }

    /// Reads what [`PackInfo::write`] wrote.
    ///
    /// # Errors
    /// [`PackError::Body`] where it is not all there; the field that is out of range.
    #[inline(never)]
    pub(super) fn read(reader: &mut Reader<'_>) -> Result<Self, PackError> {
        let mut info = Self::at(reader.f32().ok_or(PackError::Body)?);
        if is_there(reader)? {
            let ends: [u32; 4] = reader.words().ok_or(PackError::Body)?;
            let [low, high, slowest, fastest] = ends.map(f32::from_bits);
            info.operating_range = Some(OperatingRange::new([low, high], [slowest, fastest])?);
        }
        for number in [&mut info.density, &mut info.amplitude] {
            if is_there(reader)? {
                *number = Some(reader.f32().ok_or(PackError::Body)?);
            }
        }
        info.revision = reader.u32().ok_or(PackError::Body)?;
        for byte in &mut info.identity.0 {
            *byte = reader.u8().ok_or(PackError::Body)?;
        }
        let length = usize::from(reader.u8().ok_or(PackError::Body)?);
        let (name, rest) = reader.0.split_at_checked(length).ok_or(PackError::Body)?;
        reader.0 = rest;
        let name = core::str::from_utf8(name).map_err(|_| PackError::Body)?;
        let info = info.named(name)?;
        info.check()?;
        Ok(info)
    }
}

/// Whether something follows that may be left out.
fn is_there(reader: &mut Reader<'_>) -> Result<bool, PackError> {
    match reader.u8() {
        Some(0) => Ok(false),
        Some(1) => Ok(true),
        _ => Err(PackError::Body),
    }
}

/// What a load requires of a pack; nothing by default. A pack of version 6 says nothing of itself, so that whatever is required is
/// missing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expectation {
    /// Hz.
    pub tick_rate: Option<f32>,
    /// Of the model.
    pub identity: Option<Identity>,
    /// The revision has to be above this.
    pub newer_than: Option<u32>,
}

impl Expectation {
    /// A law for `tick_rate` Hz, whatever it is.
    pub const fn at(tick_rate: f32) -> Self {
        Self {
            tick_rate: Some(tick_rate),
            identity: None,
            newer_than: None,
        }
    }

    /// Of a pack's rate alone: for a rig that learns its own only after a pack has come.
    ///
    /// # Errors
    /// [`PackError::TickRate`], where `found` Hz are not the rate that is required, or `None`.
    pub fn check_tick_rate(&self, found: Option<f32>) -> Result<(), PackError> {
        match self.tick_rate {
            Some(expected) if !found.is_some_and(|found| is_same_rate(found, expected)) => {
                Err(PackError::TickRate { expected, found })
            }
            _ => Ok(()),
        }
    }

    /// # Errors
    /// [`PackError::TickRate`], [`PackError::Identity`] or [`PackError::Revision`].
    pub(super) fn check(&self, info: Option<&PackInfo>) -> Result<(), PackError> {
        self.check_tick_rate(info.map(|info| info.tick_rate))?;
        if let Some(expected) = self.identity {
            let found = info.map(|info| info.identity);
            if found != Some(expected) {
                return Err(PackError::Identity { expected, found });
            }
        }
        if let Some(newer_than) = self.newer_than {
            let found = info.map(|info| info.revision);
            if !found.is_some_and(|found| found > newer_than) {
                return Err(PackError::Revision { newer_than, found });
            }
        }
        Ok(())
    }
}

/// Whether a law for `found` Hz is right at `expected` Hz.
fn is_same_rate(found: f32, expected: f32) -> bool {
    let off = if found > expected {
        found - expected
    } else {
        expected - found
    };
    off <= SAME_RATE * expected
}
