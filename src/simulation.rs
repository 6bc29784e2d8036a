//! A test of the law without a specimen: the mixed damping law (eq 13) under a [`Programme`], and the results of each cycle.
//!
//! In a block of constant amplitude and frequency a tick is short, and equally long for every motion and all coefficients. It
//! advances the phase within a 16th of the cycle, a *sector*, and checks only for its overflow. Rare work is done at the end of a
//! sector: the fold of the sum, the end of a cycle, and, one by one, the steps to the results of the cycle before. After a swap of
//! the law the ticks are longer while its table is filled. Ramps and sweeps, and blocks with less than 16 ticks per cycle, use
//! [`SineGenerator`] and [`CycleAccumulator`], and take some hundred instructions.
//!
//! # Energy of a demanded sine
//! With y = A·sin φ, ΔW = ∮F dy = A·ω·∫F·cos φ dt. The integrand is the same at both ends of the cycle. The sum over the ticks,
//! corrected for the incomplete first and last tick, is therefore more accurate than trapezoids of any order. Let a and e be the
//! parts of a tick between the cycle's beginning, or its end, and the next tick. Let P be F·cos φ at φ = 0, where its rate g is
//! k1·A·ω per second:
//!
//! ΔW = A·ω·Δt·(ΣP + P·(a − e) + g·Δt/2·(e·(1 − e) − a·(1 − a))).
//!
//! Eq 13 is odd, so that the smallest force is the negative of the largest, and the means are 0.

use core::borrow::Borrow;

use crate::cycle::{Cycle, CycleAccumulator};
use crate::effects::Motion;
use crate::error::ConfigError;
use crate::fast_law::{FastLaw, RunningLaw};
use crate::limits;
use crate::sine::{
    Programme, SECTOR, SECTOR_ROUNDING, SECTORS, Sector, SineGenerator, SteadyBlock,
};
use crate::sum::Sum;

/// The first sector with a step at whose beginning the velocity is no longer positive, and the last at whose beginning it is not
/// yet positive.
const RISEN: usize = SECTORS / 4 + 1;
const FALLEN: usize = 3 * SECTORS / 4 - 1;

/// State of a tick in a steady block.
#[derive(Clone, Copy, Debug)]
struct Walk {
    /// Phase of the last tick within the sector, [`SECTOR`] per sector, with [`SECTOR_ROUNDING`] added.
    phase: u64,
    /// Increment of the phase per tick.
    increment: u64,
    sector: Sector,
    /// Bits of the largest force, kN: positive floats compare like integers, and are above the negative ones.
    force_max: i32,
    /// A·ω, mm/s.
    speed: f32,
    /// k1·A, kN.
    linear: f32,
    /// k3·A³, kN.
    cubic: f32,
    /// ΣF·cos φ, kN.
    work: Sum,
}

/// How a tick that is not short is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Stage {
    /// By the generator.
    #[default]
    Programme,
    /// In a steady block while the table is filled; phase and increment are not in [`Walk`].
    Filling,
    /// In a steady block, at the end of a sector.
    Steady,
}

/// Further state for the results of a steady cycle.
#[derive(Clone, Copy, Debug, Default)]
struct Steady {
    stage: Stage,
    /// Another law waits for the end of `cycles`.
    waiting: bool,
    /// `beginning` belongs to the law before.
    law_taken: bool,
    /// Number of the sector.
    sector: usize,
    /// Phase and increment while the table is filled.
    parked: [u64; 2],
    /// Cycles until work is due at the end of one, and from then until the end of the block.
    cycles: u32,
    cycles_after: u32,
    /// Cycles of the block, and those completed at its end.
    cycles_of_block: u32,
    cycles_then: u32,
    /// A, mm.
    amplitude: f32,
    /// Ticks per unit of the phase's upper half, and the same less a millionth.
    per_phase: f32,
    short_per_phase: f32,
    /// A·ω·Δt, mm.
    stroke: f32,
    /// 1/A, 1/mm.
    per_amplitude: f32,
    /// P and g·Δt/2 at the beginning of the cycle, kN.
    beginning: [f32; 2],
    /// a.
    begun: f32,
    /// For that cycle: its sum, and the upper half of the phase of the tick after it.
    work: Sum,
    ended: u32,
    results: Cycle,
    /// The largest force before the velocity became negative.
    held: i32,
}

/// The law under a programme of up to `B` blocks, which the simulation owns or borrows.
#[derive(Clone, Debug)]
// The fields used on every tick come first, within the offset of a load.
#[repr(C)]
pub struct Simulation<const B: usize, P = Programme<B>> {
    walk: Walk,
    steady: Steady,
    law: RunningLaw<0>,
    generator: SineGenerator<B, P>,
    accumulator: CycleAccumulator<1>,
    results: Cycle,
    completed: u32,
    ramp: bool,
    done: bool,
    /// Of the last tick that the generator computed, mm.
    displacement: f32,
}

impl<const B: usize, P: Borrow<Programme<B>>> Simulation<B, P> {
    /// A simulation at rest, at the start of `programme`.
    ///
    /// # Errors
    /// [`ConfigError::Empty`] for a programme without a block.
    pub fn new(programme: P, law: FastLaw<0>) -> Result<Self, ConfigError> {
        let generator = SineGenerator::new(programme)?;
        Ok(Self {
            walk: Walk::PARKED,
            law: RunningLaw::new(law),
            steady: Steady::default(),
            generator,
            accumulator: CycleAccumulator::new(),
            results: Cycle::default(),
            completed: 0,
            ramp: true,
            done: false,
            displacement: 0.0,
        })
    }

    /// Sets a law that takes over at the end of this cycle.
    pub fn swap_law(&mut self, law: FastLaw<0>) {
        self.law.swap(law);
        let steady = &mut self.steady;
        if steady.stage != Stage::Programme && !steady.waiting {
            steady.waiting = true;
            steady.cycles_after = steady.cycles.saturating_sub(1);
            steady.cycles = 1;
        }
    }

    /// The running law.
    pub fn law(&self) -> &FastLaw<0> {
        self.law.law()
    }

    /// Cycles completed up to the last tick, ramps included.
    pub fn cycle(&self) -> u32 {
        let Steady {
            cycles,
            cycles_after,
            cycles_then,
            ..
        } = self.steady;
        cycles_then.wrapping_sub(cycles).wrapping_sub(cycles_after)
    }

    /// Displacement of the last tick, mm. It is computed here, so that a tick whose displacement nobody needs is short.
    pub fn displacement(&self) -> f32 {
        let phase = match self.steady.stage {
            Stage::Programme => return self.displacement,
            Stage::Filling => self.steady.parked[0],
            Stage::Steady => self.walk.phase,
        };
        let (sin, _) = self.walk.sector.sin_cos(phase);
        self.steady.amplitude * sin
    }

    /// Number of cycles with results, and the results of the last one. In a steady block they are complete thirteen sectors after
    /// the cycle's end, so that no tick bears the whole computation.
    pub fn results(&self) -> (u32, &Cycle) {
        (self.completed, &self.results)
    }

    /// Whether a law has taken over and its table is being filled. Until then a tick takes two and a half times as long.
    pub fn filling(&self) -> bool {
        self.law.is_filling()
    }

    /// Whether the last tick was in a ramp.
    pub fn ramp(&self) -> bool {
        self.ramp
    }

    /// Whether the programme is over: the force stays 0.
    pub fn done(&self) -> bool {
        self.done
    }

    /// The force in kN at the next tick; the first tick is at rest.
    #[inline]
    pub fn tick(&mut self) -> f32 {
        self.walk.phase = self.walk.phase.wrapping_add(self.walk.increment);
        if self.walk.phase >= SECTOR {
            return self.attend();
        }
        self.walk.sample(&self.law)
    }

    /// The forces in kN at the next ticks, like repeated calls of [`Simulation::tick`], at a lower cost.
    pub fn block(&mut self, forces: &mut [f32]) {
        let mut forces = forces;
        loop {
            let short = self.short_ticks().min(forces.len());
            let (run, rest) = forces.split_at_mut(short);
            if self.rises() {
                self.walk.run::<true>(&self.law, run);
            } else {
                self.walk.run::<false>(&self.law, run);
            }
            let Some((force, rest)) = rest.split_first_mut() else {
                return;
            };
            *force = self.tick();
            forces = rest;
        }
    }

    /// Whether the velocity is positive or about to be. The largest force is there: damping makes it larger than at the same
    /// displacement on the way back.
    #[inline(always)]
    fn rises(&self) -> bool {
        !(RISEN..FALLEN).contains(&self.steady.sector)
    }

    /// Number of ticks certain to come before the end of the sector; there are hardly more.
    #[inline(always)]
    fn short_ticks(&self) -> usize {
        if self.steady.stage != Stage::Steady {
            return 0;
        }
        let ahead = (SECTOR - 1).saturating_sub(self.walk.phase) >> 32;
        (ahead as u32 as f32 * self.steady.short_per_phase) as usize
    }

    /// A tick that is not short.
    #[cold]
    #[inline(never)]
    fn attend(&mut self) -> f32 {
        if self.steady.stage != Stage::Steady {
            return self.attend_other();
        }
        if self.sector_ends() {
            return self.attend_boundary();
        }
        self.walk.sample(&self.law)
    }

    /// The first tick of a cycle at whose beginning work is due.
    #[inline(never)]
    fn attend_boundary(&mut self) -> f32 {
        let steady = &mut self.steady;
        steady.cycles = core::mem::take(&mut steady.cycles_after);
        if steady.cycles == 0 {
            return self.block_ends();
        }
        (steady.waiting, steady.law_taken) = (false, true);
        self.law.boundary();
        self.take_law();
        self.fill()
    }

    #[inline(never)]
    fn attend_other(&mut self) -> f32 {
        if self.steady.stage == Stage::Programme {
            return self.programme_tick();
        }
        let [phase, increment] = self.steady.parked;
        self.walk.phase = phase.wrapping_add(increment);
        if self.walk.phase >= SECTOR && self.sector_ends() {
            self.walk.increment = increment;
            return self.attend_boundary();
        }
        self.fill()
    }

    /// A tick that fills one of the table's rows.
    #[inline(always)]
    fn fill(&mut self) -> f32 {
        let (elastic, cos) = self.walk.elastic();
        let speed = self.walk.speed * cos;
        self.law.fill(speed);
        let force = self.law.add_damping_force(elastic, speed);
        self.walk.account(force, cos);
        self.park();
        force
    }

    /// Takes phase and increment out of the walk while the table is filled, so that no tick is short.
    #[inline(always)]
    fn park(&mut self) {
        let [parked, increment] = &mut self.steady.parked;
        if self.law.is_filling() {
            *parked = self.walk.phase;
            self.walk.phase = Walk::PARKED.phase;
            self.walk.increment = Walk::PARKED.increment;
            self.steady.stage = Stage::Filling;
        } else {
            self.walk.increment = *increment;
            self.steady.stage = Stage::Steady;
        }
    }

    /// The walk has entered the next sector. Returns whether more than the law's force is due.
    #[inline(always)]
    fn sector_ends(&mut self) -> bool {
        self.walk.phase &= SECTOR - 1;
        self.steady.sector = (self.steady.sector + 1) % SECTORS;
        self.walk.sector = Sector::new(self.steady.sector);
        if self.steady.sector == 0 {
            return self.cycle_ends();
        }
        self.walk.work.fold();
        if self.steady.sector % 2 == 1 {
            self.step(self.steady.sector);
        }
        false
    }

    /// The walk has entered the next cycle. Returns whether it differs from the last one.
    #[inline(always)]
    fn cycle_ends(&mut self) -> bool {
        let steady = &mut self.steady;
        steady.work = self.walk.work;
        steady.ended = (self.walk.phase >> 32) as u32;
        steady.results.force_max = f32::from_bits(self.walk.force_max as u32);
        self.walk.work = Sum::ZERO;
        self.walk.force_max = 0;
        steady.cycles = steady.cycles.wrapping_sub(1);
        steady.cycles == 0
    }

    /// Does one step towards the results of the cycle before, and of this one: at the beginning of every other sector.
    #[inline(never)]
    fn step(&mut self, sector: usize) {
        let steady = &mut self.steady;
        let results = &mut steady.results;
        // In the block's first cycle there are no results to compute.
        let first = steady.cycles.wrapping_add(steady.cycles_after) == steady.cycles_of_block;
        match sector {
            1 if !first => {
                let ended = steady.ended as f32 * steady.per_phase;
                let [level, half_rate] = steady.beginning;
                let begun = core::mem::replace(&mut steady.begun, ended);
                // e·(1 − e) − a·(1 − a) = (e − a)·(1 − e − a).
                let part = ended - begun;
                steady
                    .work
                    .add(part * (half_rate * (1.0 - ended - begun) - level));
            }
            3 => {
                results.energy = steady.stroke * steady.work.total();
                results.energy_harmonic = results.energy;
            }
            7 => {
                results.force_min = -results.force_max;
                results.stiffness = results.force_max * steady.per_amplitude;
                results.elastic_energy = 0.5 * results.force_max * steady.amplitude;
            }
            9 => {
                results.loss_factor = if results.elastic_energy > f32::MIN_POSITIVE {
                    results.energy / (core::f32::consts::TAU * results.elastic_energy)
                } else {
                    0.0
                };
            }
            13 if !first => {
                self.results = *results;
                self.completed = self.completed.wrapping_add(1);
            }
            RISEN => steady.held = self.walk.force_max,
            FALLEN => self.walk.force_max = steady.held,
            15 if steady.law_taken => self.begin_cycle(),
            _ => {}
        }
    }

    /// P and g at phase 0 for the running law.
    fn begin_cycle(&mut self) {
        let half_rate = 0.5 * self.law.law().augmented().law().k1() * self.steady.stroke;
        self.steady.beginning = [self.law.damping_force(self.walk.speed), half_rate];
        self.steady.law_taken = false;
    }

    /// The running law for the block's amplitude.
    fn take_law(&mut self) {
        let law = self.law.law().augmented().law();
        let amplitude = self.steady.amplitude;
        self.walk.linear = law.k1() * amplitude;
        self.walk.cubic = law.k3() * (amplitude * amplitude) * amplitude;
    }

    /// A tick computed by the generator.
    #[inline(never)]
    fn programme_tick(&mut self) -> f32 {
        self.walk.phase = Walk::PARKED.phase;
        let now = self.generator.tick();
        if now.cycle_end {
            self.law.boundary();
        }
        (self.ramp, self.done) = (now.ramp, now.done);
        self.displacement = now.displacement;
        self.steady.cycles_then = now.cycle;
        let force = self.law.force(&Motion::at(now.displacement, now.velocity));
        if let Some([cycle]) = self
            .accumulator
            .update(now.displacement, [force], now.phase)
        {
            self.results = cycle;
            self.completed = self.completed.wrapping_add(1);
        }
        if let Some(block) = self.generator.steady_begun() {
            self.block_begins(&block, force);
        }
        force
    }

    /// From the block's first tick on, whose force is known, the walk is short.
    fn block_begins(&mut self, block: &SteadyBlock, force: f32) {
        let increment = block.increment.saturating_add(1 << (PHASE_SHIFT - 1)) >> PHASE_SHIFT;
        let speed = block.amplitude * block.angular;
        if increment >= u128::from(SECTOR) || speed > limits::VELOCITY as f32 {
            return;
        }
        let phase = (block.phase >> PHASE_SHIFT).saturating_add(u128::from(SECTOR_ROUNDING));
        let increment = increment as u64;
        let sector = (phase >> SECTOR.ilog2()) as usize;
        self.walk = Walk {
            phase: phase as u64 & (SECTOR - 1),
            increment,
            sector: Sector::new(sector),
            speed,
            ..Walk::PARKED
        };
        let per_phase = (1u64 << 32) as f32 / increment as f32;
        // Ticks per cycle.
        let ticks = SECTORS as f32 * (SECTOR as f32 / increment as f32);
        let stroke = core::f32::consts::TAU * block.amplitude / ticks;
        self.steady = Steady {
            sector,
            parked: [0, increment],
            cycles: block.cycles,
            cycles_of_block: block.cycles,
            cycles_then: self.steady.cycles_then.wrapping_add(block.cycles),
            amplitude: block.amplitude,
            per_phase,
            short_per_phase: per_phase * (1.0 - 1e-6),
            stroke,
            per_amplitude: 1.0 / block.amplitude,
            begun: (phase >> 32) as f32 * per_phase,
            results: Cycle {
                displacement_max: block.amplitude,
                displacement_min: -block.amplitude,
                amplitude: block.amplitude,
                ticks,
                ..Cycle::default()
            },
            ..Steady::default()
        };
        self.take_law();
        self.begin_cycle();
        let (_, cos) = self.walk.elastic();
        self.walk.account(force, cos);
        self.park();
    }

    /// The tick after the block, computed by the generator again. The cycle from here on begins with the block's last tick.
    #[inline(never)]
    fn block_ends(&mut self) -> f32 {
        for sector in [1, 3, 7, 9, 13] {
            self.step(sector);
        }
        // The last tick was in the last sector.
        let mut last = self.walk;
        last.sector = Sector::new(SECTORS - 1);
        last.phase = (last.phase + SECTOR).saturating_sub(last.increment);
        let (sin, cos) = last.sector.sin_cos(last.phase);
        let (elastic, _) = last.elastic();
        let force = elastic + self.law.damping_force(last.speed * cos);
        let phase = ((SECTORS as u64 - 1) << 32 | last.phase >> 31) >> SECTORS.ilog2();
        self.accumulator.reset();
        self.accumulator
            .update(self.steady.amplitude * sin, [force], phase as u32);
        let past = self.walk.phase.saturating_sub(SECTOR_ROUNDING);
        self.generator.steady_ended(u128::from(past) << PHASE_SHIFT);
        self.walk = Walk::PARKED;
        self.steady = Steady::default();
        self.programme_tick()
    }
}

/// Bits by which a phase of 2¹²⁸ per cycle is finer than a phase within a sector.
const PHASE_SHIFT: u32 = 128 - SECTORS.ilog2() - SECTOR.ilog2();

impl Walk {
    /// With these values every tick ends a sector.
    const PARKED: Self = Self {
        phase: 0,
        increment: SECTOR,
        sector: Sector::FIRST,
        force_max: 0,
        speed: 0.0,
        linear: 0.0,
        cubic: 0.0,
        work: Sum::ZERO,
    };

    /// Ticks that all come before the end of the sector.
    // Not inlined, because it needs every register.
    #[inline(never)]
    fn run<const RISES: bool>(&mut self, law: &RunningLaw<0>, forces: &mut [f32]) {
        let mut walk = *self;
        for force in forces {
            walk.phase = walk.phase.wrapping_add(walk.increment);
            let (elastic, cos) = walk.elastic();
            *force = law.add_damping_force(elastic, walk.speed * cos);
            walk.work.add(*force * cos);
            if RISES {
                walk.see(*force);
            }
        }
        *self = walk;
    }

    /// One tick at its phase.
    #[inline(always)]
    fn sample(&mut self, law: &RunningLaw<0>) -> f32 {
        let (elastic, cos) = self.elastic();
        let force = law.add_damping_force(elastic, self.speed * cos);
        self.account(force, cos);
        force
    }

    /// k1·y + k3·y³ in kN, and cos φ.
    #[inline(always)]
    fn elastic(&self) -> (f32, f32) {
        let (sin, cos) = self.sector.sin_cos(self.phase);
        (sin * (self.linear + self.cubic * (sin * sin)), cos)
    }

    #[inline(always)]
    fn account(&mut self, force: f32, cos: f32) {
        self.work.add(force * cos);
        self.see(force);
    }

    #[inline(always)]
    fn see(&mut self, force: f32) {
        self.force_max = self.force_max.max(force.to_bits() as i32);
    }
}
