//! The stages between the specimen and the measurement: the gap before the law and every effect, and the delay after them.

use std::f64::consts::{PI, TAU};

use mesh_damper::effects::{
    AugmentedLaw, Compliance, Delay, Effect, Gap, Inertia, MAX_DELAY, Motion, Offset, StickSlip,
    Viscous,
};
use mesh_damper::law::Law;

use crate::loops::{TICKS, alone, close, energy, moduli, nothing, sine};

fn with(law: Law<f64>, effects: &[Effect<f64>]) -> AugmentedLaw<f64, 4> {
    let add = |law: AugmentedLaw<f64, 4>, effect: &Effect<f64>| law.with(*effect).unwrap();
    effects.iter().fold(AugmentedLaw::new(law), add)
}

/// The last of two cycles.
fn steady(law: &AugmentedLaw<f64, 4>, amplitude: f64, frequency: f64) -> Vec<f64> {
    let mut state = law.at_rest();
    let all = (0..2 * TICKS).map(|n| law.force(&mut state, &sine(amplitude, frequency, n)));
    all.skip(TICKS).collect()
}

fn gap(half_width: f64, damps_inside: bool) -> Effect<f64> {
    Effect::Gap(Gap::new(half_width, damps_inside).unwrap())
}

/// Behind the play a slider moves by X − w only. So it absorbs 4·k·x·(X − w − x) from its own motion, and 4·k·x·w more from the
/// mounting, which also meets its force within the play.
#[test]
fn the_dead_zones_loop_is_that_of_the_amplitude_left() {
    let slider = Effect::StickSlip(StickSlip::new(&[(1.2, 0.03)]).unwrap());
    let force = steady(&with(nothing(), &[slider, gap(0.05, false)]), 0.2, 1.0);
    close(energy(&force, 0.2), 4.0 * 1.2 * 0.03 * (0.2 - 0.03), 1e-5);
    let gap = Gap::new(0.05, false).unwrap();
    let felt = |n: usize| gap.transform(&sine(0.2, 1.0, n)).displacement;
    let taken: f64 = (0..TICKS)
        .map(|n| 0.5 * (force[n] + force[(n + 1) % TICKS]) * (felt(n + 1) - felt(n)))
        .sum();
    close(taken, 4.0 * 1.2 * 0.03 * (0.2 - 0.05 - 0.03), 1e-5);
}

#[test]
fn eq_13_does_not_feel_the_play() {
    let law = Law::new(1.0, 10.0, 0.1, 0.4).unwrap();
    let free = with(law, &[gap(0.05, false)]);
    let damped = with(law, &[gap(0.05, true)]);
    for (y, felt) in [(0.03, 0.0), (-0.05, 0.0), (0.2, 0.15), (-0.2, -0.15)] {
        let motion = Motion::at(y, 2.0);
        let velocity = if felt == 0.0 { 0.0 } else { 2.0 };
        let of = |law: &AugmentedLaw<f64, 4>| law.force(&mut law.at_rest(), &motion);
        close(of(&free), law.force(felt, velocity), 1e-12);
        close(of(&damped), law.force(felt, 2.0), 1e-12);
    }
}

/// ∮c·v dy over the whole cycle is π·c·ω·X², over the part beyond the play (π − 2θ − sin 2θ)·c·ω·X² with sin θ = w/X.
#[test]
fn a_dashpot_beside_the_play_dissipates_all_the_way() {
    let dashpot = Effect::Viscous(Viscous::new(0.01).unwrap());
    let all = steady(&with(nothing(), &[dashpot, gap(0.05, true)]), 0.2, 1.0);
    let scale = 0.01 * TAU * 0.04;
    close(energy(&all, 0.2), PI * scale, 1e-6);
    let beyond = steady(&with(nothing(), &[dashpot, gap(0.05, false)]), 0.2, 1.0);
    let theta = (0.05_f64 / 0.2).asin();
    // The force jumps at the play's ends, within a tick each.
    close(
        energy(&beyond, 0.2),
        (PI - 2.0 * theta - (2.0 * theta).sin()) * scale,
        1e-3,
    );
}

#[test]
fn the_public_transformation_is_the_one_that_runs() {
    let gap = Gap::new(0.05_f64, false).unwrap();
    let motion = Motion {
        acceleration: 5.0,
        cycles: 2.5,
        temperature: 31.0,
        ..Motion::at(-0.07, 3.0)
    };
    let felt = gap.transform(&motion);
    assert_eq!(
        felt,
        Motion {
            displacement: -0.07 + 0.05,
            ..motion
        }
    );
    let inside = gap.transform(&Motion {
        displacement: 0.01,
        ..motion
    });
    assert_eq!(
        (inside.displacement, inside.velocity, inside.acceleration),
        (0.0, 0.0, motion.acceleration)
    );
    assert_eq!((inside.cycles, inside.temperature), (2.5, 31.0));
    // A delay of 2.4 ticks: the force for the motion 0.4 ticks ago, delayed by two ticks.
    let delay = Delay::new(2.4e-3, 1e-3).unwrap();
    assert_eq!(delay.whole_ticks(), 2);
    let shifted = delay.shifted(&motion);
    close(shifted.velocity, 3.0 - 0.4e-3 * 5.0, 1e-12);
    close(shifted.displacement, -0.07 - 0.4e-3 * 2.999, 1e-12);
    let rest = |motion| Motion {
        displacement: 0.0,
        velocity: 0.0,
        ..motion
    };
    assert_eq!(rest(shifted), rest(motion));
}

/// A spring behind a channel with a delay T has the moduli k·cos ωT and −k·sin ωT.
#[test]
fn a_delay_turns_the_phase() {
    let law = Law::new(1.5, 0.0, 0.0, 0.0).unwrap();
    let tick = 1.0 / (2.0 * TICKS as f64);
    for ticks in [0.0, 1.0, 100.0, 33.5, 200.25, 255.0] {
        let delay = Effect::Delay(Delay::new(ticks * tick, tick).unwrap());
        let (storage, loss) = moduli(&steady(&with(law, &[delay]), 0.1, 2.0), 0.1);
        let angle = TAU * ticks / TICKS as f64;
        // Within half a tick the motion is approximated by a parabola, within (ωΔt/2)²/2 = 5e-9 of the sine's velocity.
        close(storage, 1.5 * angle.cos(), 2e-8);
        assert!((loss + 1.5 * angle.sin()).abs() < 2e-8, "{loss}");
    }
}

/// It is the last of all stages, and holds the first force until there is an older one.
#[test]
fn a_delay_holds_the_first_force_and_delays_every_effects() {
    let offset = Effect::Offset(Offset::new(0.5).unwrap());
    for (ticks, exact) in [(3.0, true), (255.0, true), (2.4, false)] {
        let delay = Effect::Delay(Delay::new(ticks * 1e-3, 1e-3).unwrap());
        let law = with(Law::new(1.0, 0.0, 0.0, 0.0).unwrap(), &[offset, delay]);
        let mut state = law.at_rest();
        for n in 0..2000_i32 {
            let at = |n: f64| 0.5 + 7.0 + 1e-3 * n.max(0.0);
            let motion = Motion::at(at(f64::from(n)) - 0.5, 1.0);
            let force = law.force(&mut state, &motion);
            let expected = at(f64::from(n) - ticks);
            // Before the first tick the motion is extrapolated.
            if exact || f64::from(n) > ticks {
                close(force, expected, 1e-12);
            }
        }
    }
}

#[test]
fn the_longest_delay_is_of_255_ticks_in_f32_too() {
    let tick = 1e-4_f32;
    let delay = Delay::new(f32::from(MAX_DELAY) * tick, tick).unwrap();
    let law = alone(Effect::Delay(delay));
    assert_eq!(law.force(&mut law.at_rest(), &Motion::default()), 0.0);
    assert!(Delay::new(255.1 * tick, tick).is_err());
}

/// All stages and a mass: springs in series k·K/(k + K) beyond the play, and m·a before both, with a delay T.
#[test]
fn the_stages_together_are_springs_in_series_behind_the_play_a_mass_and_late() {
    let tick = 1e-3;
    let stages = [
        gap(0.05, false),
        Effect::Compliance(Compliance::new(6.0, tick).unwrap()),
        Effect::Delay(Delay::new(3.0 * tick, tick).unwrap()),
        Effect::Inertia(Inertia::new(40.0).unwrap()),
    ];
    let law = with(Law::new(1.5, 0.0, 0.0, 0.0).unwrap(), &stages);
    let mut state = law.at_rest();
    for n in 0..200 {
        let at = |n: i32| tick * f64::from(n);
        let acceleration = |n: i32| 700.0 + f64::from(n);
        let motion = Motion {
            acceleration: acceleration(n),
            ..Motion::at(at(n), 1.0)
        };
        let force = law.force(&mut state, &motion);
        // The force before the first tick is not known.
        if n > 10 {
            let springs = 1.5 * 6.0 / (1.5 + 6.0) * f64::max(at(n - 3) - 0.05, 0.0);
            close(force, springs + 40.0 * 1e-6 * acceleration(n - 3), 1e-9);
        }
    }
}
