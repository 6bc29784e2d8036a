//! Dry friction parallel to a spring under a sine force: Den Hartog (1931), Forced vibrations with combined Coulomb and viscous
//! friction, Transactions of the ASME 53.

use std::f64::consts::{PI, TAU};

use mesh_damper_model::respond::{Excitation, Moment, Settings, respond};

use super::{KG, law, peak, sampled};

/// 25 kg on 1 kN/mm: ω = 200 rad/s.
const MASS: f64 = 25.0;
const OMEGA: f64 = 200.0;
/// Samples in a cycle.
const SAMPLES: usize = 200;

/// Under a force of 1 kN at `ratio` times the natural frequency, with `friction` kN.
fn forced(ratio: f64, friction: f64, cycles: usize) -> Vec<Moment> {
    assert!((1.0 / (MASS * KG)).sqrt() - OMEGA < 1e-9);
    let tick = TAU / (ratio * OMEGA * SAMPLES as f64);
    let force = sampled(tick, cycles * SAMPLES + 1, |t| (ratio * OMEGA * t).sin());
    let excitation = Excitation::force(tick, force);
    let model = law(1.0, 0.0, friction, 0.0);
    respond(&model, &excitation, &Settings::new(MASS))
        .unwrap()
        .moments
}

/// Where the mass never stops, x₀ = P/k·√(V² − (F/P)²·U²).
#[test]
fn without_stops_the_amplitude_is_den_hartogs() {
    for (ratio, friction) in [(0.6, 0.3), (0.8, 0.4), (1.5, 0.2), (1.5, 0.3), (2.0, 0.2)] {
        let v = 1.0 / (1.0 - ratio * ratio);
        let u = (PI / ratio).sin() / (ratio * (1.0 + (PI / ratio).cos()));
        let expected = (v * v - friction * friction * u * u).sqrt();
        let moments = forced(ratio, friction, 150);
        let found = peak(&moments, SAMPLES, |m| m.displacement);
        // The largest of 200 samples a cycle is within 1e-4 of the peak.
        assert!(
            (found / expected - 1.0).abs() < 3e-3,
            "{ratio}, {friction}: {found} {expected}"
        );
        let stops = moments
            .iter()
            .rev()
            .take(SAMPLES)
            .filter(|m| m.velocity == 0.0);
        assert!(stops.count() <= 2, "{ratio}, {friction}");
    }
}

#[test]
fn with_stops_the_mass_rests_twice_a_cycle_and_nothing_chatters() {
    let moments = forced(0.25, 0.8, 20);
    let last: Vec<&Moment> = moments.iter().rev().take(2 * SAMPLES).collect();
    let resting = last.iter().filter(|m| m.velocity == 0.0).count();
    assert!(resting > SAMPLES / 2, "{resting}");
    // While the mass rests, friction balances force and spring, below its limit.
    for moment in last
        .iter()
        .filter(|m| m.velocity == 0.0 && m.acceleration == 0.0)
    {
        let friction = moment.force - moment.displacement;
        assert!(friction.abs() <= 0.8 + 1e-9, "{friction}");
    }
    let moving: Vec<f64> = last
        .iter()
        .map(|m| m.velocity)
        .filter(|&v| v != 0.0)
        .collect();
    let turns = moving
        .windows(2)
        .filter(|pair| pair[0] * pair[1] < 0.0)
        .count();
    // Two in each of the two cycles.
    assert!((3..=4).contains(&turns), "{turns}");
    let starts = last
        .windows(2)
        .filter(|pair| (pair[0].velocity == 0.0) != (pair[1].velocity == 0.0));
    assert!((6..=9).contains(&starts.count()));
}

#[test]
fn a_force_that_friction_holds_moves_nothing() {
    for moment in forced(0.5, 1.0, 5) {
        assert_eq!(
            [moment.displacement, moment.velocity, moment.acceleration],
            [0.0; 3]
        );
    }
    // On a base that rises evenly and stops, the mass comes along and stays where friction holds it.
    let tick = 1e-3;
    let base = sampled(tick, 2000, |t| 2.0 * t.min(1.0));
    let model = law(1.0, 0.0, 0.5, 0.0);
    let response = respond(&model, &Excitation::base(tick, base), &Settings::new(MASS)).unwrap();
    let last = response.moments[1900..]
        .iter()
        .map(|m| m.relative_displacement);
    let at = response.moments[1999].relative_displacement;
    assert!(at.abs() < 0.5, "{at}");
    for relative in last {
        assert!((relative - at).abs() < 1e-12, "{relative} {at}");
    }
}

/// |v|^α with a small α is nearly Coulomb friction.
#[test]
fn a_small_exponent_is_friction() {
    let (ratio, friction) = (0.8, 0.4);
    let tick = TAU / (ratio * OMEGA * SAMPLES as f64);
    let force = sampled(tick, 100 * SAMPLES + 1, |t| (ratio * OMEGA * t).sin());
    let excitation = Excitation::force(tick, force);
    let run = |alpha| {
        let model = law(1.0, 0.0, friction, alpha);
        let moments = respond(&model, &excitation, &Settings::new(MASS))
            .unwrap()
            .moments;
        peak(&moments, SAMPLES, |m| m.displacement)
    };
    let (small, none) = (run(1e-5), run(0.0));
    assert!((small / none - 1.0).abs() < 1e-3, "{small} {none}");
}

/// Free vibration with dry friction loses 4F/k a cycle, and stops where the spring can no longer move the mass.
#[test]
fn free_vibration_on_friction_falls_by_equal_steps_and_stops() {
    let tick = 2e-4;
    let settings = Settings {
        start: [1.05, 0.0],
        tolerance: 1e-4,
        ..Settings::new(MASS)
    };
    let still = Excitation::force(tick, vec![0.0; 2001]);
    let response = respond(&law(1.0, 0.0, 0.1, 0.0), &still, &settings).unwrap();
    let mut turns = vec![1.05];
    for pair in response.moments.windows(3) {
        if (pair[1].displacement - pair[0].displacement)
            * (pair[2].displacement - pair[1].displacement)
            < 0.0
        {
            turns.push(pair[1].displacement);
        }
    }
    for (index, turn) in turns.iter().enumerate() {
        let expected = 1.05 - 0.2 * index as f64;
        assert!((turn.abs() - expected).abs() < 2e-3, "{turns:?}");
    }
    let end = response.moments.last().unwrap();
    assert_eq!(end.velocity, 0.0);
    // 1.05, 0.85, 0.65, 0.45, 0.25 and 0.05; at the last one 0.05 kN do not overcome 0.1 kN.
    assert!((end.displacement.abs() - 0.05).abs() < 2e-3, "{end:?}");
}
