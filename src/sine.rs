//! The excitation: a programme of sines and sweeps, with ramps between them.
//!
//! y(θ) = a(θ)·sin 2πθ, where θ counts the cycles. A block keeps a constant. Between two blocks, before the first and after the
//! last there are ramps of whole cycles. A ramp leads a from one amplitude to the next by the quintic 10s³ − 15s⁴ + 6s⁵, where s is
//! the completed part of the ramp. A block of n cycles thus has n cycles at full amplitude, and its ramps are additional.
//!
//! In a sweep, and in a ramp between two frequencies, the frequency is linear in the cycles: f = f₀ + k·θ. This is the logarithmic
//! sweep f = f₀·eᵏᵗ. One tick of length h advances θ by
//!
//! Δθ = (f₀/k + θ)·(eᵏʰ − 1),
//!
//! exactly, wherever in the tick the sweep began. Position, velocity and frequency are continuous throughout. The acceleration is
//! continuous too, except where a change of frequency begins or ends, where k jumps.

mod block;
mod excitation;
mod generator;
mod increment;
mod phase;
mod programme;
mod segment;

pub use block::Block;
pub use excitation::Excitation;
pub use generator::SineGenerator;
pub(crate) use generator::SteadyBlock;
pub(crate) use increment::increment;
#[cfg(feature = "fixed-point")]
pub(crate) use phase::quarter_sine;
pub use phase::sin_cos;
pub(crate) use phase::{SECTOR, SECTOR_ROUNDING, SECTORS, Sector};
pub use programme::{PlannedBlock, Programme, ProgrammeHead};

/// Smallest amplitude, mm.
pub const AMPLITUDE_MIN: f64 = 1e-6;
/// Largest amplitude, mm.
pub const AMPLITUDE_MAX: f64 = 1e4;
/// Lowest frequency, Hz. The highest is a quarter of the tick rate.
pub const FREQUENCY_MIN: f64 = 1e-6;
/// Highest tick rate, Hz.
pub const TICK_RATE_MAX: f64 = 1e6;
