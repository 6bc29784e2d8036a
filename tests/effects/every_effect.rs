//! All effects in one law: one of each, f32 against f64, and finite for any input.

use std::path::Path;

use mesh_damper::effects::{AugmentedLaw, DESCRIPTIONS, Effect, Motion, Offset, StickSlip};
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::real::Real;
use proptest::prelude::*;

use crate::loops::{TICKS, alone, close, nothing, sine};

/// Each family has its row in the page about effects.
#[test]
fn the_page_of_effects_has_every_family() {
    let page = include_str!("../../docs/effects.md");
    for description in DESCRIPTIONS {
        let row = format!("| `{}` |", description.family);
        assert!(page.contains(&row), "docs/effects.md: {row}");
    }
}

/// Each effect has a test against an oracle of another kind, in a file of this folder that makes it by its constructor. Files over all
/// effects make some of them for other reasons.
#[test]
fn every_effect_has_an_oracle() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/effects");
    let files = std::fs::read_dir(&folder).unwrap();
    let names = files.map(|file| file.unwrap().path());
    let tests: Vec<String> = names
        .filter(|path| {
            let others = ["every_effect", "loops", "outside", "refusals"];
            others
                .iter()
                .all(|other| path.file_stem().unwrap() != *other)
        })
        .map(|path| std::fs::read_to_string(path).unwrap())
        .collect();
    for description in DESCRIPTIONS {
        let effect = Effect::<f32>::from_parameters(description.number, description.typical, 1e-4);
        let named = format!("{:?}", effect.unwrap());
        let constructor = format!("{}::new(", named.split('(').next().unwrap());
        assert!(
            tests.iter().any(|test| test.contains(&constructor)),
            "no file of tests/effects tests {constructor}…)"
        );
    }
}

/// In a state that was created for fewer effects, the others start at rest, and no state is dropped.
#[test]
fn a_state_of_fewer_effects_serves_more() {
    let offset = Effect::Offset(Offset::new(0.5).unwrap());
    let slider = Effect::StickSlip(StickSlip::new(&[(2.0, 0.5)]).unwrap());
    let small: AugmentedLaw<f64, 2> = AugmentedLaw::new(nothing()).with(offset).unwrap();
    let large = small.clone().with(slider).unwrap();
    let mut state = small.at_rest();
    small.force(&mut state, &Motion::default());
    large.force(&mut state, &Motion::default());
    let force = large.force(&mut state, &Motion::at(0.1, 0.0));
    close(force, 0.5 + 0.2, 1e-12);
}

#[test]
fn a_full_set_refuses_one_more() {
    let offset = Effect::Offset(Offset::new(1.0_f32).unwrap());
    assert_eq!(
        alone(offset).with(offset),
        Err(ConfigError::Full {
            field: "effects",
            capacity: 1
        })
    );
}

/// Two effects of a kind equal one with other coefficients or more elements.
#[test]
fn a_second_effect_of_a_kind_is_refused() {
    let law = one_of_each::<f64>();
    let mut roomy = AugmentedLaw::<f64, 30>::new(*law.law());
    for effect in law.effects() {
        roomy = roomy.with(effect).unwrap();
        let again = roomy.clone().with(effect);
        assert!(
            matches!(again, Err(ConfigError::Full { capacity: 1, .. })),
            "{again:?}"
        );
    }
    assert_eq!(roomy.effects().count(), EFFECTS);
}

/// Number of effects.
const EFFECTS: usize = DESCRIPTIONS.len();

/// One of each, with its typical parameters.
fn one_of_each<R: Real>() -> AugmentedLaw<R, EFFECTS> {
    let r = R::from_f64;
    let law = Law::new(r(1.05), r(10.5), r(0.11), r(0.4)).unwrap();
    let all = DESCRIPTIONS.iter().map(|each| {
        Effect::from_parameters(each.number, each.typical, 1e-4).expect("typical parameters")
    });
    all.fold(AugmentedLaw::new(law), |law, effect| {
        law.with(effect).unwrap()
    })
}

/// f32 and f64 through the same code, ten cycles of 2·10^4 ticks, every effect at once.
///
/// Differences of displacements update the stretch of whatever slides or relaxes. A stretch of up to 0.06 mm rounds by 2^-24 of itself,
/// 3.6e-9 mm, in each tick: a random walk over a half cycle of 10⁴ ticks. The typical effects are together as stiff as 14 kN/mm, so that
/// this is √10⁴·14·3.6e-9/√3 = 2.9e-6 kN. The peak force is 1.2 kN.
#[test]
fn f32_follows_f64_within_rounding() {
    let (single, double) = (one_of_each::<f32>(), one_of_each::<f64>());
    let (mut small, mut large) = (single.at_rest(), double.at_rest());
    let (mut error, mut peak) = (0.0_f64, 0.0_f64);
    for n in 0..10 * TICKS {
        let f32_force = f64::from(single.force(&mut small, &sine(0.2, 2.0, n)));
        let f64_force: f64 = double.force(&mut large, &sine(0.2, 2.0, n));
        error = error.max((f32_force - f64_force).abs());
        peak = peak.max(f64_force.abs());
    }
    assert!(error < 4e-6 * peak, "{error} of {peak}");
    assert!(error > 0.0, "f32 and f64 cannot agree to the last bit");
}

fn any_motion() -> impl Strategy<Value = Motion<f32>> {
    let number = || {
        prop_oneof![
            any::<f32>(),
            -1.0..1.0_f32,
            Just(f32::MAX),
            Just(f32::MIN_POSITIVE),
            Just(-0.0)
        ]
    };
    let controls = [number(), number(), number(), number()];
    let all = (number(), number(), number(), number(), number(), controls);
    all.prop_map(|(y, v, a, cycles, temperature, controls)| Motion {
        displacement: y,
        velocity: v,
        acceleration: a,
        cycles,
        temperature,
        controls,
    })
}

proptest! {
    /// The force is finite for any motion, including NaN and infinities, and remains so afterwards.
    #[test]
    fn every_force_is_finite(motions in prop::collection::vec(any_motion(), 1..40)) {
        let law = one_of_each::<f32>();
        let mut state = law.at_rest();
        for motion in &motions {
            prop_assert!(law.force(&mut state, motion).is_finite());
        }
        prop_assert!(law.force(&mut state, &sine(0.1, 1.0, 7)).is_finite());
    }
}

/// A parameter of −0 is refused, or as good as one of 0: nothing is divided by it.
#[test]
fn a_zero_of_the_other_sign_is_refused_or_gives_the_same_force() {
    let mut refused = Vec::new();
    for description in DESCRIPTIONS {
        for (place, parameter) in description.parameters.iter().enumerate() {
            let forces = |zero: f64| {
                let mut parameters = description.typical.to_vec();
                parameters[place] = zero;
                let made = Effect::<f32>::from_parameters(description.number, &parameters, 1e-4);
                let law = AugmentedLaw::<f32, 1>::new(Law::new(1.0, 10.0, 0.1, 0.3).unwrap());
                let law = law.with(made.ok()?).unwrap();
                let mut state = law.at_rest();
                let motion = |n| Motion {
                    controls: [0.7; 4],
                    cycles: 0.01 * n as f32,
                    ..sine(0.1, 5.0, n)
                };
                let forces: Vec<f32> = (0..TICKS / 4)
                    .map(|n| law.force(&mut state, &motion(n)))
                    .collect();
                Some(forces)
            };
            let (negative, positive) = (forces(-0.0), forces(0.0));
            if negative.is_none() && positive.is_some() {
                refused.push(parameter.name);
                continue;
            }
            let name = description.name;
            assert_eq!(negative, positive, "{name} {}", parameter.name);
            assert!(positive.into_iter().flatten().all(f32::is_finite));
        }
    }
    assert_eq!(refused, ["lag"]);
}
