//! The pictures of the fault campaign.

use mesh_damper_report::campaign;
use mesh_damper_rig::campaign::{Campaign, Change, Outcome};

#[test]
fn every_trial_and_every_slow_change_has_its_marks() {
    let campaign = Campaign {
        known: vec![Change::WireBreakage, Change::ForceStuck],
        specimens: vec![(3.0, 0.1, 10.0)],
        healthy_cycles: 100,
        ..Campaign::part()
    };
    let summary = campaign.run(&|| ()).unwrap();
    let named = summary.counts.named();
    assert!(named > 0);
    // One mark for each trial in the pictures, in addition to those of the legend.
    let found = campaign::found(&summary);
    assert!(found.contains("named incorrectly"));
    assert_eq!(found.matches("<circle").count(), named + 1);
    let followed = campaign::followed(&summary.slow);
    assert_eq!(
        followed.matches("<circle").count(),
        2 * (summary.slow.len() + 1)
    );
    // Correct names, for single attacks and in one row each for pairs and for the adversary; one triangle for each hazardous state.
    let attacked = campaign::attacked(&summary.attacks);
    let outcomes = &summary.attacks.outcomes;
    let is_hazardous = |one: &&Outcome| one.is_hazardous();
    let alone_hidden = |one: &&Outcome| one.trial.changes.len() > 1 || one.hidden.is_none();
    let marked = || outcomes.all().filter(alone_hidden);
    let right = marked()
        .filter(|one| !is_hazardous(one) && one.is_named())
        .count();
    assert!(right > 0);
    assert_eq!(attacked.matches("<circle").count(), right + 1);
    let hazardous = marked().filter(is_hazardous).count();
    assert_eq!(attacked.matches("<polygon").count(), hazardous + 1);
}
