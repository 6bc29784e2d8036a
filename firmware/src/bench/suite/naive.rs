//! The whole tick in its obvious form, with libm: a sine, a cosine and a power per tick, and sums in plain f32.
//!
//! It gives the results of [`mesh_damper::simulation`], and leaves out the same ones, which a sine and an odd law make known: means
//! and harmonics, and the displacement's extremes. `hil/trials/bench/peer.c` is the same in C, line by line.

use core::f32::consts::TAU;

use mesh_damper::cycle::Cycle;
use mesh_damper::law::Law;

use super::tally::{Region, When};

#[derive(Clone, Copy, Default)]
struct Sample {
    displacement: f32,
    force: f32,
}

/// Trapezoids over the cycle so far, without their factor ½.
#[derive(Clone, Copy, Default)]
struct Sums {
    energy: f32,
    force_max: f32,
    force_min: f32,
}

impl Sums {
    fn start(at: Sample) -> Self {
        Self {
            energy: 0.0,
            force_max: at.force,
            force_min: at.force,
        }
    }

    /// Adds the trapezoid from `a` to `b`.
    #[inline(always)]
    fn add(&mut self, a: Sample, b: Sample) {
        self.energy += (a.force + b.force) * (b.displacement - a.displacement);
        if b.force > self.force_max {
            self.force_max = b.force;
        }
        if b.force < self.force_min {
            self.force_min = b.force;
        }
    }

    fn finish(&self, amplitude: f32) -> Cycle {
        let range = self.force_max - self.force_min;
        let energy = 0.5 * self.energy;
        let elastic_energy = 0.25 * range * amplitude;
        Cycle {
            force_max: self.force_max,
            force_min: self.force_min,
            displacement_max: amplitude,
            displacement_min: -amplitude,
            amplitude,
            energy,
            energy_harmonic: energy,
            stiffness: range / (2.0 * amplitude),
            elastic_energy,
            loss_factor: energy / (TAU * elastic_energy),
            ..Cycle::default()
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
    /// The cycle that ended with the last tick.
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
            cycle: None,
        }
    }

    /// The moment of the last tick.
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
        let damping = self.c * libm::powf(v.abs(), self.alpha);
        let force = self.k1 * y + self.k3 * y * y * y + if v < 0.0 { -damping } else { damping };
        let now = Sample {
            displacement: y,
            force,
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
            };
            self.sums.add(last, middle);
            self.cycle = Some(self.sums.finish(self.amplitude));
            self.sums = Sums::start(middle);
            self.sums.add(middle, now);
        } else {
            self.sums.add(self.last, now);
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
