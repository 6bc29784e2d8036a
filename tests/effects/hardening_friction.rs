//! Friction that hardens, against the closed forms of its equation.

use mesh_damper::effects::{BoucWen, Effect, HardeningFriction, Motion};
use proptest::prelude::*;

use crate::loops::{alone, close, largest_force, work};

fn effect(stiffness: f64, limit: f64, sharpness: f64, hardening: f64, loss: f64) -> Effect<f64> {
    Effect::HardeningFriction(
        HardeningFriction::new(stiffness, limit, sharpness, hardening, loss).unwrap(),
    )
}

/// The forces at the ends of legs of `steps` equal steps: from 0 to the first of `turns`, and from each to the next.
fn at_turns(effect: Effect<f64>, turns: &[f64], steps: usize) -> Vec<f64> {
    let law = alone(effect);
    let mut state = law.at_rest();
    let mut to = |displacement: f64| {
        let motion = Motion::at(displacement, 0.0);
        law.force(&mut state, &motion)
    };
    to(0.0);
    let mut from = 0.0;
    turns
        .iter()
        .map(|&turn| {
            let leg = (1..=steps).map(|n| from + (turn - from) * n as f64 / steps as f64);
            let force = leg.fold(0.0, |_, y| to(y));
            from = turn;
            force
        })
        .collect()
}

/// For n = 1, with a = h/x and b = (h + l)/x: away from 0 z = (e^(a·y) − 1)/a, towards 0 z = ((1 + b·z₀)·e^(−b·y) − 1)/b, which is 0
/// after ln(1 + b·z₀)/b.
#[test]
fn branches_are_the_closed_forms() {
    let (x, h, l): (f64, f64, f64) = (2.0, 1.2, 3.0);
    let (a, b) = (h / x, (h + l) / x);
    let (up, back) = (0.5, 0.1);
    let top = ((a * up).exp() - 1.0) / a;
    let returned = ((1.0 + b * top) * (-b * back).exp() - 1.0) / b;
    // To 0, and the same distance on the other side.
    let to_zero = (1.0 + b * returned).ln() / b;
    let beyond = 0.3;
    let end = -((a * beyond).exp() - 1.0) / a;
    let turns = [up, up - back, up - back - to_zero - beyond];
    // For any step length.
    for (sign, steps) in [(1.0, 500), (-1.0, 500), (1.0, 1), (-1.0, 2)] {
        let turns = turns.map(|y| sign * y);
        let found = at_turns(effect(1.5, x, 1.0, h, l), &turns, steps);
        for (found, expected) in found.into_iter().zip([top, returned, end]) {
            close(found, sign * 1.5 * expected, 1e-4);
        }
    }
}

/// With h = −1 and l = 1 a branch away from 0 bends, and one towards 0 is straight, as for [`BoucWen`].
#[test]
fn without_hardening_it_is_the_softening_one() {
    for n in [0.7, 1.0, 2.5] {
        let other = Effect::BoucWen(BoucWen::new(1.2, 0.03, n).unwrap());
        let turns = [0.05, -0.02, 0.01, -0.08];
        let own = at_turns(effect(1.2, 0.03, n, -1.0, 1.0), &turns, 4000);
        for (own, other) in own.into_iter().zip(at_turns(other, &turns, 4000)) {
            assert!(
                (own - other).abs() < 1e-4 * 1.2 * 0.03,
                "{n}: {own} {other}"
            );
        }
    }
}

/// Steps of half the length have a quarter of the error.
#[test]
fn a_step_is_of_the_second_order() {
    for n in [1.3, 2.0, 3.0] {
        // Within the limit, and not through 0, where steps end at other positions.
        let turns = [0.5, 0.3];
        let of = |steps| at_turns(effect(1.0, 1.5, n, 1.5, 6.0), &turns, steps);
        let exact = of(20_000);
        let error = |steps| -> f64 {
            let pairs = of(steps).into_iter().zip(&exact);
            pairs.map(|(coarse, exact)| (coarse - exact).abs()).sum()
        };
        let ratio = error(20) / error(40);
        assert!((3.5..4.5).contains(&ratio), "{n}: {ratio}");
    }
}

/// With h + l < 0 the force of a branch towards 0 falls less than in proportion: n = 1 has the closed form of
/// [`branches_are_the_closed_forms`] with b < 0.
#[test]
fn a_branch_that_falls_less_than_its_way_ends_where_it_must() {
    let (x, h, l): (f64, f64, f64) = (1.0, -0.9, 0.2);
    let b = (h + l) / x;
    let top = ((h * 0.8).exp() - 1.0) / h;
    let to_zero = (1.0 + b * top).ln() / b;
    let end = -((h * 0.3).exp() - 1.0) / h;
    for steps in [500, 1] {
        let turns = [0.8, 0.8 - to_zero - 0.3];
        let found = at_turns(effect(1.0, x, 1.0, h, l), &turns, steps);
        for (found, expected) in found.into_iter().zip([top, end]) {
            close(found, expected, 1e-4);
        }
    }
}

/// Twenty steps a cycle, also for sharp and lossy friction: the dissipated energy is about that with many steps.
#[test]
fn few_steps_lose_about_as_much() {
    for (n, loss) in [
        (0.6, 20.0),
        (1.0, 100.0),
        (2.0, 20.0),
        (2.0, 100.0),
        (3.0, 160.0),
    ] {
        let turns = [0.4, -0.4, 0.4, -0.4, 0.4];
        let lost = |steps| work(effect(1.0, 1.0, n, 4.0, loss), turns, steps);
        let (fine, coarse) = (lost(20_000), lost(10));
        assert!(
            (0.8..1.6).contains(&(coarse / fine)),
            "{n} {loss}: {coarse} {fine}"
        );
    }
}

proptest! {
    /// The force never exceeds stiffness times its limit, for any steps.
    #[test]
    fn it_stays_within_its_limit(
        path in prop::collection::vec(prop_oneof![-1.0..1.0_f32, -1e4..1e4_f32], 1..100),
        k in 0.01..10.0_f32, x in 1e-6..0.5_f32, n in prop_oneof![0.5..0.7_f32, 0.5..8.0_f32],
        h in prop_oneof![-1.0..0.0_f32, -1.0..100.0_f32], l in prop_oneof![0.0..1.0_f32, 0.0..200.0_f32],
    ) {
        let friction = HardeningFriction::new(k, x, n, h, l).unwrap();
        let force = largest_force(Effect::HardeningFriction(friction), path);
        prop_assert!(force <= k * x);
    }

    /// Passive: over any closed path it absorbs energy and supplies none.
    #[test]
    fn it_is_passive(
        turns in prop::collection::vec(-0.3..0.3_f64, 2..8), x in 0.05..1.0_f64, n in 0.5..4.0_f64,
        h in -1.0..5.0_f64, l in 0.0..20.0_f64,
    ) {
        let work = work(effect(1.0, x, n, h, l), turns.into_iter().chain([0.0]), 2000);
        prop_assert!(work > -1e-4 * x, "{work}");
    }
}
