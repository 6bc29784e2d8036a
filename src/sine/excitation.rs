//! An excitation is what the generator demands at one tick.

/// Demand of the generator at one tick. Velocity and acceleration are the time derivatives of the position, also in ramps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Excitation {
    /// Position, mm.
    pub displacement: f32,
    /// Velocity, mm/s.
    pub velocity: f32,
    /// Acceleration, mm/s².
    pub acceleration: f32,
    /// Phase, 2³² per cycle, rounded to the nearest.
    pub phase: u32,
    /// Cycles completed since the start, ramps included.
    pub cycle: u32,
    /// Index of the block: in a ramp that of the block ahead, in the final ramp and after it that of the last block.
    pub block: usize,
    /// Whether the tick is in a ramp.
    pub ramp: bool,
    /// Whether a cycle ended since the tick before, so that this tick is the first of the next cycle.
    pub cycle_end: bool,
    /// Whether the programme is over; everything stays at 0.
    pub done: bool,
}

/// Half a unit of [`Excitation::phase`], so that its upper 32 bits are rounded to the nearest. A tick that misses the end of a
/// cycle only by the rounding of a decimal frequency thus belongs to the next cycle.
pub(super) const ROUNDING: u128 = 1 << 95;

/// Cycles per unit of [`Excitation::phase`].
pub(super) const CYCLES_PER_UNIT: f32 = 1.0 / (1u64 << 32) as f32;
