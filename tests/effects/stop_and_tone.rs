//! The stop, an elastic contact, and the tone, which does not depend on the motion.

use std::f64::consts::{PI, TAU};

use mesh_damper::effects::{Effect, Motion, Periodic, Stop};
use mesh_damper::real::Real;

use crate::loops::{TICKS, alone, close, energy, last_cycle, moduli};

/// Beyond its gap k·(X − g), 0 on the other side, and no loss. Its first harmonic is that of a clipped sine: with cos θ = g/X, k/π·(θ
/// − sin θ·cos θ).
#[test]
fn a_stop_is_a_spring_beyond_its_gap() {
    let force = last_cycle(
        Effect::Stop(Stop::new(&[(4.0, 0.12)]).unwrap()),
        0.2,
        1.0,
        1,
    );
    close(force[TICKS / 4], 4.0 * (0.2 - 0.12), 1e-12);
    assert_eq!(force[3 * TICKS / 4], 0.0);
    assert!(energy(&force, 0.2).abs() < 1e-12);
    let theta = (0.12_f64 / 0.2).acos();
    // The corner falls within a tick: an error of second order.
    close(
        moduli(&force, 0.2).0,
        4.0 / PI * (theta - theta.sin() * theta.cos()),
        1e-6,
    );
}

#[test]
fn two_stops_are_of_one_side_or_of_both() {
    let both = last_cycle(
        Effect::Stop(Stop::new(&[(4.0, 0.12), (1.5, -0.05)]).unwrap()),
        0.2,
        1.0,
        1,
    );
    close(both[TICKS / 4], 4.0 * (0.2 - 0.12), 1e-12);
    close(both[3 * TICKS / 4], -1.5 * (0.2 - 0.05), 1e-12);
    let one = last_cycle(
        Effect::Stop(Stop::new(&[(-2.0_f64).abs(), 1.0].map(|k| (k, -0.1))).unwrap()),
        0.2,
        1.0,
        1,
    );
    assert_eq!(one[TICKS / 4], 0.0);
    close(one[3 * TICKS / 4], -(2.0 + 1.0) * 0.1, 1e-12);
}

fn tone<R: Real>(ticks: usize, frequency: f64, phase: f64, tick: f64) -> Vec<f64> {
    let amplitude = R::from_f64(0.05);
    let law = alone(Effect::Periodic(
        Periodic::new(&[(amplitude, frequency, phase)], tick).unwrap(),
    ));
    let mut state = law.at_rest();
    let forces = (0..ticks).map(|n| {
        let motion = Motion::at(R::from_f64((n % 17) as f64), R::from_f64((n % 5) as f64));
        law.force(&mut state, &motion).to_f64()
    });
    forces.collect()
}

/// All of its power is at its frequency, with its amplitude and its phase, for any motion.
#[test]
fn the_tones_spectrum_is_one_line() {
    let ticks = 1000;
    let force = tone::<f64>(ticks, 37.0, 0.7, 1e-3);
    for line in 0..=ticks / 2 {
        let (mut sin, mut cos) = (0.0, 0.0);
        for (n, f) in force.iter().enumerate() {
            let (s, c) = (TAU * (line * n) as f64 / ticks as f64).sin_cos();
            sin += 2.0 / ticks as f64 * f * s;
            cos += 2.0 / ticks as f64 * f * c;
        }
        if line == 37 {
            close(sin, 0.05 * 0.7_f64.cos(), 1e-9);
            close(cos, 0.05 * 0.7_f64.sin(), 1e-9);
        } else {
            assert!(sin.hypot(cos) < 1e-14, "line {line}: {sin} {cos}");
        }
    }
}

/// After a million ticks it is still correct in f32, because the phase is not a float.
#[test]
fn a_million_ticks_later_the_tone_has_not_drifted() {
    let (frequency, tick) = (49.98, 1e-4);
    let force = tone::<f32>(1_000_001, frequency, -2.0, tick);
    for (n, &f) in force.iter().enumerate().step_by(1237) {
        let turns = frequency * tick * n as f64;
        let expected = 0.05 * (TAU * (turns - turns.floor()) - 2.0).sin();
        // The rounding of 0.05, and 1e-7 of the sine.
        assert!((f - expected).abs() < 2e-7 * 0.05, "{n}: {f} {expected}");
    }
}
