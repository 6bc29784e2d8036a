//! The energy balance, against a separate count.

use std::f64::consts::TAU;

use mesh_damper_model::respond::{Excitation, Moment, Settings, respond};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{KG, law, sampled, with};

/// Twelve sines of random phase from 2 to 60 Hz.
fn random_force(tick: f64, count: usize, size: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let sines: Vec<[f64; 2]> = (0..12)
        .map(|_| {
            [
                random.random_range(2.0..60.0),
                random.random_range(0.0..TAU),
            ]
        })
        .collect();
    sampled(tick, count, |t| {
        let sum: f64 = sines
            .iter()
            .map(|[f, phase]| (TAU * f * t + phase).sin())
            .sum();
        // From rest, without a jump.
        size * sum * (t / 0.1).min(1.0)
    })
}

/// The balance accounts for the work of the force: as kinetic energy, in springs, in the dashpot, and as slip times friction.
#[test]
fn the_work_of_a_random_force_is_found_again_piece_by_piece() {
    let (k1, k3, dashpot) = (2.0, 3.0, 2e-3);
    let (stiffness, limit) = (3.0, 0.05);
    let model = with(
        with(law(k1, k3, 0.0, 0.5), "viscous", &[("c1", dashpot)]),
        "stick_slip",
        &[("stiffness", stiffness), ("slip_limit", limit)],
    );
    let (mass, tick) = (80.0, 5e-5);
    let force = random_force(tick, 40_001, 0.15, 3);
    let excitation = Excitation::force(tick, force.clone());
    let response = respond(&model, &excitation, &Settings::new(mass)).unwrap();
    let (mut input, mut burnt, mut slipped, mut stretch) = (0.0, 0.0, 0.0, 0.0_f64);
    for (pair, force) in response.moments.windows(2).zip(force.windows(2)) {
        let step = pair[1].displacement - pair[0].displacement;
        input += 0.5 * (force[0] + force[1]) * step;
        burnt += dashpot * step * step / tick;
        let free = stretch + step;
        stretch = free.clamp(-limit, limit);
        slipped += stiffness * limit * (free - stretch).abs();
    }
    let end = response.moments.last().unwrap();
    let y = end.displacement;
    let springs = 0.5 * k1 * y * y + 0.25 * k3 * y.powi(4);
    let pre_sliding = 0.5 * stiffness * stretch * stretch;
    let kinetic = 0.5 * mass * KG * end.velocity * end.velocity;
    let all = kinetic + springs + pre_sliding + burnt + slipped;
    assert!(
        slipped > 0.3 * input,
        "friction does most: {slipped} of {input}"
    );
    assert!((all / input - 1.0).abs() < 2e-3, "{all} {input}");
    let energy = response.energy;
    assert!((energy.input / input - 1.0).abs() < 2e-3);
    assert!((energy.kinetic - kinetic).abs() < 1e-9);
    assert!((energy.elastic - springs).abs() < 1e-9);
    assert!((energy.dissipated - burnt - slipped - pre_sliding).abs() < 2e-3 * input);
    assert!(energy.residual.abs() < 1e-3 * input, "{energy:?}");
}

/// The whole balance closes for a moving base too, with every kind of effect.
#[test]
fn the_balance_holds_on_a_moving_base() {
    let mut model = law(2.0, 4.0, 0.05, 0.3);
    for (family, parameters) in [
        ("relaxation", &[("stiffness", 0.6), ("time", 0.02)][..]),
        ("stick_slip", &[("stiffness", 0.8), ("slip_limit", 0.03)]),
        ("load_friction", &[("load", 2.0)]),
        ("asymmetry", &[("k2", 0.8)]),
        ("inertia", &[("mass", 12.0)]),
        ("compliance", &[("stiffness", 40.0)]),
    ] {
        model = with(model, family, parameters);
    }
    let tick = 1e-4;
    let base = random_force(tick, 20_001, 0.02, 9);
    let response = respond(&model, &Excitation::base(tick, base), &Settings::new(60.0)).unwrap();
    assert!(response.settled, "{}", response.change);
    let energy = response.energy;
    assert!(energy.dissipated > 0.0);
    let parts = energy.kinetic + energy.elastic + energy.dissipated;
    assert!((energy.input - parts - energy.residual).abs() < 1e-12);
    assert!(energy.residual.abs() < 5e-3 * energy.input, "{energy:?}");
    // M·a equals the damper's force at every sample.
    let unbalanced = |m: &Moment| (60.0 * KG * m.acceleration + m.force).abs();
    assert!(response.moments[1..].iter().all(|m| unbalanced(m) < 1e-9));
}
