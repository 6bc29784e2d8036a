//! The coefficient pack: a law and its effects as bytes, for a rig that goes on running while it takes them.
//!
//! ```text
//! "MDCP"   u16 version   u16 length of the body   u32 CRC-32 of version, length and body   body
//! ```
//! Numbers are little-endian, the CRC is that of Ethernet, the body is laid out as
//! [postcard](https://postcard.jamesmunns.com) does, by hand, as its code would take 3 KiB of a target's flash: what the pack says of
//! itself, a [`PackInfo`]; the mixed damping law's coefficients, the [`crate::power::PowerSeed`] that the host computed in f64, and a
//! `Vec` of each effect's kind and numbers, `(u8, Vec<f32>)`, and an `Option` of the residual table: its numbers, and its tables as
//! bytes. A pack of version 6 has no [`PackInfo`]; it is read, and nobody knows its tick rate.
//!
//! The host makes a pack with [`encode`]. The rig collects it with an [`Upload`], which gives a law only when every byte is
//! there and right, and the pack is what the rig's [`Expectation`] asks for;
//! [`crate::rig::RigController::swap_law_with`] writes that law beside the one in force and takes it at the end of a
//! cycle. So there are two slots, and an upload that breaks off or arrives damaged never touches the one in force.

mod check;
mod info;

pub use info::{DENSITY_MOST, Expectation, Identity, NAME, PackInfo, Stamp};

use core::fmt;

use crate::effects::MOST_WORDS;
use crate::effects::residual_table::LARGEST_TABLE;
use crate::error::ConfigError;
use crate::fast_law::FastLaw;
use crate::frame::{Writer, checksum};
use crate::passivity::{Active, Passivity};
use crate::power::{OCTAVES, SEGMENTS};
use check::Check;
use info::LARGEST_INFO;

/// The version that is written.
pub const VERSION: u16 = 7;
/// The oldest version that is read: it has no [`PackInfo`].
pub const OLDEST: u16 = 6;
/// Bytes before the body.
const HEADER: usize = 12;
/// Bytes of the mixed damping law and of the damping's seed.
const LAW: usize = 4 * (4 + 4 * SEGMENTS + OCTAVES);
/// Most bytes of the effects: their count, one with [`MOST_WORDS`], and seven more with no more than [`OTHER_WORDS`].
const EFFECTS: usize = 1 + (2 + 4 * MOST_WORDS) + 7 * (2 + 4 * OTHER_WORDS);
/// Most words of an effect that is not tones; `the_largest_effects_fit_often_enough` in `tests/wire/pack.rs` holds it.
const OTHER_WORDS: usize = 12;
/// Most bytes of a pack. Derived: the sum of its parts.
pub const LARGEST: usize = HEADER + LARGEST_INFO + LAW + EFFECTS + 1 + LARGEST_TABLE;

/// Hz, for which the effects of a pack are taken to be made that does not say it: that of the paper's rig in this crate's tests.
const SILENT_RATE: f32 = 1e4;

const MAGIC: [u8; 4] = *b"MDCP";

/// Why a pack was refused. The law in force stays as it was.
///
/// A log of defmt takes it as the [`Refusal`](crate::message::Refusal) that it becomes: a format of its own made the firmware's image 0.7
/// KiB larger, which is optimized as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum PackError {
    /// It does not begin as a pack does.
    Magic,
    /// A version that is not read.
    Version {
        /// What it says.
        found: u16,
    },
    /// It is for another tick rate than is required.
    TickRate {
        /// Hz.
        expected: f32,
        /// Hz; `None` where the pack does not say, because it is of version 6.
        found: Option<f32>,
    },
    /// It is of another model than is required.
    Identity {
        /// Of which model it should be.
        expected: Identity,
        /// Of which it is; `None` where the pack does not say.
        found: Option<Identity>,
    },
    /// It is no newer than is required.
    Revision {
        /// Its revision should be above this.
        newer_than: u32,
        /// What it is; `None` where the pack does not say.
        found: Option<u32>,
    },
    /// More or fewer bytes than it says of itself, or than fit.
    Length {
        /// How many it should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A part of an upload that does not follow the one before.
    Order {
        /// Where the next byte belongs.
        expected: usize,
        /// Where this part says that it belongs.
        found: usize,
    },
    /// The checksum does not match.
    Checksum,
    /// The body cannot be read, though its checksum matches.
    Body,
    /// Its law gives more energy than it takes, and [`Expectation::allow_active`] is not set: see [`crate::passivity`].
    Active {
        /// Of the motion in which it does, mm.
        amplitude: f32,
        /// Of that motion, Hz.
        frequency: f32,
    },
    /// A coefficient or parameter that its constructor refuses.
    Refused(ConfigError),
}

impl fmt::Display for PackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magic => write!(f, "these bytes are no coefficient pack"),
            Self::Version { found } => write!(
                f,
                "the pack is of version {found}, and versions {OLDEST} to {VERSION} are read: export the model for this one"
            ),
            Self::TickRate { expected, found } => {
                match found {
                    Some(found) => write!(f, "tick_rate: the pack is for {found} Hz")?,
                    None => write!(
                        f,
                        "tick_rate: the pack is of version {OLDEST} and does not say its rate"
                    )?,
                }
                write!(
                    f,
                    ", and {expected} Hz is required: export the model for that rate"
                )
            }
            Self::Identity { expected, found } => {
                match found {
                    Some(found) => write!(f, "identity: the pack is of the model {found}")?,
                    None => write!(
                        f,
                        "identity: the pack is of version {OLDEST} and does not say its model"
                    )?,
                }
                write!(f, ", and {expected} is required")
            }
            Self::Revision { newer_than, found } => {
                match found {
                    Some(found) => write!(f, "revision: the pack has {found}")?,
                    None => write!(f, "revision: the pack is of version {OLDEST} and has none")?,
                }
                write!(f, ", and one above {newer_than} is required")
            }
            Self::Length { expected, found } => {
                write!(f, "the pack has {found} bytes instead of {expected}")
            }
            Self::Order { expected, found } => {
                write!(
                    f,
                    "a part for byte {found} came where byte {expected} was due"
                )
            }
            Self::Checksum => write!(f, "the pack's checksum does not match"),
            Self::Body => write!(f, "the pack's body cannot be read"),
            Self::Active {
                amplitude,
                frequency,
            } => write!(
                f,
                "law: it gives more energy than it takes in a cycle of {amplitude} mm at {frequency} Hz, and a passive one is required: \
                 see to its damping and to stiffnesses of friction below 0, or allow an active law"
            ),
            Self::Refused(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for PackError {}

impl From<Active> for PackError {
    fn from(active: Active) -> Self {
        Self::Active {
            amplitude: active.amplitude,
            frequency: active.frequency,
        }
    }
}

impl From<ConfigError> for PackError {
    fn from(error: ConfigError) -> Self {
        Self::Refused(error)
    }
}

/// Writes the pack of `law` into `buffer` and gives the part of it that was used. `info` is what it says of itself: the law's effects
/// have to be made for its tick rate.
///
/// # Errors
/// [`PackError::Length`] when `buffer` is too short or the pack longer than [`LARGEST`]; a field of `info` that is out of range.
pub fn encode<'b, const N: usize>(
    law: &FastLaw<N>,
    info: &PackInfo,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], PackError> {
    info.check()?;
    let capacity = buffer.len().min(LARGEST);
    let too_short = PackError::Length {
        expected: LARGEST,
        found: capacity,
    };
    let (header, rest) = buffer
        .get_mut(..capacity)
        .and_then(|used| used.split_at_mut_checked(HEADER))
        .ok_or(too_short)?;
    let room = rest.len();
    let mut writer = Writer::new(rest);
    info.write(&mut writer);
    let eq13 = law.augmented().law();
    for value in [eq13.k1(), eq13.k3(), eq13.c(), eq13.alpha()] {
        writer.f32(value);
    }
    for value in law.damping().octave().as_flattened() {
        writer.f32(*value);
    }
    for value in law.damping().scale() {
        writer.f32(*value);
    }
    let effects = || law.augmented().effects();
    writer.u8(u8::try_from(effects().count()).map_err(|_| too_short)?);
    for effect in effects() {
        effect.pack(&mut writer);
    }
    let correction = law.augmented().residual_table();
    writer.u8(u8::from(correction.is_some()));
    if let Some(correction) = correction {
        correction.pack(&mut writer);
    }
    let length = room - writer.left().ok_or(too_short)?;
    let [version_low, version_high] = VERSION.to_le_bytes();
    let [length_low, length_high] = (length as u16).to_le_bytes();
    let stamp = [version_low, version_high, length_low, length_high];
    let checksum = checksum(&[&stamp, rest.get(..length).unwrap_or_default()]);
    let mut writer = Writer::new(header);
    writer.bytes(&MAGIC);
    writer.bytes(&stamp);
    writer.u32(checksum);
    Ok(buffer.get(..HEADER + length).unwrap_or_default())
}

/// Writes the law in a pack over `slot`, which is no law where the pack is refused. Gives the pack's stamp; `None` of one of version 6,
/// which has none. [`PackInfo::of`] gives all that the pack says of itself.
///
/// Unless [`Expectation::allow_active`] is set it takes a [`Passivity`] on the stack, and several hundred forces of the law, far more than a
/// tick has time for: [`Upload::finish_slice`] is for that.
///
/// # Errors
/// Whatever is wrong with it; a pack with any one bit changed is refused. One that is not what is `expected`: `slot` is as it was.
/// [`PackError::Active`]: `slot` has the law, which must not be used.
pub fn decode<const N: usize>(
    pack: &[u8],
    slot: &mut FastLaw<N>,
    expected: &Expectation,
) -> Result<Option<Stamp>, PackError> {
    let mut check = Check::START;
    loop {
        if let Some(stamp) = check.step(pack, slot, expected, None)? {
            if !expected.allow_active {
                check.check_passivity(slot)?;
            }
            return Ok(stamp);
        }
    }
}

/// What the bytes before a pack's body say.
struct Header {
    version: u16,
    /// Version and length, which the checksum is of as well.
    stamp: [u8; 4],
    checksum: u32,
}

/// Header and body of a pack that begins as a pack does, and is as long as it says.
fn header(pack: &[u8]) -> Result<(Header, &[u8]), PackError> {
    let short = PackError::Length {
        expected: HEADER,
        found: pack.len(),
    };
    let (magic, rest) = pack.split_first_chunk::<4>().ok_or(short)?;
    let (stamp, rest) = rest.split_first_chunk::<4>().ok_or(short)?;
    let (checksum, body) = rest.split_first_chunk::<4>().ok_or(short)?;
    if *magic != MAGIC {
        return Err(PackError::Magic);
    }
    let [version_low, version_high, length_low, length_high] = *stamp;
    let version = u16::from_le_bytes([version_low, version_high]);
    if !(OLDEST..=VERSION).contains(&version) {
        return Err(PackError::Version { found: version });
    }
    let length = usize::from(u16::from_le_bytes([length_low, length_high]));
    if length != body.len() {
        return Err(PackError::Length {
            expected: HEADER + length,
            found: pack.len(),
        });
    }
    let header = Header {
        version,
        stamp: *stamp,
        checksum: u32::from_le_bytes(*checksum),
    };
    Ok((header, body))
}

/// The version of a pack and what it carries, once its header and checksum are found right.
fn body(pack: &[u8]) -> Result<(u16, &[u8]), PackError> {
    let (header, body) = header(pack)?;
    if checksum(&[&header.stamp, body]) != header.checksum {
        return Err(PackError::Checksum);
    }
    Ok((header.version, body))
}

/// A pack that is being received, part by part, and checked, slice by slice.
#[derive(Clone, Debug)]
pub struct Upload {
    bytes: [u8; LARGEST],
    received: usize,
    check: Check,
}

impl Default for Upload {
    fn default() -> Self {
        Self::new()
    }
}

impl Upload {
    /// Nothing yet.
    pub const fn new() -> Self {
        Self {
            bytes: [0; LARGEST],
            received: 0,
            check: Check::START,
        }
    }

    /// The next part, whose first byte is byte `offset` of the pack. Offset 0 begins anew, whatever comes of it; any part has the check
    /// begin from the first byte.
    ///
    /// # Errors
    /// [`PackError::Order`] for a part that does not follow, [`PackError::Length`] for more bytes than [`LARGEST`]. What
    /// came before stays, for the part that does follow.
    pub fn part(&mut self, offset: usize, bytes: &[u8]) -> Result<(), PackError> {
        self.check = Check::START;
        if offset == 0 {
            self.received = 0;
        }
        if offset != self.received {
            return Err(PackError::Order {
                expected: self.received,
                found: offset,
            });
        }
        let end = offset.saturating_add(bytes.len());
        let Some(to) = self.bytes.get_mut(offset..end) else {
            return Err(PackError::Length {
                expected: LARGEST,
                found: end,
            });
        };
        for (to, from) in to.iter_mut().zip(bytes) {
            *to = *from;
        }
        self.received = end;
        Ok(())
    }

    /// A slice of what [`Upload::finish`] does, once every part is there: at most some 600 instructions or one force of the law, for a rig that goes on ticking between
    /// one slice and the next. `passivity` is what looks whether the law is passive, the same each time. None as long as there is more to do: `slot` is no law until then; see
    /// [`RunningLaw::swap_in_slices`](crate::fast_law::RunningLaw::swap_in_slices). A slot that another law was written over in between is begun
    /// anew. Whatever comes of the last one, the upload is empty
    /// after it.
    ///
    /// # Errors
    /// As [`decode`].
    pub fn finish_slice<const N: usize>(
        &mut self,
        slot: &mut FastLaw<N>,
        expected: &Expectation,
        passivity: &mut Passivity<N>,
    ) -> Result<Option<Option<Stamp>>, PackError> {
        let pack = self.bytes.get(..self.received).unwrap_or_default();
        let step = self.check.step(pack, slot, expected, Some(passivity));
        if !matches!(step, Ok(None)) {
            self.received = 0;
            self.check = Check::START;
        }
        step
    }

    /// Writes the law over `slot`, as [`decode`] does, once every part is there. The upload is empty then, whatever came of
    /// it.
    ///
    /// # Errors
    /// As [`decode`].
    pub fn finish<const N: usize>(
        &mut self,
        slot: &mut FastLaw<N>,
        expected: &Expectation,
    ) -> Result<Option<Stamp>, PackError> {
        let received = core::mem::take(&mut self.received);
        self.check = Check::START;
        let pack = self.bytes.get(..received).unwrap_or_default();
        decode(pack, slot, expected)
    }
}
