//! One law for every amplitude: its error on the held-out loop, its passivity, and its use in the firmware.

use std::f64::consts::TAU;
use std::sync::OnceLock;

use mesh_damper::amplitude_independent;
use mesh_damper::effects::Motion;
use mesh_damper::fast_law::RunningLaw;
use mesh_damper::law::Law;
use mesh_damper_model::predict::nrmse;
use mesh_damper_paper::amplitude_independent::{HeldOut, Study, embedded_force, study, ticks_of};
use mesh_damper_rig::{EmulatorBench, EmulatorSetup};
use proptest::prelude::*;

const DOCS: &str = include_str!("../../../../docs/law.md");

/// Of the paper's test, and over the frequencies of the rig.
fn studies() -> &'static [Study; 2] {
    static STUDIES: OnceLock<[Study; 2]> = OnceLock::new();
    STUDIES
        .get_or_init(|| [&[1.0][..], &[1.0, 10.0]].map(|frequencies| study(frequencies).unwrap()))
}

fn figures(errors: &HeldOut) -> [f64; 5] {
    [
        errors.equation_13,
        errors.tables,
        errors.surfaces,
        errors.law,
        errors.loops,
    ]
}

/// The requirement is half of the mean error of one mixed law. The loops do not permit it: interpolation between those on either side, with
/// the amplitude known and no law at all, leaves two thirds, and the law is nearly as good.
#[test]
fn the_held_out_amplitude_is_told_better_than_by_one_eq_13() {
    let [at_1_hz, over_frequencies] = studies();
    let mean = at_1_hz.mean(0);
    assert!(mean.law < 0.77 * mean.equation_13, "{mean:?}");
    assert!(mean.loops > 0.65 * mean.equation_13, "{mean:?}");
    assert!(mean.law < 0.65 * mean.tables && mean.law < 0.6 * mean.surfaces);
    for study in [at_1_hz, over_frequencies] {
        let of_3 = study
            .densities
            .iter()
            .find(|one| one.density == 3.0)
            .unwrap();
        assert!(of_3.held_out[0].law < 0.08, "{:?}", of_3.held_out);
    }
    let mean = over_frequencies.mean(0);
    assert!(mean.law < 0.65 * mean.equation_13, "{mean:?}");
}

/// Rows of `docs/law.md`: the first cells describe, the others are five errors in %.
#[test]
fn the_docs_tell_these_errors() {
    let [at_1_hz, over_frequencies] = studies();
    let mut expected: Vec<(String, [f64; 5])> = Vec::new();
    for one in &at_1_hz.densities {
        expected.push((format!("| {:.1} |", one.density), figures(&one.held_out[0])));
    }
    expected.push(("| mean |".to_owned(), figures(&at_1_hz.mean(0))));
    for (index, told) in ["1 Hz", "10 Hz"].iter().enumerate() {
        let of = format!("| mean, fitted at 1 and 10 Hz, error at {told} |");
        expected.push((of, figures(&over_frequencies.mean(index))));
    }
    for (start, errors) in expected {
        let row = DOCS.lines().find(|line| line.starts_with(&start));
        let row = row.unwrap_or_else(|| panic!("no row {start}"));
        let said = row[start.len()..].trim_matches(['|', ' ']).split('|');
        let said: Vec<f64> = said.map(|cell| cell.trim().parse().unwrap()).collect();
        assert_eq!(said.len(), errors.len(), "{row}");
        for (said, error) in said.iter().zip(errors) {
            assert!((said - 100.0 * error).abs() < 0.06, "{row}: {error}");
        }
    }
}

/// The crate contains the result of the fit over both frequencies, to six digits.
#[test]
fn the_crates_laws_are_the_fitted_ones() {
    let [_, study] = studies();
    for one in &study.densities {
        let carried = amplitude_independent::law(one.density as f32).unwrap();
        let carried = carried.augmented();
        let fitted = one.law.model().augmented::<f32>(0.0, 1e-4).unwrap();
        let numbers = |law: &Law<f32>| [law.k1(), law.k3(), law.c(), law.alpha()];
        for (carried, fitted) in numbers(carried.law()).iter().zip(numbers(fitted.law())) {
            assert!(
                (carried - fitted).abs() <= 1e-5 * fitted.abs(),
                "{carried} {fitted}"
            );
        }
        let sine = ticks_of(0.12, 3.0);
        let by_file = embedded_force(&one.law.model(), &sine).unwrap();
        let mut running = RunningLaw::new(amplitude_independent::law(one.density as f32).unwrap());
        let mut cycle = || -> Vec<f64> {
            let samples = sine.displacement.iter().zip(&sine.velocity);
            samples
                .map(|(&y, &v)| f64::from(running.force(&Motion::at(y as f32, v as f32))))
                .collect()
        };
        cycle();
        assert!(
            nrmse(&cycle(), &by_file, |_| true) < 1e-5,
            "{}",
            one.density
        );
    }
    assert!(
        amplitude_independent::law(1.9).is_err() && amplitude_independent::law(f32::NAN).is_err()
    );
    assert_eq!(
        amplitude_independent::law(3.2).unwrap(),
        amplitude_independent::law(3.0).unwrap()
    );
}

/// The laws of eq 13 in f64 and of the firmware in f32 with its table, on the closed loop. The tolerance is the table's 4e-7 of the
/// damping, and the random walk of the elements' stretch by the rounding of 10^4 steps, 2^-24·0.3 mm each, √10⁴·5·1.8e-8/√3 = 5e-6
/// kN.
#[test]
fn f32_is_f64_within_a_hundred_thousandth() {
    for study in studies() {
        for one in &study.densities {
            for amplitude in [0.02, 0.15, 0.3] {
                let sine = ticks_of(amplitude, 1.0);
                let double = one.law.force(&sine);
                let single = embedded_force(&one.law.model(), &sine).unwrap();
                let peak = double.iter().fold(0.0_f64, |peak, f| peak.max(f.abs()));
                for (a, b) in single.iter().zip(&double) {
                    assert!(
                        (a - b).abs() < 4e-5 * peak,
                        "{} {amplitude}: {a} {b}",
                        one.density
                    );
                }
            }
        }
    }
}

/// ∮F dy of the closed loop, for any amplitude.
#[test]
fn every_loop_takes_energy_up() {
    for study in studies() {
        for one in &study.densities {
            for step in 0..=28 {
                let amplitude = 0.02 + 0.01 * f64::from(step);
                for frequency in [0.5, 1.0, 10.0] {
                    let sine = ticks_of(amplitude, frequency);
                    let force = one.law.force(&sine);
                    let count = force.len();
                    let energy: f64 = (0..count)
                        .map(|n| {
                            let next = (n + 1) % count;
                            0.5 * (force[n] + force[next])
                                * (sine.displacement[next] - sine.displacement[n])
                        })
                        .sum();
                    assert!(
                        energy > 0.0,
                        "{} g/cm³, {amplitude} mm: {energy} J",
                        one.density
                    );
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// For any motion: the part other than the elastic force absorbs work from rest on, and never gives back more than it took. A
    /// slider's work at the end of a tick, k·z·Δy, is at least the change of k·z²/2.
    #[test]
    fn no_motion_draws_energy_out(
        density in 0usize..5,
        waves in prop::collection::vec((0.01..0.12f64, 0.3..12.0f64, 0.0..TAU), 1..4),
    ) {
        let law = &studies()[1].densities[density].law;
        let model = law.model().augmented::<f64>(0.0, 1e-4).unwrap();
        let mut state = model.at_rest();
        let elastic = |y: f64| (law.k1 + law.k3 * y * y) * y;
        let at = |n: usize| {
            let t = 1e-4 * n as f64;
            waves.iter().fold((0.0, 0.0), |(y, v), (a, f, p)| {
                let (sin, cos) = (TAU * f * t + p).sin_cos();
                (y + a * sin, v + a * TAU * f * cos)
            })
        };
        let (mut before, _) = at(0);
        let mut work = 0.0;
        for n in 0..20_000 {
            let (y, v) = at(n);
            let force = model.force(&mut state, &Motion::at(y, v));
            work += (force - elastic(y)) * (y - before);
            before = y;
            // If the velocity reverses within a tick, its friction has the sign at the tick's end.
            prop_assert!(work > -1e-6, "{work} J after {n} ticks");
        }
    }
}

/// The emulated damper receives no amplitude: its force follows the law over a beat of two sines.
#[test]
fn the_emulated_damper_follows_it_where_no_amplitude_is_declared() {
    let law = amplitude_independent::law(3.0).unwrap();
    let mut bench = EmulatorBench::new(EmulatorSetup::new(law.augmented().clone())).unwrap();
    bench.emulator.start().unwrap();
    let expected = law.augmented();
    let mut state = expected.at_rest();
    let (mut driven, mut wanted) = (Vec::new(), Vec::new());
    for tick in 0..50_000 {
        let t = 1e-4 * f64::from(tick);
        let wave = |a: f64, f: f64| (a * (TAU * f * t).sin(), a * TAU * f * (TAU * f * t).cos());
        let ((y1, v1), (y2, v2)) = (wave(0.12, 1.0), wave(0.08, 1.3));
        let force = bench.tick(y1 + y2).force;
        let motion = Motion::at((y1 + y2) as f32, (v1 + v2) as f32);
        let own = expected.force(&mut state, &motion);
        // The force is ramped in over the first half second.
        if tick > 5_000 {
            driven.push(force);
            wanted.push(f64::from(own));
        }
    }
    // The error of the observer for a displacement in steps of 3e-5 mm.
    let error = nrmse(&driven, &wanted, |_| true);
    assert!(error < 0.03, "{error}");
}
