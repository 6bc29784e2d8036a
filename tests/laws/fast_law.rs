//! The law as the target runs it, and its swap.

use mesh_damper::effects::{
    AugmentedLaw, Compliance, Delay, Effect, Gap, LoadFriction, Motion, StickSlip, Temperature,
    Viscous,
};
use mesh_damper::fast_law::{Adaptation, FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::real::Real;

fn law(k1: f32, c: f32, alpha: f32) -> FastLaw<1> {
    let law = AugmentedLaw::new(Law::new(k1, 10.0, c, alpha).unwrap());
    let joints = Effect::StickSlip(StickSlip::new(&[(1.0, 0.02)]).unwrap());
    FastLaw::new(law.with(joints).unwrap())
}

/// Tick `n` of a motion that passes every octave of the velocity repeatedly, in a varying order.
fn motion(n: u32) -> Motion<f32> {
    let scattered = n.wrapping_mul(2_654_435_769);
    let velocity = 2f32.powf(scattered as f32 * (34.0 / 4_294_967_296.0) - 21.0);
    Motion {
        displacement: 0.1 * (0.01 * n as f32).sin(),
        velocity: if n.is_multiple_of(2) {
            velocity
        } else {
            -velocity
        },
        ..Motion::default()
    }
}

/// Forces of `laws`; each law takes over at its tick.
fn forces(laws: &[(u32, FastLaw<1>)], ticks: u32) -> Vec<f32> {
    let mut running = RunningLaw::new(laws[0].1.clone());
    (0..ticks)
        .map(|n| {
            if let Some((_, law)) = laws[1..].iter().find(|(at, _)| *at == n) {
                running.swap(law.clone());
                running.boundary();
            }
            running.force(&motion(n))
        })
        .collect()
}

#[test]
fn every_force_after_a_swap_is_the_new_laws() {
    let (first, second) = (law(1.0, 0.1, 0.4), law(2.0, 0.3, 0.2));
    let (old, new) = (
        forces(&[(0, first.clone())], 2000),
        forces(&[(0, second.clone())], 2000),
    );
    // The third swap comes before the table is filled for the second.
    let swaps = [
        (0, first.clone()),
        (500, second.clone()),
        (1000, first.clone()),
        (1100, second),
        (1600, first),
    ];
    for (n, force) in forces(&swaps, 2000).iter().enumerate() {
        let expected = match n {
            500..1000 | 1100..1600 => new[n],
            _ => old[n],
        };
        assert_eq!(*force, expected, "tick {n}");
    }
}

#[test]
fn a_law_that_waits_does_nothing_before_the_boundary_and_the_last_one_counts() {
    let (first, second, third) = (law(1.0, 0.1, 0.4), law(2.0, 0.3, 0.2), law(3.0, 0.2, 0.3));
    let (old, new) = (
        forces(&[(0, first.clone())], 1000),
        forces(&[(0, third.clone())], 1000),
    );
    let mut running = RunningLaw::new(first.clone());
    for n in 0..1000 {
        match n {
            100 => running.swap(second.clone()),
            200 => running.swap(third.clone()),
            400 => assert!(running.boundary()),
            _ => {}
        }
        assert_eq!(
            *running.law(),
            if n < 400 {
                first.clone()
            } else {
                third.clone()
            }
        );
        let expected = if n < 400 { &old } else { &new };
        assert_eq!(running.force(&motion(n)), expected[n as usize]);
    }
}

const FOLLOWED: Adaptation = Adaptation {
    k1: -0.1,
    k3: 0.3,
    c: 0.2,
};

/// A law with adaptation equals the law with the adapted coefficients, together with its effects and between the stages.
#[test]
fn a_law_that_follows_is_the_law_that_it_has_come_to() {
    let through: [&[Effect<f32>]; 4] = [
        &[],
        &[Effect::Viscous(Viscous::new(0.003).unwrap())],
        &[
            Effect::LoadFriction(LoadFriction::new(2.0).unwrap()),
            Effect::Temperature(Temperature::new(0.01, 50.0).unwrap()),
        ],
        &[
            Effect::Gap(Gap::new(0.01, false).unwrap()),
            Effect::Compliance(Compliance::new(15.0, 1e-4).unwrap()),
        ],
    ];
    for effects in through {
        let of = |law| {
            let law = AugmentedLaw::<f32, 2>::new(law);
            let all = effects.iter();
            FastLaw::new(all.fold(law, |law, effect| law.with(*effect).unwrap()))
        };
        let mut following = RunningLaw::new(of(Law::new(1.0, 10.0, 0.1, 0.4).unwrap()));
        let mut other = RunningLaw::new(of(Law::new(0.9, 13.0, 0.12, 0.4).unwrap()));
        assert_eq!(following.followed(), Adaptation::default());
        following.follow(FOLLOWED);
        assert_eq!(following.followed(), FOLLOWED);
        let (mut worst, mut peak) = (0.0_f32, 0.0_f32);
        for n in 0..2000 {
            let expected = other.force(&motion(n));
            worst = worst.max((following.force(&motion(n)) - expected).abs());
            peak = peak.max(expected.abs());
        }
        assert!(worst < 1e-6 * peak, "{worst} of {peak}");
    }
}

#[test]
fn the_same_effects_stand_beside_another_law() {
    let mut changed = law(1.0, 0.1, 0.4);
    changed.set_law(*law(2.0, 0.3, 0.2).augmented().law());
    assert_eq!(changed, law(2.0, 0.3, 0.2));
}

#[test]
fn nothing_that_was_followed_is_left_of_another_law() {
    let (first, second) = (law(1.0, 0.1, 0.4), law(2.0, 0.3, 0.2));
    let mut running = RunningLaw::new(first.clone());
    running.follow(FOLLOWED);
    assert!(!running.boundary(), "none waits");
    assert_eq!(running.followed(), FOLLOWED);
    assert_eq!(running.law(), &first);
    running.swap(second.clone());
    assert!(running.boundary());
    assert_eq!(running.followed(), Adaptation::default());
    let mut fresh = RunningLaw::new(second);
    for n in 0..2000 {
        assert_eq!(running.force(&motion(n)), fresh.force(&motion(n)));
    }
}

#[test]
fn no_more_is_followed_than_the_whole() {
    let mut running = RunningLaw::new(law(1.0, 0.1, 0.4));
    let beyond = |part: f32| Adaptation {
        k1: part,
        k3: part,
        c: part,
    };
    running.follow(beyond(-3.0));
    let joints = RunningLaw::new(law(0.0, 0.0, 0.4)).force(&motion(100));
    let elastic = 10.0 * motion(100).displacement.powi(3);
    assert!((running.force(&motion(100)) - (joints - elastic)).abs() < 1e-6);
    assert_eq!(running.followed(), beyond(-1.0));
    running.follow(beyond(f32::NAN));
    assert_eq!(running.followed(), Adaptation::default());
}

/// Gap, compliance and delay around the fast law: in f32, while its table is being filled and afterwards, the force equals that of
/// the f64 law.
#[test]
fn stages_run_around_the_tabulated_law() {
    fn law<R: Real>() -> AugmentedLaw<R, 5> {
        let r = R::from_f64;
        let law = Law::new(r(1.05), r(10.5), r(0.11), r(0.4)).unwrap();
        [
            Effect::StickSlip(StickSlip::new(&[(r(1.0), r(0.02))]).unwrap()),
            Effect::Viscous(Viscous::new(r(0.003)).unwrap()),
            Effect::Gap(Gap::new(r(0.01), false).unwrap()),
            Effect::Compliance(Compliance::new(r(15.0), r(1e-4)).unwrap()),
            Effect::Delay(Delay::new(r(1.55e-3), r(1e-4)).unwrap()),
        ]
        .into_iter()
        .fold(AugmentedLaw::new(law), |law, effect| {
            law.with(effect).unwrap()
        })
    }
    let exact = law::<f64>();
    let mut state = exact.at_rest();
    let mut running = RunningLaw::new(FastLaw::new(law::<f32>()));
    let omega = std::f64::consts::TAU * 5.0;
    let (mut worst, mut peak) = (0.0_f64, 0.0_f64);
    for n in 0..20_000 {
        let (sin, cos) = (omega * 1e-4 * f64::from(n)).sin_cos();
        let (displacement, velocity) = (0.1 * sin, 0.1 * omega * cos);
        let acceleration = -omega * omega * displacement;
        let motion = Motion {
            acceleration,
            ..Motion::at(displacement, velocity)
        };
        let expected = exact.force(&mut state, &motion);
        let motion = Motion {
            acceleration: acceleration as f32,
            ..Motion::at(displacement as f32, velocity as f32)
        };
        let force = f64::from(running.force(&motion));
        worst = worst.max((force - expected).abs());
        peak = peak.max(expected.abs());
    }
    assert!(worst < 5e-6 * peak, "{worst} of {peak}");
    assert!(worst > 0.0);
}
