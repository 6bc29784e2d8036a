//! An effect is confirmed although an unlisted effect is present, and a mere resemblance is not confirmed.

use mesh_damper_identify::trace::result::Verdict;
use mesh_damper_identify::trace::rule::Rule;
use mesh_damper_identify::trace::trace;

use super::{BLOCKS, OTHERS, Sample, families, record, slider, traced};

/// An unlisted force: friction whose sign depends on the place of the motion and on the clock.
fn unmodelled(size: f64) -> impl Fn(&Sample) -> f64 {
    move |&(time, y, v, _)| size * (v / 3.0).tanh() * (40.0 * y).sin() * (3.0 * time).cos()
}

#[test]
fn a_slider_is_confirmed_beside_what_has_no_name() {
    let trace = traced(0.004, 3, || {
        let (mut slider, unmodelled) = (slider(0.9, 0.03), unmodelled(0.02));
        move |sample: &Sample| slider(sample) + unmodelled(sample)
    });
    let result = &trace.result;
    assert_eq!(result.verdict, Verdict::Found, "{:?}", result.effects);
    assert_eq!(families(&trace.result), ["stick_slip"]);
    let found = &result.effects[0].parameters["slip_limit"];
    assert!((found.value / 0.03 - 1.0).abs() < 0.1, "{found:?}");
    assert_eq!(result.effects[0].unconfirmed_by, None);
    let left = result.remainder.as_ref().expect("the rest is left");
    assert!(left.times_noise > 1.5, "{left:?}");
    assert!(left.nrmse > 0.006, "{left:?}");
    assert!(result.conditions.len() >= 3);
    for condition in &result.conditions {
        assert!(
            condition.nrmse_with < condition.nrmse_without["stick_slip"],
            "{condition:?}"
        );
    }
}

#[test]
fn what_has_no_name_gets_none() {
    let trace = traced(0.004, 4, || unmodelled(0.06));
    let result = &trace.result;
    assert_eq!(result.verdict, Verdict::Unlisted, "{:?}", result.effects);
    assert!(
        result
            .effects
            .iter()
            .all(|one| one.unconfirmed_by.is_some())
    );
    assert!(result.remainder.is_some());
}

/// A drag proportional to v² is nearly a dashpot at any single speed.
#[test]
fn a_dashpot_is_not_confirmed_for_a_drag() {
    let trace = traced(0.004, 5, || {
        let unmodelled = unmodelled(0.03);
        move |sample: &Sample| 0.004 * sample.2 * sample.2.abs() + unmodelled(sample)
    });
    let result = &trace.result;
    assert!(!families(&trace.result).contains(&"viscous") || result.verdict == Verdict::Unlisted);
    let dashpot = result.effects.iter().chain(&result.unconfirmed);
    for effect in dashpot.filter(|effect| effect.family == "viscous") {
        let rule = effect.unconfirmed_by;
        assert!(
            matches!(
                rule,
                Some(Rule::HelpsNotEverywhere | Rule::Unsteady | Rule::Rivalled)
            ),
            "{effect:?}"
        );
    }
}

/// At a single frequency a dashpot and a Maxwell branch leave the same error, with any other effect.
#[test]
fn rivals_beside_what_has_no_name_are_told_apart_by_a_test() {
    let blocks: [(f64, f64, u32); 4] = [0.05, 0.1, 0.15, 0.2].map(|amplitude| (amplitude, 5.0, 10));
    let effect = || {
        let unmodelled = unmodelled(0.02);
        move |sample: &Sample| 0.03 * sample.2 + unmodelled(sample)
    };
    let fitted = record("fitted", &blocks, 0.004, 6, effect());
    let held = record("held", &blocks[1..3], 0.004, 7, effect());
    let trace = trace(&[fitted], &[held], &|_| ()).unwrap();
    let result = &trace.result;
    assert_eq!(result.verdict, Verdict::Ambiguous, "{:?}", result.effects);
    let named = families(&trace.result);
    assert!(named.contains(&"viscous"), "{named:?}");
    assert!(named.len() > 1, "{named:?}");
    let preferred = &result.effects[0];
    assert_eq!(preferred.unconfirmed_by, Some(Rule::Rivalled));
    for rival in &preferred.rivals {
        assert!(named.contains(&&rival[..]), "{rival} of {named:?}");
    }
    for rival in &result.effects[1..] {
        assert_eq!(rival.unconfirmed_by, Some(Rule::Rivalled), "{rival:?}");
        assert!(rival.rivals.contains(&preferred.family), "{rival:?}");
    }
    assert!(result.remainder.is_some());
    let test = result
        .separating_test
        .as_ref()
        .expect("another frequency tells");
    assert!(test.contains("viscous"), "{test}");
    let frequencies = result.separating_blocks.iter().map(|block| block.frequency);
    assert!(
        frequencies
            .clone()
            .any(|hertz| (hertz / 5.0 - 1.0).abs() > 0.2),
        "{test}"
    );
}

/// A specimen whose slider came off before the held-out test.
#[test]
fn a_name_that_conditions_confirm_and_another_test_does_not_is_none() {
    let fitted = record("fitted", &BLOCKS, 0.004, 10, slider(0.9, 0.03));
    let held = record("held", &OTHERS, 0.004, 11, |_| 0.0);
    let trace = trace(&[fitted], &[held], &|_| ()).unwrap();
    let result = &trace.result;
    assert_eq!(result.verdict, Verdict::Unlisted, "{:?}", result.effects);
    assert_eq!(result.effects_rejected_by, Some(Rule::SaysLess));
    let slider = result.effects.iter().chain(&result.unconfirmed);
    let slider = slider
        .into_iter()
        .find(|effect| effect.family == "stick_slip")
        .expect("it is what was fitted");
    assert_eq!(slider.unconfirmed_by, Some(Rule::GainsNothingElsewhere));
    assert!(result.conditions.len() >= 3);
    for condition in &result.conditions {
        assert!(
            condition.nrmse_with < condition.nrmse_without["stick_slip"],
            "each confirms it: {condition:?}"
        );
    }
    let left = result.remainder.as_ref().expect("of what was held out");
    assert!(left.held_out && left.times_noise > 1.5, "{left:?}");
    assert!(
        left.depends_on.contains(&"displacement".to_owned()),
        "the slider's stiffness is missing there: {left:?}"
    );
}

/// A mass on a separate spring is nearly a plain mass as long as the motion is slow.
#[test]
fn a_name_that_says_less_of_what_was_held_out_is_not_one() {
    let blocks = [1.0, 2.5, 5.0, 7.5, 10.0].map(|hertz| (0.1, hertz, (4.0 + 2.0 * hertz) as u32));
    let resonant = |natural: f64| {
        move |&(_, y, _, a): &Sample| {
            let omega_squared = if y == 0.0 { 0.0 } else { -a / y };
            let natural_squared = (std::f64::consts::TAU * natural).powi(2);
            2.2e-5 * a / (1.0 - omega_squared / natural_squared)
        }
    };
    let traced = |natural: f64| {
        let fitted = record("fitted", &blocks, 0.004, 8, resonant(natural));
        let held = record("held", &[(0.1, 16.0, 30)], 0.004, 9, resonant(natural));
        trace(&[fitted], &[held], &|_| ()).unwrap()
    };
    let mass = traced(1e6);
    assert_eq!(mass.result.verdict, Verdict::Found);
    assert_eq!(families(&mass.result), ["inertia"]);
    assert!(mass.result.remainder.is_none());
    let on_a_spring = traced(30.0);
    let result = &on_a_spring.result;
    assert_eq!(result.verdict, Verdict::Unlisted, "{:?}", result.effects);
    assert_eq!(result.effects_rejected_by, Some(Rule::SaysLess));
    assert!(
        result
            .effects
            .iter()
            .all(|one| one.unconfirmed_by.is_some())
    );
    let left = result.remainder.as_ref().expect("of what was held out");
    assert!(left.held_out && left.times_noise > 1.5, "{left:?}");
    assert_eq!(left.nrmse, result.augmented.nrmse_held_out);
    // The law stays as fitted: held-out samples decide nothing about it.
    assert!(result.adopted);
    assert!(!on_a_spring.model.effects.is_empty());
}
