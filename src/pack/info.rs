//! Description of a pack in addition to its law, and the requirements of a load.

use core::fmt;

use super::PackError;
use crate::error::ConfigError;
use crate::frame::{Reader, Writer};
use crate::limits;
use crate::operating_range::OperatingRange;
use crate::real::in_range;

/// Longest name, bytes.
pub const NAME: usize = 32;
/// Size of a [`Stamp`] in a pack, bytes.
const STAMP: usize = 4 + 4 + 8;
/// Largest size in bytes of the fields after it: operating range, density, amplitude, name.
const LARGEST_DESCRIPTION: usize = (1 + 16) + (1 + 4) + (1 + 4) + (1 + NAME);
/// Largest size of a [`PackInfo`] in a pack, bytes.
pub(super) const LARGEST_INFO: usize = STAMP + 1 + LARGEST_DESCRIPTION;
/// Two tick rates are the same if they differ by no more than this part. Derived: above the difference between two f32 roundings of
/// one rate, 1.2e-7, and far below a difference that changes an effect.
const SAME_RATE: f32 = 1e-6;
/// Tick rates for which effects can be made, Hz.
const TICK_RATES: [f64; 2] = [1e-3, 1e7];
/// Largest density, g/cm³. Convention: above that of any metal.
pub const DENSITY_MOST: f64 = 25.0;

/// Identity of the law's model: the first bytes of a hash that the host computes. All 0 if the law does not come from a model file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Identity(pub [u8; 8]);

/// Sixteen hexadecimal digits.
impl fmt::Display for Identity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// The part of a [`PackInfo`] that every load reads, on which a load may have requirements.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stamp {
    /// Ticks per second that the law was made for, Hz: numbers in effects are valid for one tick only.
    pub tick_rate: f32,
    /// Increases from pack to pack of one specimen, so that an older one is not loaded over a newer one.
    pub revision: u32,
    /// Identity of the model.
    pub identity: Identity,
}

impl Stamp {
    /// # Errors
    /// The tick rate is not finite or out of range.
    pub(super) fn check(&self) -> Result<(), ConfigError> {
        in_range("tick_rate", self.tick_rate, TICK_RATES[0], TICK_RATES[1]).map(|_| ())
    }

    fn write(&self, writer: &mut Writer<'_>) {
        writer.f32(self.tick_rate);
        writer.u32(self.revision);
        writer.bytes(&self.identity.0);
    }

    fn read(reader: &mut Reader<'_>) -> Option<Self> {
        let tick_rate = reader.f32()?;
        let revision = reader.u32()?;
        let (identity, rest) = reader.0.split_first_chunk()?;
        let identity = Identity(*identity);
        reader.0 = rest;
        Some(Self {
            tick_rate,
            revision,
            identity,
        })
    }
}

/// The stamp of a pack, and the bytes of the remaining description.
pub(super) fn stamp<'p>(reader: &mut Reader<'p>) -> Option<(Stamp, &'p [u8])> {
    let stamp = Stamp::read(reader)?;
    let length = usize::from(reader.u8()?);
    let (description, rest) = reader.0.split_at_checked(length)?;
    reader.0 = rest;
    Some((stamp, description))
}

/// Operating range, density and amplitude.
type Numbers = (Option<OperatingRange<f32>>, Option<f32>, Option<f32>);

/// The fields after the stamp, checked, up to the name.
pub(super) fn numbers(reader: &mut Reader<'_>) -> Result<Numbers, PackError> {
    let mut range = None;
    if is_there(reader)? {
        let ends: [u32; 4] = reader.words().ok_or(PackError::Body)?;
        let [low, high, slowest, fastest] = ends.map(f32::from_bits);
        range = Some(OperatingRange::new([low, high], [slowest, fastest])?);
    }
    let mut number = || match is_there(reader)? {
        true => reader.f32().map(Some).ok_or(PackError::Body),
        false => Ok(None),
    };
    let (density, amplitude) = (number()?, number()?);
    check_numbers(density, amplitude)?;
    Ok((range, density, amplitude))
}

/// # Errors
/// The field that is not finite or out of range.
fn check_numbers(density: Option<f32>, amplitude: Option<f32>) -> Result<(), ConfigError> {
    if let Some(density) = density {
        in_range("density", density, 0.0, DENSITY_MOST)?;
    }
    if let Some(amplitude) = amplitude {
        in_range("amplitude", amplitude, 0.0, limits::DISPLACEMENT)?;
    }
    Ok(())
}

/// Description of a pack in addition to its law. A load reads and checks everything but the name, so that a firmware that does not
/// need the name links no more.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PackInfo {
    /// The fields on which a load may have requirements. The tick rate is 1e-3…1e7 Hz.
    pub stamp: Stamp,
    /// The motion on which the law was fitted, without a margin; `None` if it was not fitted.
    pub operating_range: Option<OperatingRange<f32>>,
    /// Density of the specimen, g/cm³, 0…25, if known.
    pub density: Option<f32>,
    /// Amplitude of the law's coefficients, mm, 0…1e4, if they depend on it.
    pub amplitude: Option<f32>,
    /// Name of the model, for people.
    #[cfg_attr(feature = "defmt", defmt(Display2Format))]
    #[cfg_attr(feature = "serde", serde(with = "name"))]
    pub name: heapless::String<NAME>,
}

impl PackInfo {
    /// Description of a law for `tick_rate` Hz of which nothing else is known.
    pub const fn at(tick_rate: f32) -> Self {
        Self {
            stamp: Stamp {
                tick_rate,
                revision: 0,
                identity: Identity([0; 8]),
            },
            operating_range: None,
            density: None,
            amplitude: None,
            name: heapless::String::new(),
        }
    }

    /// The description of `pack`; `None` for one of version 6, which has none. The law is not read.
    ///
    /// # Errors
    /// As [`decode`](super::decode), for header and checksum; a field that is out of range.
    pub fn of(pack: &[u8]) -> Result<Option<Self>, PackError> {
        let (version, body) = super::body(pack)?;
        if version == super::OLDEST {
            return Ok(None);
        }
        let (stamp, description) = stamp(&mut Reader(body)).ok_or(PackError::Body)?;
        stamp.check()?;
        let mut info = Self::at(stamp.tick_rate);
        info.stamp = stamp;
        info.read(&mut Reader(description))?;
        Ok(Some(info))
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
        self.stamp.check()?;
        check_numbers(self.density, self.amplitude)
    }

    /// Writes all fields, those after the stamp as postcard's `Vec<u8>`.
    pub(super) fn write(&self, writer: &mut Writer<'_>) {
        self.stamp.write(writer);
        let mut room = [0; LARGEST_DESCRIPTION];
        let mut description = Writer::new(&mut room);
        description.u8(u8::from(self.operating_range.is_some()));
        if let Some(range) = &self.operating_range {
            let ends = [range.displacement(), range.velocity()];
            for end in ends.as_flattened() {
                description.f32(*end);
            }
        }
        for number in [self.density, self.amplitude] {
            description.u8(u8::from(number.is_some()));
            if let Some(number) = number {
                description.f32(number);
            }
        }
        // At most NAME, so it is one byte.
        description.u8(self.name.len() as u8);
        description.bytes(self.name.as_bytes());
        // There is room for all of it.
        let length = LARGEST_DESCRIPTION - description.left().unwrap_or_default();
        writer.u8(length as u8);
        writer.bytes(room.get(..length).unwrap_or_default());
    }

    /// Reads the fields that [`PackInfo::write`] wrote after the stamp.
    fn read(&mut self, reader: &mut Reader<'_>) -> Result<(), PackError> {
        (self.operating_range, self.density, self.amplitude) = numbers(reader)?;
        let length = usize::from(reader.u8().ok_or(PackError::Body)?);
        let name = reader.rest();
        if name.len() != length {
            return Err(PackError::Body);
        }
        let name = core::str::from_utf8(name).map_err(|_| PackError::Body)?;
        self.name = heapless::String::try_from(name).map_err(|_| PackError::Body)?;
        Ok(())
    }
}

/// A name as text.
#[cfg(feature = "serde")]
mod name {
    use core::fmt;

    use heapless::String;
    use serde::de::{Deserializer, Error, Visitor};
    use serde::ser::Serializer;

    use super::NAME;

    pub(super) fn serialize<S: Serializer>(name: &String<NAME>, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(name)
    }

    pub(super) fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<String<NAME>, D::Error> {
        struct Name;

        impl Visitor<'_> for Name {
            type Value = String<NAME>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "a text of at most {NAME} bytes")
            }

            fn visit_str<E: Error>(self, text: &str) -> Result<String<NAME>, E> {
                String::try_from(text).map_err(|_| E::invalid_length(text.len(), &self))
            }
        }

        from.deserialize_str(Name)
    }
}

/// Reads whether an optional field follows.
fn is_there(reader: &mut Reader<'_>) -> Result<bool, PackError> {
    match reader.u8() {
        Some(0) => Ok(false),
        Some(1) => Ok(true),
        _ => Err(PackError::Body),
    }
}

/// Requirements of a load on a pack; by default only a passive law. A pack of version 6 has no stamp, so that it fails every
/// requirement on one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default, deny_unknown_fields))]
pub struct Expectation {
    /// Required tick rate, Hz.
    pub tick_rate: Option<f32>,
    /// Required identity of the model.
    pub identity: Option<Identity>,
    /// The revision must be above this.
    pub newer_than: Option<u32>,
    /// Also accepts a law that gives out more energy than it absorbs, such as one with damping below 0. Its oscillation may grow
    /// until a limit stops the rig.
    pub allow_active: bool,
}

impl Expectation {
    /// Requires a law for `tick_rate` Hz, and nothing else.
    pub const fn at(tick_rate: f32) -> Self {
        Self {
            tick_rate: Some(tick_rate),
            identity: None,
            newer_than: None,
            allow_active: false,
        }
    }

    /// Checks a pack's tick rate alone: for a rig that learns its own rate only after a pack has arrived.
    ///
    /// # Errors
    /// [`PackError::TickRate`] if `found` Hz is not the required rate, or is `None`.
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
    pub(super) fn check(&self, stamp: Option<&Stamp>) -> Result<(), PackError> {
        self.check_tick_rate(stamp.map(|stamp| stamp.tick_rate))?;
        if let Some(expected) = self.identity {
            let found = stamp.map(|stamp| stamp.identity);
            if found != Some(expected) {
                return Err(PackError::Identity { expected, found });
            }
        }
        if let Some(newer_than) = self.newer_than {
            let found = stamp.map(|stamp| stamp.revision);
            if found.is_none_or(|found| found <= newer_than) {
                return Err(PackError::Revision { newer_than, found });
            }
        }
        Ok(())
    }
}

/// Whether a law for `found` Hz is valid at `expected` Hz.
fn is_same_rate(found: f32, expected: f32) -> bool {
    let off = if found > expected {
        found - expected
    } else {
        expected - found
    };
    off <= SAME_RATE * expected
}
