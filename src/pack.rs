//! The coefficient pack: a law and its effects as bytes, for a rig that goes on running while it takes them.
//!
//! ```text
//! "MDCP"   u16 version   u16 length of the body   u32 CRC-32 of version, length and body   body
//! ```
//! Numbers are little-endian, the CRC is that of Ethernet, the body is [postcard](https://postcard.jamesmunns.com) of
//! eq 13's coefficients, the [`PowerSeed`] that the host computed in f64, and each effect's parameters.
//!
//! The host makes a pack with [`encode`]. The rig collects it with an [`Upload`], which gives a law only when every byte is
//! there and right; [`crate::rig::Rig::swap_law`] writes that law beside the one in force and takes it at the end of a
//! cycle. So there are two slots, and an upload that breaks off or arrives damaged never touches the one in force.

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use serde::{Deserialize, Serialize};

use crate::effects::{AugmentedLaw, EffectParameters};
use crate::error::ConfigError;
use crate::law::Law;
use crate::power::{OCTAVES, PowerSeed, SEGMENTS, Segment};
use crate::tabulated::TabulatedLaw;

/// The version that is written, and the only one read.
pub const VERSION: u16 = 1;
/// Bytes before the body.
const HEADER: usize = 12;
/// Most bytes of a pack: header, coefficients and seed are 284, eight effects of the largest kind 50 each.
pub const LARGEST: usize = 768;

const MAGIC: [u8; 4] = *b"MDCP";
const CHECKSUM: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// Why a pack was refused. The law in force stays as it was.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PackError {
    /// It does not begin as a pack does.
    Magic,
    /// Another version.
    Version {
        /// What it says.
        found: u16,
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
    /// A coefficient or parameter that its constructor refuses.
    Refused(ConfigError),
}

impl fmt::Display for PackError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Magic => write!(f, "these bytes are no coefficient pack"),
            Self::Version { found } => {
                write!(f, "the pack is of version {found}, this is {VERSION}")
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
            Self::Refused(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for PackError {}

impl From<ConfigError> for PackError {
    fn from(error: ConfigError) -> Self {
        Self::Refused(error)
    }
}

#[derive(Serialize, Deserialize)]
struct Body<const N: usize> {
    k1: f32,
    k3: f32,
    c: f32,
    alpha: f32,
    octave: [Segment; SEGMENTS],
    scale: [f32; OCTAVES],
    effects: heapless::Vec<EffectParameters<f32>, N>,
}

/// Writes the pack of `law` with `effects` into `buffer` and gives the part of it that was used. For the host: the seed is
/// computed in f64.
///
/// # Errors
/// [`PackError::Length`] when `buffer` is too short or the pack longer than [`LARGEST`], [`PackError::Refused`] for a
/// parameter out of range.
pub fn encode<'b, const N: usize>(
    law: &Law<f32>,
    effects: &[EffectParameters<f32>],
    buffer: &'b mut [u8],
) -> Result<&'b [u8], PackError> {
    for effect in effects {
        effect.effect()?;
    }
    let seed = PowerSeed::new(law.c().into(), law.alpha().into())?;
    let body = Body::<N> {
        k1: law.k1(),
        k3: law.k3(),
        c: law.c(),
        alpha: law.alpha(),
        octave: *seed.octave(),
        scale: *seed.scale(),
        effects: heapless::Vec::from_slice(effects).map_err(|_| ConfigError::Full {
            field: "effects",
            capacity: N,
        })?,
    };
    let capacity = buffer.len().min(LARGEST);
    let too_short = PackError::Length {
        expected: LARGEST,
        found: capacity,
    };
    let (header, rest) = buffer
        .get_mut(..capacity)
        .and_then(|used| used.split_at_mut_checked(HEADER))
        .ok_or(too_short)?;
    let length = postcard::to_slice(&body, rest)
        .map_err(|_| too_short)?
        .len();
    let [version_low, version_high] = VERSION.to_le_bytes();
    let [length_low, length_high] = (length as u16).to_le_bytes();
    let stamp = [version_low, version_high, length_low, length_high];
    let mut digest = CHECKSUM.digest();
    digest.update(&stamp);
    digest.update(rest.get(..length).unwrap_or_default());
    let parts = MAGIC.into_iter().chain(stamp);
    for (to, from) in header
        .iter_mut()
        .zip(parts.chain(digest.finalize().to_le_bytes()))
    {
        *to = from;
    }
    Ok(buffer.get(..HEADER + length).unwrap_or_default())
}

/// The law in a pack.
///
/// # Errors
/// Whatever is wrong with it; a pack with any one bit changed is refused.
pub fn decode<const N: usize>(pack: &[u8]) -> Result<TabulatedLaw<N>, PackError> {
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
    if version != VERSION {
        return Err(PackError::Version { found: version });
    }
    let length = usize::from(u16::from_le_bytes([length_low, length_high]));
    if length != body.len() {
        return Err(PackError::Length {
            expected: HEADER + length,
            found: pack.len(),
        });
    }
    let mut digest = CHECKSUM.digest();
    digest.update(stamp);
    digest.update(body);
    if digest.finalize() != u32::from_le_bytes(*checksum) {
        return Err(PackError::Checksum);
    }
    match postcard::take_from_bytes::<Body<N>>(body) {
        Ok((body, [])) => body.law(),
        _ => Err(PackError::Body),
    }
}

impl<const N: usize> Body<N> {
    fn law(&self) -> Result<TabulatedLaw<N>, PackError> {
        let mut law = AugmentedLaw::new(Law::new(self.k1, self.k3, self.c, self.alpha)?);
        for effect in &self.effects {
            law = law.with(effect.effect()?)?;
        }
        let seed = PowerSeed::from_parts(self.octave, self.scale)?;
        Ok(TabulatedLaw::from_parts(law, seed))
    }
}

/// A pack that is being received, part by part.
#[derive(Clone, Debug)]
pub struct Upload {
    bytes: [u8; LARGEST],
    received: usize,
}

impl Default for Upload {
    fn default() -> Self {
        Self {
            bytes: [0; LARGEST],
            received: 0,
        }
    }
}

impl Upload {
    /// The next part, whose first byte is byte `offset` of the pack. Offset 0 begins anew.
    ///
    /// # Errors
    /// [`PackError::Order`] for a part that does not follow, [`PackError::Length`] for more bytes than [`LARGEST`]. What
    /// came before stays.
    pub fn part(&mut self, offset: usize, bytes: &[u8]) -> Result<(), PackError> {
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

    /// The law, once every part is there. The upload is empty then, whatever came of it.
    ///
    /// # Errors
    /// As [`decode`].
    pub fn finish<const N: usize>(&mut self) -> Result<TabulatedLaw<N>, PackError> {
        let received = core::mem::take(&mut self.received);
        decode(self.bytes.get(..received).unwrap_or_default())
    }
}
