//! Effects of several elements.

use std::f64::consts::TAU;

use super::{Sample, branch, families, traced};

/// A Prony series of two terms, with the source's values for its material, is one effect with both branches.
#[test]
fn two_branches_are_one_relaxation() {
    let trace = traced(0.004, 8, || {
        let (mut fast, mut slow) = (branch(0.9, 0.02), branch(0.7, 0.25));
        move |s: &Sample| fast(s) + slow(s)
    });
    assert_eq!(families(&trace.result), ["relaxation"]);
    let found = &trace.result.effects[0].parameters;
    let number = |first: &str| {
        let fast = found["time"].value < found["time_2"].value;
        if (first == "fast") == fast { "" } else { "_2" }
    };
    for (which, stiffness, time) in [("fast", 0.9, 0.02), ("slow", 0.7, 0.25)] {
        for (name, truth) in [("stiffness", stiffness), ("time", time)] {
            let value = found[&format!("{name}{}", number(which))].value;
            assert!(
                (value - truth).abs() < 0.05 * truth,
                "{which} {name}: {value}"
            );
        }
    }
    assert!(trace.result.augmented.nrmse_held_out < 1.1 * 0.004);
}

/// Mains hum, its harmonic and a pump are one effect with all tones.
#[test]
fn three_tones_are_one_periodic_effect() {
    const HUM: [(f64, f64, f64); 3] = [(0.02, 50.0, 0.4), (0.008, 150.0, -1.1), (0.005, 97.0, 0.9)];
    let trace = traced(0.004, 9, || {
        |s: &Sample| {
            let tones = HUM.iter();
            tones
                .map(|(size, frequency, phase)| size * (TAU * frequency * s.0 + phase).sin())
                .sum()
        }
    });
    assert_eq!(families(&trace.result), ["periodic"]);
    let found = &trace.result.effects[0].parameters;
    // The stronger is found first.
    for (number, (amplitude, frequency, phase)) in ["", "_2", "_3"].into_iter().zip(HUM) {
        for (name, truth) in [
            ("amplitude", amplitude),
            ("frequency", frequency),
            ("phase", phase),
        ] {
            let estimate = &found[&format!("{name}{number}")];
            let half = 0.5 * (estimate.high - estimate.low);
            let off = (estimate.value - truth).abs();
            assert!(
                off < 2.0 * half && half < 0.03 * truth.abs(),
                "{name}{number}: {estimate:?}"
            );
        }
    }
    assert!(trace.result.augmented.nrmse_held_out < 1.1 * 0.004);
}

/// A tone at two fifths of the sampling rate looks like noise to differences of neighbours.
#[test]
fn a_tone_of_a_few_samples_is_no_noise() {
    let with = |size: f64| {
        traced(0.004, 10, || {
            move |s: &Sample| size * (TAU * 203.0 * s.0 + 0.4).sin()
        })
    };
    let (clean, trace) = (with(0.0), with(0.01));
    assert_eq!(families(&trace.result), ["periodic"]);
    let [floor, of_clean] = [&trace, &clean].map(|trace| trace.result.noise_floor_nrmse);
    assert!((floor / of_clean - 1.0).abs() < 0.1, "{floor}, {of_clean}");
    assert!(trace.result.augmented.nrmse_held_out < 1.1 * 0.004);
}
