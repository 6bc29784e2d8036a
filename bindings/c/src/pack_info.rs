//! What a pack says of itself.

use core::ffi::c_char;

use mesh_damper::pack::{NAME, PackInfo};

use crate::error::{Error, Problem, answer};
use crate::law::MD_IDENTITY;
use crate::storage;

/// Most bytes of a model's name, and its NUL.
pub const MD_NAME: usize = 33;
const _: () = assert!(MD_NAME == NAME + 1);

/// What a pack says of itself. What it does not say is 0.
#[repr(C)]
pub struct Info {
    /// Ticks per second that the law is for, Hz.
    pub tick_rate: f32,
    /// Goes up from pack to pack of one specimen.
    pub revision: u32,
    /// Of the model.
    pub identity: [u8; MD_IDENTITY],
    /// Whether the pack has `displacement` and `velocity`.
    pub has_range: bool,
    /// Whether the pack has `density`.
    pub has_density: bool,
    /// Whether the pack has `amplitude`.
    pub has_amplitude: bool,
    /// Displacement of the motion that the law was fitted on, mm: least and largest.
    pub displacement: [f32; 2],
    /// Velocity of that motion, mm/s: least and largest.
    pub velocity: [f32; 2],
    /// Density of the specimen, g/cm^3.
    pub density: f32,
    /// Amplitude that the law was taken at, mm.
    pub amplitude: f32,
    /// Of the model, UTF-8 that ends in NUL.
    pub name: [c_char; MD_NAME],
}

impl From<&PackInfo> for Info {
    fn from(info: &PackInfo) -> Self {
        let range = info.operating_range.as_ref();
        let mut name = [0; MD_NAME];
        for (to, from) in name.iter_mut().zip(info.name.bytes()) {
            *to = from as c_char;
        }
        Self {
            tick_rate: info.stamp.tick_rate,
            revision: info.stamp.revision,
            identity: info.stamp.identity.0,
            has_range: range.is_some(),
            has_density: info.density.is_some(),
            has_amplitude: info.amplitude.is_some(),
            displacement: range.map(|range| range.displacement()).unwrap_or_default(),
            velocity: range.map(|range| range.velocity()).unwrap_or_default(),
            density: info.density.unwrap_or_default(),
            amplitude: info.amplitude.unwrap_or_default(),
            name,
        }
    }
}

/// Reads what a pack of `length` bytes says of itself into `info`. Its law is not looked at.
///
/// Returns MD_ERROR_NONE, or MD_ERROR_NULL, MD_ERROR_MISALIGNED, an MD_ERROR_PACK_..., or the code of a field that is out of its
/// range; `problem` gets the details, and may be null.
///
/// # Safety
/// Each pointer is null or points to what its type says; `pack` points to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_pack_describe(
    pack: *const u8,
    length: usize,
    info: *mut Info,
    problem: *mut Problem,
) -> Error {
    let read = || {
        // SAFETY: as the caller vouches, here and below.
        let pack = unsafe { storage::slice(pack, length) }?;
        let said = PackInfo::of(pack)?.ok_or(Error::PackSilent)?;
        Ok(unsafe { storage::write(info, Info::from(&said)) }?)
    };
    // SAFETY: as above.
    unsafe { answer(read(), problem) }
}
