//! The information of a pack about itself.

use core::ffi::c_char;

use mesh_damper::pack::{NAME, PackInfo};

use crate::error::{Error, Problem, answer};
use crate::law::MD_IDENTITY;
use crate::storage;

/// Largest length of a model's name with its NUL, bytes.
pub const MD_NAME: usize = 33;
const _: () = assert!(MD_NAME == NAME + 1);

/// Information of a pack about itself. Unknown fields are 0.
#[repr(C)]
pub struct Info {
    /// Tick rate of the law, Hz.
    pub tick_rate: f32,
    /// Revision, which increases from pack to pack of one specimen.
    pub revision: u32,
    /// Identity of the model.
    pub identity: [u8; MD_IDENTITY],
    /// Whether the pack has `displacement` and `velocity`.
    pub has_range: bool,
    /// Whether the pack has `density`.
    pub has_density: bool,
    /// Whether the pack has `amplitude`.
    pub has_amplitude: bool,
    /// Smallest and largest displacement of the motion that the law was fitted on, mm.
    pub displacement: [f32; 2],
    /// Smallest and largest velocity of that motion, mm/s.
    pub velocity: [f32; 2],
    /// Density of the specimen, g/cm^3.
    pub density: f32,
    /// Amplitude of the law's coefficients, mm.
    pub amplitude: f32,
    /// Name of the model, UTF-8, ends in NUL.
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

/// Reads the information of a pack of `length` bytes into `info`. It does not check the law.
///
/// Returns MD_ERROR_NONE, or MD_ERROR_NULL, MD_ERROR_MISALIGNED, an MD_ERROR_PACK_..., or the code of a field outside its range.
/// `problem` receives the details, and may be null.
///
/// # Safety
/// Each pointer is null or points to memory of its type; `pack` points to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_pack_describe(
    pack: *const u8,
    length: usize,
    info: *mut Info,
    problem: *mut Problem,
) -> Error {
    let read = || {
        // SAFETY: guaranteed by the caller, here and below.
        let pack = unsafe { storage::slice(pack, length) }?;
        let said = PackInfo::of(pack)?.ok_or(Error::PackSilent)?;
        Ok(unsafe { storage::write(info, Info::from(&said)) }?)
    };
    // SAFETY: as above.
    unsafe { answer(read(), problem) }
}
