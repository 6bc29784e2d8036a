//! The trial over any motion; `cargo hil blind --motions` is the whole trial.

use mesh_damper_trials::blind::motions::{FLOORS_OF_A_PART, Kind, Mark, draw, run};

/// One of each kind of motion without a hidden effect, and one with a hidden effect.
#[test]
#[ignore = "half a minute: in the full tier"]
fn every_kind_of_motion_is_traced() {
    let kinds = Kind::ALL.len() as u64;
    let summary = run(0..2 * kinds, &|| ());
    let refused = summary.outcomes.iter().filter(|o| o.mark == Mark::Refused);
    assert_eq!(refused.count(), 0);
    let counted = summary.outcomes.iter().filter(|o| o.counts());
    let marks: Vec<_> = counted.map(|o| (o.seed, o.kind, o.mark)).collect();
    let missed = FLOORS_OF_A_PART.missed(&summary);
    assert!(missed.is_empty(), "{}\n{marks:?}", missed.join("\n"));
}

#[test]
fn a_seed_draws_the_same_again() {
    let [one, again] = [(); 2].map(|()| draw(20));
    assert_eq!(one.training.force, again.training.force);
    assert_eq!(one.hidden, again.hidden);
    assert_ne!(one.training.displacement, one.held_out.displacement);
    assert!(one.left_by_eq13 > one.sensors.force_noise, "it shows");
}
