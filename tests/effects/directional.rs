//! Damping that differs between the directions, together with eq 13's damping.

use std::f64::consts::TAU;

use mesh_damper::effects::{AugmentedLaw, Directional, Effect, Motion};
use mesh_damper::law::Law;
use mesh_damper::real::Real;
use proptest::prelude::*;

use super::loops::{TICKS, close, energy, sine};

fn law<R: Real>(k1: f64, c: f64, alpha: f64, difference: f64) -> AugmentedLaw<R, 1> {
    let [k1, c, alpha, difference] = [k1, c, alpha, difference].map(R::from_f64);
    let directional = Directional::new(difference).unwrap();
    AugmentedLaw::new(Law::new(k1, R::ZERO, c, alpha).unwrap())
        .with(Effect::Directional(directional))
        .unwrap()
}

fn force<R: Real>(law: &AugmentedLaw<R, 1>, motion: &Motion<R>) -> f64 {
    law.force(&mut law.at_rest(), motion).to_f64()
}

/// The half cycle with rising displacement dissipates 1 + d of the law's energy, the other half 1 − d. Over the whole cycle the
/// difference is zero. A half cycle of eq 13 dissipates c·ω^α·X^(1+α)·∫cos^(1+α).
#[test]
fn half_cycles_take_their_closed_forms() {
    let (c, amplitude, frequency) = (0.09, 0.15, 3.0);
    // ∫cos^(1+α) over half a period, by its closed forms: 2 for α = 0, π/2 for α = 1.
    for (alpha, mean) in [(0.0, 2.0), (1.0, 0.25 * TAU)] {
        let half = c * (TAU * frequency * amplitude).powf(alpha) * amplitude * mean;
        for difference in [-1.0, -0.35, 0.6, 1.0] {
            let law = law::<f64>(0.0, c, alpha, difference);
            let forces: Vec<f64> = (0..TICKS)
                .map(|n| force(&law, &sine(amplitude, frequency, n)))
                .collect();
            let power = |rising: bool| -> f64 {
                let ticks = (0..TICKS).map(|n| (n, sine::<f64>(amplitude, frequency, n).velocity));
                let ticks = ticks.filter(|(_, v)| (*v > 0.0) == rising);
                let work = ticks.map(|(n, v)| forces[n] * v);
                work.sum::<f64>() / (TICKS as f64 * frequency)
            };
            // Trapezoids, whose ends are reversals: an error of (2π/20 000)²/12.
            assert!((power(true) - (1.0 + difference) * half).abs() < 1e-6 * half);
            assert!((power(false) - (1.0 - difference) * half).abs() < 1e-6 * half);
            // The jump at a reversal of α = 0 falls within one tick of 20 000.
            close(energy(&forces, amplitude), 2.0 * half, 1e-4);
        }
    }
}

/// With d = 1 the damper acts in one direction only, with twice the force, and with d = −1 in the other.
#[test]
fn one_way_damping_is_the_whole_difference() {
    let moving = |velocity| Motion::at(0.05, velocity);
    let alone = Law::new(1.2, 0.0, 0.08, 0.3).unwrap();
    let spring = alone.force(0.05, 0.0);
    let one_way = law::<f64>(1.2, 0.08, 0.3, 1.0);
    let other = law::<f64>(1.2, 0.08, 0.3, -1.0);
    for v in [0.02, 1.0, 7.5] {
        let doubled = 2.0 * alone.damping_force(v);
        close(force(&one_way, &moving(v)), spring + doubled, 1e-12);
        close(force(&one_way, &moving(-v)), spring, 1e-12);
        close(force(&other, &moving(v)), spring, 1e-12);
        close(force(&other, &moving(-v)), spring - doubled, 1e-12);
    }
}

/// At rest there is no damping force, including the Coulomb friction of α = 0.
#[test]
fn at_rest_it_has_no_force() {
    for alpha in [0.0, 0.4, 1.0] {
        for rest in [0.0, -0.0, f64::NAN] {
            let motion = Motion {
                velocity: rest,
                ..Motion::default()
            };
            assert_eq!(force(&law::<f64>(1.0, 0.1, alpha, 0.7), &motion), 0.0);
        }
    }
}

proptest! {
    /// Together with the law it never drives the motion, and its force never exceeds the law's damping.
    #[test]
    fn its_power_is_never_negative_beside_the_law(
        difference in -1.0..=1.0f64, c in 0.0..1.0f64, alpha in 0.0..1.0f64,
        velocity in prop_oneof![-1e3..1e3f64, -1e-3..1e-3f64],
    ) {
        let motion = Motion { velocity, ..Motion::default() };
        let total = force(&law::<f64>(0.0, c, alpha, difference), &motion);
        let damping = Law::new(0.0, 0.0, c, alpha).unwrap().damping_force(velocity);
        // Two roundings of the law's force.
        let rounding = 4.0 * f64::EPSILON * damping.abs();
        prop_assert!(total * velocity >= -rounding * velocity.abs());
        prop_assert!((total - damping).abs() <= damping.abs() + rounding);
    }

    /// One product and one sum more than the law, each within 2^-24 of itself, which is at most twice the law's damping.
    #[test]
    fn f32_follows_f64(
        difference in -1.0..=1.0f32, velocity in prop_oneof![-10.0..10.0f32, -1e-3..1e-3f32],
    ) {
        let (c, alpha) = (0.11_f32, 0.4_f32);
        let motion = Motion { velocity, ..Motion::default() };
        let single = force(&law::<f32>(0.0, c.into(), alpha.into(), difference.into()), &motion);
        let alone = Law::new(0.0, 0.0, c, alpha).unwrap().damping_force(velocity);
        let factor = 1.0 + f64::from(difference) * f64::from(velocity).signum();
        let exact = factor * f64::from(alone);
        let rounding = 2.0 * f64::from(f32::EPSILON) * f64::from(alone).abs();
        prop_assert!((single - exact).abs() <= rounding, "{single} {exact}");
    }
}
