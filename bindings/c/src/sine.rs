//! An excitation: blocks of sines and sweeps, ramped into one another.

use mesh_damper::sine::{self, Programme, SineGenerator};

use crate::error::{Error, Problem, answer, code};
use crate::storage::{self, Storage, assert_fits, held, initialize};

/// Most blocks of a programme.
pub const MD_BLOCKS: usize = 8;

/// Bytes of `md_sine`.
#[cfg(target_pointer_width = "32")]
pub const MD_SINE_SIZE: usize = 1488;
/// Bytes of `md_sine`.
#[cfg(target_pointer_width = "64")]
pub const MD_SINE_SIZE: usize = 1520;
/// Alignment of `md_sine`, bytes.
pub const MD_SINE_ALIGN: usize = 16;

/// Memory of a programme and its generator.
#[repr(C, align(16))]
pub struct Sine {
    storage: [u8; MD_SINE_SIZE],
}

/// cbindgen:ignore
pub(crate) type Generator = SineGenerator<MD_BLOCKS>;

// SAFETY: the assertion below.
unsafe impl Storage for Sine {
    type Inner = Generator;
    const TAG: u32 = u32::from_le_bytes(*b"sin1");
}
const _: () = assert_fits::<Sine>();

/// Whole cycles at one amplitude: a sine where both frequencies are the same, and a logarithmic sweep otherwise.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// mm, 1e-6...1e4.
    pub amplitude: f64,
    /// Frequency at the start, Hz, 1e-6 to a quarter of the tick rate.
    pub from: f64,
    /// Frequency at the end, Hz, of the same range.
    pub to: f64,
    /// Cycles at full amplitude, at least 1.
    pub cycles: u32,
}

/// What the generator asks for at one tick: displacement, velocity and acceleration are the derivatives of one another.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Excitation {
    /// mm.
    pub displacement: f32,
    /// mm/s.
    pub velocity: f32,
    /// mm/s^2.
    pub acceleration: f32,
    /// 2^32 to the cycle, for `md_cycles_update`.
    pub phase: u32,
    /// Cycles completed since the start, ramps included.
    pub cycle: u32,
    /// Which block, from 0: in a ramp the one ahead, in the ramp to rest and after it the last.
    pub block: u32,
    /// In a ramp.
    pub ramp: bool,
    /// This tick is the first of a cycle.
    pub cycle_end: bool,
    /// The programme is over: everything stays at 0.
    pub done: bool,
}

/// A programme of what C points to.
///
/// # Safety
/// `blocks` is null or points to `count` blocks.
pub(crate) unsafe fn programme(
    tick_rate: f64,
    ramp_cycles: u32,
    blocks: *const Block,
    count: usize,
) -> Result<Programme<MD_BLOCKS>, Problem> {
    // SAFETY: as the caller vouches.
    let blocks = unsafe { storage::slice(blocks, count) }?;
    let mut programme = Programme::new(tick_rate, ramp_cycles)?;
    for block in blocks {
        let Block {
            amplitude,
            from,
            to,
            cycles,
        } = *block;
        programme = programme.with(if from == to {
            sine::Block::sine(amplitude, from, cycles)?
        } else {
            sine::Block::sweep(amplitude, from, to, cycles)?
        })?;
    }
    Ok(programme)
}

/// A generator at rest, at the start of its programme.
///
/// * `tick_rate`: Hz, 1...1e6
/// * `ramp_cycles`: cycles of each ramp, at least 1: they lead from rest to a block, from block to block and back to rest, beside the
///   cycles of the blocks
/// * `blocks`: `count` of them, 1...MD_BLOCKS
/// * `problem`: may be null
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE, MD_ERROR_OUT_OF_RANGE, MD_ERROR_FULL or
/// MD_ERROR_EMPTY.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_sine_init(
    sine: *mut Sine,
    tick_rate: f64,
    ramp_cycles: u32,
    blocks: *const Block,
    count: usize,
    problem: *mut Problem,
) -> Error {
    // SAFETY: as the caller vouches.
    unsafe {
        let make = || {
            Ok(SineGenerator::new(programme(
                tick_rate,
                ramp_cycles,
                blocks,
                count,
            )?)?)
        };
        answer(initialize(sine, make), problem)
    }
}

/// Back to the start of the programme, at rest. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED.
///
/// # Safety
/// `sine` is null or points to an `md_sine`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_sine_restart(sine: *mut Sine) -> Error {
    // SAFETY: as the caller vouches.
    code(unsafe { held(sine) }.map(SineGenerator::restart))
}

/// The excitation at this tick; the first is at rest. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED.
///
/// # Safety
/// Each pointer is null or points to what its type says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_sine_tick(sine: *mut Sine, excitation: *mut Excitation) -> Error {
    // SAFETY: as the caller vouches.
    unsafe {
        code(held(sine).and_then(|sine| storage::write(excitation, Excitation::from(sine.tick()))))
    }
}

impl From<sine::Excitation> for Excitation {
    #[inline(always)]
    fn from(now: sine::Excitation) -> Self {
        Self {
            displacement: now.displacement,
            velocity: now.velocity,
            acceleration: now.acceleration,
            phase: now.phase,
            cycle: now.cycle,
            block: now.block as u32,
            ramp: now.ramp,
            cycle_end: now.cycle_end,
            done: now.done,
        }
    }
}
