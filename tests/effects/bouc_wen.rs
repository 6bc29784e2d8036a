//! Bouc–Wen friction against the closed form of its equation, or against a fine integration.

use mesh_damper::effects::{BoucWen, Effect, Motion, StickSlip};
use proptest::prelude::*;

use crate::loops::{TICKS, alone, close, energy, largest_force, last_cycle, work};

fn effect(stiffness: f64, slip_limit: f64, sharpness: f64) -> Effect<f64> {
    Effect::BoucWen(BoucWen::new(stiffness, slip_limit, sharpness).unwrap())
}

/// The force at the end of `steps` equal steps to `end` mm.
fn backbone(effect: Effect<f64>, end: f64, steps: usize) -> f64 {
    let law = alone(effect);
    let mut state = law.at_rest();
    (0..=steps).fold(0.0, |_, n| {
        let displacement = end * n as f64 / steps as f64;
        law.force(&mut state, &Motion::at(displacement, 0.0))
    })
}

/// The first loading is x·(1 − e^(−y/x)) for n = 1 and x·tanh y/x for n = 2.
#[test]
fn the_first_loading_is_an_exponential_or_a_hyperbolic_tangent() {
    for y in [0.005, 0.02, 0.06, -0.06] {
        let u: f64 = f64::abs(y) / 0.03;
        let sign = f64::signum(y);
        // Steps of a thousandth: an error of second order.
        let one = backbone(effect(1.2, 0.03, 1.0), y, 1000);
        close(one, sign * 1.2 * 0.03 * (1.0 - (-u).exp()), 1e-6);
        let two = backbone(effect(1.2, 0.03, 2.0), y, 1000);
        close(two, sign * 1.2 * 0.03 * u.tanh(), 1e-6);
    }
}

/// A step of x from z = −0.5·x: straight up to 0, and 1 − e^(−½) from there. The approximation of eᵃ is within a⁴/24.
#[test]
fn a_step_through_0_bends_behind_it() {
    let law = alone(effect(1.0, 1.0, 1.0));
    let mut state = law.at_rest();
    let mut to = |displacement: f64| {
        let motion = Motion::at(displacement, 0.0);
        law.force(&mut state, &motion)
    };
    to(0.0);
    let turned = (0..1000).fold(0.0, |_, n| to(-f64::from(n) * 2f64.ln() / 999.0));
    close(turned, -0.5, 1e-5);
    let through = to(-2f64.ln() + 1.0);
    close(through, 1.0 - (-0.5f64).exp(), 5e-3);
}

/// dζ = (1 − ζⁿ)·dη from 0, by a hundred thousand steps of the midpoint rule.
fn integrated(eta: f64, n: f64) -> f64 {
    let steps = 100_000;
    let h = eta / f64::from(steps);
    (0..steps).fold(0.0, |zeta: f64, _| {
        let middle = zeta + 0.5 * h * (1.0 - zeta.powf(n));
        zeta + h * (1.0 - middle.powf(n))
    })
}

/// A step of half the slip limit is within 6 % of that limit, and one of an eighth within 0.5 %. At 1000 ticks a cycle, an eighth
/// corresponds to an amplitude of twenty slip limits.
#[test]
fn long_steps_stay_close_for_any_sharpness() {
    for n in [0.5, 0.8, 1.7, 3.7, 8.0] {
        for steps in [1, 2, 4, 8] {
            let exact = integrated(0.5 * f64::from(steps), n);
            let coarse = backbone(effect(1.0, 1.0, n), 0.5 * f64::from(steps), steps as usize);
            let fine = backbone(
                effect(1.0, 1.0, n),
                0.5 * f64::from(steps),
                4 * steps as usize,
            );
            assert!((coarse - exact).abs() < 6e-2, "{n}: {coarse} {exact}");
            assert!((fine - exact).abs() < 5e-3, "{n}: {fine} {exact}");
        }
    }
}

/// From +Z at y = X it unloads in a straight line to 0 at X − Z, and bends from there to −Z at −X. With L = 2X − Z and Z the backbone
/// at L, the loop's energy is 2·k·(∫backbone to L − Z²/2).
#[test]
fn the_steady_loop_has_the_energy_of_its_branches() {
    let (k, x, amplitude) = (1.2, 0.03, 0.1);
    // Z is defined implicitly: it is nearly x.
    let fixed_point =
        |backbone: &dyn Fn(f64) -> f64| (0..100).fold(x, |z, _| backbone(2.0 * amplitude - z));
    let exponential = |l: f64| x * (1.0 - (-l / x).exp());
    let z = fixed_point(&exponential);
    let l = 2.0 * amplitude - z;
    let force = last_cycle(effect(k, x, 1.0), amplitude, 1.0, 3);
    close(
        energy(&force, amplitude),
        2.0 * k * (x * (l - z) - 0.5 * z * z),
        1e-6,
    );
    let tangent = |l: f64| x * (l / x).tanh();
    let z = fixed_point(&tangent);
    let l = 2.0 * amplitude - z;
    let force = last_cycle(effect(k, x, 2.0), amplitude, 1.0, 3);
    close(
        energy(&force, amplitude),
        2.0 * k * (x * x * (l / x).cosh().ln() - 0.5 * z * z),
        1e-6,
    );
}

/// The larger the sharpness, the closer to a Jenkins element, whose loop is 4·k·x·(X − x).
#[test]
fn sharp_ones_tend_to_a_jenkins_element() {
    let jenkins = Effect::StickSlip(StickSlip::new(&[(1.2, 0.03)]).unwrap());
    let jenkins = last_cycle(jenkins, 0.1, 1.0, 2);
    let distance = |sharpness| {
        let force = last_cycle(effect(1.2, 0.03, sharpness), 0.1, 1.0, 2);
        let squares = force.iter().zip(&jenkins).map(|(a, b)| (a - b).powi(2));
        (squares.sum::<f64>() / TICKS as f64).sqrt() / (1.2 * 0.03)
    };
    let distances = [1.0, 2.0, 4.0, 8.0].map(distance);
    assert!(distances.is_sorted_by(|a, b| a > b), "{distances:?}");
    assert!(distances[3] < 0.04, "{distances:?}");
}

#[test]
fn it_knows_no_frequency() {
    let effect = effect(1.2, 0.03, 1.4);
    assert_eq!(
        last_cycle(effect, 0.1, 0.5, 2),
        last_cycle(effect, 0.1, 10.0, 2)
    );
}

proptest! {
    /// The force never exceeds stiffness times slip limit, for any steps.
    #[test]
    fn it_stays_within_its_limit(
        path in prop::collection::vec(prop_oneof![-1.0..1.0_f32, -1e4..1e4_f32], 1..100),
        k in 0.01..10.0_f32, x in 1e-6..0.5_f32, n in 0.5..8.0_f32,
    ) {
        let force = largest_force(Effect::BoucWen(BoucWen::new(k, x, n).unwrap()), path);
        prop_assert!(force <= k * x);
    }

    /// Passive: over any closed path it absorbs energy and supplies none.
    #[test]
    fn it_is_passive(
        turns in prop::collection::vec(-0.3..0.3_f64, 2..8), x in 1e-3..0.2_f64, n in 0.5..8.0_f64,
    ) {
        let work = work(effect(1.0, x, n), turns.into_iter().chain([0.0]), 400);
        prop_assert!(work > -1e-6 * x, "{work}");
    }
}
