//! Stiffness, energy and loss factor of each cycle.

use mesh_damper::crossing::CrossingAccumulator;
use mesh_damper::cycle::CycleAccumulator;

use crate::error::{Error, Problem, answer, code};
use crate::storage::{self, Storage, assert_fits, held, initialize};

/// Bytes of `md_cycles`.
pub const MD_CYCLES_SIZE: usize = 144;
/// Alignment of `md_cycles`, bytes.
pub const MD_CYCLES_ALIGN: usize = 8;
/// Bytes of `md_crossings`.
pub const MD_CROSSINGS_SIZE: usize = 200;
/// Alignment of `md_crossings`, bytes.
pub const MD_CROSSINGS_ALIGN: usize = 8;

/// Memory of a cycle accumulator whose caller knows the phase, such as that of `md_sine_tick`.
#[repr(C, align(8))]
pub struct Cycles {
    storage: [u8; MD_CYCLES_SIZE],
}

/// Memory of a cycle accumulator that finds the cycles of a measured displacement by itself.
#[repr(C, align(8))]
pub struct Crossings {
    storage: [u8; MD_CROSSINGS_SIZE],
}

// SAFETY: the assertions below.
unsafe impl Storage for Cycles {
    type Inner = CycleAccumulator<1>;
    const TAG: u32 = u32::from_le_bytes(*b"cyc1");
}
const _: () = assert_fits::<Cycles>();
// SAFETY: as above.
unsafe impl Storage for Crossings {
    type Inner = CrossingAccumulator;
    const TAG: u32 = u32::from_le_bytes(*b"crs1");
}
const _: () = assert_fits::<Crossings>();

/// The results of one cycle. Every field is finite.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Cycle {
    /// Largest force, kN.
    pub force_max: f32,
    /// Smallest force, kN.
    pub force_min: f32,
    /// Largest displacement, mm.
    pub displacement_max: f32,
    /// Smallest displacement, mm.
    pub displacement_min: f32,
    /// Half of the displacement's range, mm.
    pub amplitude: f32,
    /// Energy that the specimen took up, J.
    pub energy: f32,
    /// The same of the first harmonics alone, J.
    pub energy_harmonic: f32,
    /// Dynamic stiffness, kN/mm. 0 of a cycle that stands still.
    pub stiffness: f32,
    /// Elastic energy at the amplitude, J.
    pub elastic_energy: f32,
    /// energy / (2*pi*elastic_energy). 0 where the elastic energy is.
    pub loss_factor: f32,
    /// Mean force, kN.
    pub mean_force: f32,
    /// Mean displacement, mm.
    pub mean_displacement: f32,
    /// Length of the cycle in ticks, fractions included.
    pub ticks: f32,
}

impl From<&mesh_damper::cycle::Cycle> for Cycle {
    fn from(cycle: &mesh_damper::cycle::Cycle) -> Self {
        Self {
            force_max: cycle.force_max,
            force_min: cycle.force_min,
            displacement_max: cycle.displacement_max,
            displacement_min: cycle.displacement_min,
            amplitude: cycle.amplitude,
            energy: cycle.energy,
            energy_harmonic: cycle.energy_harmonic,
            stiffness: cycle.stiffness,
            elastic_energy: cycle.elastic_energy,
            loss_factor: cycle.loss_factor,
            mean_force: cycle.mean_force,
            mean_displacement: cycle.mean_displacement,
            ticks: cycle.ticks,
        }
    }
}

/// Hands `cycle` to C, where it is complete.
///
/// # Safety
/// `results` is null or points to writable memory for them.
unsafe fn complete(cycle: Option<&mesh_damper::cycle::Cycle>, results: *mut Cycle) -> bool {
    if let Some(cycle) = cycle {
        // Null says that the caller does not want them.
        // SAFETY: as the caller vouches.
        let _ = unsafe { storage::write(results, Cycle::from(cycle)) };
    }
    cycle.is_some()
}

/// Before the first sample; again, it forgets the cycle under way. Returns MD_ERROR_NONE, MD_ERROR_NULL or MD_ERROR_MISALIGNED.
///
/// # Safety
/// `cycles` is null or points to an `md_cycles`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_cycles_init(cycles: *mut Cycles) -> Error {
    // SAFETY: as the caller vouches.
    let made = unsafe { initialize(cycles, || Ok(CycleAccumulator::new())) };
    code(made.map_err(|problem| problem.error))
}

/// One tick. Returns whether a cycle ended with it that was seen from its beginning: `results` has it then, and is left as it was
/// otherwise.
///
/// * `displacement`: mm; limited to -1e4...1e4, and NaN counts as 0
/// * `force`: kN; limited to -1e12...1e12, and NaN counts as 0
/// * `phase`: 2^32 to the cycle, and a cycle ends where it passes through 0. It must not go backwards, nor half a cycle or more
///   forward.
/// * `results`: may be null
///
/// For memory that is null, misaligned or not initialised no cycle ends.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_cycles_update(
    cycles: *mut Cycles,
    displacement: f32,
    force: f32,
    phase: u32,
    results: *mut Cycle,
) -> bool {
    // SAFETY: as the caller vouches.
    unsafe {
        let Ok(cycles) = held(cycles) else {
            return false;
        };
        let ended = cycles.update(displacement, [force], phase);
        complete(ended.as_ref().map(|[cycle]| cycle), results)
    }
}

/// Before the first sample.
///
/// * `hysteresis`: mm, 1e-9...1e4: above the noise's peak and below the motion's amplitude
/// * `problem`: may be null
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE or MD_ERROR_OUT_OF_RANGE.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_crossings_init(
    crossings: *mut Crossings,
    hysteresis: f32,
    problem: *mut Problem,
) -> Error {
    // SAFETY: as the caller vouches.
    unsafe {
        let make = || Ok(CrossingAccumulator::new(hysteresis)?);
        answer(initialize(crossings, make), problem)
    }
}

/// One tick, with displacement and force as in `md_cycles_update`. Returns whether a cycle ended, from the third on; `results` has it
/// then, and may be null.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_crossings_update(
    crossings: *mut Crossings,
    displacement: f32,
    force: f32,
    results: *mut Cycle,
) -> bool {
    // SAFETY: as the caller vouches.
    unsafe {
        let Ok(crossings) = held(crossings) else {
            return false;
        };
        complete(crossings.update(displacement, force).as_ref(), results)
    }
}
