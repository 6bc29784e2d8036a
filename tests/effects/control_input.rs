//! A branch and a dashpot whose strength a control input sets, against closed forms.

use mesh_damper::effects::{CONTROLS, ControlInput, Effect, Motion, Yielding};
use mesh_damper::error::ConfigError;
use mesh_damper::limits;
use mesh_damper::real::Real;
use proptest::prelude::*;

use crate::loops::{alone, close};

const TICK: f64 = 1e-3;
/// Stiffness, yield stretch, rate and viscosity at an input of 1.
const BRANCH: [f64; 4] = [2.0, 0.04, 0.3, 0.01];

fn effect<R: Real>(input: usize, tick: f64) -> ControlInput<R> {
    let [k, x, rate, viscosity] = BRANCH.map(R::from_f64);
    let branch = Yielding::new(k, x, rate, R::ZERO, R::from_f64(tick)).unwrap();
    ControlInput::new(input, branch, viscosity).unwrap()
}

fn under<R: Real>(displacement: f64, velocity: f64, control: f64) -> Motion<R> {
    Motion {
        controls: [R::from_f64(control); CONTROLS],
        ..Motion::at(R::from_f64(displacement), R::from_f64(velocity))
    }
}

/// The force after a long motion at a steady velocity under a steady input.
fn steady(effect: ControlInput<f64>, velocity: f64, control: f64) -> f64 {
    let law = alone(Effect::ControlInput(effect));
    let mut state = law.at_rest();
    let ticks = 0..20_000;
    ticks.fold(0.0, |_, n| {
        law.force(
            &mut state,
            &under(velocity * TICK * f64::from(n), velocity, control),
        )
    })
}

/// f·(k·x·tanh(v/v₀) + c·v), f = |u|/(1 + |u|/s).
#[test]
fn at_a_steady_velocity_the_force_is_the_inputs_strength() {
    let [k, x, rate, viscosity] = BRANCH;
    for (velocity, control) in [(0.2, 0.5), (-1.0, 2.0), (0.4, -2.0), (0.3, 0.0)] {
        let of_one: f64 = k * x * f64::tanh(velocity / rate) + viscosity * velocity;
        let expected = control.abs() * of_one;
        close(steady(effect(0, TICK), velocity, control), expected, 1e-9);
        let bent = effect(0, TICK).with_saturation(1.5).unwrap();
        let expected = control.abs() / (1.0 + control.abs() / 1.5) * of_one;
        close(steady(bent, velocity, control), expected, 1e-9);
    }
}

/// f·(k·y + c·v), wherever the motion begins and however it turns.
#[test]
fn a_branch_that_no_motion_makes_yield_is_a_spring() {
    fn force<R: Real>(first: f64) -> Vec<(f64, f64)> {
        let [k, x, rate, viscosity] = [2.0, limits::DISPLACEMENT, 1e-9, 0.01].map(R::from_f64);
        let branch = Yielding::new(k, x, rate, R::ZERO, R::from_f64(TICK)).unwrap();
        let law = alone(Effect::ControlInput(
            ControlInput::new(0, branch, viscosity).unwrap(),
        ));
        let mut state = law.at_rest();
        let each = (0..3000).map(|n| {
            let phase = 0.01 * f64::from(n);
            let (y, v) = (first + 30.0 * phase.sin(), 300.0 * phase.cos());
            let force = law.force(&mut state, &under(y, v, 0.5));
            (force.to_f64(), 0.5 * (2.0 * y + 0.01 * v))
        });
        each.collect()
    }
    for first in [-50.0, 0.0, 12.0] {
        for (force, expected) in force::<f64>(first) {
            close(force, expected, 1e-9);
        }
        // Of 80 mm at 1 kN/mm.
        let worst = force::<f32>(first).into_iter();
        let worst = worst.fold(0.0, |worst, (force, expected)| {
            f64::max(worst, (force - expected).abs())
        });
        assert!(worst < 80.0 * 2e-6, "{worst}");
    }
}

/// A step of the input arrives as 1 − e^(−t/T), for any tick. f32 agrees with f64 even if a tick takes a millionth of the step.
#[test]
fn a_step_of_the_input_arrives_exponentially() {
    fn arrived<R: Real>(tick: f64, lag: f64, time: f64) -> f64 {
        let late = effect::<R>(2, tick).with_lag(R::from_f64(lag), R::from_f64(tick));
        let law = alone(Effect::ControlInput(late.unwrap()));
        let mut state = law.at_rest();
        // Only the dashpot acts, which has no state that must settle: the displacement stays at 0.
        let mut force = |control| {
            law.force(&mut state, &under::<R>(0.0, 1.0, control))
                .to_f64()
        };
        assert_eq!(force(0.0), 0.0);
        let ticks = (time / tick).round() as u32;
        (0..ticks).fold(0.0, |_, _| force(3.0)) / (3.0 * BRANCH[3])
    }
    for tick in [1e-4, 1e-3, 1e-2] {
        close(
            arrived::<f64>(tick, 0.05, 0.1),
            1.0 - (-2.0_f64).exp(),
            1e-9,
        );
    }
    // 1 − e^(−Δt/T) rounds by 2^-24 of itself.
    let slow = arrived::<f32>(1e-4, 100.0, 100.0);
    close(slow, 1.0 - (-1.0_f64).exp(), 1e-6);
}

/// An input that was on before the first tick has arrived, and only the input at its own index counts.
#[test]
fn a_steady_input_has_arrived_and_others_are_of_no_matter() {
    let late = effect(1, TICK).with_lag(10.0, TICK).unwrap();
    let law = alone(Effect::ControlInput(late));
    let mut others = under(0.0, 1.0, 7.0);
    others.controls[1] = 0.5;
    let force = law.force(&mut law.at_rest(), &others);
    close(force, 0.5 * BRANCH[3], 1e-12);
    others.controls[1] = f64::NAN;
    assert_eq!(law.force(&mut law.at_rest(), &others), 0.0);
}

#[test]
fn what_is_out_of_range_is_named() {
    let field = |error: ConfigError| match error {
        ConfigError::NonFinite(field) | ConfigError::OutOfRange { field, .. } => field,
        other => panic!("{other} contains no field"),
    };
    let branch = || Yielding::new(1.0, 0.1, 1.0, 0.0, TICK).unwrap();
    assert_eq!(
        field(ControlInput::new(CONTROLS, branch(), 0.0).unwrap_err()),
        "input"
    );
    assert_eq!(
        field(ControlInput::new(0, branch(), f64::NAN).unwrap_err()),
        "viscosity"
    );
    let with_time = Yielding::new(1.0, 0.1, 0.5, 0.3, TICK).unwrap();
    assert_eq!(
        ControlInput::new(0, with_time, 0.0)
            .unwrap_err()
            .to_string(),
        "time * rate of the branch = 0.15 is outside 0…0"
    );
    let at_once = effect::<f64>(0, TICK);
    assert_eq!(field(at_once.with_lag(-1.0, TICK).unwrap_err()), "lag");
    assert_eq!(field(at_once.with_lag(1.0, 0.0).unwrap_err()), "tick");
    assert_eq!(
        field(at_once.with_saturation(0.0).unwrap_err()),
        "saturation"
    );
    let half = Effect::<f64>::from_parameters(19, &[1.0, 0.1, 1.0, 0.0, 0.0, 1.0, 0.5], TICK);
    assert_eq!(field(half.unwrap_err()), "input");
}

proptest! {
    /// Passive under a steady input: over a closed path it absorbs energy and supplies none.
    #[test]
    fn under_a_steady_input_it_is_passive(
        turns in prop::collection::vec(-0.3..0.3_f64, 2..8), control in -3.0..3.0_f64, saturation in 0.1..10.0_f64,
    ) {
        let bent = effect(0, TICK).with_saturation(saturation).unwrap();
        let law = alone(Effect::ControlInput(bent));
        let mut state = law.at_rest();
        let (mut work, mut y, mut before) = (0.0, 0.0, 0.0);
        law.force(&mut state, &under(0.0, 0.0, control));
        for &target in turns.iter().chain(&[0.0]) {
            let start = y;
            for n in 1..=200 {
                let next = start + (target - start) * f64::from(n) / 200.0;
                let force = law.force(&mut state, &under(next, (next - y) / TICK, control));
                work += 0.5 * (force + before) * (next - y);
                (y, before) = (next, force);
            }
        }
        prop_assert!(work > -1e-9, "{work}");
    }

    /// For any size of the input: on the first tick the branch has no force yet, and the dashpot no more than s·c·|v|.
    #[test]
    fn the_strength_never_passes_the_saturation(control in -1e9..1e9_f64, velocity in -10.0..10.0_f64) {
        let bent = effect(0, TICK).with_saturation(1.5).unwrap();
        let law = alone(Effect::ControlInput(bent));
        let force = law.force(&mut law.at_rest(), &under(0.0, velocity, control));
        prop_assert!(force.abs() <= 1.5 * BRANCH[3] * velocity.abs() * (1.0 + 1e-12));
    }
}
