//! The results of a cycle against closed forms; which cycles are reported, and that their values are finite.

use core::f64::consts::{PI, TAU};

use mesh_damper::crossing::CrossingAccumulator;
use mesh_damper::cycle::{Cycle, CycleAccumulator};
use proptest::prelude::*;

use crate::support::{
    MotionAt, lagging, near, run, sine, tolerance, two_harmonics, u32_phase, update,
};

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
            // cω/k, except that K of eq 3 includes the dashpot's share.
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

/// ln Γ(x) for x ≥ 1 by Stirling's series from x + 10 down; the remainder is below 1e-12.
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
        // The offset force does work over the small gap between the ends of the cycle, 0.7·0.1·(2π/n)²/8.
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

proptest! {
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

proptest! {
    /// Cycles may end anywhere between two samples, and one after the other: each result is finite, and a mean lies between the
    /// extremes or is that of a cycle without a length.
    #[test]
    fn a_boundary_is_anywhere(
        samples in prop::collection::vec(
            (
                -1e12f32..1e12,
                -1e4f32..1e4,
                any::<u32>(),
                prop_oneof![
                    Just(None), Just(Some(0.0f32)), Just(Some(-0.0)), Just(Some(1.0)), Just(Some(1e-40)),
                    Just(Some(1e-45)), Just(Some(f32::MIN_POSITIVE)), Just(Some(-0.5)), Just(Some(f32::NAN)),
                    Just(Some(7.0)), (0.0..1.0f32).prop_map(Some),
                ],
            ),
            3..60,
        ),
    ) {
        let mut accumulator = CycleAccumulator::<1>::new();
        for (force, displacement, phase, boundary) in samples {
            let Some([cycle]) = accumulator.update_at(displacement, [force], phase, boundary) else {
                continue;
            };
            prop_assert!(cycle.values().iter().all(|value| value.is_finite()), "{:?}", cycle);
            prop_assert!(cycle.ticks >= 0.0, "{:?}", cycle);
            if cycle.ticks > 1e-30 {
                let near = |mean: f32, low: f32, high: f32| {
                    let margin = 1e-5 * low.abs().max(high.abs());
                    mean >= low - margin && mean <= high + margin
                };
                prop_assert!(near(cycle.mean_force, cycle.force_min, cycle.force_max), "{:?}", cycle);
                prop_assert!(
                    near(cycle.mean_displacement, cycle.displacement_min, cycle.displacement_max),
                    "{:?}", cycle
                );
            }
        }
    }
}

/// Two ends with 1e-40 of a tick between them: the reciprocal of that is infinite.
#[test]
fn a_cycle_without_a_length_has_means_of_0() {
    let mut accumulator = CycleAccumulator::<1>::new();
    accumulator.update_at(0.1, [1.0], 0, None);
    accumulator.update_at(0.2, [2.0], 1 << 30, Some(1.0));
    let [cycle] = accumulator
        .update_at(0.3, [3.0], 1 << 31, Some(1e-40))
        .unwrap();
    assert_eq!((cycle.mean_force, cycle.mean_displacement), (0.0, 0.0));
    assert!(
        cycle.values().iter().all(|value| value.is_finite()),
        "{cycle:?}"
    );
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
    // After a quarter, the current cycle is not complete; the next one is.
    let found: Vec<_> = (25..250).filter_map(|n| at(f64::from(n) / 100.0)).collect();
    assert_eq!(found.len(), 1);
    near(found[0].ticks, 100.0, 1e-4, "ticks");

    // A generator that stays at 0 does not lengthen the next cycle.
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
