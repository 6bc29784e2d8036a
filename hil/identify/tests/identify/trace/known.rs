//! A user's knowledge of a specimen: another law than eq 13, and known effects.

use super::*;
use mesh_damper_identify::known_terms::known_terms;
use mesh_damper_identify::trace::{Sought, trace_for};
use mesh_damper_model::{AddedEffect, LawNode, Model};

fn traced_for(sought: &Sought, force: impl Fn() -> Box<dyn FnMut(&Sample) -> f64>) -> Trace {
    // Subtracts the law that `record` adds.
    let own = |mut force: Box<dyn FnMut(&Sample) -> f64>| {
        move |sample: &Sample| force(sample) - law(sample)
    };
    let fitted = record("fitted", &BLOCKS, 0.004, 3, own(force()));
    let held = record("held", &OTHERS, 0.004, 4, own(force()));
    trace_for(sought, &[fitted], &[held], &|_| ()).unwrap()
}

fn beside(law: BaseLaw) -> Sought {
    Sought {
        law,
        ..Sought::default()
    }
}

fn assert_near(value: f64, truth: f64, what: &str) {
    assert!((value / truth - 1.0).abs() < 0.05, "{what} is {value}");
}

#[test]
fn effects_are_sought_beside_a_spring_and_a_dashpot() {
    let linear = |&(_, y, v, _): &Sample| 2.0 * y + 0.02 * v;
    let found = traced_for(&beside(BaseLaw::Linear), || {
        let mut slider = slider(1.5, 0.03);
        Box::new(move |sample| linear(sample) + slider(sample))
    });
    assert_eq!(families(&found.result), ["stick_slip"]);
    assert_eq!(found.result.baseline.law, "linear");
    for LawNode {
        k1, k3, c, alpha, ..
    } in found.model.law
    {
        assert_near(k1, 2.0, "k1");
        assert_near(c, 0.02, "c");
        assert_eq!((k3, alpha), (0.0, 1.0));
    }
}

/// A spring in series is fitted with the crate's computation, which includes k3 and α.
#[test]
fn a_spring_in_series_leaves_the_law_as_it_is_made() {
    // x' = (k·(y − x) − kx·x)/c of a Zener body, in steps of a hundredth of the tick.
    let (series, k1, c) = (3.0, 2.0, 0.05);
    let sought = Sought {
        // A Maxwell branch parallel to a spring is the same.
        families: vec![Family::named("compliance").unwrap()],
        ..beside(BaseLaw::Linear)
    };
    let found = traced_for(&sought, || {
        let mut inner = None;
        Box::new(move |&(_, y, v, _)| {
            let mut x = inner.unwrap_or(y * series / (series + k1));
            let steps = 100;
            for step in 0..steps {
                let before = f64::from(steps - step) / f64::from(steps);
                let y = y - v * TICK * before;
                x += TICK / f64::from(steps) * (series * (y - x) - k1 * x) / c;
            }
            inner = Some(x);
            series * (y - x)
        })
    });
    assert_eq!(found.result.verdict, Verdict::Found);
    let stiffness = found.result.effects[0].parameters["stiffness"].value;
    assert_near(stiffness, series, "stiffness");
    for LawNode { k3, alpha, .. } in found.model.law {
        assert_eq!((k3, alpha), (0.0, 1.0));
    }
}

#[test]
fn effects_may_be_all_of_the_force() {
    let found = traced_for(&beside(BaseLaw::None), || {
        let mut slider = slider(1.5, 0.03);
        Box::new(move |sample| 0.02 * sample.2 + slider(sample))
    });
    let mut named = families(&found.result);
    named.sort_unstable();
    assert_eq!(named, ["stick_slip", "viscous"]);
    assert_eq!(found.result.baseline.law, "none");
    assert_eq!(found.result.baseline.nrmse_held_out, 1.0);
    let [node] = found.model.law[..] else {
        panic!("one node");
    };
    assert_eq!([node.k1, node.k3, node.c], [0.0; 3]);
}

#[test]
fn nothing_is_found_where_nothing_beside_the_law_is() {
    let found = traced_for(&beside(BaseLaw::Linear), || {
        Box::new(|&(_, y, v, _)| 2.0 * y + 0.02 * v)
    });
    assert_eq!(found.result.verdict, Verdict::None);
    // Without a base law, no listed effect is a plain spring.
    let found = traced_for(&beside(BaseLaw::None), || Box::new(|&(_, y, _, _)| 2.0 * y));
    assert_ne!(found.result.verdict, Verdict::None);
}

fn known(model: &Model) -> Sought {
    let effects = model.effects.iter();
    Sought {
        known: effects.flat_map(|one| known_terms(one).unwrap()).collect(),
        ..Sought::default()
    }
}

fn mass(kilograms: f64) -> impl Fn(&Sample) -> f64 {
    move |&(_, _, _, a)| 1e-6 * kilograms * a
}

/// The law with a slider is known from one test; in the next the specimen also carries a mass.
#[test]
fn what_is_known_stays_and_more_is_found() {
    let slides = || {
        let mut slider = slider(0.9, 0.04);
        move |sample: &Sample| slider(sample)
    };
    let first = traced(0.004, 1, slides);
    assert_eq!(families(&first.result), ["stick_slip"]);
    let recorded = |seed, kilograms: f64| {
        let (mut slider, mass) = (slides(), mass(kilograms));
        record("next", &BLOCKS, 0.004, seed, move |sample| {
            slider(sample) + mass(sample)
        })
    };
    let sought = known(&first.model);
    let next = trace_for(&sought, &[recorded(5, 40.0)], &[], &|_| ()).unwrap();
    assert_eq!(families(&next.result), ["inertia"]);
    assert_eq!(next.result.baseline.known, ["stick_slip"]);
    assert!(next.result.adopted);
    let limit = |model: &Model| {
        let mut effects = model.effects.iter();
        let slider = effects.find(|one| one.family.name() == "stick_slip");
        slider.unwrap().parameters["slip_limit"]
    };
    assert_near(limit(&next.model), 0.04, "slip limit");
    assert_near(
        next.result.effects[0].parameters["mass"].value,
        40.0,
        "mass",
    );

    let same = trace_for(&sought, &[recorded(6, 0.0)], &[], &|_| ()).unwrap();
    assert_eq!(same.result.verdict, Verdict::None);
    assert!(families(&same.result).is_empty() && !same.result.adopted);
    assert_near(limit(&same.model), 0.04, "slip limit");
}

/// If the data do not show the effect, it still stays in the law, within the limits of the data.
#[test]
fn what_is_known_is_not_dropped() {
    let effect = AddedEffect {
        family: Family::named("stop").unwrap(),
        parameters: [("stiffness", 5.0), ("gap", 0.15)]
            .map(|(name, value)| (name.to_owned(), value))
            .into(),
    };
    let sought = Sought {
        known: known_terms(&effect).unwrap(),
        ..Sought::default()
    };
    let recording = record("stops", &BLOCKS, 0.004, 7, |&(_, y, _, _)| {
        5.0 * (y - 0.15).max(0.0)
    });
    let found = trace_for(&sought, &[recording], &[], &|_| ()).unwrap();
    assert_eq!(found.result.verdict, Verdict::None);
    let [stop] = &found.model.effects[..] else {
        panic!("the stop alone");
    };
    assert_near(stop.parameters["gap"], 0.15, "gap");
}
