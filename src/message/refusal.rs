//! [`super::Answer::Refused`]: why the image did not do what it was asked.

use super::{answer, kind};
use crate::error::ConfigError;
use crate::frame::{FrameBuffer, Reader};
use crate::pack::PackError;

/// Why the image did not do what it was asked. A field's value and its range are not told: the harness has them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal<'a> {
    /// It cannot be done in this order: a tick without a rig, or a law for a rig while there is none.
    Order,
    /// A converter did not answer its driver.
    Converter,
    /// This field of a configuration.
    Field(&'a str),
    /// [`PackError::Magic`].
    PackMagic,
    /// [`PackError::Version`].
    PackVersion,
    /// [`PackError::Length`].
    PackLength,
    /// [`PackError::Order`].
    PackOrder,
    /// [`PackError::Checksum`].
    PackChecksum,
    /// [`PackError::Body`].
    PackBody,
}

/// The refusals without a field by the number that they have on the link.
const REFUSALS: [Refusal<'static>; 8] = [
    Refusal::Order,
    Refusal::Converter,
    Refusal::PackMagic,
    Refusal::PackVersion,
    Refusal::PackLength,
    Refusal::PackOrder,
    Refusal::PackChecksum,
    Refusal::PackBody,
];

impl From<ConfigError> for Refusal<'static> {
    fn from(error: ConfigError) -> Self {
        let (ConfigError::NonFinite(field)
        | ConfigError::OutOfRange { field, .. }
        | ConfigError::NotIncreasing(field)
        | ConfigError::Full { field, .. }
        | ConfigError::Empty(field)
        | ConfigError::Removed(field)) = error;
        Self::Field(field)
    }
}

impl From<PackError> for Refusal<'static> {
    fn from(error: PackError) -> Self {
        match error {
            PackError::Magic => Self::PackMagic,
            PackError::Version { .. } => Self::PackVersion,
            PackError::Length { .. } => Self::PackLength,
            PackError::Order { .. } => Self::PackOrder,
            PackError::Checksum => Self::PackChecksum,
            PackError::Body => Self::PackBody,
            PackError::Refused(error) => error.into(),
        }
    }
}

/// Number of [`Refusal::Field`] on the link.
const FIELD: u8 = u8::MAX;

/// Writes [`super::Answer::Refused`].
pub fn write_refusal(sequence: u32, refusal: &Refusal<'_>, buffer: &mut FrameBuffer) {
    buffer.write(answer(kind::REFUSED, sequence, 1), |writer| {
        if let Refusal::Field(field) = refusal {
            writer.u8(FIELD);
            writer.bytes(field.as_bytes());
        } else {
            let number = (0..).zip(&REFUSALS).find(|(_, other)| *other == refusal);
            writer.u8(number.map_or(FIELD, |(number, _)| number));
        }
    });
}

pub(super) fn read_refusal<'a>(reader: &mut Reader<'a>) -> Option<Refusal<'a>> {
    Some(match reader.u8()? {
        FIELD => Refusal::Field(core::str::from_utf8(reader.rest()).ok()?),
        number => *REFUSALS.get(usize::from(number))?,
    })
}
