//! Cycles between crossings of the mean: they equal the cycles by phase, under noise, drift, jumps and wild samples.

use core::f64::consts::{PI, TAU};

use mesh_damper::crossing::{CrossingAccumulator, CrossingDetector, SWINGS};

use crate::support::{near, sine, tolerance};

/// Small periodic noise, within ±1.
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
            // The rounding of the displacement grows with the offset.
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
        // The noise shifts a crossing by the noise over the slope: 0.005/(0.1·2π) of a cycle = 8 ticks, at both ends.
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
    // One tick of drift is 5e-7/(2π·0.1/n) of the motion in a tick.
    near(found.first().unwrap().ticks, 1_000.0, 2.0, "ticks at first");
    near(found.last().unwrap().ticks, 613.7, 1.5, "ticks at last");
    near(
        found.last().unwrap().mean_displacement,
        0.02,
        4e-4,
        "mean at last",
    );
}

/// The ticks of the boundaries in `cycles` cycles of 0.1 mm at 1000 ticks each, with `disturbance` added.
fn boundaries(cycles: u32, disturbance: impl Fn(u32) -> f64) -> Vec<u32> {
    let mut detector = CrossingDetector::new(0.01).unwrap();
    (0..cycles * 1_000)
        .filter(|&n| {
            let y = sine(f64::from(n) / 1_000.0).0 + disturbance(n);
            detector.update(y as f32).boundary.is_some()
        })
        .collect()
}

/// The swings until the loss is detected, the rest of that cycle, one cycle to the first crossing, two whole cycles to the first
/// boundary.
const RECOVERY: u32 = (SWINGS as u32 + 1 + 1 + 2) * 1_000;

#[test]
fn crossings_come_back_after_the_mean_has_jumped_by_more_than_the_amplitude() {
    for jump in [0.15, -0.15, 3.0, -3.0] {
        // At several phases of the cycle, before and after a period is known.
        for at in [300, 20_000, 20_250, 20_500, 20_870] {
            let found = boundaries(60, |n| if n < at { 0.0 } else { jump });
            let after: Vec<_> = found.iter().filter(|&&n| n > at + 1_000).collect();
            let first = **after.first().unwrap();
            assert!(first <= at + RECOVERY, "{jump} at {at}: {first}");
            // Every cycle from there on is found. The first two may still begin and end at different means, the first of which is a
            // midpoint. Two ticks allow for the f32 of the mean.
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
            // A crossing in the middle of a run includes the wild sample in its mean: this takes one more cycle.
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

/// The first motion, down from 20, is not a swing, because nothing went up before it. Each of the others ends at 10.
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
