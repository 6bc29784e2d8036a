//! [`super::Answer::Refused`]: why the image refused a request.

use super::{answer, kind};
use crate::error::ConfigError;
use crate::frame::{FrameBuffer, Reader};
use crate::pack::PackError;
use crate::rig::{ClearRefused, StartRefused, State};

use super::outcome::{state_code, state_of};

/// Why the image refused a request. The value of a field and its range are not sent, because the harness has them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Refusal<'a> {
    /// The request is not possible in this order: a tick without a rig, or a law for a rig that does not exist yet.
    Order,
    /// A converter did not answer its driver.
    Converter,
    /// This field of a configuration is not valid.
    Field(&'a str),
    /// [`ConfigError::Removed`], with the name of the removed feature.
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
    /// [`PackError::Active`], with the name of the parameter.
    PackActive(&'a str),
    /// The first request had a number other than 0: the board has restarted since.
    Restarted,
    /// The rig does not start.
    Start(StartRefused),
    /// The rig does not clear its trip.
    Clear(ClearRefused),
}

/// The refusals that consist of their number alone.
const PLAIN: [Refusal<'static>; 12] = [
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
    Refusal::Restarted,
];

/// Number of [`Refusal::PackActive`] on the link.
const ACTIVE: u8 = 11;
/// Number of [`Refusal::Field`] on the link.
const FIELD: u8 = u8::MAX;
/// Number of [`Refusal::Removed`] on the link.
const REMOVED: u8 = FIELD - 1;
/// Number of [`Refusal::Start`] on the link.
const START: u8 = REMOVED - 1;
/// Number of [`Refusal::Clear`] on the link.
const CLEAR: u8 = START - 1;

/// The reason why a rig does not start, as its state: a command on its way to 0 is [`State::Idle`] that is not at rest.
fn state_of_start(refused: StartRefused) -> State {
    match refused {
        StartRefused::Moving => State::Idle,
        StartRefused::Running => State::Running,
        StartRefused::Faulted(cause) => State::Faulted(cause),
    }
}

fn start_of_state(state: State) -> Option<StartRefused> {
    match state {
        State::Idle => Some(StartRefused::Moving),
        State::Running => Some(StartRefused::Running),
        State::Faulted(cause) => Some(StartRefused::Faulted(cause)),
        State::Done => None,
    }
}

/// The reason why a rig does not clear its trip, in the same way: without a trip it is [`State::Done`].
fn state_of_clear(refused: ClearRefused) -> State {
    match refused {
        ClearRefused::Moving => State::Idle,
        ClearRefused::NoFault => State::Done,
        ClearRefused::Faulted(cause) => State::Faulted(cause),
    }
}

fn clear_of_state(state: State) -> Option<ClearRefused> {
    match state {
        State::Idle => Some(ClearRefused::Moving),
        State::Done => Some(ClearRefused::NoFault),
        State::Faulted(cause) => Some(ClearRefused::Faulted(cause)),
        State::Running => None,
    }
}

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
            Self::PackActive(_) => ACTIVE,
            Self::Restarted => 12,
            Self::Field(_) => FIELD,
            Self::Removed(_) => REMOVED,
            Self::Start(_) => START,
            Self::Clear(_) => CLEAR,
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

impl From<StartRefused> for Refusal<'static> {
    fn from(refused: StartRefused) -> Self {
        Self::Start(refused)
    }
}

impl From<ClearRefused> for Refusal<'static> {
    fn from(refused: ClearRefused) -> Self {
        Self::Clear(refused)
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
            PackError::Active(active) => Self::PackActive(active.field),
            PackError::Refused(error) => error.into(),
        }
    }
}

/// Writes [`super::Answer::Refused`].
pub fn write_refusal(sequence: u32, refusal: &Refusal<'_>, buffer: &mut FrameBuffer) {
    buffer.write(answer(kind::REFUSED, sequence, 1), |writer| {
        writer.u8(refusal.number());
        let state = match refusal {
            Refusal::Field(name) | Refusal::Removed(name) | Refusal::PackActive(name) => {
                return writer.bytes(name.as_bytes());
            }
            Refusal::Start(refused) => state_of_start(*refused),
            Refusal::Clear(refused) => state_of_clear(*refused),
            _ => return,
        };
        writer.u8(state_code(state));
    });
}

pub(super) fn read_refusal<'a>(reader: &mut Reader<'a>) -> Option<Refusal<'a>> {
    let number = reader.u8()?;
    let name = |reader: &mut Reader<'a>| core::str::from_utf8(reader.rest()).ok();
    Some(match number {
        FIELD => Refusal::Field(name(reader)?),
        REMOVED => Refusal::Removed(name(reader)?),
        ACTIVE => Refusal::PackActive(name(reader)?),
        START => Refusal::Start(start_of_state(state_of(reader.u8()?)?)?),
        CLEAR => Refusal::Clear(clear_of_state(state_of(reader.u8()?)?)?),
        number => PLAIN.into_iter().find(|each| each.number() == number)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An image and a harness of different versions understand each other as long as these numbers stay.
    #[test]
    fn numbers_on_the_link_are_those_of_the_table() {
        use crate::rig::TripCause::{EnableLine, LinkLost};
        let refusals: [(&[u8], Refusal<'_>); 22] = [
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
            (b"\x0bc1", Refusal::PackActive("c1")),
            // From an image that does not name the parameter.
            (&[11], Refusal::PackActive("")),
            (&[12], Refusal::Restarted),
            (&[252, 0], Refusal::Clear(ClearRefused::Moving)),
            (&[252, 2], Refusal::Clear(ClearRefused::NoFault)),
            (
                &[252, 18],
                Refusal::Clear(ClearRefused::Faulted(EnableLine)),
            ),
            (&[253, 0], Refusal::Start(StartRefused::Moving)),
            (&[253, 1], Refusal::Start(StartRefused::Running)),
            (&[253, 29], Refusal::Start(StartRefused::Faulted(LinkLost))),
            (b"\xfeclock", Refusal::Removed("clock")),
            (b"\xffk1", Refusal::Field("k1")),
        ];
        for (bytes, refusal) in refusals {
            assert_eq!(refusal.number(), bytes[0]);
            assert_eq!(read_refusal(&mut Reader(bytes)), Some(refusal));
            let mut written = FrameBuffer::new();
            write_refusal(3, &refusal, &mut written);
            let frame = crate::frame::Frames(written.bytes()).next().unwrap();
            assert_eq!(frame.payload, bytes);
        }
        // A rig that is done does start, and a running one has nothing to clear.
        for bytes in [[253, 2], [252, 1], [253, 255]] {
            assert_eq!(read_refusal(&mut Reader(&bytes)), None);
        }
        assert_eq!(read_refusal(&mut Reader(&[13])), None);
    }
}
