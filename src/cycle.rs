//! Energy, stiffness and loss factor of each cycle, computed recursively in constant memory.
//!
//! From one cycle's displacement y (mm) and force F (kN), eqs 3–7 of the paper:
//!
//! ```text
//! X0 = (y_max − y_min)/2                  K = (F_max − F_min)/(2·X0)                        (3)
//! ΔW = ∮F dy                              W = K·X0²/2                                       (6)
//! ΔW₁ = π·(F_c·Y_s − F_s·Y_c)             η = ΔW/(2π·W)                                     (4)
//! ```
//!
//! ΔW₁ is eq 5. Let Y and F be the first harmonics over the phase φ, y ≈ Y_s·sin φ + Y_c·cos φ and F in the same form. ΔW₁ is the
//! energy that the fundamental of the force does over the fundamental of the displacement. For a displacement Y_s·sin φ it is
//! Y_s·∫F·cos φ dφ, the paper's sum. With Y_c it needs no α, the phase at which the paper begins to count. ΔW contains every
//! harmonic, and η is computed from it. Both are the same for a sinusoidal displacement.
//!
//! Integrals are trapezoids from sample to sample. A cycle rarely ends on a tick, so the tick in which it ends is split at the end
//! of the cycle, with displacement and force interpolated linearly. Each cycle thus gets its part, and no energy is lost or counted
//! twice. At n ticks per cycle, for a smooth motion, the trapezoids have an error within (2π/n)²/6, and the extremes, which are
//! taken from samples, within (π/n)²/2.

use crate::limits;
use crate::real::Real;
use crate::sine::sin_cos;
use crate::sum::{FOLD, Sum};

/// A cycle of an amplitude below this many mm counts as standing still.
pub const AMPLITUDE_MIN: f32 = 1e-9;

/// Results of one cycle. Every field is finite.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// ΔW = ∮F dy, J. Positive when the specimen absorbs energy.
    pub energy: f32,
    /// ΔW of the first harmonics, eq 5, J.
    pub energy_harmonic: f32,
    /// Dynamic stiffness K, eq 3, kN/mm. 0 when the cycle stands still.
    pub stiffness: f32,
    /// W, eq 6, J.
    pub elastic_energy: f32,
    /// η = ΔW/(2π·W), eq 4. 0 when W is 0, as for a cycle that stands still or has no force.
    pub loss_factor: f32,
    /// Mean force over the time of the cycle, kN. 0 for a cycle without a length.
    pub mean_force: f32,
    /// Mean displacement over the time of the cycle, mm. 0 for a cycle without a length.
    pub mean_displacement: f32,
    /// Length of the cycle in ticks, fractions included.
    pub ticks: f32,
}

impl Cycle {
    /// Every field, in the order of declaration.
    #[inline]
    pub fn values(&self) -> [f32; 13] {
        [
            self.force_max,
            self.force_min,
            self.displacement_max,
            self.displacement_min,
            self.amplitude,
            self.energy,
            self.energy_harmonic,
            self.stiffness,
            self.elastic_energy,
            self.loss_factor,
            self.mean_force,
            self.mean_displacement,
            self.ticks,
        ]
    }
}

/// One force and its products for the harmonics.
#[derive(Clone, Copy, Debug, Default)]
struct ForceSample {
    force: f32,
    sin: f32,
    cos: f32,
}

/// One sample of `F` forces over one displacement, with their products for the harmonics.
#[derive(Clone, Copy, Debug)]
struct Sample<const F: usize> {
    displacement: f32,
    sin: f32,
    cos: f32,
    forces: [ForceSample; F],
}

impl<const F: usize> Sample<F> {
    #[inline(always)]
    fn new(displacement: f32, forces: [f32; F], (sin, cos): (f32, f32)) -> Self {
        Self {
            displacement,
            sin: displacement * sin,
            cos: displacement * cos,
            forces: forces.map(|force| ForceSample {
                force,
                sin: force * sin,
                cos: force * cos,
            }),
        }
    }
}

/// Sums over one force. The trapezoids' factor ½ is applied at the end.
#[derive(Clone, Copy, Debug, Default)]
struct ForceIntegrals {
    /// F dy
    energy: Sum,
    /// F dt, t in ticks
    force: Sum,
    /// F·sin φ dφ and F·cos φ dφ, φ in units of 2⁻³² cycle
    sin: Sum,
    cos: Sum,
    max: f32,
    min: f32,
}

impl ForceIntegrals {
    fn start(at: &ForceSample) -> Self {
        Self {
            max: at.force,
            min: at.force,
            ..Self::default()
        }
    }

    /// Adds the interval from `a` to `b`: `way` mm in `time` ticks and `turn` of phase.
    #[inline(always)]
    fn add(&mut self, a: &ForceSample, b: &ForceSample, way: f32, time: f32, turn: f32) {
        let force = a.force + b.force;
        self.energy.add(force * way);
        self.force.add(force * time);
        self.sin.add((a.sin + b.sin) * turn);
        self.cos.add((a.cos + b.cos) * turn);
        extend(&mut self.max, &mut self.min, b.force);
    }

    #[inline(always)]
    fn fold(&mut self) {
        self.energy.fold();
        self.force.fold();
        self.sin.fold();
        self.cos.fold();
    }
}

/// Comparisons instead of `min` and `max`, because those are function calls on a Cortex-M.
#[inline(always)]
fn extend(max: &mut f32, min: &mut f32, value: f32) {
    if value > *max {
        *max = value;
    }
    if value < *min {
        *min = value;
    }
}

/// Sums over the cycle so far, like [`ForceIntegrals`].
#[derive(Clone, Copy, Debug)]
struct Integrals<const F: usize> {
    /// y dt
    displacement: Sum,
    /// y·sin φ dφ and y·cos φ dφ
    sin: Sum,
    cos: Sum,
    max: f32,
    min: f32,
    /// Whole ticks, without the fractions at both ends.
    ticks: u32,
    fraction: f32,
    forces: [ForceIntegrals; F],
}

impl<const F: usize> Integrals<F> {
    fn start(at: &Sample<F>) -> Self {
        Self {
            displacement: Sum::default(),
            sin: Sum::default(),
            cos: Sum::default(),
            max: at.displacement,
            min: at.displacement,
            ticks: 0,
            fraction: 0.0,
            forces: at.forces.each_ref().map(ForceIntegrals::start),
        }
    }

    /// Adds the interval from `a` to `b`: `time` ticks and `turn` of phase.
    #[inline(always)]
    fn add(&mut self, a: &Sample<F>, b: &Sample<F>, time: f32, turn: f32) {
        self.displacement
            .add((a.displacement + b.displacement) * time);
        self.sin.add((a.sin + b.sin) * turn);
        self.cos.add((a.cos + b.cos) * turn);
        extend(&mut self.max, &mut self.min, b.displacement);
        let way = b.displacement - a.displacement;
        for (force, (a, b)) in self.forces.iter_mut().zip(a.forces.iter().zip(&b.forces)) {
            force.add(a, b, way, time, turn);
        }
    }

    /// Counts one whole tick.
    #[inline(always)]
    fn tick(&mut self) {
        self.ticks = self.ticks.saturating_add(1);
        if self.ticks.is_multiple_of(FOLD) {
            self.displacement.fold();
            self.sin.fold();
            self.cos.fold();
            for force in &mut self.forces {
                force.fold();
            }
        }
    }

    fn finish(&self) -> [Cycle; F] {
        let amplitude = 0.5 * (self.max - self.min);
        let ticks = self.ticks as f32 + self.fraction;
        // The reciprocal of a shorter time would be infinite.
        let per_tick = if ticks > f32::MIN_POSITIVE {
            0.5 / ticks
        } else {
            0.0
        };
        // Both harmonics are 2/(2π) times their integral over the phase. The phase's unit is 2π/2³², and the trapezoids' ½ is
        // applied here.
        let harmonic = |sum: Sum| sum.total() * (1.0 / (1u64 << 32) as f32);
        let (y_sin, y_cos) = (harmonic(self.sin), harmonic(self.cos));
        let mean_displacement = self.displacement.total() * per_tick;
        self.forces.each_ref().map(|force| {
            let range = force.max - force.min;
            let energy = 0.5 * force.energy.total();
            let energy_harmonic =
                core::f32::consts::PI * (harmonic(force.cos) * y_sin - harmonic(force.sin) * y_cos);
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
            Cycle {
                force_max: force.max,
                force_min: force.min,
                displacement_max: self.max,
                displacement_min: self.min,
                amplitude,
                energy,
                energy_harmonic,
                stiffness,
                elastic_energy,
                loss_factor,
                mean_force: force.force.total() * per_tick,
                mean_displacement,
                ticks,
            }
        })
    }
}

/// Takes one sample per tick of displacement and of `F` forces over it, and returns a [`Cycle`] for each force when a cycle is
/// complete.
///
/// Only whole cycles are returned: samples before the first end of a cycle are left out, unless that cycle began with the
/// generator's phase 0.
#[derive(Clone, Copy, Debug)]
pub struct CycleAccumulator<const F: usize> {
    sums: Integrals<F>,
    last: Sample<F>,
    last_phase: u32,
    /// At least one sample has been taken.
    begun: bool,
    /// The current cycle was measured from its beginning.
    whole: bool,
}

impl<const F: usize> Default for CycleAccumulator<F> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const F: usize> CycleAccumulator<F> {
    /// An accumulator without a sample.
    pub fn new() -> Self {
        let last = Sample::new(0.0, [0.0; F], (0.0, 0.0));
        Self {
            sums: Integrals::start(&last),
            last,
            last_phase: 0,
            begun: false,
            whole: false,
        }
    }

    /// Drops the current cycle, as needed after a restart of the generator.
    pub fn reset(&mut self) {
        *self = Self::new();
    }

    /// Forces of the last tick, kN.
    pub(crate) fn last_forces(&self) -> [f32; F] {
        self.last.forces.map(|sample| sample.force)
    }

    /// Takes one tick whose phase is the generator's ([`crate::sine::Excitation::phase`]). A cycle ends where the phase passes
    /// through 0.
    ///
    /// * `displacement`: mm; beyond ±[`limits::DISPLACEMENT`] treated as the limit, NaN as 0
    /// * `forces`: kN; beyond ±[`limits::FORCE`] treated as the limit, NaN as 0
    /// * `phase`: 2³² per cycle. It must not go backwards, nor half a cycle or more forward. While it stays 0, as at the end of a
    ///   programme, no cycle begins.
    #[inline]
    pub fn update(
        &mut self,
        displacement: f32,
        forces: [f32; F],
        phase: u32,
    ) -> Option<[Cycle; F]> {
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
        let cycles = self.update_at(displacement, forces, phase, boundary);
        self.whole |= begins;
        cycles
    }

    /// Takes one tick where the caller knows the end of the cycle: `boundary` is the part of the interval from the last sample to
    /// this one, 0…1, at which a cycle ended and the next began with phase 0; below 0 and NaN it is treated as 0, above 1 as 1. The
    /// other arguments are those of [`CycleAccumulator::update`].
    #[inline]
    pub fn update_at(
        &mut self,
        displacement: f32,
        forces: [f32; F],
        phase: u32,
        boundary: Option<f32>,
    ) -> Option<[Cycle; F]> {
        let displacement = displacement.clamped(limits::DISPLACEMENT as f32);
        let forces = forces.map(|force| force.clamped(limits::FORCE as f32));
        let sample = Sample::new(displacement, forces, sin_cos(u64::from(phase) << 32));
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
        let boundary = if boundary > 0.0 {
            boundary.clamped(1.0)
        } else {
            0.0
        };
        self.end_cycle(&last, &sample, boundary, last_phase, phase)
    }

    fn end_cycle(
        &mut self,
        last: &Sample<F>,
        sample: &Sample<F>,
        boundary: f32,
        last_phase: u32,
        phase: u32,
    ) -> Option<[Cycle; F]> {
        let between = |a: f32, b: f32| a + boundary * (b - a);
        let mut forces = [0.0; F];
        let both = last.forces.iter().zip(&sample.forces);
        for (force, (last, sample)) in forces.iter_mut().zip(both) {
            *force = between(last.force, sample.force);
        }
        let middle = Sample::new(
            between(last.displacement, sample.displacement),
            forces,
            (0.0, 1.0),
        );
        self.sums
            .add(last, &middle, boundary, last_phase.wrapping_neg() as f32);
        self.sums.fraction += boundary;
        let cycles = self.whole.then(|| self.sums.finish());
        self.whole = true;
        self.sums = Integrals::start(&middle);
        self.sums.add(&middle, sample, 1.0 - boundary, phase as f32);
        self.sums.fraction = 1.0 - boundary;
        cycles
    }
}
