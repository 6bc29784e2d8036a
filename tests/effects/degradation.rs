//! A spring that degrades with the largest displacement, against the closed forms of its strokes.

use mesh_damper::effects::{Degradation, Effect, Motion};
use mesh_damper::real::Real;
use proptest::prelude::*;

use crate::loops::{TICKS, alone, close, energy, largest_force, last_cycle, sine, work};

fn effect<R: Real>(stiffness: f64, softening: f64, pinching: f64) -> Effect<R> {
    let [k, m0, p] = [stiffness, softening, pinching].map(R::from_f64);
    Effect::Degradation(Degradation::new(k, m0, p).unwrap())
}

/// The force at each displacement of `path`, mm.
fn along<R: Real>(effect: Effect<R>, path: &[f64]) -> Vec<f64> {
    let law = alone(effect);
    let mut state = law.at_rest();
    let force = |displacement: &f64| {
        let motion = Motion::at(R::from_f64(*displacement), R::ZERO);
        law.force(&mut state, &motion).to_f64()
    };
    path.iter().map(force).collect()
}

/// k·y/(1 + |y|/m₀), for any pinching.
#[test]
fn a_first_stroke_is_the_backbone() {
    let (k, m0) = (1.5, 0.08);
    for (sign, pinching) in [(1.0, 0.0), (-1.0, 0.0), (1.0, 0.4), (-1.0, 1.0)] {
        let path: Vec<f64> = (0..200).map(|n| sign * 1e-3 * f64::from(n)).collect();
        for (y, force) in path
            .iter()
            .zip(along::<f64>(effect(k, m0, pinching), &path))
        {
            let expected = k * y / (1.0 + y.abs() / m0);
            assert!((force - expected).abs() <= 1e-14, "{force} {expected}");
        }
    }
}

/// Within the previous range it is elastic: k·y·(1 − p + p·|y|/m)/(1 + m/m₀), on both sides, and its loop dissipates nothing.
#[test]
fn within_the_largest_displacement_it_is_elastic() {
    let (k, m0, m) = (1.5, 0.08, 0.2);
    for pinching in [0.0, 0.35, 1.0] {
        let whole = k / (1.0 + m / m0);
        let line = |y: f64| whole * y * (1.0 - pinching + pinching * y.abs() / m);
        let path = [-m, 0.15, 0.02, -0.1, 0.0, 0.2, -0.2];
        for (y, force) in path
            .iter()
            .zip(along::<f64>(effect(k, m0, pinching), &path))
        {
            assert!((force - line(*y)).abs() < 1e-14, "{y}: {force}");
        }
        let cycle = last_cycle::<f64>(effect(k, m0, pinching), m, 1.0, 2);
        assert!(energy(&cycle, m).abs() < 1e-12);
        close(cycle[TICKS / 4], line(m), 1e-12);
        let within = sine::<f64>(m, 1.0, TICKS / 12).displacement;
        close(cycle[TICKS / 12], line(within), 1e-12);
    }
}

/// The first stroke to m absorbs k·m₀²·(r − ln(1 + r)) with r = m/m₀, and returns k·m²·((1 − p)/2 + p/3)/(1 + r). The difference is
/// lost. A second stroke that goes no further loses nothing.
#[test]
fn a_first_stroke_loses_its_closed_form() {
    for (k, m0, p, m) in [
        (1.5, 0.08, 0.0, 0.2),
        (1.5, 0.08, 0.5, 0.2),
        (0.3, 1.0, 1.0, 0.1),
    ] {
        let r: f64 = m / m0;
        let taken = k * m0 * m0 * (r - r.ln_1p());
        let back = k * m * m * (0.5 * (1.0 - p) + p / 3.0) / (1.0 + r);
        let lost = work(effect(k, m0, p), [m, 0.0], 20_000);
        close(lost, taken - back, 1e-6);
        let again = work(effect(k, m0, p), [m, 0.0, -m, 0.0, 0.5 * m, 0.0], 20_000);
        close(again, lost, 1e-6);
    }
}

/// Without softening it is a spring.
#[test]
fn a_long_softening_leaves_a_spring() {
    let path = [0.1, -0.2, 0.05, 0.3];
    for (y, force) in path.iter().zip(along::<f64>(effect(2.0, 1e7, 0.0), &path)) {
        close(force, 2.0 * y, 1e-7);
    }
}

/// Before the first displacement there is no force, and the smallest displacement has a finite one.
#[test]
fn at_rest_it_has_no_force() {
    for pinching in [0.0, 1.0] {
        let forces = along::<f32>(effect(1.5, 0.08, pinching), &[0.0, -0.0, 0.0]);
        assert_eq!(forces, [0.0; 3]);
        let smallest = f64::from(f32::from_bits(1));
        let forces = along::<f32>(effect(1.5, 1e-9, pinching), &[smallest, 0.0, -smallest]);
        assert!(forces.iter().all(|force| force.is_finite()), "{forces:?}");
        assert_eq!(forces[1], 0.0);
        assert_eq!(
            along::<f64>(effect(1.5, 0.08, pinching), &[0.1, 0.0])[1],
            0.0
        );
    }
}

proptest! {
    /// The force is at most k·m₀, within the four roundings of its factors.
    #[test]
    fn it_stays_within_its_limit(
        path in prop::collection::vec(prop_oneof![-1.0..1.0_f32, -1e4..1e4_f32], 1..100),
        k in 0.01..10.0_f32, m0 in prop_oneof![1e-9..1e-6_f32, 1e-3..1.0_f32, 1.0..1e7_f32], p in 0.0..=1.0_f32,
    ) {
        let spring = Effect::Degradation(Degradation::new(k, m0, p).unwrap());
        let most = f64::from(k) * f64::from(m0);
        prop_assert!(f64::from(largest_force(spring, path)) <= most * (1.0 + 8.0 * 2.0_f64.powi(-24)));
    }

    /// Passive: along any path it absorbs at least the energy that it stores at the end.
    ///
    /// Trapezoids have an error of step²/8 times the change of the slope. The change is at most 2·k and occurs at most four times in
    /// a leg: about 0, at the largest displacement, and along the two curved branches.
    #[test]
    fn it_is_passive(
        turns in prop::collection::vec(-0.3..0.3_f64, 1..9), k in 0.1..5.0_f64, m0 in 1e-3..1.0_f64, p in 0.0..=1.0_f64,
    ) {
        let work = work(effect(k, m0, p), turns.iter().copied(), 2000);
        let step: f64 = 0.6 / 2000.0;
        let rounding = turns.len() as f64 * k * step.powi(2);
        prop_assert!(work > -rounding, "{work}");
    }

    /// For equal displacements in both precisions: eight roundings of 2^-24, and no sum in which they cancel.
    #[test]
    fn f32_follows_f64(
        path in prop::collection::vec(-0.3..0.3_f32, 1..50), m0 in 1e-3..1.0_f32, p in 0.0..=1.0_f32,
    ) {
        let path: Vec<f64> = path.into_iter().map(f64::from).collect();
        let [single, double] = [
            along(effect::<f32>(1.5, m0.into(), p.into()), &path),
            along(effect::<f64>(1.5, m0.into(), p.into()), &path),
        ];
        for (one, other) in single.into_iter().zip(double) {
            prop_assert!((one - other).abs() <= 8.0 * 2.0_f64.powi(-24) * other.abs(), "{one} {other}");
        }
    }
}
