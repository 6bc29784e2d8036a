//! The cycle accumulator against closed forms, and against the same sums in f64.

use core::f64::consts::{PI, TAU};
use mesh_damper::crossing::{CrossingAccumulator, CrossingDetector, SWINGS};
use mesh_damper::cycle::{Cycle, CycleAccumulator};
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::table::PAPER;
use proptest::prelude::*;

/// One motion: displacement and velocity in mm and mm/s at a phase in cycles, for a frequency of 1 Hz.
type MotionAt = fn(f64) -> (f64, f64);

fn sine(phase: f64) -> (f64, f64) {
    let (sin, cos) = (TAU * phase).sin_cos();
    (0.1 * sin, 0.1 * TAU * cos)
}

/// Sine and third harmonic.
fn two_harmonics(phase: f64) -> (f64, f64) {
    let (sin, cos) = (TAU * phase).sin_cos();
    let (sin3, cos3) = (3.0 * TAU * phase).sin_cos();
    (0.1 * sin + 0.03 * sin3, TAU * (0.1 * cos + 0.09 * cos3))
}

/// Lags the generator by 40° and rides on an offset.
fn lagging(phase: f64) -> (f64, f64) {
    let (y, v) = sine(phase - 40.0 / 360.0);
    (y + 0.5, v)
}

fn u32_phase(cycles: f64) -> u32 {
    (cycles.fract() * 2f64.powi(32)) as u32
}

/// `cycles` whole cycles at `per_cycle` ticks each (any number), from phase 0 on.
fn run(
    motion: MotionAt,
    force: impl Fn(f64, f64) -> f64,
    per_cycle: f64,
    cycles: usize,
) -> Vec<Cycle> {
    let mut accumulator = CycleAccumulator::new();
    let ticks = (per_cycle * cycles as f64).ceil() as usize;
    let found: Vec<_> = (0..=ticks)
        .filter_map(|n| {
            let phase = n as f64 / per_cycle;
            let (y, v) = motion(phase);
            update(
                &mut accumulator,
                y as f32,
                force(y, v) as f32,
                u32_phase(phase),
            )
        })
        .collect();
    assert_eq!(found.len(), cycles);
    found
}

/// [`CycleAccumulator::update`] of one force.
fn update(
    accumulator: &mut CycleAccumulator<1>,
    displacement: f32,
    force: f32,
    phase: u32,
) -> Option<Cycle> {
    let cycles = accumulator.update(displacement, [force], phase);
    cycles.map(|[cycle]| cycle)
}

fn near(is: f32, exact: f64, tolerance: f64, what: &str) {
    assert!(
        (f64::from(is) - exact).abs() <= tolerance,
        "{what}: {is} instead of {exact} ± {tolerance:e}"
    );
}

/// Of a smooth motion at n ticks a cycle: (2π/n)²/6 of the trapezoids, (π/n)²/2 of the extremes, and where the tick
/// is split (2π/n)²/8 at both ends; of f32: 6e-8 in each sample's rounding, 2.4e-7 of sixteen terms. Twice that.
fn tolerance(per_cycle: f64) -> f64 {
    let step = TAU / per_cycle;
    2.0 * (step * step * (1.0 / 6.0 + 1.0 / 8.0 + 1.0 / 4.0) + 3e-7)
}

#[test]
fn spring_and_dashpot() {
    let (k, c, amplitude) = (3.0, 0.2, 0.1);
    let loss = c * TAU;
    for per_cycle in [10_000.0, 1_234.567, 10_000.0 / 7.0, 333.3] {
        for cycle in run(sine, |y, v| k * y + c * v, per_cycle, 5) {
            let near =
                |is, exact: f64, what| near(is, exact, tolerance(per_cycle) * exact.abs(), what);
            let stiffness = k.hypot(loss);
            near(cycle.stiffness, stiffness, "K");
            near(cycle.amplitude, amplitude, "X0");
            near(cycle.energy, PI * loss * amplitude * amplitude, "ΔW");
            near(
                cycle.energy_harmonic,
                PI * loss * amplitude * amplitude,
                "ΔW₁",
            );
            near(
                cycle.elastic_energy,
                0.5 * stiffness * amplitude * amplitude,
                "W",
            );
            // cω/k but for eq 3, whose K holds the dashpot's share.
            near(cycle.loss_factor, loss / stiffness, "η");
            near(cycle.ticks, per_cycle, "ticks");
            near(cycle.force_max, stiffness * amplitude, "F_max");
            near(cycle.force_min, -stiffness * amplitude, "F_min");
        }
    }
}

#[test]
fn coulomb_friction() {
    let (friction, amplitude) = (0.05, 0.1);
    for per_cycle in [10_000.0, 1_234.567] {
        for cycle in run(sine, |_, v| friction * v.signum(), per_cycle, 3) {
            // The force jumps within a tick at both ends of the stroke, where y moves by at most X0·(2π/n)²/2.
            let exact = 4.0 * friction * amplitude;
            near(
                cycle.energy,
                exact,
                exact * (tolerance(per_cycle) + (TAU / per_cycle).powi(2)),
                "ΔW",
            );
            assert_eq!(
                (cycle.force_max, cycle.force_min),
                (friction as f32, -friction as f32)
            );
        }
    }
}

/// ln Γ(x) for x ≥ 1 by Stirling's series from x + 10 down; what it leaves out is below 1e-12.
fn gamma(x: f64) -> f64 {
    let shifted = x + 10.0;
    let series =
        1.0 / (12.0 * shifted) - 1.0 / (360.0 * shifted.powi(3)) + 1.0 / (1260.0 * shifted.powi(5));
    let large = (TAU / shifted).sqrt() * (shifted / 1f64.exp()).powf(shifted) * series.exp();
    (0..10).fold(large, |value, i| value / (x + f64::from(i)))
}

#[test]
fn power_law_damping() {
    let (c, amplitude) = (0.11, 0.1);
    for alpha in [0.16, 0.33, 0.56, 1.0] {
        // ∮c|v|^α sgn v dy = 4·c·X0·(ωX0)^α·∫cos^(1+α) over a quarter = 2√π·c·X0·(ωX0)^α·Γ(α/2+1)/Γ(α/2+3/2)
        let exact = 2.0
            * PI.sqrt()
            * c
            * amplitude
            * f64::powf(TAU * amplitude, alpha)
            * gamma(alpha / 2.0 + 1.0)
            / gamma(alpha / 2.0 + 1.5);
        for per_cycle in [10_000.0, 1_428.571] {
            for cycle in run(
                sine,
                |y, v| y + c * v.abs().powf(alpha) * v.signum(),
                per_cycle,
                3,
            ) {
                // At the ends of the stroke F is singular as |t|^α: the trapezoid there misses about F·v·h with v ~ h.
                let singular =
                    2.0 * (TAU / per_cycle).powf(2.0 + alpha) + (TAU / per_cycle).powi(2);
                near(
                    cycle.energy,
                    exact,
                    exact * (tolerance(per_cycle) + singular),
                    "ΔW",
                );
            }
        }
    }
}

#[test]
fn a_nonlinear_spring_takes_no_energy() {
    for motion in [sine as MotionAt, two_harmonics, lagging] {
        for per_cycle in [10_000.0, 1_234.567] {
            let mut turned = 0.0;
            for cycle in run(motion, |y, _| 2.0 * y + 150.0 * y * y * y, per_cycle, 5) {
                let elastic = f64::from(cycle.elastic_energy);
                near(
                    cycle.energy,
                    0.0,
                    elastic * (4.0 * tolerance(per_cycle)),
                    "ΔW",
                );
                turned += f64::from(cycle.energy);
            }
            assert!(turned.abs() < 5.0 * tolerance(per_cycle));
        }
    }
}

#[test]
fn a_motion_that_is_no_sine() {
    let c = 0.2;
    for cycle in run(two_harmonics, |y, v| 3.0 * y + c * v, 1_234.567, 4) {
        // π·c·ω·Σ n²·a_n²
        let first = PI * c * TAU * 0.01;
        let exact = first + PI * c * TAU * 9.0 * 0.0009;
        // The third harmonic has a third of the ticks.
        near(
            cycle.energy,
            exact,
            exact * 9.0 * tolerance(1_234.567),
            "ΔW",
        );
        near(
            cycle.energy_harmonic,
            first,
            first * tolerance(1_234.567),
            "ΔW₁",
        );
    }
}

#[test]
fn a_displacement_that_lags_the_generator() {
    let (k, c, offset) = (3.0, 0.2, 0.7);
    for cycle in run(lagging, |y, v| k * (y - 0.5) + c * v + offset, 1_234.567, 4) {
        let exact = PI * c * TAU * 0.01;
        // The offset force turns with the small gap between the ends of the cycle, 0.7·0.1·(2π/n)²/8.
        let gap = (TAU / 1_234.567f64).powi(2) * offset * 0.1;
        near(
            cycle.energy,
            exact,
            exact * tolerance(1_234.567) + gap,
            "ΔW",
        );
        near(
            cycle.energy_harmonic,
            exact,
            exact * tolerance(1_234.567),
            "ΔW₁",
        );
        near(cycle.mean_force, offset, tolerance(1_234.567), "mean force");
        near(
            cycle.mean_displacement,
            0.5,
            tolerance(1_234.567),
            "mean displacement",
        );
    }
}

/// The accumulator's sums in f64, plainly.
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
    /// One rounding of each sample (6e-8), of each product, and of the sums (2.4e-7 of sixteen terms at the worst):
    /// together within 1e-6 of f64 on the same samples.
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
                // ΔW and ΔW₁ are sums of terms that are larger by 1/η: their roundings weigh as much more.
                prop_assume!(exact[3] > 0.15);
                compare(&cycle, &exact, amplitude, "same samples");
                compared += 1;
            }
        }
        prop_assert_eq!(compared, 3);
    }

    #[test]
    fn energy_scales_and_elastic_force_adds_none(
        per_cycle in 500.0f64..2_000.0,
        shift in 0.0f64..1.0,
        k in -5.0f64..5.0,
        factor in 0.1f64..100.0,
    ) {
        let run = |k: f64, factor: f64, shift: f64| {
            let mut accumulator = CycleAccumulator::new();
            (0..(2.0 * per_cycle) as u64).find_map(|n| {
                let (y, v) = sine(n as f64 / per_cycle + shift);
                let force = factor * (0.3 * v + k * y + 10.0 * k * y * y * y);
                update(&mut accumulator, y as f32, force as f32, u32_phase(n as f64 / per_cycle))
            }).unwrap()
        };
        let plain = run(0.0, 1.0, 0.0);
        let exact = f64::from(plain.energy);
        let elastic = 0.1 * 0.1 * k.abs() * 1.2;
        let allowed = tolerance(per_cycle) * (exact + 2.0 * elastic);
        near(run(k, 1.0, shift).energy, exact, allowed, "elastic and shifted");
        near(run(k, 1.0, shift).energy_harmonic, exact, allowed, "elastic and shifted, first harmonic");
        near(run(k, factor, 0.0).energy, factor * exact, factor * allowed, "scaled");
    }

    #[test]
    fn finite_whatever_comes(
        samples in prop::collection::vec((prop::num::f32::ANY, prop::num::f32::ANY), 40..200),
        hysteresis in 1e-6f32..1e3,
    ) {
        let finite = |cycle: Cycle| {
            let all = [
                cycle.force_max, cycle.force_min, cycle.displacement_max, cycle.displacement_min, cycle.amplitude,
                cycle.energy, cycle.energy_harmonic, cycle.stiffness, cycle.elastic_energy, cycle.loss_factor,
                cycle.mean_force, cycle.mean_displacement, cycle.ticks,
            ];
            all.iter().all(|value| value.is_finite())
        };
        let mut by_phase = CycleAccumulator::new();
        let mut by_crossing = CrossingAccumulator::new(hysteresis).unwrap();
        let mut seen = 0;
        for (n, (y, f)) in samples.into_iter().enumerate() {
            if let Some(cycle) = update(&mut by_phase, y, f, u32_phase(n as f64 / 7.3)) {
                prop_assert!(finite(cycle), "{:?}", cycle);
                seen += 1;
            }
            if let Some(cycle) = by_crossing.update(y, f) {
                prop_assert!(finite(cycle), "{:?}", cycle);
            }
        }
        prop_assert!(seen >= 5);
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
            // f64's own cosine is 6e-17 where it ought to be 0, and |v|^α would blow that up.
            let cos = if n % 10_000 == 2_500 || n % 10_000 == 7_500 {
                0.0
            } else {
                cos
            };
            let exact_force = law.force(amplitude * sin, amplitude * TAU * cos);
            if !tick.ramp {
                // In the order of their weight: |v|^α 3e-7, sine and amplitude 1e-7 each, three sums and products.
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
    // 50 ticks a cycle exactly: the last of 200 000 cycles is the first, bit for bit.
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
    // A displacement's rounding is 6e-8 of X0, much more than its step, yet falls out of the sum but for the force's
    // own step.
    near(cycle.energy, 0.5 * PI, 1e-6 * PI, "ΔW");
    near(cycle.energy_harmonic, 0.5 * PI, 1e-6 * PI, "ΔW₁");
    near(cycle.mean_force, 2.0, 2e-6, "mean force");
}

#[test]
fn degenerate_cycles_have_defined_results() {
    let still = run(|_| (0.25, 0.0), |_, _| 1.5, 40.0, 3);
    for cycle in still {
        assert_eq!(
            (
                cycle.stiffness,
                cycle.elastic_energy,
                cycle.loss_factor,
                cycle.energy
            ),
            (0.0, 0.0, 0.0, 0.0)
        );
        near(cycle.mean_force, 1.5, 1e-6, "mean force");
        near(cycle.mean_displacement, 0.25, 1e-6, "mean displacement");
    }
    let forceless = run(sine, |_, _| 0.0, 40.0, 3);
    for cycle in forceless {
        assert_eq!(
            (
                cycle.stiffness,
                cycle.elastic_energy,
                cycle.loss_factor,
                cycle.energy
            ),
            (0.0, 0.0, 0.0, 0.0)
        );
        assert!(cycle.amplitude > 0.099);
    }
}

#[test]
fn forces_over_one_displacement_are_as_each_alone() {
    let mut both = CycleAccumulator::<2>::new();
    let mut alone = [CycleAccumulator::<1>::new(); 2];
    let mut compared = 0;
    for n in 0..1_000 {
        let phase = f64::from(n) / 137.3;
        let (y, v) = sine(phase);
        let (y, phase) = (y as f32, u32_phase(phase));
        let forces = [(2.0 * y + v as f32), 0.3 - v as f32];
        let cycles = both.update(y, forces, phase);
        for (index, accumulator) in alone.iter_mut().enumerate() {
            let cycle = update(accumulator, y, forces[index], phase);
            assert_eq!(cycles.map(|cycles| cycles[index]), cycle);
            compared += usize::from(cycle.is_some());
        }
    }
    assert_eq!(compared, 2 * 7);
}

#[test]
fn only_whole_cycles_are_given() {
    let mut accumulator = CycleAccumulator::new();
    let mut at = |phase: f64| {
        let (y, v) = sine(phase);
        update(&mut accumulator, y as f32, v as f32, u32_phase(phase))
    };
    // From a quarter on, the cycle under way is no whole one; the next is.
    let found: Vec<_> = (25..250).filter_map(|n| at(f64::from(n) / 100.0)).collect();
    assert_eq!(found.len(), 1);
    near(found[0].ticks, 100.0, 1e-4, "ticks");

    // A generator that holds at 0 does not lengthen the cycle that follows.
    accumulator.reset();
    let held = (0..500)
        .filter_map(|_| update(&mut accumulator, 0.0, 0.0, 0))
        .count();
    assert_eq!(held, 0);
    let first = (1..=100).find_map(|n| {
        update(
            &mut accumulator,
            sine(f64::from(n) / 100.0).0 as f32,
            0.0,
            u32_phase(f64::from(n) / 100.0),
        )
    });
    near(first.unwrap().ticks, 100.0, 1e-4, "ticks after the hold");
}

/// Small noise that repeats itself, within ±1.
fn noise(n: u64) -> f64 {
    let mixed = (n ^ (n >> 3))
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .rotate_left(29)
        .wrapping_mul(0xBF58_476D_1CE4_E5B9);
    (mixed >> 11) as f64 / 2f64.powi(52) - 1.0
}

#[test]
fn cycles_by_zero_crossing_are_those_by_phase() {
    let (k, c) = (3.0, 0.2);
    for (per_cycle, offset) in [(1_000.0, 0.0), (1_234.567, 0.7), (87.3, -3.0)] {
        let mut accumulator = CrossingAccumulator::new(0.02).unwrap();
        let mut found = Vec::new();
        for n in 0..(12.0 * per_cycle) as u64 {
            let (y, v) = sine(n as f64 / per_cycle + 0.37);
            found.extend(accumulator.update((y + offset) as f32, (k * y + c * v) as f32));
        }
        assert!((8..=10).contains(&found.len()), "{}", found.len());
        let exact = PI * c * TAU * 0.01;
        for cycle in found {
            // The displacement's rounding weighs with the offset.
            let allowed = tolerance(per_cycle) + 1e-6 * f64::abs(offset);
            near(cycle.energy, exact, exact * allowed, "ΔW");
            near(cycle.energy_harmonic, exact, exact * allowed, "ΔW₁");
            near(cycle.ticks, per_cycle, per_cycle * allowed, "ticks");
            near(
                cycle.mean_displacement,
                offset,
                0.1 * allowed + 3e-7 * f64::abs(offset),
                "mean displacement",
            );
            near(
                cycle.stiffness,
                k.hypot(c * TAU),
                k * allowed + 4e-6 * f64::abs(offset),
                "K",
            );
        }
    }
}

#[test]
fn noise_makes_no_cycles_of_its_own() {
    let mut accumulator = CrossingAccumulator::new(0.02).unwrap();
    let mut found = Vec::new();
    let per_cycle = 1_000.0;
    for n in 0..20_000u64 {
        let (y, v) = sine(n as f64 / per_cycle + 0.1);
        found.extend(accumulator.update(
            (y + 0.005 * noise(n) + 0.2) as f32,
            (3.0 * y + 0.2 * v) as f32,
        ));
    }
    assert!((16..=18).contains(&found.len()), "{}", found.len());
    for cycle in &found {
        // A crossing is off by the noise over the slope: 0.005/(0.1·2π) of a cycle = 8 ticks, twice.
        near(cycle.ticks, per_cycle, 17.0, "ticks");
        // Σ n·ΔF over 1000 ticks, n of 0.005/√3 and ΔF of 2π/1000·0.33/√2 RMS: 1.3e-4, four of them.
        near(cycle.energy, PI * 0.2 * TAU * 0.01, 6e-4, "ΔW");
    }
    // Noise alone stays within the hysteresis.
    accumulator.reset();
    assert_eq!(
        (0..20_000)
            .filter_map(|n| accumulator.update((0.009 * noise(n)) as f32, 1.0))
            .count(),
        0
    );
}

#[test]
fn crossings_follow_a_change_of_period_and_mean() {
    let mut accumulator = CrossingAccumulator::new(0.02).unwrap();
    let mut phase = 0.0;
    let mut found = Vec::new();
    for n in 0..40_000 {
        let per_cycle = if n < 20_000 { 1_000.0 } else { 613.7 };
        phase += 1.0 / per_cycle;
        let drift = f64::from(n) * 5e-7;
        let (y, v) = sine(phase);
        found.extend(accumulator.update((y + drift) as f32, (0.2 * v) as f32));
    }
    assert_eq!(found.len(), 19 - 2 + 32);
    // One tick of drift is 5e-7/(2π·0.1/n) of a tick's motion.
    near(found.first().unwrap().ticks, 1_000.0, 2.0, "ticks at first");
    near(found.last().unwrap().ticks, 613.7, 1.5, "ticks at last");
    near(
        found.last().unwrap().mean_displacement,
        0.02,
        4e-4,
        "mean at last",
    );
}

/// The boundaries' ticks in `cycles` cycles of 0.1 mm at 1000 ticks each, `disturbance` added.
fn boundaries(cycles: u32, disturbance: impl Fn(u32) -> f64) -> Vec<u32> {
    let mut detector = CrossingDetector::new(0.01).unwrap();
    (0..cycles * 1_000)
        .filter(|&n| {
            let y = sine(f64::from(n) / 1_000.0).0 + disturbance(n);
            detector.update(y as f32).boundary.is_some()
        })
        .collect()
}

/// Swings to see the loss, the rest of that cycle, one to the first crossing, two whole ones to the first boundary.
const RECOVERY: u32 = (SWINGS as u32 + 1 + 1 + 2) * 1_000;

#[test]
fn crossings_come_back_after_the_mean_has_jumped_by_more_than_the_amplitude() {
    for jump in [0.15, -0.15, 3.0, -3.0] {
        // At several phases of the cycle, with and without a period known by then.
        for at in [300, 20_000, 20_250, 20_500, 20_870] {
            let found = boundaries(60, |n| if n < at { 0.0 } else { jump });
            let after: Vec<_> = found.iter().filter(|&&n| n > at + 1_000).collect();
            let first = **after.first().unwrap();
            assert!(first <= at + RECOVERY, "{jump} at {at}: {first}");
            // Every cycle from there on. The first two may still begin and end at different means, of which the first
            // is a midpoint; two ticks for the f32 of the mean.
            let mut lengths = after.windows(2).map(|w| w[1] - w[0]);
            assert!(lengths.by_ref().take(2).all(|n| (980..=1_020).contains(&n)));
            assert!(lengths.all(|n| (998..=1_002).contains(&n)));
            assert!(60_000 - **after.last().unwrap() <= 1_002);
        }
    }
}

#[test]
fn crossings_come_back_after_a_wild_sample() {
    for wild in [1.0, -1.0, 1e4] {
        for at in [0, 1, 500, 20_400] {
            let found = boundaries(60, |n| if n == at { wild } else { 0.0 });
            let first = *found.iter().find(|&&n| n > at + 1_000).unwrap();
            // A crossing in the middle of a run takes the wild sample into its mean: a cycle more.
            assert!(first <= at + RECOVERY + 1_000, "{wild} at {at}: {first}");
            assert!(60_000 - found.last().unwrap() <= 1_002);
        }
    }
}

#[test]
fn no_cycle_spans_a_jump_of_the_mean() {
    let mut accumulator = CrossingAccumulator::new(0.02).unwrap();
    let mut found = Vec::new();
    for n in 0..40_000 {
        let (y, v) = sine(f64::from(n) / 1_000.0);
        let mean = if n < 20_250 { 0.0 } else { 0.5 };
        found.extend(accumulator.update((y + mean) as f32, (0.2 * v) as f32));
    }
    assert!((25..=34).contains(&found.len()), "{}", found.len());
    for cycle in found {
        near(cycle.ticks, 1_000.0, 1.0, "ticks");
        near(cycle.amplitude, 0.1, 1e-4, "X0");
    }
}

#[test]
fn a_hysteresis_that_makes_no_sense_is_refused() {
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(CrossingAccumulator::new(bad).is_err());
    }
}

/// The first way, down from 20, is no swing though nothing has gone up before it; each of the others ends at 10.
#[test]
fn a_mean_is_lost_with_the_last_of_its_swings_and_not_before() {
    let mut detector = CrossingDetector::new(0.1).unwrap();
    for y in [20.0, 15.0, 10.0] {
        assert!(!detector.update(y).lost);
    }
    for swing in 1..=SWINGS {
        assert!(!detector.update(14.0).lost);
        assert_eq!(detector.update(10.0).lost, swing == SWINGS, "{swing}");
    }
}
