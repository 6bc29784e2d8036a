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

/// Memory of a cycle accumulator for a caller that knows the phase, for example from `md_sine_tick`.
#[repr(C, align(8))]
pub struct Cycles {
    storage: [u8; MD_CYCLES_SIZE],
}

/// Memory of a cycle accumulator that finds the cycles of a measured displacement itself.
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
    /// Half of the peak-to-peak displacement, mm.
    pub amplitude: f32,
    /// Energy taken up by the specimen, J.
    pub energy: f32,
    /// Energy of the first harmonics alone, J.
    pub energy_harmonic: f32,
    /// Dynamic stiffness, kN/mm; 0 for a cycle without motion.
    pub stiffness: f32,
    /// Elastic energy at the amplitude, J.
    pub elastic_energy: f32,
    /// energy / (2*pi*elastic_energy); 0 if the elastic energy is 0.
    pub loss_factor: f32,
    /// Mean force, kN.
    pub mean_force: f32,
    /// Mean displacement, mm.
    pub mean_displacement: f32,
    /// Length of the cycle in ticks, including fractions.
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

/// Writes `cycle` to C, if it is complete.
///
/// # Safety
/// `results` is null or points to writable memory for the results.
unsafe fn complete(cycle: Option<&mesh_damper::cycle::Cycle>, results: *mut Cycle) -> bool {
    if let Some(cycle) = cycle {
        // Null means that the caller does not want the results.
        // SAFETY: guaranteed by the caller.
        let _ = unsafe { storage::write(results, Cycle::from(cycle)) };
    }
    cycle.is_some()
}

/// Call it before the first sample. Called again, it discards the current cycle. Returns MD_ERROR_NONE, MD_ERROR_NULL or
/// MD_ERROR_MISALIGNED.
///
/// # Safety
/// `cycles` is null or points to an `md_cycles`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_cycles_init(cycles: *mut Cycles) -> Error {
    // SAFETY: guaranteed by the caller.
    let made = unsafe { initialize(cycles, || Ok(CycleAccumulator::new())) };
    code(made.map_err(|problem| problem.error))
}

/// Processes one tick. Returns whether a cycle ended with this tick and was observed from its beginning. Only then are its results
/// written to `results`.
///
/// * `displacement`: mm; limited to -1e4...1e4, and NaN counts as 0
/// * `force`: kN; limited to -1e12...1e12, and NaN counts as 0
/// * `phase`: 2^32 per cycle. A cycle ends at the passage through 0. The phase must not go backwards, nor half a cycle or more
///   forward.
/// * `results`: may be null
///
/// For memory that is null, misaligned or not initialised, no cycle ends.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_cycles_update(
    cycles: *mut Cycles,
    displacement: f32,
    force: f32,
    phase: u32,
    results: *mut Cycle,
) -> bool {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let Ok(cycles) = held(cycles) else {
            return false;
        };
        let ended = cycles.update(displacement, [force], phase);
        complete(ended.as_ref().map(|[cycle]| cycle), results)
    }
}

/// Call it before the first sample.
///
/// * `hysteresis`: mm, 1e-9...1e4: above the peak of the noise and below the amplitude of the motion
/// * `problem`: may be null
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE or MD_ERROR_OUT_OF_RANGE.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_crossings_init(
    crossings: *mut Crossings,
    hysteresis: f32,
    problem: *mut Problem,
) -> Error {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let make = || Ok(CrossingAccumulator::new(hysteresis)?);
        answer(initialize(crossings, make), problem)
    }
}

/// Processes one tick, with displacement and force as in `md_cycles_update`. Returns whether a cycle ended, from the third cycle
/// on. Only then are its results written to `results`, which may be null.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_crossings_update(
    crossings: *mut Crossings,
    displacement: f32,
    force: f32,
    results: *mut Cycle,
) -> bool {
    // SAFETY: guaranteed by the caller.
    unsafe {
        let Ok(crossings) = held(crossings) else {
            return false;
        };
        complete(crossings.update(displacement, force).as_ref(), results)
    }
}
