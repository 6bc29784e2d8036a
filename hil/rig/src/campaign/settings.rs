//! Invalid settings that arrive over the link.

use mesh_damper::error::ConfigError;
use mesh_damper::frame::{Fields as _, Reader, Writer};
use mesh_damper::rig::{RigConfig, RigSettings};
use serde::Serialize;

use crate::TICK_RATE;

/// A word of a rig's settings that was replaced with an invalid one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Forgery {
    /// Index of the word, from the first word of the settings on.
    pub word: usize,
    /// The replacement: NaN, an infinity, or a value that no count may have.
    pub bits: u32,
    /// Whether the rig rejects the settings.
    pub refused: bool,
}

/// Neither a number nor a count of a rig's settings may be one of these.
const FORGED: [u32; 4] = [
    f32::NAN.to_bits(),
    f32::INFINITY.to_bits(),
    f32::NEG_INFINITY.to_bits(),
    u32::MAX,
];
/// Bytes of a word.
const WORD: usize = 4;

/// Each word of a rig's settings replaced by each of these.
///
/// # Errors
/// The crate rejects its own settings.
pub fn forgeries() -> Result<Vec<Forgery>, ConfigError> {
    let mut room = [0; 512];
    let length = room.len();
    let mut writer = Writer::new(&mut room);
    RigSettings::default().at(TICK_RATE)?.write(&mut writer);
    let used = writer.left().map_or(0, |left| length - left);
    let good = &room[..used];
    let mut all = Vec::new();
    for word in 0..used / WORD {
        for bits in FORGED {
            let mut bytes = good.to_vec();
            bytes[word * WORD..(word + 1) * WORD].copy_from_slice(&bits.to_le_bytes());
            let refused = RigConfig::read(&mut Reader(&bytes)).is_none();
            all.push(Forgery {
                word,
                bits,
                refused,
            });
        }
    }
    Ok(all)
}
