//! An excitation: blocks of sines and sweeps with ramps between them.

use mesh_damper::sine::{self, Programme, SineGenerator};

use crate::error::{Error, Problem, answer, code};
use crate::storage::{self, Storage, assert_fits, held, initialize};

/// Largest number of blocks in a programme.
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

/// Whole cycles at one amplitude: a sine if both frequencies are the same, otherwise a logarithmic sweep.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Amplitude, mm, 1e-6...1e4.
    pub amplitude: f64,
    /// Frequency at the start, Hz, 1e-6 to a quarter of the tick rate.
    pub from: f64,
    /// Frequency at the end, Hz, in the same range.
    pub to: f64,
    /// Number of cycles at full amplitude, at least 1.
    pub cycles: u32,
}

/// The demand of the generator at one tick. Displacement, velocity and acceleration are derivatives of one another.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Excitation {
    /// Displacement, mm.
    pub displacement: f32,
    /// Velocity, mm/s.
    pub velocity: f32,
    /// Acceleration, mm/s^2.
    pub acceleration: f32,
    /// Phase, 2^32 per cycle, for `md_cycles_update`.
    pub phase: u32,
    /// Number of cycles completed since the start, including ramps.
    pub cycle: u32,
    /// Number of the block, from 0. In a ramp it is the next block; in the final ramp and after it, the last block.
    pub block: u32,
    /// Whether the tick is in a ramp.
    pub ramp: bool,
    /// Whether this tick is the first of a cycle.
    pub cycle_end: bool,
    /// Whether the programme has ended; all quantities then stay at 0.
    pub done: bool,
}

/// The programme from C's blocks.
///
/// # Safety
/// `blocks` is null or points to `count` blocks.
pub(crate) unsafe fn programme(
    tick_rate: f64,
    ramp_cycles: u32,
    blocks: *const Block,
    count: usize,
) -> Result<Programme<MD_BLOCKS>, Problem> {
    // SAFETY: guaranteed by the caller.
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

/// Initialises a generator at rest, at the start of its programme.
///
/// * `tick_rate`: Hz, 1...1e6
/// * `ramp_cycles`: number of cycles in each ramp, at least 1. Ramps lead from rest to a block, from block to block and back to
///   rest. Their cycles are in addition to those of the blocks.
/// * `blocks`: `count` of them, 1...MD_BLOCKS
/// * `problem`: may be null
///
/// Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED, MD_ERROR_NON_FINITE, MD_ERROR_OUT_OF_RANGE, MD_ERROR_FULL or
/// MD_ERROR_EMPTY.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_sine_init(
    sine: *mut Sine,
    tick_rate: f64,
    ramp_cycles: u32,
    blocks: *const Block,
    count: usize,
    problem: *mut Problem,
) -> Error {
    // SAFETY: guaranteed by the caller.
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

/// Resets to the start of the programme, at rest. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED.
///
/// # Safety
/// `sine` is null or points to an `md_sine`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_sine_restart(sine: *mut Sine) -> Error {
    // SAFETY: guaranteed by the caller.
    code(unsafe { held(sine) }.map(SineGenerator::restart))
}

/// The excitation at this tick; the first is at rest. Returns MD_ERROR_NONE, MD_ERROR_NULL, MD_ERROR_MISALIGNED or
/// MD_ERROR_NOT_INITIALIZED.
///
/// # Safety
/// Each pointer is null or points to memory of its type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn md_sine_tick(sine: *mut Sine, excitation: *mut Excitation) -> Error {
    // SAFETY: guaranteed by the caller.
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
