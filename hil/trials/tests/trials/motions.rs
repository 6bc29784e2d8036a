//! The trial over any motion; `cargo hil blind --motions` is the whole trial.

use mesh_damper_trials::blind::{Draw, Floors, Kind, Mark, Test, Version, run};

/// One of each kind of motion without a hidden effect, and one with a hidden effect.
#[test]
#[ignore = "half a minute: in the full tier"]
fn every_kind_of_motion_is_traced() {
    let kinds = Kind::ALL.len() as u64;
    let version = Version::new(1).unwrap();
    let summary = run(0..2 * kinds, Draw::Motions, version, &|| ());
    let outcomes = summary.outcomes.iter();
    let refused = outcomes.filter(|o| o.mark() == Mark::Refused);
    assert_eq!(refused.count(), 0);
    let counted = summary.outcomes.iter().filter(|o| o.counts());
    let marks: Vec<_> = counted.map(|o| (&o.secret.test, o.mark())).collect();
    let missed = Floors::PartOfMotions.missed(&summary.results);
    assert!(missed.is_empty(), "{}\n{marks:?}", missed.join("\n"));
}

#[test]
fn a_seed_draws_the_same_again() {
    let draw = |()| Draw::Motions.trial(Version::NEWEST, 20).unwrap();
    let [one, again] = [(); 2].map(draw);
    assert_eq!(one.training.force, again.training.force);
    assert_eq!(one.secret, again.secret);
    assert_ne!(one.training.displacement, one.held_out.displacement);
    let Test::Motion(_) = one.secret.test else {
        panic!("it is a motion");
    };
    let shown = one.secret.effects.iter().map(|effect| effect.visible);
    assert!(shown.clone().count() > 0 && shown.into_iter().all(|ratio| ratio > 1.0));
}
