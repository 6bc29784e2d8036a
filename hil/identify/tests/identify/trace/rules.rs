//! The report states the rules by which a trace rejects candidates.

use mesh_damper_identify::trace::result::{TraceResult, Verdict};
use mesh_damper_identify::trace::rule::Rule;
use mesh_damper_identify::trace::{Sought, trace_for};
use mesh_damper_model::Family;

use super::{slider, traced};

/// A slider is found at the first step; at the second step the law with it is noise-limited.
#[test]
fn every_candidate_that_is_not_in_the_law_has_its_rule() {
    let result = traced(0.004, 1, || slider(0.9, 0.03)).result;
    assert_eq!(result.verdict, Verdict::Found);
    assert_eq!(result.effects_rejected_by, None);
    assert_eq!(result.table_rejected_by, None);
    let (first, later): (Vec<_>, Vec<_>) = result
        .candidates
        .iter()
        .partition(|candidate| candidate.step == 1);
    for candidate in &first {
        let is_taken_or_alike = candidate.added || !candidate.distinguishable;
        let rule = candidate.rejected_by;
        let inherent = matches!(
            rule,
            Some(Rule::NotPassive | Rule::StandsStill | Rule::InStepWithMotion)
        );
        assert_eq!(candidate.admissible, !inherent, "{candidate:?}");
        assert!(is_taken_or_alike || rule.is_some(), "{candidate:?}");
        assert!(!candidate.added || rule.is_none(), "{candidate:?}");
    }
    let first_has = |rule| first.iter().any(|c| c.rejected_by == Some(rule));
    assert!(first_has(Rule::Worse) && first_has(Rule::LittlePromise));
    assert!(!later.is_empty());
    for candidate in later.iter().filter(|candidate| candidate.admissible) {
        assert_eq!(candidate.rejected_by, Some(Rule::NoiseLimited));
    }
}

/// An unlisted force: the best law of the search leaves too large an error.
#[test]
fn effects_that_do_not_explain_a_recording_are_rejected_by_a_rule() {
    let result = traced(0.004, 2, || {
        |&(time, y, v, _): &super::Sample| {
            0.3 * (v / 3.0).tanh() * (40.0 * y).sin() * (3.0 * time).cos()
        }
    })
    .result;
    assert_eq!(result.verdict, Verdict::Unlisted);
    assert_eq!(
        result.effects_rejected_by.is_some(),
        result.candidates.iter().any(|candidate| candidate.added)
    );
    assert_eq!(
        result.table_rejected_by.is_none(),
        result.correction.is_some()
    );
}

/// Excluded effects are not searched for, and a list of permitted effects limits the search.
#[test]
fn only_what_is_sought_is_tried() {
    let slides =
        |name: &str, seed| super::record(name, &super::BLOCKS, 0.004, seed, slider(0.9, 0.03));
    let of = |sought: &Sought| {
        let [fitted, held] = [slides("fitted", 1), slides("held", 2)];
        trace_for(sought, &[fitted], &[held], &|_| ())
            .unwrap()
            .result
    };
    let named = |name: &str| vec![Family::named(name).unwrap()];
    let without = of(&Sought {
        exclude: named("stick_slip"),
        ..Sought::default()
    });
    let tried = |result: &TraceResult, name: &str| {
        let mut candidates = result.candidates.iter();
        candidates.any(|candidate| candidate.family == name)
    };
    assert!(!tried(&without, "stick_slip") && tried(&without, "relaxation"));
    let alone = of(&Sought {
        families: named("stick_slip"),
        ..Sought::default()
    });
    assert!(tried(&alone, "stick_slip") && !tried(&alone, "relaxation"));
    assert_eq!(alone.verdict, Verdict::Found);
}

/// A force that is another in each block: what fits the others says little of the one left out, and the law alone is written
/// unless told otherwise.
#[test]
fn what_no_condition_confirms_is_written_only_if_insisted_on() {
    const FORCES: [[f64; 2]; 6] = [
        [0.3, 30.0],
        [-0.2, 60.0],
        [0.4, 40.0],
        [0.2, 90.0],
        [-0.3, 50.0],
        [0.3, 70.0],
    ];
    let ends = [6.0, 8.0, 14.0, 16.0, 22.0, f64::INFINITY];
    let unlisted = |&(time, y, v, _): &super::Sample| {
        let block = ends.iter().position(|&end| time < end).unwrap();
        let [strength, waves] = FORCES[block];
        strength * (waves * y).sin() * (v / 3.0).tanh()
    };
    let of = |adopt: bool| {
        let recording = super::record("blocks", &super::BLOCKS, 0.004, 3, unlisted);
        let sought = Sought {
            adopt,
            ..Sought::default()
        };
        trace_for(&sought, &[recording], &[], &|_| ()).unwrap()
    };
    let [kept, adopted] = [false, true].map(of);
    for trace in [&kept, &adopted] {
        assert_eq!(trace.result.verdict, Verdict::Unlisted);
    }
    assert!(!kept.result.adopted && kept.result.rejected.is_some());
    assert!(kept.model.effects.is_empty() && kept.model.correction.is_none());
    assert!(adopted.result.adopted && adopted.result.rejected.is_none());
    assert!(!adopted.model.effects.is_empty() || adopted.model.correction.is_some());
}
