//! Codes of an ADC and a DAC, and the input of a controller at each tick.

use mesh_damper::converter;

use crate::error::{Error, Problem, answer};
use crate::law::MD_CONTROLS;
use crate::storage::{self, Storage, assert_fits, held_const, initialize};

/// Bytes of `md_scale`.
pub const MD_SCALE_SIZE: usize = 16;
/// Alignment of `md_scale`, bytes.
pub const MD_SCALE_ALIGN: usize = 4;

/// Memory of a channel's scale: value = full_scale*(code - 32768)/32768 - zero, for 16-bit offset binary. It may be copied.
#[repr(C, align(4))]
#[derive(Clone, Copy)]
pub struct Scale {
    storage: [u8; MD_SCALE_SIZE],
}

// SAFETY: the assertion below.
unsafe impl Storage for Scale {
    type Inner = converter::Scale;
    const TAG: u32 = u32::from_le_bytes(*b"scl1");
}
const _: () = assert_fits::<Scale>();

/// One reading of a channel.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Value in the channel's unit. A value that is not finite counts as a missing measurement, and exceeds every limit.
    pub value: f32,
    /// Code in offset binary, 16 bits. At 0 and 0xFFFF the channel counts as clipped, which stops a controller.
    pub code: u16,
}

/// The readings of the sensors at one tick.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Displacement, mm.
    pub displacement: Sample,
    /// Force, kN.
    pub force: Sample,
    /// Control inputs as in `md_motion`; 0 for unused ones.
    pub controls: [f32; MD_CONTROLS],
}

/// Scales of the three channels of a controller.
#[repr(C)]
pub struct Wiring {
    /// Scale of the displacement, mm.
    pub displacement: Scale,
    /// Scale of the force, kN.
    pub force: Scale,
    /// Scale of the command, mm, or kN for a damper emulation. A command beyond its ends stops the controller.
    pub command: Scale,
}

/// Initialises the scale of a converter's channel.
///
/// * `full_scale`: the quantity at the positive full scale, 1e-6...1e6 in magnitude; negative if the sensor or the amplifier
///   inverts
/// * `zero`: the reading at a quantity of 0, -1e6...1e6
/// * `problem`: may be null
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE or MD_ERROR_OUT_OF_RANGE.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_scale_init(
    scale: *mut Scale,
    full_scale: f64,
    zero: f64,
    problem: *mut Problem,
) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let make = || Ok(converter::Scale::new(full_scale, zero)?);
        answer(initialize(scale, make), problem)
    }
}

/// The value of an ADC code.
///
/// * `bits`: resolution of the ADC, 1...16; 0 and larger values count as 16
/// * `code`: offset binary over the same range. The last code counts as clipped, as 0 does.
///
/// For a scale that is null, misaligned or not initialised, the value is NaN, which stops a controller.
///
/// # Safety
/// `scale` is null or points to an `md_scale`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_scale_decode(scale: *const Scale, bits: u32, code: u16) -> Sample {
    // SAFETY: guaranteed by the caller.
    let Ok(scale) = (unsafe { held_const(scale) }) else {
        return Sample {
            value: f32::NAN,
            code: 0,
        };
    };
    let converter::Sample { value, code } = scale.decode_bits(bits, code);
    Sample { value, code }
}

/// The 16-bit DAC code nearest to `value`. Beyond the range it is the code at the end of the range. It is 0x8000, which is 0 V, for
/// NaN and for a scale that is null, misaligned or not initialised.
///
/// # Safety
/// `scale` is null or points to an `md_scale`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_scale_encode(scale: *const Scale, value: f32) -> u16 {
    // SAFETY: guaranteed by the caller.
    unsafe { held_const(scale) }.map_or(converter::MIDSCALE, |scale| scale.encode(value).code)
}

impl Sample {
    fn of_crate(self) -> converter::Sample {
        converter::Sample {
            value: self.value,
            code: self.code,
        }
    }
}

impl Reading {
    /// 0 V on both channels: values that C does not fill in are no measurements.
    pub(crate) const NONE: Self = {
        let missing = Sample {
            value: f32::NAN,
            code: converter::MIDSCALE,
        };
        Self {
            displacement: missing,
            force: missing,
            controls: [0.0; MD_CONTROLS],
        }
    };

    #[inline(always)]
    pub(crate) fn of_crate(&self) -> mesh_damper::rig::Reading {
        mesh_damper::rig::Reading {
            displacement: self.displacement.of_crate(),
            force: self.force.of_crate(),
            controls: self.controls,
        }
    }
}

/// The wiring that C points to.
///
/// # Safety
/// `wiring` is null or points to a wiring.
pub(crate) unsafe fn wiring(wiring: *const Wiring) -> Result<mesh_damper::rig::Wiring, Error> {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let given = storage::read(wiring)?;
        let scale = |scale: &Scale| held_const(scale).copied();
        Ok(mesh_damper::rig::Wiring {
            displacement: scale(&given.displacement)?,
            force: scale(&given.force)?,
            command: scale(&given.command)?,
        })
    }
}
