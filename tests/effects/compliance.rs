//! A spring in series against the closed forms of springs, dashpots and sliders in series, and against a fine integration.

use std::f64::consts::TAU;

use mesh_damper::effects::{
    AugmentedLaw, Compliance, Delay, Effect, Motion, Offset, Relaxation, StickSlip, Viscous,
};
use mesh_damper::law::Law;
use mesh_damper::real::Real;

use crate::loops::{close, nothing};

/// One cycle of `ticks` after four others, with y = X·sin ωt.
fn steady<R: Real>(
    law: Law<R>,
    effects: &[Effect<R>],
    amplitude: f64,
    frequency: f64,
    ticks: usize,
) -> Vec<f64> {
    let add = |law: AugmentedLaw<R, 4>, effect: &Effect<R>| law.with(*effect).unwrap();
    let law = effects.iter().fold(AugmentedLaw::new(law), add);
    let mut state = law.at_rest();
    let omega = TAU * frequency;
    let all = (0..5 * ticks).map(|n| {
        let (sin, cos) = (TAU * n as f64 / ticks as f64).sin_cos();
        let motion = Motion::at(
            R::from_f64(amplitude * sin),
            R::from_f64(amplitude * omega * cos),
        );
        law.force(&mut state, &motion).to_f64()
    });
    all.skip(4 * ticks).collect()
}

fn series<R: Real>(stiffness: f64, frequency: f64, ticks: usize) -> Effect<R> {
    let tick = R::from_f64(1.0 / (frequency * ticks as f64));
    Effect::Compliance(Compliance::new(R::from_f64(stiffness), tick).unwrap())
}

fn moduli(force: &[f64], amplitude: f64) -> (f64, f64) {
    let scale = 2.0 / (force.len() as f64 * amplitude);
    let angle = |n: usize| TAU * n as f64 / force.len() as f64;
    let terms = force.iter().enumerate();
    terms.fold((0.0, 0.0), |(storage, loss), (n, f)| {
        let (sin, cos) = angle(n).sin_cos();
        (storage + scale * f * sin, loss + scale * f * cos)
    })
}

fn energy(force: &[f64], amplitude: f64) -> f64 {
    let y = |n: usize| amplitude * (TAU * n as f64 / force.len() as f64).sin();
    let mean = |n: usize| 0.5 * (force[n] + force[(n + 1) % force.len()]);
    (0..force.len()).map(|n| mean(n) * (y(n + 1) - y(n))).sum()
}

fn rms(values: impl Iterator<Item = f64> + Clone) -> f64 {
    (values.clone().map(|x| x * x).sum::<f64>() / values.count() as f64).sqrt()
}

/// Two springs in series: K·k/(K + k).
#[test]
fn a_spring_in_series_with_a_spring_softens_it() {
    let law = Law::new(1.5, 0.0, 0.0, 0.0).unwrap();
    for stiffness in [0.5, 5.0, 500.0] {
        let force = steady(law, &[series(stiffness, 2.0, 400)], 0.1, 2.0, 400);
        let (storage, loss) = moduli(&force, 0.1);
        close(storage, stiffness * 1.5 / (stiffness + 1.5), 1e-12);
        assert!(loss.abs() < 1e-12);
    }
}

/// A spring and a dashpot in series are a Maxwell branch, whether the dashpot is eq 13's with α = 1 or the effect:
/// storage K·s²/(1 + s²) and loss K·s/(1 + s²), s = ω·c/K.
#[test]
fn a_spring_in_series_with_a_dashpot_is_a_maxwell_branch() {
    let frequency = 2.0;
    for (ticks, tolerance) in [(200, 5e-3), (2000, 5e-5)] {
        for stiffness in [0.3, 3.0] {
            let s = TAU * frequency * 0.06 / stiffness;
            let compliance = series(stiffness, frequency, ticks);
            let dashpot = Effect::Viscous(Viscous::new(0.06).unwrap());
            let forces = [
                steady(
                    Law::new(0.0, 0.0, 0.06, 1.0).unwrap(),
                    &[compliance],
                    0.1,
                    frequency,
                    ticks,
                ),
                steady(nothing(), &[compliance, dashpot], 0.1, frequency, ticks),
            ];
            for force in forces {
                let (storage, loss) = moduli(&force, 0.1);
                // The second backward difference has an error of (ωΔt)²/3.
                close(storage, stiffness * s * s / (1.0 + s * s), tolerance);
                close(loss, stiffness * s / (1.0 + s * s), tolerance);
            }
        }
    }
}

/// A spring in series with Coulomb friction is a Jenkins element: 4·K·x·(X − x) with x = c/K.
#[test]
fn a_spring_in_series_with_coulomb_friction_is_a_jenkins_element() {
    let law = Law::new(0.0, 0.0, 0.06, 0.0).unwrap();
    let (stiffness, slip_limit) = (2.0, 0.03);
    for (ticks, tolerance) in [(200, 1e-2), (20_000, 1e-4)] {
        let force = steady(law, &[series(stiffness, 1.0, ticks)], 0.1, 1.0, ticks);
        close(
            energy(&force, 0.1),
            4.0 * stiffness * slip_limit * (0.1 - slip_limit),
            tolerance,
        );
        let largest = force.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        close(largest, 0.06, 1e-3);
    }
}

/// K·(y − x) = F(x, ẋ) is ẋ = ((K·(y − x) − k1·x − k3·x³)/c)^(1/α): integrated by Runge–Kutta, with many steps in a tick.
fn integrated(
    law: &Law<f64>,
    stiffness: f64,
    amplitude: f64,
    frequency: f64,
    ticks: usize,
) -> Vec<f64> {
    const STEPS: usize = 400;
    let h = 1.0 / (frequency * (ticks * STEPS) as f64);
    let y = |step: f64| amplitude * (TAU * step / (ticks * STEPS) as f64).sin();
    let slope = |step: f64, x: f64| {
        let pull = stiffness * (y(step) - x) - law.k1() * x - law.k3() * x.powi(3);
        pull.signum() * (pull.abs() / law.c()).powf(1.0 / law.alpha())
    };
    let mut x = 0.0;
    let mut forces = Vec::new();
    for step in 0..2 * ticks * STEPS {
        let at = step as f64;
        if step % STEPS == 0 {
            forces.push(stiffness * (y(at) - x));
        }
        let a = slope(at, x);
        let b = slope(at + 0.5, x + 0.5 * h * a);
        let c = slope(at + 0.5, x + 0.5 * h * b);
        let d = slope(at + 1.0, x + h * c);
        x += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
    }
    forces.split_off(ticks)
}

/// The published law at 3 g/cm³, and sharper and softer friction, in series with fixtures from soft to stiff.
#[test]
fn the_law_in_series_follows_a_fine_integration() {
    for (k1, k3, c, alpha) in [
        (1.05, 10.5, 0.11, 0.4),
        (2.0, 40.0, 0.2, 0.16),
        (0.5, 5.0, 0.03, 0.7),
    ] {
        let law = Law::new(k1, k3, c, alpha).unwrap();
        for stiffness in [3.0, 20.0, 100.0] {
            for (ticks, tolerance) in [(100, 1e-2), (1000, 2e-4)] {
                let expected = integrated(&law, stiffness, 0.1, 2.0, ticks);
                let force = steady(law, &[series(stiffness, 2.0, ticks)], 0.1, 2.0, ticks);
                let error = rms(force.iter().zip(&expected).map(|(a, b)| a - b));
                let scale = rms(expected.iter().copied());
                assert!(
                    error < tolerance * scale,
                    "α {alpha}, K {stiffness}, {ticks} ticks: {}",
                    error / scale
                );
            }
        }
    }
}

/// The stiffer the spring, the closer to the law alone, and without noise in f32. The reversal of the friction converges slowly: the
/// force reverses within the spring's deflection, so within a time proportional to the root of 1/K.
#[test]
fn a_very_stiff_spring_is_none() {
    let law = Law::new(1.05_f32, 10.5, 0.11, 0.4).unwrap();
    let alone = steady(law, &[], 0.1, 2.0, 5000);
    let scale = rms(alone.iter().copied());
    for (stiffness, tolerance) in [(1e3, 2e-2), (1e5, 2e-3), (1e7, 2e-4), (1e9, 5e-5)] {
        let force = steady(law, &[series(stiffness, 2.0, 5000)], 0.1, 2.0, 5000);
        let error = rms(force.iter().zip(&alone).map(|(a, b)| a - b));
        assert!(error < tolerance * scale, "{stiffness}: {}", error / scale);
    }
}

/// f32 at 10 kHz agrees with f64, for friction of every kind: no tick differs by more than a few roundings of the force.
#[test]
fn f32_follows_f64() {
    for alpha in [0.0, 0.005, 0.16, 0.4, 1.0] {
        for stiffness in [2.0, 20.0, 2e4] {
            let ticks = 5000;
            let single = steady(
                Law::new(1.05_f32, 10.5, 0.11, alpha).unwrap(),
                &[series(stiffness, 2.0, ticks)],
                0.1,
                2.0,
                ticks,
            );
            let double = steady(
                Law::new(1.05_f64, 10.5, 0.11, f64::from(alpha)).unwrap(),
                &[series(stiffness, 2.0, ticks)],
                0.1,
                2.0,
                ticks,
            );
            let peak = double.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
            let pairs = single.iter().zip(&double);
            let worst = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
            assert!(
                worst < 5e-6 * peak,
                "α {alpha}, K {stiffness}: {}",
                worst / peak
            );
        }
    }
}

/// Effects with memory see the specimen's own motion: a stuck slider is a spring in series.
#[test]
fn a_stuck_slider_in_series_is_a_spring_in_series() {
    let slider = Effect::StickSlip(StickSlip::new(&[(1.5, 1.0)]).unwrap());
    let ticks = 2000;
    let force = steady(
        nothing(),
        &[series(20.0, 2.0, ticks), slider],
        0.1,
        2.0,
        ticks,
    );
    // One tick late: an angle of ωΔt·k/(K + k).
    close(moduli(&force, 0.1).0, 20.0 * 1.5 / 21.5, 1e-3);
}

/// With friction, relaxation, an offset and a delay in the same law, nothing grows over a thousand cycles of coarse ticks.
#[test]
fn nothing_grows_in_series_with_other_effects() {
    let effects = [
        series(10.0, 5.0, 100),
        Effect::StickSlip(StickSlip::new(&[(3.0, 0.02), (1.0, 0.05)]).unwrap()),
        Effect::Relaxation(Relaxation::new(&[(2.0, 0.02)], 2e-3).unwrap()),
        Effect::Delay(Delay::new(4e-3, 2e-3).unwrap()),
    ];
    let law = Law::new(1.05, 10.5, 0.11, 0.4).unwrap();
    let force = steady(law, &effects, 0.2, 5.0, 100);
    // Less than the force of all springs at full stretch.
    let most = (1.05 + 10.5 * 0.04 + 3.0 + 1.0 + 2.0) * 0.2 + 1.0;
    assert!(force.iter().all(|f| f.abs() < most));
    let offset = [effects[0], Effect::Offset(Offset::new(0.4).unwrap())];
    let moved = steady(law, &offset, 1e-6, 5.0, 100);
    // The spring and k1 share the offset, except for the part that friction holds.
    for force in moved {
        close(force, 0.4 * 10.0 / (10.0 + 1.05), 2e-2);
    }
}
