//! The sums in f32 against the same sums in f64, and over many ticks.

use core::f64::consts::{PI, TAU};

use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;
use proptest::prelude::*;

use crate::support::{near, sine, u32_phase, update};

/// The accumulator's sums in f64, without compensation.
#[derive(Default, Clone)]
struct Plain {
    energy: f64,
    force: (f64, f64),
    displacement: (f64, f64),
    harmonics: [f64; 4],
    mean: (f64, f64),
    ticks: f64,
    last: Option<(f64, f64, f64)>,
    whole: bool,
}

impl Plain {
    fn add(&mut self, (y0, f0, p0): (f64, f64, f64), (y1, f1, p1): (f64, f64, f64), time: f64) {
        self.energy += 0.5 * (f0 + f1) * (y1 - y0);
        self.force = (self.force.0.max(f1), self.force.1.min(f1));
        self.displacement = (self.displacement.0.max(y1), self.displacement.1.min(y1));
        self.mean.0 += 0.5 * (f0 + f1) * time;
        self.mean.1 += 0.5 * (y0 + y1) * time;
        self.ticks += time;
        let ((s0, c0), (s1, c1)) = ((TAU * p0).sin_cos(), (TAU * p1).sin_cos());
        let products = [
            (y0 * s0, y1 * s1),
            (y0 * c0, y1 * c1),
            (f0 * s0, f1 * s1),
            (f0 * c0, f1 * c1),
        ];
        for (sum, (a, b)) in self.harmonics.iter_mut().zip(products) {
            *sum += (a + b) * (p1 - p0);
        }
    }

    fn start(&mut self, (y, f, _): (f64, f64, f64)) {
        *self = Self {
            force: (f, f),
            displacement: (y, y),
            last: self.last,
            whole: true,
            ..Self::default()
        };
    }

    /// ΔW, ΔW₁, K, η, mean force, mean displacement, ticks
    fn finish(&self) -> [f64; 7] {
        let amplitude = (self.displacement.0 - self.displacement.1) / 2.0;
        let stiffness = (self.force.0 - self.force.1) / (2.0 * amplitude);
        let [ys, yc, fs, fc] = self.harmonics;
        let loss = self.energy / (PI * stiffness * amplitude * amplitude);
        let harmonic = PI * (fc * ys - fs * yc);
        [
            self.energy,
            harmonic,
            stiffness,
            loss,
            self.mean.0 / self.ticks,
            self.mean.1 / self.ticks,
            self.ticks,
        ]
    }

    fn update(&mut self, y: f64, f: f64, phase: f64) -> Option<[f64; 7]> {
        let now = (y, f, phase);
        let Some(last) = self.last.replace(now) else {
            self.start(now);
            self.whole = phase == 0.0;
            return None;
        };
        if phase >= last.2 {
            self.add(last, now, 1.0);
            return None;
        }
        let part = (1.0 - last.2) / (1.0 - last.2 + phase);
        let (middle_y, middle_f) = (last.0 + part * (y - last.0), last.1 + part * (f - last.1));
        self.add(last, (middle_y, middle_f, 1.0), part);
        let cycle = self.whole.then(|| self.finish());
        self.start((middle_y, middle_f, 0.0));
        self.add((middle_y, middle_f, 0.0), now, 1.0 - part);
        cycle
    }
}

fn compare(cycle: &Cycle, exact: &[f64; 7], amplitude: f64, what: &str) {
    let [
        energy,
        harmonic,
        stiffness,
        loss,
        mean_force,
        mean_displacement,
        ticks,
    ] = *exact;
    let peak = stiffness * amplitude;
    near(cycle.energy, energy, 1e-6 * energy, &format!("{what}: ΔW"));
    near(
        cycle.energy_harmonic,
        harmonic,
        1e-6 * harmonic,
        &format!("{what}: ΔW₁"),
    );
    near(
        cycle.stiffness,
        stiffness,
        1e-6 * stiffness,
        &format!("{what}: K"),
    );
    near(cycle.loss_factor, loss, 1e-6 * loss, &format!("{what}: η"));
    near(
        cycle.mean_force,
        mean_force,
        1e-6 * peak,
        &format!("{what}: mean force"),
    );
    near(
        cycle.mean_displacement,
        mean_displacement,
        1e-6 * amplitude,
        &format!("{what}: mean displacement"),
    );
    near(cycle.ticks, ticks, 1e-6 * ticks, &format!("{what}: ticks"));
}

proptest! {
    /// One rounding of each sample (6e-8), of each product, and of the sums (2.4e-7 for sixteen terms at worst): together within 1e-6
    /// of f64 on the same samples.
    #[test]
    fn the_same_samples_in_f64(
        per_cycle in 100.0f64..3_000.0,
        k in 0.2f64..10.0,
        k3 in 0.0f64..200.0,
        c in 0.02f64..0.7,
        alpha in 0.15f64..0.6,
        amplitude in 0.05f64..0.25,
        shift in 0.0f64..1.0,
    ) {
        let law = Law::new(k, k3, c / (k * amplitude).recip().max(1.0), alpha).unwrap();
        let (mut accumulator, mut plain) = (CycleAccumulator::new(), Plain::default());
        let mut compared = 0;
        for n in 0..(4.0 * per_cycle) as u64 {
            let phase = u32_phase(n as f64 / per_cycle);
            let (sin, cos) = (TAU * (n as f64 / per_cycle + shift)).sin_cos();
            let y = (amplitude * sin) as f32;
            let f = law.force(amplitude * sin, amplitude * TAU * cos) as f32;
            let cycle = update(&mut accumulator, y, f, phase);
            let exact = plain.update(f64::from(y), f64::from(f), f64::from(phase) / 2f64.powi(32));
            prop_assert_eq!(cycle.is_some(), exact.is_some());
            if let (Some(cycle), Some(exact)) = (cycle, exact) {
                // ΔW and ΔW₁ are sums of terms that are larger by 1/η: their rounding errors are larger by the same factor.
                prop_assume!(exact[3] > 0.15);
                compare(&cycle, &exact, amplitude, "same samples");
                compared += 1;
            }
        }
        prop_assert_eq!(compared, 3);
    }
}

#[test]
fn every_cell_of_the_table_in_f32_is_the_f64() {
    // Generator, law and accumulator in f32 against the closed-form sine, the law and plain sums in f64, at 10 kHz and
    // 1 Hz.
    let rate = 10_000.0;
    for (density, node) in PAPER
        .densities()
        .flat_map(|density| PAPER.amplitudes().map(move |a| (density, a)))
    {
        let law32 = PAPER.lookup(density, node).law;
        let law = law32.cast::<f64>();
        let amplitude = f64::from(node);
        let peak = law
            .force(amplitude, 0.0)
            .max(law.force(0.0, TAU * amplitude));
        let programme = Programme::<1>::new(rate, 1).unwrap();
        let programme = programme
            .with(Block::sine(amplitude, 1.0, 3).unwrap())
            .unwrap();
        let mut generator = SineGenerator::new(programme).unwrap();
        let (mut accumulator, mut plain) = (CycleAccumulator::new(), Plain::default());
        let mut compared = 0;
        for n in 0u64.. {
            let tick = generator.tick();
            if tick.done {
                break;
            }
            let force = law32.force(tick.displacement, tick.velocity);
            let cycle = update(&mut accumulator, tick.displacement, force, tick.phase);
            let phase = (n % 10_000) as f64 / rate;
            let (sin, cos) = (TAU * phase).sin_cos();
            // The cosine in f64 is 6e-17 where it should be 0, and |v|^α would amplify that.
            let cos = if n % 10_000 == 2_500 || n % 10_000 == 7_500 {
                0.0
            } else {
                cos
            };
            let exact_force = law.force(amplitude * sin, amplitude * TAU * cos);
            if !tick.ramp {
                // In the order of their size: |v|^α 3e-7, sine and amplitude 1e-7 each, three sums and products.
                near(force, exact_force, 1e-6 * peak, "force");
            }
            let exact = plain.update(amplitude * sin, exact_force, phase);
            if (2..=4).contains(&tick.cycle)
                && let (Some(cycle), Some(exact)) = (cycle, exact)
            {
                compare(
                    &cycle,
                    &exact,
                    amplitude,
                    &format!("{density} g/cm³, {amplitude} mm"),
                );
                compared += 1;
            }
        }
        assert_eq!(compared, 3);
    }
}

#[test]
fn a_long_run_does_not_drift() {
    // Exactly 50 ticks a cycle: the last of 200 000 cycles equals the first, bit for bit.
    let mut accumulator = CycleAccumulator::new();
    let samples: Vec<_> = (0..50).map(|n| sine(f64::from(n) / 50.0)).collect();
    let mut first = None;
    let mut found = 0;
    for n in 0..=200_000 * 50u64 {
        let (y, v) = samples[(n % 50) as usize];
        let phase = (((n % 50) << 32) / 50) as u32;
        if let Some(cycle) = update(
            &mut accumulator,
            y as f32,
            (3.0 * y + 0.2 * v) as f32,
            phase,
        ) {
            assert_eq!(*first.get_or_insert(cycle), cycle);
            found += 1;
        }
    }
    assert_eq!(found, 200_000);
}

#[test]
fn ten_million_ticks_in_one_cycle() {
    // Plain f32 sums stop growing here: at 10⁷ ticks a term is 1e-7 of the sum.
    let n = 10_000_000u64;
    let mut accumulator = CycleAccumulator::new();
    let cycle = (0..=n)
        .find_map(|i| {
            let (sin, cos) = (TAU * i as f64 / n as f64).sin_cos();
            let phase = ((i << 32) / n) as u32;
            update(
                &mut accumulator,
                sin as f32,
                (sin + 0.5 * cos + 2.0) as f32,
                phase,
            )
        })
        .unwrap();
    // The rounding of the displacement is 6e-8 of X0, much more than its step. It cancels in the sum, except for the force's own
    // step.
    near(cycle.energy, 0.5 * PI, 1e-6 * PI, "ΔW");
    near(cycle.energy_harmonic, 0.5 * PI, 1e-6 * PI, "ΔW₁");
    near(cycle.mean_force, 2.0, 2e-6, "mean force");
}
