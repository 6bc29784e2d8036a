//! Closed motions that a seed draws, and the energy that a law gives out in them.

use std::f64::consts::TAU;

use mesh_damper::effects::description::Energy;
use mesh_damper::effects::{AugmentedLaw, CONTROLS, Effect, Motion};
use mesh_damper::fast_law::{FastLaw, RunningLaw};

/// SplitMix64.
#[derive(Clone, Debug)]
pub struct Draw(pub u64);

impl Draw {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        for (shift, factor) in [(30, 0xbf58_476d_1ce4_e5b9), (27, 0x94d0_49bb_1331_11eb)] {
            mixed = (mixed ^ (mixed >> shift)).wrapping_mul(factor);
        }
        mixed ^ (mixed >> 31)
    }

    /// 0 to 1, without 1.
    pub fn part(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.part()
    }

    /// 0 to `count` − 1.
    pub fn place(&mut self, count: usize) -> usize {
        (self.part() * count as f64) as usize
    }
}

/// A motion of a few harmonics within a range of displacement and velocity, with constant other inputs: from 0 mm over one period,
/// one period at full amplitude, and back to 0 over the third.
#[derive(Clone, Debug)]
pub struct Drawn {
    middle: f64,
    /// Multiple of the period's frequency, amplitude in mm, phase.
    tones: Vec<(f64, f64, f64)>,
    /// rad/s
    omega: f64,
    /// Part of the speed at which a law runs that does not depend on the tick.
    slowed: f64,
    inputs: Motion<f32>,
}

impl Drawn {
    /// Within `displacement` mm, which holds 0, and ±`speed` mm/s: from a seventh of the one and a third of the other on. A law
    /// without effects is run at as little as 1e-5 of that speed.
    pub fn new(draw: &mut Draw, displacement: [f64; 2], speed: f64) -> Self {
        let [low, high] = displacement;
        let half = 0.5 * (high - low) * draw.between(0.15, 1.0);
        let middle = draw.between(low + half, high - half);
        let harmonics: &[f64] = match draw.place(4) {
            0 => &[1.0],
            1 => &[1.0, 2.0],
            2 => &[1.0, 3.0],
            _ => &[1.0, 2.0, 3.0],
        };
        let tones: Vec<_> = harmonics
            .iter()
            .map(|harmonic| {
                let amplitude = draw.between(0.2, 1.0) / harmonic;
                (*harmonic, amplitude, draw.between(0.0, TAU))
            })
            .collect();
        let reach: f64 = tones.iter().map(|(_, amplitude, _)| amplitude).sum();
        let scale = half / reach;
        let slope: f64 = tones.iter().map(|(n, amplitude, _)| n * amplitude).sum();
        // The ramp adds twice the largest displacement in a period.
        let ramp = (middle.abs() + half) / (0.5 * TAU);
        let omega = speed * draw.between(0.3, 1.0) / (scale * slope + ramp);
        let slowed = 10f64.powf(draw.between(-5.0, 0.0));
        let scaled = |(n, amplitude, phase)| (n, scale * amplitude, phase);
        let control = || draw.between(0.0, 2.0) as f32;
        let controls: Vec<f32> = std::iter::repeat_with(control).take(CONTROLS).collect();
        let inputs = Motion {
            cycles: draw.place(3) as f32 * 50.0,
            temperature: draw.between(-60.0, 200.0) as f32,
            controls: controls.try_into().unwrap(),
            ..Motion::default()
        };
        Self {
            middle,
            tones: tones.into_iter().map(scaled).collect(),
            omega,
            slowed,
            inputs,
        }
    }

    /// Ticks of a period at `rate` Hz.
    pub fn ticks(&self, rate: f64) -> usize {
        (TAU / self.omega * rate).round() as usize
    }

    /// After this many periods, 0 to 3.
    fn at(&self, periods: f64) -> Motion<f32> {
        let sum = |of: &dyn Fn(f64, f64, f64) -> f64| -> f64 {
            let tones = self.tones.iter();
            tones
                .map(|&(n, amplitude, phase)| {
                    of(n * self.omega, amplitude, TAU * n * periods + phase)
                })
                .sum()
        };
        let [y, v, a] = [
            self.middle + sum(&|_, amplitude, angle| amplitude * angle.sin()),
            sum(&|omega, amplitude, angle| amplitude * omega * angle.cos()),
            sum(&|omega, amplitude, angle| -amplitude * omega * omega * angle.sin()),
        ];
        // s − sin(2πs)/2π and its derivatives.
        let (side, s) = match periods {
            ..1.0 => (1.0, periods),
            2.0.. => (-1.0, 3.0 - periods),
            _ => (1.0, 1.0),
        };
        let turn = TAU * s;
        let slope = self.omega / TAU;
        let [r, r1, r2] = [
            s - turn.sin() / TAU,
            side * slope * (1.0 - turn.cos()),
            slope * self.omega * turn.sin(),
        ];
        Motion {
            displacement: (r * y) as f32,
            velocity: (r1 * y + r * v) as f32,
            acceleration: (r2 * y + 2.0 * r1 * v + r * a) as f32,
            ..self.inputs
        }
    }

    /// Runs `law` through it from rest, at `rate` Hz.
    pub fn run<const N: usize>(&self, law: &FastLaw<N>, rate: f64) -> Run {
        let mut running = RunningLaw::new(law.clone());
        let ticks = self.ticks(rate);
        // As if its ticks were further apart: the work of an effect may depend on how far they are.
        let is_alone = law.augmented().effects().next().is_none();
        let slowed = if is_alone { self.slowed as f32 } else { 1.0 };
        let mut run = Run::default();
        let [mut energy, mut moved] = [0.0; 2];
        let mut before = (0.0, 0.0);
        let mut rise = 0.0;
        for tick in 0..=3 * ticks {
            let mut motion = self.at(tick as f64 / ticks as f64);
            motion.velocity *= slowed;
            motion.acceleration *= slowed * slowed;
            let (y, force) = (
                f64::from(motion.displacement),
                f64::from(running.force(&motion)),
            );
            let work = 0.5 * (force + before.1) * (y - before.0);
            // Where the force has a corner within a tick, as at a contact, the trapezoid is off by at most that.
            let bend = force - before.1 - rise;
            energy += work + 0.125 * (bend * (y - before.0)).abs();
            moved += work.abs();
            rise = force - before.1;
            before = (y, force);
            let sizes = [motion.displacement, motion.velocity, motion.acceleration];
            for (most, size) in run.most.iter_mut().zip(sizes) {
                *most = f64::from(size.abs()).max(*most);
            }
            run.force = force.abs().max(run.force);
        }
        run.energy = energy / moved.max(f64::MIN_POSITIVE);
        run
    }
}

/// What a law gave along a motion.
#[derive(Clone, Copy, Debug, Default)]
pub struct Run {
    /// ∫F dy as a part of ∫|F dy|, the error of its trapezoids added. A law that cannot supply energy has stored none at rest, so that
    /// this is not below 0.
    pub energy: f64,
    /// The largest force, kN.
    pub force: f64,
    /// The largest displacement, velocity and acceleration, mm, mm/s and mm/s².
    pub most: [f64; 3],
}

/// `law` without the parts that no check judges: effects that supply energy by their nature, and a spring in series beside other
/// effects than a dashpot, which it solves for, and a mass, which is not behind it: it takes their forces from the tick before.
pub fn judged<const N: usize>(law: &FastLaw<N>) -> FastLaw<N> {
    let whole = law.augmented();
    let is_solved = whole.effects().all(|effect| {
        matches!(
            effect,
            Effect::Compliance(_) | Effect::Viscous(_) | Effect::Inertia(_)
        )
    });
    let is_judged = |effect: &Effect<f32>| match effect {
        Effect::Compliance(_) => is_solved,
        other => other.description().energy != Energy::Active,
    };
    if whole.effects().all(|effect| is_judged(&effect)) {
        // As it is, with the table of its damping.
        return law.clone();
    }
    let alone = AugmentedLaw::new(*whole.law());
    let mut effects = whole.effects().filter(is_judged);
    let judged = effects.try_fold(alone, AugmentedLaw::with).unwrap();
    FastLaw::new(match whole.residual_table() {
        Some(table) => judged.with_residual_table(*table).unwrap(),
        None => judged,
    })
}
