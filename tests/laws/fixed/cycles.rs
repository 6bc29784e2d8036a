//! Cycles in integers against f64, their closed forms and the polygon of their samples.

use std::f64::consts::{PI, TAU};

use mesh_damper::fixed_point::{CycleAccumulator, Part, RawCycle, Scales, Sine};
use mesh_damper::law;
use mesh_damper_reference::{dynamic_test, tables};
use proptest::prelude::*;

use super::{TICK_RATE, cycles_of, law_of, part, tolerance, value};
use crate::largest::Largest;

/// Against 10 000 samples a cycle and complete cycles in f64. At 1.37 Hz a cycle is not a whole number of ticks.
#[test]
fn stiffness_energy_and_loss_factor_are_f64s_within_a_ten_thousandth() {
    let [mut stiffness, mut energy, mut loss_factor] = [const { Largest(0.0) }; 3];
    let mut peak = Largest(0.0);
    for (_, amplitude, exact) in tables::cells() {
        for frequency in [0.5, 1.0, 1.37, 10.0] {
            let speed = TAU * frequency * amplitude;
            let law = law_of(exact);
            let scale = tolerance::SCALE;
            let scales = Scales::covering(&law, scale * amplitude, scale * speed).unwrap();
            let (y, force): (Vec<f64>, Vec<f64>) = (0..10_000)
                .map(|i| (TAU * f64::from(i) / 10_000.0).sin_cos())
                .map(|(sin, cos)| (amplitude * sin, exact.force(amplitude * sin, speed * cos)))
                .unzip();
            let exact = dynamic_test::characterize(&y, &force).unwrap();
            let sine = Sine {
                amplitude,
                frequency,
                cycles: 3,
                ramp_cycles: 1,
            };
            let cycles = cycles_of(&law, &scales, sine);
            assert_eq!(cycles.len(), 3);
            for cycle in cycles {
                stiffness.see(f64::from(cycle.stiffness) / exact.stiffness - 1.0);
                energy.see(f64::from(cycle.energy) / exact.dissipated - 1.0);
                loss_factor.see(f64::from(cycle.loss_factor) / exact.loss_factor - 1.0);
                peak.see(f64::from(cycle.amplitude) / amplitude - 1.0);
            }
        }
    }
    stiffness.check("K", tolerance::STIFFNESS);
    energy.check("ΔW", tolerance::ENERGY);
    loss_factor.check("loss factor", tolerance::LOSS_FACTOR);
    peak.check("X0", tolerance::POSITION);
}

/// k1·y, c·v and c·sgn v enclose 0, π·c·ω·A² and 4·c·A. 997 Hz gives ten ticks a cycle, none of which is at its end.
#[test]
fn a_cycle_encloses_the_energy_of_its_closed_form() {
    let amplitude = 0.2;
    for frequency in [0.1, 1.3, 97.0, 997.0] {
        let omega = TAU * frequency;
        let sine = Sine {
            amplitude,
            frequency,
            cycles: 4,
            ramp_cycles: 1,
        };
        let energies = |k1: f64, c: f64, alpha: f64| {
            let law = law::Law::new(k1, 0.0, c, alpha).unwrap();
            let scales = Scales::covering(&law, 0.25, 0.25 * omega).unwrap();
            cycles_of(&law, &scales, sine)
        };
        for cycle in energies(5.0, 0.0, 1.0) {
            // Forces of 1 kN over 0.8 mm, each rounded to 16 bits.
            assert!(cycle.energy.abs() < 1e-5 * 0.8, "{cycle:?}");
        }
        // The polygon of n samples has sin(2π/n)/(2π/n) of an ellipse's area; at its closing point it may lack one more part.
        let ticks = TICK_RATE / frequency;
        let lacks = (TAU / ticks).powi(2);
        for cycle in energies(0.0, 2.0, 1.0) {
            let exact = PI * 2.0 * omega * amplitude * amplitude;
            let error = f64::from(cycle.energy) / exact - 1.0;
            assert!(error.abs() < 3e-5 + lacks, "{frequency} Hz: {error:e}");
        }
        // A reversal at fractions a and b of a tick from its neighbours lacks (a² + b²)/2·(2π/n)² of c·A. For two reversals and 4·c·A
        // this is at most (2π/n)²/4.
        for cycle in energies(0.0, 2.0, 0.0) {
            let error = f64::from(cycle.energy) / (4.0 * 2.0 * amplitude) - 1.0;
            assert!(
                error.abs() < 5e-5 + lacks / 4.0,
                "{frequency} Hz: {error:e}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// For any samples: nothing overflows, the extremes are those of the samples, and the energy is that of their polygon, except for
    /// the force's 16 bits and half a unit a tick.
    #[test]
    fn the_energy_is_that_of_the_polygon(
        samples in prop::collection::vec((part(), part()), 1..50),
    ) {
        let mut accumulator = CycleAccumulator::new();
        for (i, &(y, f)) in samples.iter().enumerate() {
            prop_assert_eq!(accumulator.update(y, f, i == 0), None);
        }
        let cycle = accumulator.update(Part::ZERO, Part::ZERO, true).unwrap();
        let (mut exact, mut path) = (0.0, 0.0);
        for (i, &(y, f)) in samples.iter().enumerate() {
            let (next_y, next_f) = samples[(i + 1) % samples.len()];
            let way = value(next_y) - value(y);
            exact += 0.5 * (value(f) + value(next_f)) * way;
            path += way.abs();
        }
        let count = samples.len() as f64;
        let energy = cycle.energy as f64 / f64::from(1 << 29);
        let tolerance = path * 2_f64.powi(-15) + count * 2_f64.powi(-29);
        prop_assert!((energy - exact).abs() <= tolerance, "{energy} for {exact}");
        let extremes = |of: fn(&(Part, Part)) -> Part| {
            let parts = samples.iter().map(of);
            (parts.clone().max().unwrap(), parts.min().unwrap())
        };
        prop_assert_eq!((cycle.displacement_max, cycle.displacement_min), extremes(|s| s.0));
        prop_assert_eq!((cycle.force_max, cycle.force_min), extremes(|s| s.1));
    }

    #[test]
    fn every_cycle_is_finite(
        energy in any::<i64>(),
        y in (part(), part()),
        f in (part(), part()),
        scales in prop::sample::select(vec![(1e-9, 1e-9), (1e-9, 1e12), (1.0, 1.0), (1e4, 1e-9), (1e4, 1e12)]),
    ) {
        let raw = RawCycle {
            energy,
            force_max: f.0.max(f.1),
            force_min: f.0.min(f.1),
            displacement_max: y.0.max(y.1),
            displacement_min: y.0.min(y.1),
        };
        let cycle = raw.over(&Scales::new(scales.0, 1.0, scales.1).unwrap());
        for value in [cycle.amplitude, cycle.energy, cycle.stiffness, cycle.elastic_energy, cycle.loss_factor] {
            prop_assert!(value.is_finite(), "{cycle:?}");
        }
    }
}
