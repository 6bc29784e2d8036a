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
    /// [`ConfigError::Removed`], with what there is no more.
    Removed(&'a str),
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
    /// [`PackError::TickRate`].
    PackTickRate,
    /// [`PackError::Identity`].
    PackIdentity,
    /// [`PackError::Revision`].
    PackRevision,
}

/// The refusals that are told by their number alone.
const PLAIN: [Refusal<'static>; 11] = [
    Refusal::Order,
    Refusal::Converter,
    Refusal::PackMagic,
    Refusal::PackVersion,
    Refusal::PackLength,
    Refusal::PackOrder,
    Refusal::PackChecksum,
    Refusal::PackBody,
    Refusal::PackTickRate,
    Refusal::PackIdentity,
    Refusal::PackRevision,
];

/// Number of [`Refusal::Field`] on the link.
const FIELD: u8 = u8::MAX;
/// Number of [`Refusal::Removed`] on the link.
const REMOVED: u8 = FIELD - 1;

impl Refusal<'_> {
    /// Its number on the link.
    const fn number(&self) -> u8 {
        match self {
            Self::Order => 0,
            Self::Converter => 1,
            Self::PackMagic => 2,
            Self::PackVersion => 3,
            Self::PackLength => 4,
            Self::PackOrder => 5,
            Self::PackChecksum => 6,
            Self::PackBody => 7,
            Self::PackTickRate => 8,
            Self::PackIdentity => 9,
            Self::PackRevision => 10,
            Self::Field(_) => FIELD,
            Self::Removed(_) => REMOVED,
        }
    }
}

impl From<ConfigError> for Refusal<'static> {
    fn from(error: ConfigError) -> Self {
        match error {
            ConfigError::NonFinite(field)
            | ConfigError::OutOfRange { field, .. }
            | ConfigError::NotIncreasing(field)
            | ConfigError::Full { field, .. }
            | ConfigError::Empty(field) => Self::Field(field),
            ConfigError::Removed(what) => Self::Removed(what),
        }
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
            PackError::TickRate { .. } => Self::PackTickRate,
            PackError::Identity { .. } => Self::PackIdentity,
            PackError::Revision { .. } => Self::PackRevision,
            PackError::Refused(error) => error.into(),
        }
    }
}

/// Writes [`super::Answer::Refused`].
pub fn write_refusal(sequence: u32, refusal: &Refusal<'_>, buffer: &mut FrameBuffer) {
    buffer.write(answer(kind::REFUSED, sequence, 1), |writer| {
        writer.u8(refusal.number());
        if let Refusal::Field(name) | Refusal::Removed(name) = refusal {
            writer.bytes(name.as_bytes());
        }
    });
}

pub(super) fn read_refusal<'a>(reader: &mut Reader<'a>) -> Option<Refusal<'a>> {
    let number = reader.u8()?;
    let mut name = || core::str::from_utf8(reader.rest()).ok();
    Some(match number {
        FIELD => Refusal::Field(name()?),
        REMOVED => Refusal::Removed(name()?),
        number => PLAIN.into_iter().find(|each| each.number() == number)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An image of one version and a harness of another understand each other as long as these stay.
    #[test]
    fn numbers_on_the_link_are_those_of_the_table() {
        let refusals: [(&[u8], Refusal<'_>); 13] = [
            (&[0], Refusal::Order),
            (&[1], Refusal::Converter),
            (&[2], Refusal::PackMagic),
            (&[3], Refusal::PackVersion),
            (&[4], Refusal::PackLength),
            (&[5], Refusal::PackOrder),
            (&[6], Refusal::PackChecksum),
            (&[7], Refusal::PackBody),
            (&[8], Refusal::PackTickRate),
            (&[9], Refusal::PackIdentity),
            (&[10], Refusal::PackRevision),
            (b"\xfeclock", Refusal::Removed("clock")),
            (b"\xffk1", Refusal::Field("k1")),
        ];
        for (bytes, refusal) in refusals {
            assert_eq!(refusal.number(), bytes[0]);
            assert_eq!(read_refusal(&mut Reader(bytes)), Some(refusal));
        }
        assert_eq!(read_refusal(&mut Reader(&[11])), None);
    }
}
