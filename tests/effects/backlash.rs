//! Friction behind a play, against the closed forms of its loop.

use std::f64::consts::TAU;

use mesh_damper::effects::{Backlash, Effect, Motion, StickSlip};
use mesh_damper::real::Real;
use proptest::prelude::*;

use crate::loops::{TICKS, alone, close, energy, largest_force, last_cycle, sine, work};

fn effect<R: Real>(stiffness: f64, slip_limit: f64, slack: f64) -> Effect<R> {
    let [k, x, s] = [stiffness, slip_limit, slack].map(R::from_f64);
    Effect::Backlash(Backlash::new(k, x, s).unwrap())
}

/// 4·k·x·(X − x − s/2) if it slides, and 0 if it does not.
#[test]
fn it_dissipates_its_closed_form() {
    for (k, x, s, amplitude) in [
        (1.2, 0.03, 0.05, 0.2),
        (0.7, 0.1, 0.15, 0.2),
        (2.0, 0.01, 0.3, 0.2),
        (5.0, 0.02, 0.0, 0.03),
    ] {
        let force = last_cycle::<f64>(effect(k, x, s), amplitude, 1.0, 2);
        // A corner falls within a tick: an error of second order in the tick.
        let expected = 4.0 * k * x * (amplitude - x - 0.5 * s);
        close(energy(&force, amplitude), expected, 1e-5);
    }
    let stuck = last_cycle::<f64>(effect(2.0, 0.1, 0.21), 0.2, 1.0, 2);
    assert!(energy(&stuck, 0.2).abs() < 1e-7);
    close(stuck[TICKS / 4], 2.0 * (0.2 - 0.105), 1e-9);
}

/// After the reversal: k·(x − u) until the spring is slack, 0 over the play, −k·(u − x − s) until it slides.
#[test]
fn after_a_reversal_it_goes_through_the_play() {
    let (k, x, s, amplitude) = (1.2, 0.03, 0.05, 0.2);
    let force = last_cycle::<f64>(effect(k, x, s), amplitude, 1.0, 2);
    let mut in_the_play = 0;
    let ticks = force.iter().enumerate();
    for (n, force) in ticks.take(3 * TICKS / 4).skip(TICKS / 4) {
        let way = amplitude * (1.0 - (TAU * n as f64 / TICKS as f64).sin());
        let expected = k * (x - way).max(0.0) - k * (way - x - s).clamp(0.0, x);
        assert!(
            (force - expected).abs() < 1e-12,
            "{way}: {force} is not {expected}"
        );
        in_the_play += usize::from(*force == 0.0);
    }
    assert!(in_the_play > 500, "{in_the_play}");
}

/// Half of the play lies before the first motion.
#[test]
fn it_begins_in_the_middle_of_the_play() {
    for sign in [1.0, -1.0] {
        let law = alone::<f64>(effect(2.0, 0.03, 0.08));
        let mut state = law.at_rest();
        let mut to = |displacement| {
            let motion = Motion::at(displacement, 0.0);
            law.force(&mut state, &motion)
        };
        // At any start position.
        assert_eq!(to(5.0), 0.0);
        assert_eq!(to(5.0 + sign * 0.0399), 0.0);
        close(to(5.0 + sign * 0.05), sign * 2.0 * 0.01, 1e-9);
        close(to(5.0 + sign * 0.3), sign * 2.0 * 0.03, 1e-9);
        // The slider moved with it, and at rest the force stays.
        close(to(5.0 + sign * 0.3), sign * 2.0 * 0.03, 1e-9);
        assert_eq!(to(5.0 + sign * 0.2), 0.0);
        assert_eq!(to(5.0 + sign * 0.2), 0.0);
    }
}

#[test]
fn without_a_play_it_is_a_jenkins_element() {
    for zero in [0.0, -0.0] {
        let slider = Effect::StickSlip(StickSlip::new(&[(1.3, 0.04)]).unwrap());
        assert_eq!(
            last_cycle::<f64>(effect(1.3, 0.04, zero), 0.1, 1.0, 2),
            last_cycle(slider, 0.1, 1.0, 2)
        );
    }
}

/// For equal displacements in both precisions, steps are exact, and their sums round by at most 2^-24 of half the play and the slip
/// limit. This is a random walk over the 10⁴ ticks of a half cycle, √10⁴·2^-24·(s/2 + x)/√3; the worst case is three of these.
#[test]
fn f32_follows_f64_within_rounding() {
    let (k, x, s) = (1.5_f64, 0.02, 0.05);
    let (single, double) = (alone::<f32>(effect(k, x, s)), alone::<f64>(effect(k, x, s)));
    let (mut small, mut large) = (single.at_rest(), double.at_rest());
    let mut error = 0.0_f64;
    for n in 0..5 * TICKS {
        let motion: Motion<f32> = sine(0.2, 1.0, n);
        let exact = Motion::at(f64::from(motion.displacement), 0.0);
        let [one, other] = [
            f64::from(single.force(&mut small, &motion)),
            double.force(&mut large, &exact),
        ];
        error = error.max((one - other).abs());
    }
    let walk = 100.0 * 2.0_f64.powi(-24) * (0.5 * s + x) / 3.0_f64.sqrt();
    assert!(error > 0.0 && error < 3.0 * k * walk, "{error} {walk}");
}

proptest! {
    /// The force never exceeds stiffness times limit, for any play and any step length.
    #[test]
    fn it_stays_within_its_limit(
        path in prop::collection::vec(prop_oneof![-1.0..1.0_f32, -1e4..1e4_f32], 1..100),
        k in 0.01..10.0_f32, x in prop_oneof![1e-9..1e-6_f32, 1e-4..0.5_f32],
        s in prop_oneof![Just(0.0_f32), 1e-4..1.0_f32, 1.0..1e4_f32],
    ) {
        let backlash = Effect::Backlash(Backlash::new(k, x, s).unwrap());
        prop_assert!(largest_force(backlash, path) <= k * x);
    }

    /// Passive: along any path it absorbs at least the energy that its spring stores at the end, which it may return.
    ///
    /// A step that ends in the play counts more energy than the spring returns: by k·a·b/2, with a before the play's edge and b
    /// behind it, at most k·step²/8. There is one such step in a leg.
    #[test]
    fn it_is_passive(
        turns in prop::collection::vec(-0.3..0.3_f64, 1..9), k in 0.1..5.0_f64, x in 1e-3..0.2_f64,
        s in prop_oneof![Just(0.0), 0.0..0.4_f64],
    ) {
        let work = work(effect(k, x, s), turns.iter().copied(), 2000);
        let step: f64 = 0.6 / 2000.0;
        let rounding = turns.len() as f64 * k * step.powi(2) / 8.0 + 1e-12;
        prop_assert!(work > -rounding, "{work}");
    }
}
