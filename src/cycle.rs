//! Energy, stiffness and loss factor of each cycle, recursively and in constant memory.
//!
//! From one cycle's displacement y (mm) and force F (kN), eqs 3–7 of the paper:
//!
//! ```text
//! X0 = (y_max − y_min)/2                  K = (F_max − F_min)/(2·X0)                        (3)
//! ΔW = ∮F dy                              W = K·X0²/2                                       (6)
//! ΔW₁ = π·(F_c·Y_s − F_s·Y_c)             η = ΔW/(2π·W)                                     (4)
//! ```
//!
//! ΔW₁ is eq 5: with Y and F the first harmonics over the phase φ, y ≈ Y_s·sin φ + Y_c·cos φ, F alike, it is the energy that
//! the fundamental of the force does over the fundamental of the displacement. For a displacement Y_s·sin φ it reads
//! Y_s·∫F·cos φ dφ, the paper's sum; with Y_c it needs no α, the phase at which the paper begins to count. ΔW counts every
//! harmonic and is what η takes. Both are the same for a sinusoidal displacement.
//!
//! Integrals are trapezoids from sample to sample. A cycle rarely ends on a tick: the tick in which it ends is split
//! where it does, both samples interpolated linearly, so that each cycle gets its part and no energy is lost or counted
//! twice. At n ticks a cycle the trapezoids are within (2π/n)²/6 and the extremes, which are those of the samples,
//! within (π/n)²/2 of a smooth motion's.

use crate::limits;
use crate::real::Real;
use crate::sine::sin_cos;
use crate::sum::{FOLD, Sum};

/// A cycle whose amplitude is below this many mm counts as standing still.
pub const AMPLITUDE_MIN: f32 = 1e-9;

/// What one cycle came to. Every field is finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycle {
    /// Largest force, kN.
    pub force_max: f32,
    /// Smallest force, kN.
    pub force_min: f32,
    /// Largest displacement, mm.
    pub displacement_max: f32,
    /// Smallest displacement, mm.
    pub displacement_min: f32,
    /// X0, half of the displacement's range, mm.
    pub amplitude: f32,
    /// ΔW = ∮F dy, J. Positive when the specimen takes energy up.
    pub energy: f32,
    /// ΔW of the first harmonics, eq 5, J.
    pub energy_harmonic: f32,
    /// Dynamic stiffness K, eq 3, kN/mm. 0 when the cycle stands still.
    pub stiffness: f32,
    /// W, eq 6, J.
    pub elastic_energy: f32,
    /// η = ΔW/(2π·W), eq 4. 0 when W is 0, as for a cycle that stands still or has no force.
    pub loss_factor: f32,
    /// Mean force over the time of the cycle, kN.
    pub mean_force: f32,
    /// Mean displacement over the time of the cycle, mm.
    pub mean_displacement: f32,
    /// Length of the cycle in ticks, fractions included.
    pub ticks: f32,
}

/// One sample with what the harmonics need of it.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    displacement: f32,
    force: f32,
    displacement_sin: f32,
    displacement_cos: f32,
    force_sin: f32,
    force_cos: f32,
}

impl Sample {
    #[inline(always)]
    fn new(displacement: f32, force: f32, (sin, cos): (f32, f32)) -> Self {
        Self {
            displacement,
            force,
            displacement_sin: displacement * sin,
            displacement_cos: displacement * cos,
            force_sin: force * sin,
            force_cos: force * cos,
        }
    }
}

/// Sums over the cycle so far. The trapezoids' factor ½ is taken at the end.
#[derive(Clone, Copy, Debug, Default)]
struct Integrals {
    /// F dy
    energy: Sum,
    /// F dt, y dt, t in ticks
    force: Sum,
    displacement: Sum,
    /// y·sin φ dφ and the like, φ in units of 2⁻³² cycle
    displacement_sin: Sum,
    displacement_cos: Sum,
    force_sin: Sum,
    force_cos: Sum,
    force_max: f32,
    force_min: f32,
    displacement_max: f32,
    displacement_min: f32,
    /// Ticks but for the fractions at both ends.
    ticks: u32,
    fraction: f32,
}

impl Integrals {
    fn start(at: &Sample) -> Self {
        Self {
            force_max: at.force,
            force_min: at.force,
            displacement_max: at.displacement,
            displacement_min: at.displacement,
            ..Self::default()
        }
    }

    /// The way from `a` to `b` in `time` ticks and `turn` of phase.
    #[inline(always)]
    fn add(&mut self, a: &Sample, b: &Sample, time: f32, turn: f32) {
        let force = a.force + b.force;
        self.energy.add(force * (b.displacement - a.displacement));
        self.force.add(force * time);
        self.displacement
            .add((a.displacement + b.displacement) * time);
        self.displacement_sin
            .add((a.displacement_sin + b.displacement_sin) * turn);
        self.displacement_cos
            .add((a.displacement_cos + b.displacement_cos) * turn);
        self.force_sin.add((a.force_sin + b.force_sin) * turn);
        self.force_cos.add((a.force_cos + b.force_cos) * turn);
        // Comparisons instead of `min` and `max`, which are calls on a Cortex-M.
        if b.force > self.force_max {
            self.force_max = b.force;
        }
        if b.force < self.force_min {
            self.force_min = b.force;
        }
        if b.displacement > self.displacement_max {
            self.displacement_max = b.displacement;
        }
        if b.displacement < self.displacement_min {
            self.displacement_min = b.displacement;
        }
    }

    /// One whole tick has been added.
    #[inline(always)]
    fn tick(&mut self) {
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks.is_multiple_of(FOLD) {
            self.energy.fold();
            self.force.fold();
            self.displacement.fold();
            self.displacement_sin.fold();
            self.displacement_cos.fold();
            self.force_sin.fold();
            self.force_cos.fold();
        }
    }

    fn finish(&self) -> Cycle {
        let amplitude = 0.5 * (self.displacement_max - self.displacement_min);
        let range = self.force_max - self.force_min;
        let energy = 0.5 * self.energy.total();
        // Both harmonics are 2/(2π) times their integral over the phase, whose unit is 2π/2³² and whose ½ is due.
        let unit = 1.0 / (1u64 << 32) as f32;
        let [y_sin, y_cos, f_sin, f_cos] = [
            self.displacement_sin,
            self.displacement_cos,
            self.force_sin,
            self.force_cos,
        ]
        .map(|sum| sum.total() * unit);
        let energy_harmonic = core::f32::consts::PI * (f_cos * y_sin - f_sin * y_cos);
        let (stiffness, elastic_energy) = if amplitude > AMPLITUDE_MIN {
            (range / (2.0 * amplitude), 0.25 * range * amplitude)
        } else {
            (0.0, 0.0)
        };
        let loss_factor = if elastic_energy > f32::MIN_POSITIVE {
            energy / (core::f32::consts::TAU * elastic_energy)
        } else {
            0.0
        };
        let ticks = self.ticks as f32 + self.fraction;
        let per_tick = if ticks > 0.0 { 0.5 / ticks } else { 0.0 };
        Cycle {
            force_max: self.force_max,
            force_min: self.force_min,
            displacement_max: self.displacement_max,
            displacement_min: self.displacement_min,
            amplitude,
            energy,
            energy_harmonic,
            stiffness,
            elastic_energy,
            loss_factor,
            mean_force: self.force.total() * per_tick,
            mean_displacement: self.displacement.total() * per_tick,
            ticks,
        }
    }
}

/// Takes one sample of displacement and force a tick and gives a [`Cycle`] each time one is complete.
///
/// Only whole cycles are given: what comes before the first end of a cycle is left out, unless it began with the
/// generator's phase 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct CycleAccumulator {
    sums: Integrals,
    last: Sample,
    last_phase: u32,
    /// A sample has been seen.
    begun: bool,
    /// The cycle under way was seen from its beginning.
    whole: bool,
}

impl CycleAccumulator {
    /// Before the first sample.
    pub fn new() -> Self {
        Self::default()
    }

    /// Forgets the cycle under way, as after a restart of the generator.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// One tick, where the phase is the generator's ([`crate::sine::Excitation::phase`]). A cycle ends where the phase
    /// passes through 0.
    ///
    /// * `displacement`: mm; beyond ±[`limits::DISPLACEMENT`] treated as the limit, NaN as 0
    /// * `force`: kN; beyond ±[`limits::FORCE`] treated as the limit, NaN as 0
    /// * `phase`: 2³² to the cycle. It must not go backwards, nor half a cycle or more forward; while it stays 0, as at
    ///   the end of a programme, the cycle does not begin.
    #[inline]
    pub fn update(&mut self, displacement: f32, force: f32, phase: u32) -> Option<Cycle> {
        if phase == 0 && self.last_phase == 0 {
            self.reset();
        }
        let begins = !self.begun && phase == 0;
        let boundary = if phase < self.last_phase {
            let before = self.last_phase.wrapping_neg() as f32;
            Some(before / (before + phase as f32))
        } else {
            None
        };
        let cycle = self.update_at(displacement, force, phase, boundary);
        self.whole |= begins;
        cycle
    }

    /// One tick, where the caller knows the end of the cycle: `boundary` is the part of the way from the last sample to
    /// this one, 0…1, at which a cycle ended and the next began with phase 0. The rest as in
    /// [`CycleAccumulator::update`].
    #[inline]
    pub fn update_at(
        &mut self,
        displacement: f32,
        force: f32,
        phase: u32,
        boundary: Option<f32>,
    ) -> Option<Cycle> {
        let displacement = displacement.confined(limits::DISPLACEMENT as f32);
        let force = force.confined(limits::FORCE as f32);
        let sample = Sample::new(displacement, force, sin_cos(u64::from(phase) << 32));
        let last = core::mem::replace(&mut self.last, sample);
        let last_phase = core::mem::replace(&mut self.last_phase, phase);
        if !self.begun {
            self.begun = true;
            self.sums = Integrals::start(&sample);
            return None;
        }
        let Some(boundary) = boundary else {
            self.sums
                .add(&last, &sample, 1.0, phase.wrapping_sub(last_phase) as f32);
            self.sums.tick();
            return None;
        };
        self.end_cycle(&last, &sample, boundary.confined(1.0), last_phase, phase)
    }

    fn end_cycle(
        &mut self,
        last: &Sample,
        sample: &Sample,
        boundary: f32,
        last_phase: u32,
        phase: u32,
    ) -> Option<Cycle> {
        let between = |a: f32, b: f32| a + boundary * (b - a);
        let middle = Sample::new(
            between(last.displacement, sample.displacement),
            between(last.force, sample.force),
            (0.0, 1.0),
        );
        self.sums
            .add(last, &middle, boundary, last_phase.wrapping_neg() as f32);
        self.sums.fraction += boundary;
        let cycle = self.whole.then(|| self.sums.finish());
        self.whole = true;
        self.sums = Integrals::start(&middle);
        self.sums.add(&middle, sample, 1.0 - boundary, phase as f32);
        self.sums.fraction = 1.0 - boundary;
        cycle
    }
}
