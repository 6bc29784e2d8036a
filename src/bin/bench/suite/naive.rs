//! The whole tick as it is written down first, on libm: a sine, a cosine and a power a tick, sums in plain f32.
//!
//! `hil/bench/peer.c` is the same in C, line by line.

use core::f32::consts::{PI, TAU};

use mesh_damper::cycle::Cycle;
use mesh_damper::law::Law;

use super::tally::{Region, When};

/// One sample with what the harmonics need of it.
#[derive(Clone, Copy, Default)]
struct Sample {
    displacement: f32,
    force: f32,
    sin: f32,
    cos: f32,
}

/// Trapezoids over the cycle so far, without their factor ½.
#[derive(Clone, Copy, Default)]
struct Sums {
    energy: f32,
    force: f32,
    displacement: f32,
    displacement_sin: f32,
    displacement_cos: f32,
    force_sin: f32,
    force_cos: f32,
    force_max: f32,
    force_min: f32,
    displacement_max: f32,
    displacement_min: f32,
    ticks: f32,
}

impl Sums {
    fn start(at: Sample) -> Self {
        Self {
            force_max: at.force,
            force_min: at.force,
            displacement_max: at.displacement,
            displacement_min: at.displacement,
            ..Self::default()
        }
    }

    /// The way from `a` to `b` in `time` ticks.
    #[inline(always)]
    fn add(&mut self, a: Sample, b: Sample, time: f32) {
        self.energy += (a.force + b.force) * (b.displacement - a.displacement);
        self.force += (a.force + b.force) * time;
        self.displacement += (a.displacement + b.displacement) * time;
        self.displacement_sin += (a.displacement * a.sin + b.displacement * b.sin) * time;
        self.displacement_cos += (a.displacement * a.cos + b.displacement * b.cos) * time;
        self.force_sin += (a.force * a.sin + b.force * b.sin) * time;
        self.force_cos += (a.force * a.cos + b.force * b.cos) * time;
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
        self.ticks += time;
    }

    fn finish(&self) -> Cycle {
        let amplitude = 0.5 * (self.displacement_max - self.displacement_min);
        let range = self.force_max - self.force_min;
        let energy = 0.5 * self.energy;
        let elastic_energy = 0.25 * range * amplitude;
        Cycle {
            force_max: self.force_max,
            force_min: self.force_min,
            displacement_max: self.displacement_max,
            displacement_min: self.displacement_min,
            amplitude,
            energy,
            energy_harmonic: PI
                * (self.force_cos * self.displacement_sin - self.force_sin * self.displacement_cos)
                / (self.ticks * self.ticks),
            stiffness: range / (2.0 * amplitude),
            elastic_energy,
            loss_factor: energy / (TAU * elastic_energy),
            mean_force: 0.5 * self.force / self.ticks,
            mean_displacement: 0.5 * self.displacement / self.ticks,
            ticks: self.ticks,
        }
    }
}

/// A steady sine, the law and the cycle under way.
pub struct Naive {
    phase: u32,
    /// Phase of a tick, 2³² to the cycle.
    step: u32,
    amplitude: f32,
    /// rad/s
    angular: f32,
    k1: f32,
    k3: f32,
    c: f32,
    alpha: f32,
    last: Sample,
    sums: Sums,
    begun: bool,
    /// mm/s²
    acceleration: f32,
    pub cycle: Option<Cycle>,
}

impl Naive {
    /// `law` under a sine of `amplitude` mm and `frequency` Hz.
    pub fn new(law: &Law<f32>, amplitude: f32, frequency: f64, tick_rate: f64) -> Self {
        Self {
            phase: 0,
            step: (frequency / tick_rate * (1u64 << 32) as f64) as u32,
            amplitude,
            angular: (core::f64::consts::TAU * frequency) as f32,
            k1: law.k1(),
            k3: law.k3(),
            c: law.c(),
            alpha: law.alpha(),
            last: Sample::default(),
            sums: Sums::default(),
            begun: false,
            acceleration: 0.0,
            cycle: None,
        }
    }

    /// What happened in the last tick.
    pub fn when(&self) -> When {
        if self.cycle.is_some() {
            When::CycleEnd
        } else {
            When::Steady
        }
    }

    #[inline(always)]
    fn tick(&mut self) -> f32 {
        let theta = self.phase as f32 * (TAU / (1u64 << 32) as f32);
        let (sin, cos) = (libm::sinf(theta), libm::cosf(theta));
        let y = self.amplitude * sin;
        let v = self.amplitude * self.angular * cos;
        self.acceleration = -(self.amplitude * self.angular * self.angular) * sin;
        let damping = self.c * libm::powf(v.abs(), self.alpha);
        let force = self.k1 * y + self.k3 * y * y * y + if v < 0.0 { -damping } else { damping };
        let now = Sample {
            displacement: y,
            force,
            sin,
            cos,
        };
        self.cycle = None;
        if !self.begun {
            self.begun = true;
            self.sums = Sums::start(now);
        } else if self.phase < self.step {
            // The cycle ended between the last tick and this one.
            let part = 1.0 - self.phase as f32 / self.step as f32;
            let last = self.last;
            let middle = Sample {
                displacement: last.displacement + part * (y - last.displacement),
                force: last.force + part * (force - last.force),
                sin: 0.0,
                cos: 1.0,
            };
            self.sums.add(last, middle, part);
            self.cycle = Some(self.sums.finish());
            self.sums = Sums::start(middle);
            self.sums.add(middle, now, 1.0 - part);
        } else {
            self.sums.add(self.last, now, 1.0);
        }
        self.last = now;
        self.phase = self.phase.wrapping_add(self.step);
        force
    }
}

extern "C" fn tick(naive: &mut Naive, _: f32, _: f32) -> f32 {
    naive.tick()
}

/// One tick.
pub const TICK: Region<Naive> = tick;
