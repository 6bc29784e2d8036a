//! Energy, stiffness and loss factor of each cycle, in integers.

use super::{Part, Scales};

/// Takes one sample of displacement and force per tick, and returns a [`RawCycle`] with the first sample of the next cycle.
///
/// ΔW = ∮F dy is a sum of trapezoids over the polygon of the cycle's samples, closed from the last to the first. No division is
/// thus needed where a cycle ends between two ticks. At n ticks per cycle the area is still within (2π/n)², and every constant part
/// of the force, its rounding included, cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct CycleAccumulator {
    raw: RawCycle,
    first: Sample,
    last: Sample,
    begun: bool,
}

/// Displacement and force, 2³⁰ per full scale, so that their sums and differences fit.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    displacement: i32,
    force: i32,
}

/// Results of one cycle in integer units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RawCycle {
    /// ∮F dy, 2²⁹ per product of the full scales. A tick adds at most 2³⁰ of these units, so that 2³² ticks per cycle cannot
    /// overflow it.
    pub energy: i64,
    /// Largest force.
    pub force_max: Part,
    /// Smallest force.
    pub force_min: Part,
    /// Largest displacement.
    pub displacement_max: Part,
    /// Smallest displacement.
    pub displacement_min: Part,
}

/// Results of one cycle. Every field is finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Cycle {
    /// X0, half of the displacement's range, mm.
    pub amplitude: f32,
    /// ΔW = ∮F dy, J. Positive when the specimen absorbs energy.
    pub energy: f32,
    /// Dynamic stiffness K, eq 3, kN/mm. 0 when the cycle stands still.
    pub stiffness: f32,
    /// W, eq 6, J.
    pub elastic_energy: f32,
    /// η = ΔW/(2π·W), eq 4. 0 when W is 0, as for a cycle that stands still or has no force.
    pub loss_factor: f32,
}

impl CycleAccumulator {
    /// An accumulator without a sample.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes one tick. `cycle_end`: a cycle ended since the tick before, so that this is the first sample of the next.
    ///
    /// The samples before the first such tick are returned too, as the cycle that the first sample began.
    #[inline(always)]
    pub fn update(&mut self, displacement: Part, force: Part, cycle_end: bool) -> Option<RawCycle> {
        let now = Sample {
            displacement: displacement.to_bits() >> 1,
            force: force.to_bits() >> 1,
        };
        if cycle_end || !self.begun {
            return self.end_cycle(displacement, force, now);
        }
        self.raw.energy += i64::from(self.last.work_to(now));
        self.last = now;
        let raw = &mut self.raw;
        if displacement > raw.displacement_max {
            raw.displacement_max = displacement;
        }
        if displacement < raw.displacement_min {
            raw.displacement_min = displacement;
        }
        if force > raw.force_max {
            raw.force_max = force;
        }
        if force < raw.force_min {
            raw.force_min = force;
        }
        None
    }

    #[cold]
    fn end_cycle(&mut self, displacement: Part, force: Part, now: Sample) -> Option<RawCycle> {
        let mut ended = self.raw;
        ended.energy += i64::from(self.last.work_to(self.first));
        let ended = self.begun.then_some(ended);
        *self = Self {
            raw: RawCycle {
                energy: 0,
                force_max: force,
                force_min: force,
                displacement_max: displacement,
                displacement_min: displacement,
            },
            first: now,
            last: now,
            begun: true,
        };
        ended
    }
}

impl Sample {
    /// Mean force times the displacement to `to`, 2²⁹ per full scale: a product of 32 bits by 16.
    #[inline(always)]
    fn work_to(self, to: Self) -> i32 {
        let force = (self.force + to.force) >> 16;
        let way = to.displacement - self.displacement;
        (way >> 16) * force + (((way & 0xffff) * force + (1 << 15)) >> 16)
    }
}

impl RawCycle {
    /// Converts to physical units. It takes some 2400 instructions on a core without a floating-point unit: not for the tick's
    /// interrupt.
    pub fn over(&self, scales: &Scales) -> Cycle {
        let (y, f) = (scales.displacement() as f32, scales.force() as f32);
        let unit = 1.0 / (1u32 << 31) as f32;
        // A difference of two parts is up to twice full scale.
        let range = |high: Part, low: Part| {
            (i64::from(high.to_bits()) - i64::from(low.to_bits())) as f32 * unit
        };
        let displacement = range(self.displacement_max, self.displacement_min);
        let force = range(self.force_max, self.force_min);
        let amplitude = 0.5 * displacement * y;
        let energy = self.energy as f32 * (4.0 * unit) * (y * f);
        let elastic_energy = 0.125 * (force * displacement) * (y * f);
        Cycle {
            amplitude,
            energy,
            stiffness: ratio(force * f, displacement * y),
            elastic_energy,
            loss_factor: ratio(energy, core::f32::consts::TAU * elastic_energy),
        }
    }
}

/// `a`/`b`, or 0 where the quotient does not exist.
fn ratio(a: f32, b: f32) -> f32 {
    if b > 0.0 { a / b } else { 0.0 }
}
