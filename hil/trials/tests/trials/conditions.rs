//! The trial of conditions; `cargo hil blind --conditions --seeds 500` is the whole trial.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use mesh_damper_trials::conditions::{Condition, Device, Family, Kind, Scale, run, trial};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

const SCALE: Scale = Scale {
    length: 2.0,
    angular_frequency: TAU * 3.0,
    stiffness: 5.0,
    control: 1.5,
};
/// Steps in a cycle: the explicit parts are accurate to a per mille.
const STEPS: usize = 2000;

/// Device number `seed` of a kind.
fn device(family: Family, seed: u64) -> Device {
    family.device(SCALE, &mut ChaCha8Rng::seed_from_u64(seed))
}

/// Displacement and force over cycle number `cycle` of a sine of `amplitude` mm and `frequency` Hz; the first grows from rest.
fn loop_of(mut device: Device, amplitude: f64, frequency: f64, cycle: usize) -> Vec<[f64; 2]> {
    let omega = TAU * frequency;
    let dt = 1.0 / (STEPS as f64 * frequency);
    let mut samples = Vec::new();
    for step in 0..=(cycle + 1) * STEPS {
        let part = (step as f64 / STEPS as f64).min(1.0);
        let (ramp, slope) = (
            part * part * (3.0 - 2.0 * part),
            6.0 * part * (1.0 - part) * frequency,
        );
        let (sin, cos) = (TAU * step as f64 / STEPS as f64).sin_cos();
        let y = amplitude * ramp * sin;
        let v = amplitude * (slope * sin + ramp * omega * cos);
        let force = device.force(
            dt,
            y,
            v,
            -amplitude * omega * omega * ramp * sin,
            SCALE.control,
        );
        if step >= cycle * STEPS {
            samples.push([y, force]);
        }
    }
    samples
}

/// The work on the device over a loop, kN·mm.
fn work(of: &[[f64; 2]]) -> f64 {
    let pairs = of.windows(2);
    pairs
        .map(|pair| 0.5 * (pair[0][1] + pair[1][1]) * (pair[1][0] - pair[0][0]))
        .sum()
}

fn largest_force(of: &[[f64; 2]]) -> f64 {
    of.iter()
        .fold(0.0, |most, sample| most.max(sample[1].abs()))
}

#[test]
fn a_seed_draws_the_same_again() {
    let [one, again] = [(); 2].map(|()| trial(11));
    assert_eq!(one.secret, again.secret);
    assert_eq!(one.training, again.training);
    assert_eq!(one.held_out, again.held_out);
    assert_ne!(one.secret.device, trial(12).secret.device);
}

#[test]
fn every_kind_of_device_and_condition_is_drawn() {
    let (mut families, mut kinds) = (BTreeSet::new(), BTreeSet::new());
    let mut outside = 0;
    const SEEDS: u64 = 150;
    for seed in 0..SEEDS {
        let secret = trial(seed).secret;
        families.insert(secret.family);
        kinds.insert(secret.programme.kind);
        outside += u32::from(secret.programme.is_outside);
    }
    assert_eq!(families, Family::ALL.into());
    assert_eq!(kinds, Kind::ALL.into());
    // A third, within three standard deviations of 150 draws.
    assert!((33..68).contains(&outside), "{outside}");
}

/// Held-out values are not among the fitted ones, and are on the stated side of their range.
#[test]
fn held_out_conditions_are_others() {
    for seed in 0..100 {
        let trial = trial(seed);
        let programme = &trial.secret.programme;
        let value = |condition: &Condition| condition.value(programme.kind);
        let fitted: Vec<f64> = programme.training.iter().map(value).collect();
        let least = fitted.iter().copied().fold(f64::INFINITY, f64::min);
        let most = fitted.iter().copied().fold(0.0, f64::max);
        assert!(fitted.len() >= 2, "seed {seed}");
        for held in programme.held_out.iter().map(value) {
            let is_outside = held > 1.1 * most || held < least / 1.1;
            assert_eq!(
                is_outside, programme.is_outside,
                "seed {seed}: {held} of {fitted:?}"
            );
            let apart = fitted
                .iter()
                .all(|fitted| (held / fitted - 1.0).abs() > 0.03);
            assert!(apart, "seed {seed}: {held} of {fitted:?}");
        }
        let samples: usize = trial
            .training
            .iter()
            .chain(&trial.held_out)
            .map(|r| r.len())
            .sum();
        assert!(samples <= 13_000, "seed {seed}: {samples}");
    }
}

/// π·c·ω·A², with c from the force at displacement 0: the loop's energy goes with the frequency and with the squared amplitude.
#[test]
fn a_linear_device_has_the_loop_of_its_damper() {
    for seed in 0..10 {
        let energy = |amplitude, frequency| {
            work(&loop_of(
                device(Family::Linear, seed),
                amplitude,
                frequency,
                1,
            ))
        };
        let force_at_top_speed = {
            let samples = loop_of(device(Family::Linear, seed), 1.2, 2.0, 1);
            samples[0][1]
        };
        let c = force_at_top_speed / (1.2 * TAU * 2.0);
        let expected = PI * c * TAU * 2.0 * 1.2 * 1.2;
        assert!((energy(1.2, 2.0) / expected - 1.0).abs() < 1e-4);
        assert!((energy(0.6, 2.0) / expected - 0.25).abs() < 1e-4);
        assert!((energy(1.2, 6.0) / expected - 3.0).abs() < 1e-3);
    }
}

/// The parts beside the frame do not know the rate. The frame may hold a viscous damper, which is taken out by its loop at two rates.
#[test]
fn hysteresis_of_solids_does_not_depend_on_the_rate() {
    for family in [
        Family::BoucWen,
        Family::Pinching,
        Family::WireRope,
        Family::Masing,
        Family::AsymmetricSliders,
        Family::Superelastic,
        Family::Rocking,
        Family::Structural,
        Family::LoadedFriction,
        Family::WavyFriction,
    ] {
        for seed in 0..5 {
            let energies = [1.0, 2.0, 3.0].map(|f| work(&loop_of(device(family, seed), 1.8, f, 2)));
            // A viscous part grows evenly with the rate; the rest stays.
            let bend = energies[0] - 2.0 * energies[1] + energies[2];
            let still = 2.0 * energies[0] - energies[1];
            assert!(
                bend.abs() < 1e-3 * energies[0],
                "{family:?} {seed}: {energies:?}"
            );
            assert!(
                still > 0.01 * energies[0],
                "{family:?} {seed}: {energies:?}"
            );
        }
    }
}

/// Over a closed loop every device takes energy, at small and large amplitudes, slow and fast.
#[test]
fn every_device_is_passive() {
    for family in Family::ALL {
        for seed in 0..8 {
            for (amplitude, frequency) in [(2.0, 3.0), (0.4, 3.0), (2.0, 0.5), (1.0, 12.0)] {
                let samples = loop_of(device(family, seed), amplitude, frequency, 4);
                let largest = largest_force(&samples);
                assert!(largest.is_finite() && largest > 0.0, "{family:?} {seed}");
                let energy = work(&samples);
                // A part with a slow state has no closed loop after four cycles: a hundredth of the elastic energy is its drift.
                let least = if closes(family) { -1e-6 } else { -1e-2 };
                let case = format!("{family:?} {seed} at {amplitude} mm, {frequency} Hz: {energy}");
                assert!(energy > least * largest * amplitude, "{case}");
            }
        }
    }
}

/// Whether four cycles are enough for a steady loop.
fn closes(family: Family) -> bool {
    !matches!(
        family,
        Family::Fractional
            | Family::Maxwell
            | Family::Payne
            | Family::AirSpring
            | Family::Pair
            | Family::HydraulicMount
    )
}

/// A quarter of the step changes the force by at most two per cent, about as much as the strongest noise: the device is nearly the
/// same at every frequency.
#[test]
fn the_steps_are_fine_enough() {
    for family in Family::ALL {
        for seed in 3..8 {
            let [coarse, fine] = [800, 3200].map(|steps| peak(device(family, seed), steps));
            assert!(
                (coarse / fine - 1.0).abs() < 0.02,
                "{family:?}: {coarse} {fine}"
            );
        }
    }
}

/// Largest force in the third cycle of a sine of 2 mm and 3 Hz, with `steps` in a cycle.
fn peak(mut device: Device, steps: usize) -> f64 {
    let omega = TAU * 3.0;
    let mut most = 0.0_f64;
    for step in 0..3 * steps {
        let x = step as f64 / steps as f64;
        let ramp = x.min(1.0).powi(2) * (3.0 - 2.0 * x.min(1.0));
        let slope = 6.0 * x.min(1.0) * (1.0 - x.min(1.0)) * 3.0;
        let (sin, cos) = (TAU * x).sin_cos();
        let v = 2.0 * (slope * sin + ramp * omega * cos);
        let force = device.force(
            1.0 / (3.0 * steps as f64),
            2.0 * ramp * sin,
            v,
            -2.0 * omega * omega * ramp * sin,
            SCALE.control,
        );
        if x >= 2.0 {
            most = most.max(force.abs());
        }
    }
    most
}

/// A part of the trial, with floors far from its target; a refusal counts as worse.
#[test]
#[ignore = "half a minute: in the full tier"]
fn models_predict_other_conditions() {
    let summary = run(0..20, &|| ());
    assert_eq!(summary.outcomes.len(), 20);
    assert!(summary.all.worse <= 2, "{:?}", summary.all);
    assert!(summary.all.mean_ratio < 0.6, "{:?}", summary.all);
    assert!(summary.all.within_band > 0.8, "{:?}", summary.all);
}
