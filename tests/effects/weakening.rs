//! A slider that weakens with its dissipated energy, against the closed form of that energy over its sliding distance.

use mesh_damper::effects::{Effect, Motion, StickSlip, Weakening};
use mesh_damper::real::Real;
use proptest::prelude::*;

use crate::loops::{TICKS, alone, close, energy, largest_force, last_cycle, sine, work};

fn effect<R: Real>(parameters: [f64; 4]) -> Effect<R> {
    let [k, x, d, e0] = parameters.map(R::from_f64);
    Effect::Weakening(Weakening::new(k, x, d, e0).unwrap())
}

/// E in J after `way` mm of sliding at k·x·(1 − d·E/(E + E₀)) kN: E/(1 − d) − d·E₀/(1 − d)²·ln(1 + (1 − d)·E/E₀) = k·x·way, by
/// bisection. d is below 1.
fn dissipated(way: f64, [k, x, d, e0]: [f64; 4]) -> f64 {
    let left = 1.0 - d;
    let held = |e: f64| e / left - d * e0 / (left * left) * (left * e / e0).ln_1p();
    let (mut low, mut high) = (0.0, k * x * way);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if held(middle) < k * x * way {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The remaining strength at that point.
fn strength(way: f64, parameters: [f64; 4]) -> f64 {
    let [k, x, d, e0] = parameters;
    let e = dissipated(way, parameters);
    k * x * (1.0 - d * e / (e + e0))
}

/// The first quarter cycle slides X − x, each half cycle after it 2·(X − x): the force at the reversals.
#[test]
fn it_weakens_as_its_closed_form_says() {
    for parameters in [
        [1.5, 0.03, 0.6, 0.05],
        [0.8, 0.1, 0.95, 0.01],
        [2.0, 0.01, 0.2, 0.3],
    ] {
        let (x, amplitude) = (parameters[1], 0.2);
        let law = alone::<f64>(effect(parameters));
        let mut state = law.at_rest();
        let mut fallen = 1.0;
        for n in 0..10 * TICKS {
            let force = law.force(&mut state, &sine(amplitude, 1.0, n));
            if n % (TICKS / 2) == TICKS / 4 {
                let turn = (2 * n / TICKS) as f64;
                let way = (1.0 + 2.0 * turn) * (amplitude - x);
                let expected = strength(way, parameters);
                // A tick's strength by its ends: an error of second order in the tick.
                close(force.abs(), expected, 1e-7);
                fallen = expected / (parameters[0] * x);
            }
        }
        assert!(fallen < 0.99);
    }
}

/// 4·k·x·(X − x)·(1 − d·E/(E + E₀)), with E at the middle of the cycle: it changes by a hundredth within one cycle.
#[test]
fn a_steady_loop_dissipates_its_closed_form() {
    let (k, x, d, amplitude) = (1.5, 0.03, 0.7, 0.2);
    let whole = 4.0 * k * x * (amplitude - x);
    let e0 = 20.0 * whole;
    let force = last_cycle::<f64>(effect([k, x, d, e0]), amplitude, 1.0, 40);
    // The sliding to the first reversal, in 77 half cycles, in another one up to 0, and in half of this cycle.
    let way = (1.0 + 2.0 * 77.0 + 2.0) * (amplitude - x) + amplitude - 2.0 * x;
    let e = dissipated(way, [k, x, d, e0]);
    let expected = whole * (1.0 - d * e / (e + e0));
    assert!(expected < 0.7 * whole);
    close(energy(&force, amplitude), expected, 1e-3);
}

#[test]
fn without_a_loss_it_is_a_jenkins_element() {
    let slider = Effect::StickSlip(StickSlip::new(&[(1.3, 0.04)]).unwrap());
    assert_eq!(
        last_cycle::<f64>(effect([1.3, 0.04, 0.0, 0.1]), 0.1, 1.0, 3),
        last_cycle(slider, 0.1, 1.0, 3)
    );
}

/// A slider that sticks does not weaken, for any time.
#[test]
fn what_does_not_slide_does_not_weaken() {
    let force = last_cycle::<f64>(effect([2.0, 0.3, 1.0, 1e-9]), 0.2, 1.0, 20);
    assert!(energy(&force, 0.2).abs() < 1e-12);
    close(force[TICKS / 4], 2.0 * 0.2, 1e-9);
    // At rest it has no force before the first motion, and keeps its force after a motion.
    let law = alone::<f32>(effect([2.0, 0.3, 1.0, 1e-9]));
    let mut state = law.at_rest();
    let mut to = |displacement| {
        let motion = Motion::at(displacement, 0.0);
        law.force(&mut state, &motion)
    };
    assert_eq!(to(3.0), 0.0);
    let held = to(3.125);
    assert!((0..1000).all(|_| to(3.125) == held));
}

/// 10⁷ ticks in f32, the last of which add less than a rounding unit of the sum: back and forth by exact steps of 2^-24 mm.
///
/// The sum is compensated, so its error is two units of 2^-24 and does not grow with the ticks. Each term has four roundings of its
/// own.
#[test]
fn ten_million_ticks_add_up_in_f32() {
    // In steps.
    let (limit, turn, turns) = (1 << 9, 1 << 14, 305);
    let step = 2.0_f64.powi(-24);
    let parameters = [1.0, f64::from(limit) * step, 0.5, 2e-5];
    let law = alone::<f32>(effect(parameters));
    let mut state = law.at_rest();
    let (mut force, mut ticks) = (0.0, 0);
    // To the first reversal, and from reversal to reversal.
    let mut place: i32 = 0;
    for number in 0..=turns {
        let way = if number % 2 == 0 { 1 } else { -1 };
        while place != way * turn {
            place += way;
            let motion = Motion::at((f64::from(place) * step) as f32, 0.0);
            force = law.force(&mut state, &motion);
            ticks += 1;
        }
    }
    assert!(ticks > 9_990_000, "{ticks}");
    // The first tick is at the start position.
    let slid = f64::from(turn - limit - 1) + 2.0 * f64::from(turns * (turn - limit));
    let expected = strength(slid * step, parameters);
    assert!(expected < 0.9 * parameters[1]);
    close(f64::from(force.abs()), expected, 1e-6);
}

/// The energy ends where it no longer matters: the remaining strength is 1 − d, and nothing overflows.
#[test]
fn it_ends_with_what_is_left() {
    for (k, x, d) in [(1e9, 1e4, 0.75), (-1e9, 1e4, 1.0), (1e9, 1.0, 0.5)] {
        let law = alone::<f32>(effect([k, x, d, 1e-9]));
        let mut state = law.at_rest();
        let mut force = 0.0;
        for n in 0..1000 {
            let motion = Motion::at(if n % 2 == 0 { -1e4 } else { 1e4 }, 0.0);
            force = law.force(&mut state, &motion);
        }
        let left = k * x * (1.0 - d);
        assert!(
            (f64::from(force) - left).abs() <= 1e-6 * (k * x).abs(),
            "{force} {left}"
        );
    }
}

proptest! {
    /// The force never exceeds stiffness times its limit.
    #[test]
    fn it_stays_within_its_limit(
        path in prop::collection::vec(prop_oneof![-1.0..1.0_f32, -1e4..1e4_f32], 1..100),
        k in 0.01..10.0_f32, x in 1e-6..0.5_f32, d in 0.0..=1.0_f32, e0 in prop_oneof![1e-9..1e-6_f32, 1e-3..1.0_f32],
    ) {
        let slider = Effect::Weakening(Weakening::new(k, x, d, e0).unwrap());
        prop_assert!(largest_force(slider, path) <= k * x);
    }

    /// Passive: along any path it absorbs at least the energy that its spring stores at the end. No step here leads from one limit to
    /// the other.
    #[test]
    fn it_is_passive(
        turns in prop::collection::vec(-0.3..0.3_f64, 1..9), k in 0.1..5.0_f64, x in 1e-3..0.2_f64, d in 0.0..=1.0_f64,
        e0 in prop_oneof![1e-6..1e-3_f64, 1e-3..1.0_f64],
    ) {
        let work = work(effect([k, x, d, e0]), turns, 2000);
        prop_assert!(work > -1e-12, "{work}");
    }
}
