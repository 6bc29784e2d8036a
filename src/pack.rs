//! The coefficient pack: a law and its effects as bytes, for a rig that keeps running while it receives them.
//!
//! ```text
//! "MDCP"   u16 version   u16 length of the body   u32 CRC-32 of version, length and body   body
//! ```
//! Numbers are little-endian, and the CRC is that of Ethernet. The body has the layout of
//! [postcard](https://postcard.jamesmunns.com), but is written by hand, because postcard's code would take 3 KiB of a target's
//! flash. The body holds, in this order: a [`PackInfo`], which describes the pack; the coefficients of the mixed damping law; the
//! [`crate::power::PowerSeed`] that the host computed in f64; a `Vec` of each effect's kind and numbers, `(u8, Vec<f32>)`; and an
//! `Option` of the residual table, with its numbers, and its tables as bytes. A pack of version 6 has no [`PackInfo`]. It is
//! accepted, and its tick rate is unknown.
//!
//! The host makes a pack with [`encode`]. The rig collects it with an [`Upload`], which returns a law only when every byte is
//! present and correct and the pack meets the rig's [`Expectation`]. [`crate::rig::RigController::swap_law_with`] writes that law
//! into a second slot and switches to it at the end of a cycle. With two slots, an upload that breaks off or arrives damaged never
//! touches the running law.

mod check;
mod info;

pub use info::{DENSITY_MOST, Expectation, Identity, NAME, PackInfo, Stamp};

use core::fmt;

use crate::effects::MOST_WORDS;
use crate::effects::residual_table::LARGEST_TABLE;
use crate::error::ConfigError;
use crate::fast_law::FastLaw;
use crate::frame::{Writer, checksum};
use crate::passivity::Active;
use crate::power::{OCTAVES, SEGMENTS};
use check::Check;
use info::LARGEST_INFO;

/// The version written.
pub const VERSION: u16 = 7;
/// The oldest version read: it has no [`PackInfo`].
pub const OLDEST: u16 = 6;
/// Bytes before the body.
const HEADER: usize = 12;
/// Bytes of the mixed damping law and of the damping's seed.
const LAW: usize = 4 * (4 + 4 * SEGMENTS + OCTAVES);
/// Largest size of the effects in bytes: their count, one effect with [`MOST_WORDS`], and seven more with at most [`OTHER_WORDS`].
const EFFECTS: usize = 1 + (2 + 4 * MOST_WORDS) + 7 * (2 + 4 * OTHER_WORDS);
/// Most words of any effect but tones; `the_largest_effects_fit_often_enough` in `tests/wire/pack.rs` asserts it.
const OTHER_WORDS: usize = 12;
/// Largest pack, bytes. Derived: the sum of its parts.
pub const LARGEST: usize = HEADER + LARGEST_INFO + LAW + EFFECTS + 1 + LARGEST_TABLE;

const MAGIC: [u8; 4] = *b"MDCP";

/// Why a pack was refused. The running law stays as it was.
///
/// A log of defmt takes it as the [`Refusal`](crate::message::Refusal) into which it is converted. A separate format made the
/// firmware's image, which is optimized as a whole, 0.7 KiB larger.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum PackError {
    /// It does not begin with the bytes of a pack.
    Magic,
    /// A version that is not supported.
    Version {
        /// Version of the pack.
        found: u16,
    },
    /// It is for another tick rate than required.
    TickRate {
        /// Required tick rate, Hz.
        expected: f32,
        /// Tick rate of the pack, Hz; `None` if the pack does not state it, because it is of version 6.
        found: Option<f32>,
    },
    /// It is of another model than required.
    Identity {
        /// Required model.
        expected: Identity,
        /// Model of the pack; `None` if the pack does not state it.
        found: Option<Identity>,
    },
    /// It is not newer than required.
    Revision {
        /// Its revision must be above this.
        newer_than: u32,
        /// Revision of the pack; `None` if the pack does not state it.
        found: Option<u32>,
    },
    /// More or fewer bytes than its header states, or than fit.
    Length {
        /// Required number of bytes.
        expected: usize,
        /// Number of bytes found.
        found: usize,
    },
    /// A part of an upload that does not continue the one before.
    Order {
        /// Position of the next byte.
        expected: usize,
        /// Position that this part states.
        found: usize,
    },
    /// The checksum is wrong.
    Checksum,
    /// The body cannot be read, although its checksum is right.
    Body,
    /// Its law can give out more energy than it absorbs, and [`Expectation::allow_active`] is not set: see [`crate::passivity`].
    Active(Active),
    /// A coefficient or parameter that its constructor rejects.
    Refused(ConfigError),
}

impl fmt::Display for PackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magic => write!(
                f,
                "these bytes are not a coefficient pack: export the model as one"
            ),
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
                write!(
                    f,
                    ", and {expected} is required: give the pack of that model"
                )
            }
            Self::Revision { newer_than, found } => {
                match found {
                    Some(found) => write!(f, "revision: the pack has {found}")?,
                    None => write!(f, "revision: the pack is of version {OLDEST} and has none")?,
                }
                write!(
                    f,
                    ", and one above {newer_than} is required: export the model with a higher one"
                )
            }
            Self::Length { expected, found } => {
                write!(
                    f,
                    "the pack has {found} bytes instead of {expected}: copy or export it again"
                )
            }
            Self::Order { expected, found } => {
                write!(
                    f,
                    "a part for byte {found} came where byte {expected} was due: send the parts again in their order"
                )
            }
            Self::Checksum => write!(
                f,
                "the pack's checksum does not match: copy or export it again"
            ),
            Self::Body => write!(f, "the pack's body cannot be read: export the model again"),
            Self::Active(active) => write!(
                f,
                "law: {active}, and a passive law is required: correct it, or allow an active law"
            ),
            Self::Refused(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for PackError {}

impl From<Active> for PackError {
    fn from(active: Active) -> Self {
        Self::Active(active)
    }
}

impl From<ConfigError> for PackError {
    fn from(error: ConfigError) -> Self {
        Self::Refused(error)
    }
}

/// Writes the pack of `law` into `buffer` and returns the part of the buffer that was used. `info` describes the pack; the law's
/// effects must be made for its tick rate.
///
/// # Errors
/// [`PackError::Length`] if `buffer` is too short or the pack longer than [`LARGEST`]; a field of `info` that is out of range.
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

/// Writes the law in a pack over `slot`; if the pack is refused, `slot` holds no law. Returns the pack's stamp, or `None` for a
/// pack of version 6, which has none. [`PackInfo::of`] returns the complete description of the pack.
///
/// It takes far longer than a tick has time for. Use [`Upload::finish_slice`] in a running rig.
///
/// # Errors
/// Any error of the pack; a pack with any one bit changed is refused. If the pack does not meet `expected`, `slot` stays as it was.
pub fn decode<const N: usize>(
    pack: &[u8],
    slot: &mut FastLaw<N>,
    expected: &Expectation,
) -> Result<Option<Stamp>, PackError> {
    let mut check = Check::START;
    loop {
        if let Some(stamp) = check.step(pack, slot, expected)? {
            return Ok(stamp);
        }
    }
}

/// The bytes before a pack's body.
struct Header {
    version: u16,
    /// Version and length, which the checksum covers too.
    stamp: [u8; 4],
    checksum: u32,
}

/// Header and body of a pack that begins correctly and has the length that it states.
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

/// The version of a pack and its body, after its header and checksum have been checked.
fn body(pack: &[u8]) -> Result<(u16, &[u8]), PackError> {
    let (header, body) = header(pack)?;
    if checksum(&[&header.stamp, body]) != header.checksum {
        return Err(PackError::Checksum);
    }
    Ok((header.version, body))
}

/// A pack that is received part by part, and checked slice by slice.
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
    /// An upload without bytes.
    pub const fn new() -> Self {
        Self {
            bytes: [0; LARGEST],
            received: 0,
            check: Check::START,
        }
    }

    /// Takes the next part, whose first byte is byte `offset` of the pack. Offset 0 restarts the upload, even if this part then
    /// fails. Every part restarts the check from the first byte.
    ///
    /// # Errors
    /// [`PackError::Order`] for a part that does not follow, [`PackError::Length`] for more bytes than [`LARGEST`]. The bytes
    /// received before stay, for the part that does follow.
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

    /// Does one slice of [`Upload::finish`], once every part has arrived: at most about 600 instructions, for a rig that keeps
    /// ticking between slices. Returns `None` while slices remain: `slot` holds no law until then; see
    /// [`RunningLaw::swap_in_slices`](crate::fast_law::RunningLaw::swap_in_slices). If another law was written over the slot in
    /// between, the check starts again. After the last slice the upload is empty, whatever its result.
    ///
    /// # Errors
    /// As [`decode`].
    pub fn finish_slice<const N: usize>(
        &mut self,
        slot: &mut FastLaw<N>,
        expected: &Expectation,
    ) -> Result<Option<Option<Stamp>>, PackError> {
        let pack = self.bytes.get(..self.received).unwrap_or_default();
        let step = self.check.step(pack, slot, expected);
        if !matches!(step, Ok(None)) {
            self.received = 0;
            self.check = Check::START;
        }
        step
    }

    /// Writes the law over `slot`, as [`decode`] does, once every part has arrived. The upload is empty afterwards, whatever the
    /// result.
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
