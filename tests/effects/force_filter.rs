//! A force channel behind a low-pass, against the gain, lag and step response of the continuous filter.

use std::f64::consts::{PI, SQRT_2, TAU};

use mesh_damper::effects::{AugmentedLaw, Delay, Effect, ForceFilter, Motion, Offset};
use mesh_damper::law::Law;
use mesh_damper::real::Real;
use proptest::prelude::*;

use crate::loops::{alone, close};

/// A spring of 1 kN/mm before the filter, so that the force equals the displacement.
fn filter<R: Real>(corner: f64, tick: f64) -> AugmentedLaw<R, 1> {
    let r = R::from_f64;
    let spring = Law::new(r(1.0), r(0.0), r(0.0), r(0.0)).unwrap();
    let filter = ForceFilter::new(r(corner), r(tick)).unwrap();
    let law = AugmentedLaw::new(spring);
    law.with(Effect::ForceFilter(filter)).unwrap()
}

/// The filter's output for forces in kN, one a tick.
fn shown<R: Real>(law: &AugmentedLaw<R, 1>, forces: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut state = law.at_rest();
    let force = |force| {
        let displacement = R::from_f64(force);
        let motion = Motion::at(displacement, R::ZERO);
        law.force(&mut state, &motion).to_f64()
    };
    forces.into_iter().map(force).collect()
}

/// Gain and lag in rad of a steady sine, by the ticks of its period.
fn response(law: &AugmentedLaw<f64, 1>, period: usize, settled: usize) -> (f64, f64) {
    let angle = |tick: usize| TAU * tick as f64 / period as f64;
    let all = shown(law, (0..settled + period).map(|tick| angle(tick).sin()));
    let (in_phase, across) = (settled..settled + period).fold((0.0, 0.0), |(sin, cos), tick| {
        let force = all[tick];
        (
            sin + force * angle(tick).sin(),
            cos + force * angle(tick).cos(),
        )
    });
    let part = 2.0 / period as f64;
    let lag = (-across).atan2(in_phase);
    (part * in_phase.hypot(across), lag.rem_euclid(TAU))
}

/// H = 1/(1 − r² + i·√2·r) at r times the corner: gain 1/√(1 + r⁴), which is 1/√2 with a lag of a quarter period at the corner.
#[test]
fn gain_and_lag_are_butterworths() {
    let (corner, tick) = (40.0, 1e-5);
    let law = filter(corner, tick);
    for period in [100_000, 10_000, 5_000, 2_500, 1_250, 500] {
        let r = 1.0 / (period as f64 * tick * corner);
        // The start decays as e^(−ω·t/√2): over 0.2 s by e^(−35).
        let (gain, lag) = response(&law, period, 20_000);
        // Between ticks a sine is approximated by chords, which are (π/period)²/3 too small: 1.3e-5 for the fastest.
        let chords = 0.4 * (PI / period as f64).powi(2) + 1e-9;
        close(gain, 1.0 / (1.0 + r.powi(4)).sqrt(), chords);
        let expected = (SQRT_2 * r).atan2(1.0 - r * r);
        assert!((lag - expected).abs() < 1e-9, "{r}: {lag} {expected}");
    }
}

/// Along straight lines the step is exact, for any number of ticks: the closed form of a ramp from rest.
#[test]
fn a_ramp_is_late_by_the_closed_form_at_every_tick() {
    for (corner, tick) in [(40.0, 1e-4), (40.0, 1e-2), (0.3, 0.5), (1.2e4, 1e-4)] {
        let a = PI * SQRT_2 * corner;
        let all = shown(
            &filter::<f64>(corner, tick),
            (0..300).map(|n| tick * f64::from(n)),
        );
        for (n, force) in all.into_iter().enumerate() {
            // The delay √2/ω = 1/a, and the part that has not settled yet.
            let time = tick * n as f64;
            let expected = time - (1.0 - (-a * time).exp() * (a * time).cos()) / a;
            assert!((force - expected).abs() < 1e-12, "{force} {expected}");
        }
    }
}

/// 1 − √2·e^(−a)·sin(a + π/4) overshoots by e^(−π) = 4.3 % at a = π, and settles at the whole force.
#[test]
fn a_step_goes_beyond_by_a_23rd_and_settles_at_all_of_it() {
    let (corner, tick) = (25.0, 1e-4);
    let step = |n: i32| if n < 10 { 0.5 } else { 1.5 };
    let all = shown(&filter::<f64>(corner, tick), (0..4000).map(step));
    assert!(all[..10].iter().all(|force| *force == 0.5));
    let most = all.iter().fold(0.0, |most: f64, force| most.max(*force)) - 1.5;
    close(most, (-PI).exp(), 1e-3);
    close(all[3999], 1.5, 1e-12);
    let least = all.iter().fold(1.0, |least: f64, force| least.min(*force));
    assert_eq!(least, 0.5);
}

/// It filters the sum of all forces, starts in the steady state of the first one, and works together with a delay.
#[test]
fn every_effects_force_passes_and_the_first_has_stood_for_ever() {
    let offset = Effect::Offset(Offset::new(0.7).unwrap());
    let law = Law::new(1.0, 0.0, 0.0, 0.0).unwrap();
    let filter = Effect::ForceFilter(ForceFilter::new(30.0, 1e-3).unwrap());
    let delay = Effect::Delay(Delay::new(3e-3, 1e-3).unwrap());
    let add = |law: AugmentedLaw<f64, 3>, effect: Effect<f64>| law.with(effect).unwrap();
    let with = |effects: &[Effect<f64>]| {
        let law = effects.iter().copied().fold(AugmentedLaw::new(law), add);
        let mut state = law.at_rest();
        let force = |tick: i32| {
            let displacement = 0.2 + 0.1 * (0.1 * f64::from(tick)).sin();
            let motion = Motion::at(displacement, 0.0);
            law.force(&mut state, &motion)
        };
        (0..200).map(force).collect::<Vec<f64>>()
    };
    let plain = with(&[filter]);
    assert_eq!(plain[0], 0.2);
    let (raised, late) = (with(&[offset, filter]), with(&[filter, delay]));
    for tick in 0..200 {
        close(raised[tick], plain[tick] + 0.7, 1e-12);
        close(late[tick], plain[tick.saturating_sub(3)], 1e-12);
    }
}

/// A constant force is unchanged, to the last bit and at every corner.
#[test]
fn what_stands_still_is_shown_as_it_is_in_f32() {
    for corner in [1.0, 3.7, 200.0, 1e4, 1e7] {
        let held = shown(&filter::<f32>(corner, 1e-4), [0.3; 5000]);
        assert!(held.iter().all(|force| *force == f64::from(0.3_f32)));
        let law = alone(Effect::ForceFilter(
            ForceFilter::new(corner as f32, 1e-4).unwrap(),
        ));
        let quiet = law.force(&mut law.at_rest(), &Motion::default());
        assert_eq!(quiet, 0.0);
    }
}

proptest! {
    /// f32 is within 2e-5 of f64 at the corners of a rig's tick. At the slowest it is within the rounding error of a tick's change,
    /// 2⁻²⁵/a.
    #[test]
    fn f32_follows_f64(corner in 1.0..5e3_f64, period in 40..4000_u32) {
        let force = |tick: u32| f64::from((TAU * f64::from(tick) / f64::from(period)).sin() as f32);
        let single = shown(&filter::<f32>(corner, 1e-4), (0..8000).map(force));
        let double = shown(&filter::<f64>(corner, 1e-4), (0..8000).map(force));
        let a = PI * SQRT_2 * corner * 1e-4;
        let most = 1e-6 + 6e-8 / a;
        for (single, double) in single.iter().zip(double) {
            prop_assert!((single - double).abs() < most, "{} {}", single - double, most);
        }
    }

    /// Its output never exceeds 1 + 2·e^(−π)/(1 − e^(−π)) times the largest input force. This is the sum of the magnitudes of its
    /// impulse response.
    #[test]
    fn nothing_grows(
        corner in -4.0..3.0_f64, forces in prop::collection::vec(-1.0..1.0_f64, 1..400), scale in 0..30,
    ) {
        let scale = 10_f64.powi(scale - 26);
        let forces = forces.into_iter().map(|force| scale * force);
        let all = shown(&filter::<f32>(1.001 * 10_f64.powf(corner), 1.0), forces);
        let bound = 1.0 + 2.0 * (-PI).exp() / (1.0 - (-PI).exp());
        prop_assert!(all.iter().all(|force| force.abs() <= scale * (bound + 1e-3)));
    }
}
