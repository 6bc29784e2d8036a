//! Loops of one effect, and their dissipated energy.

use std::f64::consts::TAU;

use mesh_damper::effects::{AugmentedLaw, Effect, Motion};
use mesh_damper::law::Law;
use mesh_damper::real::Real;

/// Ticks per cycle of the sampled loops.
pub const TICKS: usize = 20_000;

/// A law without a force.
pub fn nothing<R: Real>() -> Law<R> {
    Law::new(R::ZERO, R::ZERO, R::ZERO, R::ZERO).unwrap()
}

pub fn alone<R: Real>(effect: Effect<R>) -> AugmentedLaw<R, 1> {
    AugmentedLaw::new(nothing()).with(effect).unwrap()
}

/// Tick `n` of y = X·sin ωt.
pub fn sine<R: Real>(amplitude: f64, frequency: f64, n: usize) -> Motion<R> {
    let omega = TAU * frequency;
    let (sin, cos) = (TAU * n as f64 / TICKS as f64).sin_cos();
    Motion {
        displacement: R::from_f64(amplitude * sin),
        velocity: R::from_f64(amplitude * omega * cos),
        acceleration: R::from_f64(-amplitude * omega * omega * sin),
        cycles: R::from_f64(n as f64 / TICKS as f64),
        temperature: R::from_f64(20.0),
        controls: [1.0, 0.4, -0.7, 2.0].map(R::from_f64),
    }
}

/// Forces of the last of `cycles` cycles, from rest.
pub fn last_cycle<R: Real>(
    effect: Effect<R>,
    amplitude: f64,
    frequency: f64,
    cycles: usize,
) -> Vec<f64> {
    let law = alone(effect);
    let mut state = law.at_rest();
    let all: Vec<f64> = (0..cycles * TICKS)
        .map(|n| {
            law.force(&mut state, &sine(amplitude, frequency, n))
                .to_f64()
        })
        .collect();
    all[(cycles - 1) * TICKS..].to_vec()
}

/// ∮F dy over one cycle, by trapezoids.
pub fn energy(force: &[f64], amplitude: f64) -> f64 {
    let y = |n: usize| amplitude * (TAU * n as f64 / TICKS as f64).sin();
    (0..TICKS)
        .map(|n| 0.5 * (force[n] + force[(n + 1) % TICKS]) * (y(n + 1) - y(n)))
        .sum()
}

/// Components of the force in phase with displacement and with velocity, over the amplitude.
pub fn moduli(force: &[f64], amplitude: f64) -> (f64, f64) {
    let scale = 2.0 / (TICKS as f64 * amplitude);
    force
        .iter()
        .enumerate()
        .fold((0.0, 0.0), |(storage, loss), (n, f)| {
            let (sin, cos) = (TAU * n as f64 / TICKS as f64).sin_cos();
            (storage + scale * f * sin, loss + scale * f * cos)
        })
}

pub fn close(value: f64, expected: f64, tolerance: f64) {
    assert!(
        (value - expected).abs() <= tolerance * expected.abs(),
        "{value} is not {expected} within {tolerance}"
    );
}

/// ∫F dy of an effect from rest at 0 along legs of `steps` equal steps to each of `turns`, by trapezoids.
pub fn work(effect: Effect<f64>, turns: impl IntoIterator<Item = f64>, steps: u32) -> f64 {
    let law = alone(effect);
    let mut state = law.at_rest();
    let mut at = |displacement: f64| {
        let motion = Motion::at(displacement, 0.0);
        law.force(&mut state, &motion)
    };
    let (mut y, mut before) = (0.0, at(0.0));
    let mut work = 0.0;
    for turn in turns {
        let start = y;
        for step in 1..=steps {
            let next = start + (turn - start) * f64::from(step) / f64::from(steps);
            let force = at(next);
            work += 0.5 * (force + before) * (next - y);
            (y, before) = (next, force);
        }
    }
    work
}

/// The largest force of an effect along `path`, mm.
pub fn largest_force(effect: Effect<f32>, path: Vec<f32>) -> f32 {
    let law = alone(effect);
    let mut state = law.at_rest();
    let forces = path.into_iter().map(|displacement| {
        let motion = Motion::at(displacement, 0.0);
        law.force(&mut state, &motion).abs()
    });
    // NaN counts as the largest.
    forces.fold(0.0, |most, force| {
        if force > most || force.is_nan() {
            force
        } else {
            most
        }
    })
}
