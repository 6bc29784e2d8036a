//! Friction that grows with the load, together with eq 13's friction.

use std::f64::consts::TAU;

use mesh_damper::effects::{AugmentedLaw, Effect, LoadFriction};
use mesh_damper::law::Law;
use proptest::prelude::*;

use super::loops::{TICKS, close, energy, sine};

const LOAD: f64 = 9.0;

fn law(c: f64, alpha: f64, load: f64) -> AugmentedLaw<f64, 1> {
    let law = Law::new(0.4, 15.0, c, alpha).unwrap();
    let friction = LoadFriction::new(load).unwrap();
    AugmentedLaw::new(law)
        .with(Effect::LoadFriction(friction))
        .unwrap()
}

fn cycle(law: &AugmentedLaw<f64, 1>, amplitude: f64, frequency: f64) -> Vec<f64> {
    let mut state = law.at_rest();
    (0..TICKS)
        .map(|n| law.force(&mut state, &sine(amplitude, frequency, n)))
        .collect()
}

/// The load adds a dissipation of 4·λ·c·ω^α·X^(2+α)/(2 + α).
#[test]
fn it_dissipates_its_closed_form() {
    for (amplitude, frequency, c, alpha) in [
        (0.1, 1.0, 0.05, 0.4),
        (0.25, 10.0, 0.09, 0.16),
        (0.02, 3.0, 0.2, 1.0),
    ] {
        let [with, without] = [LOAD, 0.0].map(|load| {
            energy(
                &cycle(&law(c, alpha, load), amplitude, frequency),
                amplitude,
            )
        });
        let omega = TAU * frequency;
        let expected =
            4.0 * LOAD * c * omega.powf(alpha) * amplitude.powf(2.0 + alpha) / (2.0 + alpha);
        // |v|^α changes sign within a tick at the reversals, more steeply for a smaller α.
        close(with - without, expected, 1e-5);
    }
}

/// α = 0 is Coulomb friction at contacts with a normal force proportional to |y|: ΔW = 2·λ·c·X², from a loop that is closed at its
/// middle.
#[test]
fn without_rate_it_is_coulombs_with_the_load_as_its_normal_force() {
    let (c, amplitude) = (0.05, 0.1);
    let [with, without] = [LOAD, 0.0].map(|load| cycle(&law(c, 0.0, load), amplitude, 1.0));
    let added: Vec<f64> = with.iter().zip(&without).map(|(a, b)| a - b).collect();
    // The jump at a reversal falls within one tick of 20 000.
    close(
        energy(&added, amplitude),
        2.0 * LOAD * c * amplitude.powi(2),
        1e-4,
    );
    for (n, force) in added.iter().enumerate().take(TICKS / 4).skip(1) {
        let y = sine::<f64>(amplitude, 1.0, n).displacement;
        close(*force, LOAD * c * y, 1e-9);
    }
}

proptest! {
    /// It never drives the motion, except for the rounding of the law's force.
    #[test]
    fn its_power_is_never_negative(
        load in 0.0..1e3f64,
        c in 0.0..1.0f64,
        alpha in 0.0..1.0f64,
        amplitude in 1e-3..0.5f64,
        frequency in 0.1..50.0f64,
    ) {
        let [with, without] = [load, 0.0].map(|load| cycle(&law(c, alpha, load), amplitude, frequency));
        for n in 0..TICKS {
            let v = sine::<f64>(amplitude, frequency, n).velocity;
            let rounding = 1e-14 * load * with[n].abs() * v.abs();
            prop_assert!((with[n] - without[n]) * v >= -rounding);
        }
    }
}
