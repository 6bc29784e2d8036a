//! A dashpot that yields behind a spring, against its closed forms and limiting cases.

use std::f64::consts::TAU;

use mesh_damper::effects::{Effect, Motion, Relaxation, StickSlip, Yielding};
use mesh_damper::real::Real;
use proptest::prelude::*;

use crate::loops::{alone, close, largest_force, work};

/// Stiffness, yield stretch, rate and time.
type Parameters = [f64; 4];

fn effect<R: Real>(parameters: Parameters, tick: f64) -> Effect<R> {
    let [k, x, rate, time] = parameters.map(R::from_f64);
    Effect::Yielding(Yielding::new(k, x, rate, time, R::from_f64(tick)).unwrap())
}

/// The forces along `path`, starting at rest.
fn along<R: Real>(effect: Effect<R>, path: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let law = alone(effect);
    let mut state = law.at_rest();
    let force = |displacement: f64| {
        let motion = Motion::at(R::from_f64(displacement), R::ZERO);
        law.force(&mut state, &motion).to_f64()
    };
    path.into_iter().map(force).collect()
}

/// A path of two sines at `rate` ticks a second, for `duration` s.
fn wave(rate: f64, duration: f64) -> impl Iterator<Item = f64> {
    (0..=(rate * duration) as usize).map(move |n| {
        let time = n as f64 / rate;
        0.1 * (TAU * 2.0 * time).sin() + 0.04 * (TAU * 7.0 * time).sin()
    })
}

fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().map(f64::abs).fold(0.0, f64::max)
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    largest(a.iter().zip(b).map(|(a, b)| a - b))
}

/// w of x·tanh(w/v₀) + τ·w = e, by bisection.
fn rate_at(e: f64, [_, x, v0, time]: Parameters) -> f64 {
    let (mut low, mut high) = (0.0, 1e4);
    for _ in 0..100 {
        let middle: f64 = 0.5 * (low + high);
        if x * (middle / v0).tanh() + time * middle < e.abs() {
            low = middle;
        } else {
            high = middle;
        }
    }
    low.copysign(e)
}

/// The forces at the ticks, with straight lines between them, each integrated in many steps of the midpoint rule.
fn reference(parameters: Parameters, path: &[f64], tick: f64) -> Vec<f64> {
    const STEPS: u32 = 100;
    let step = tick / f64::from(STEPS);
    let mut e: f64 = 0.0;
    let mut forces = vec![0.0];
    for ends in path.windows(2) {
        let velocity = (ends[1] - ends[0]) / tick;
        let slope = |e: f64| velocity - rate_at(e, parameters);
        for _ in 0..STEPS {
            let middle = e + 0.5 * step * slope(e);
            e += step * slope(middle);
        }
        forces.push(parameters[0] * e);
    }
    forces
}

/// With a yield stretch of 0 the dashpot is linear.
#[test]
fn without_a_yield_stretch_it_is_a_maxwell_branch() {
    let error = |rate: f64| {
        let branch = Effect::Relaxation(Relaxation::new(&[(1.5, 0.04)], 1.0 / rate).unwrap());
        let own = along(
            effect::<f64>([1.5, 0.0, 3.0, 0.04], 1.0 / rate),
            wave(rate, 1.0),
        );
        difference(&own, &along(branch, wave(rate, 1.0)))
    };
    let (coarse, fine) = (error(250.0), error(500.0));
    assert!(
        fine < 1e-4 && (3.5..4.5).contains(&(coarse / fine)),
        "{coarse} {fine}"
    );
}

/// The same for a small motion, with the time x/v₀ + τ.
#[test]
fn a_small_motion_does_not_make_it_yield() {
    let small = || wave(1000.0, 1.0).map(|y| 1e-4 * y);
    let branch = Effect::Relaxation(Relaxation::new(&[(2.0, 0.05 / 2.0 + 0.01)], 1e-3).unwrap());
    let branch = along(branch, small());
    let own = along(effect::<f64>([2.0, 0.05, 2.0, 0.01], 1e-3), small());
    assert!(difference(&own, &branch) < 1e-3 * largest(branch));
}

#[test]
fn a_steady_velocity_is_held_by_the_dashpot() {
    let [k, x, rate, time] = [1.2, 0.05, 3.0, 0.002];
    for velocity in [-40.0, -2.0, 0.03, 1.0, 7.0, 300.0] {
        let tick = 1e-3;
        let path = (0..3000).map(|n| velocity * tick * f64::from(n));
        let forces = along(effect::<f64>([k, x, rate, time], tick), path);
        let held = k * (x * (velocity / rate).tanh() + time * velocity);
        close(*forces.last().unwrap(), held, 1e-6);
    }
}

/// Behind a stiff spring the dashpot takes the whole motion, and its rate at a tick's end is that of the straight line before it.
#[test]
fn a_stiff_spring_leaves_the_dashpot() {
    let (yields, rate, c, stiffness) = (0.3, 2.0, 0.01, 1e7);
    let tick = 1e-3;
    let path: Vec<f64> = wave(1.0 / tick, 1.0).collect();
    let stiff = [stiffness, yields / stiffness, rate, c / stiffness];
    let forces = along(effect::<f64>(stiff, tick), path.iter().copied());
    for (ends, force) in path.windows(2).zip(&forces[1..]) {
        let velocity = (ends[1] - ends[0]) / tick;
        let dashpot = yields * (velocity / rate).tanh() + c * velocity;
        assert!((force - dashpot).abs() < 1e-3 * yields, "{force} {dashpot}");
    }
}

/// With a very small rate it holds as long as a Jenkins element, and yields where that slips.
#[test]
fn a_small_rate_makes_a_jenkins_element() {
    let [k, x] = [1.5, 0.03];
    let slider = Effect::StickSlip(StickSlip::new(&[(k, x)]).unwrap());
    let slider = along(slider, wave(2000.0, 1.0));
    let own = along(effect::<f64>([k, x, 1e-6, 0.0], 5e-4), wave(2000.0, 1.0));
    let error = difference(&own, &slider);
    assert!(error < 1e-4 * k * x, "{error}");
}

/// Against an integration of another kind; steps of half the length have a quarter of the error.
#[test]
fn a_step_is_of_the_second_order() {
    for parameters in [
        [1.0, 0.05, 0.8, 0.003],
        [1.0, 0.04, 2.0, 0.0],
        [1.0, 0.02, 0.5, 0.05],
    ] {
        let error = |rate: f64| {
            // The same path for all tick lengths: a straight line within the coarsest tick.
            let corners: Vec<f64> = wave(200.0, 1.0).collect();
            let within = (rate / 200.0) as usize;
            let path: Vec<f64> = (0..within * (corners.len() - 1))
                .map(|n| {
                    let (corner, part) = (n / within, (n % within) as f64 / within as f64);
                    corners[corner] + part * (corners[corner + 1] - corners[corner])
                })
                .collect();
            let tick = 1.0 / rate;
            let own = along(effect::<f64>(parameters, tick), path.iter().copied());
            let exact = reference(parameters, &path, tick);
            let squares = own
                .iter()
                .zip(exact)
                .map(|(own, exact)| (own - exact).powi(2));
            (squares.sum::<f64>() / own.len() as f64).sqrt()
        };
        let (coarse, fine) = (error(400.0), error(800.0));
        let ratio = coarse / fine;
        assert!(
            fine < 1e-4 && (3.0..5.0).contains(&ratio),
            "{parameters:?}: {coarse} {fine}"
        );
    }
}

/// The rounding is no more than that of a stretch of 0.1 mm.
#[test]
fn f32_follows_f64() {
    for parameters in [
        [1.0, 0.05, 0.8, 0.003],
        [1.0, 0.0, 0.8, 0.03],
        [1.0, 0.03, 1e-6, 0.0],
        [1.0, 0.03, 50.0, 1e-5],
        [1.0, 1e-6, 1.0, 0.0],
    ] {
        let path = || wave(1e4, 1.0).map(|y| f64::from(y as f32));
        let exact = along(effect::<f64>(parameters, 1e-4), path());
        let rounded = along(effect::<f32>(parameters, 1e-4), path());
        let error = difference(&rounded, &exact);
        assert!(error < 1e-5 * largest(exact), "{parameters:?}: {error}");
    }
}

fn parameters() -> impl Strategy<Value = Parameters> {
    let logarithm = |low: f64, high: f64| (low.ln()..high.ln()).prop_map(f64::exp);
    let or_none = |low, high| prop_oneof![1 => Just(0.0), 4 => logarithm(low, high)];
    (or_none(1e-4, 3.0), logarithm(1e-3, 1e3), or_none(1e-4, 1e2))
        .prop_map(|(x, rate, time)| [1.0, x, rate, time])
}

proptest! {
    /// Passive: over any closed path it absorbs energy and supplies none.
    #[test]
    fn it_is_passive(
        turns in prop::collection::vec(-0.3..0.3_f64, 2..8), parameters in parameters(), tick in 1e-5..1e-2_f64,
    ) {
        let work = work(effect(parameters, tick), turns.into_iter().chain([0.0]), 500);
        prop_assert!(work > -1e-5, "{work}");
    }

    /// The longest permitted steps supply no energy either: the energy absorbed since rest is never below 0.
    #[test]
    fn few_ticks_to_a_cycle_give_no_energy(
        turns in prop::collection::vec(-1.0..1.0_f64, 2..7), parameters in parameters(), tick in 0.1..10.0_f64,
    ) {
        let path: Vec<f64> = (0..40).flat_map(|_| &turns).fold(vec![0.0], |mut path, y| {
            path.push(*y);
            path
        });
        let forces = along::<f64>(effect(parameters, tick), path.iter().copied());
        let (mut taken, mut size) = (0.0, 0.0);
        for (ends, forces) in path.windows(2).zip(forces.windows(2)) {
            let work = 0.5 * (forces[0] + forces[1]) * (ends[1] - ends[0]);
            taken += work;
            size += (forces[0].abs() + forces[1].abs()) * (ends[1] - ends[0]).abs();
            prop_assert!(taken >= -1e-9 * size, "{taken} of {size}");
        }
    }

    /// The force never exceeds that of the dashpot at the largest velocity. If its memory is shorter than a tick, the limit is a
    /// fifth higher.
    #[test]
    fn it_stays_below_what_the_dashpot_holds(
        path in prop::collection::vec(prop_oneof![-1.0..1.0_f32, -1e4..1e4_f32], 2..100),
        x in 1e-6..0.5_f32, rate in 1e-3..1e3_f32, time in prop_oneof![Just(0.0), 1e-5..1.0_f32],
    ) {
        let tick = 1e-3;
        let velocity = path.windows(2).map(|ends| (ends[1] - ends[0]).abs() / tick).fold(0.0, f32::max);
        let effect = Effect::Yielding(Yielding::new(1.0, x, rate, time, tick).unwrap());
        let force = largest_force(effect, path);
        prop_assert!(force <= 1.2001 * time * velocity + x * 1.00001, "{force}");
    }

    /// For any parameters and any path.
    #[test]
    fn it_is_finite(
        path in prop::collection::vec(prop_oneof![-1e-30..1e-30_f32, -1.0..1.0_f32, -1e4..1e4_f32], 2..50),
        x in prop_oneof![Just(0.0_f32), Just(1e-38), Just(1e4), (-40.0..9.0_f32).prop_map(f32::exp)],
        rate in prop_oneof![Just(1e-9_f32), Just(1e6), (-20.0..13.0_f32).prop_map(f32::exp)],
        time in prop_oneof![Just(0.0_f32), Just(1e6), (-40.0..13.0_f32).prop_map(f32::exp)],
        tick in prop_oneof![Just(1e-7_f32), Just(1e3), (-16.0..6.0_f32).prop_map(f32::exp)],
    ) {
        let effect = Effect::Yielding(Yielding::new(1.0, x, rate, time, tick).unwrap());
        let force = largest_force(effect, path.clone());
        prop_assert!(force <= 2e4 * path.len() as f32, "{force}");
    }
}
