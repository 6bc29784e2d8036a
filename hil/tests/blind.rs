//! The blind trial.

use hil::blind::{Class, FLOORS_OF_A_PART, GROUP, PART, draw, run};

/// Every group has its shares of the classes; what is hidden is as large as promised; the same seed hides the same.
#[test]
fn trials_are_what_they_promise() {
    let mut classes = [0; 4];
    for seed in 0..GROUP {
        let trial = draw(seed);
        let secret = &trial.secret;
        classes[secret.class as usize] += 1;
        let (count, least) = match secret.class {
            Class::None => (0, 0.0),
            Class::Listed | Class::Unlisted => (1, 1.0 / 1.15),
            Class::Pair => (2, 3.0 / 1.15),
        };
        assert_eq!(secret.effects.len(), count, "seed {seed}");
        for effect in &secret.effects {
            assert!(
                effect.visible > least && effect.visible < 57.5,
                "seed {seed}: {effect:?}"
            );
            // The fit is over all but the ramps, which may be quieter.
            assert!(
                effect.size > 0.5 * effect.visible,
                "seed {seed}: {effect:?}"
            );
        }
        let families = secret.families();
        assert!(count < 2 || families[0] != families[1], "seed {seed}");
        for recording in [&trial.training, &trial.held_out] {
            assert!((1_000..140_000).contains(&recording.len()), "seed {seed}");
        }
    }
    assert_eq!(classes, [10, 18, 9, 13]);
    let (once, again) = (draw(7), draw(7));
    assert_eq!(once.secret, again.secret);
    assert_eq!(once.training, again.training);
    assert_eq!(once.held_out, again.held_out);
}

/// A part of the trial; `cargo hil blind --seeds 500 --check` is the whole.
#[test]
fn a_part_of_the_trial_reaches_what_it_has_reached() {
    let summary = run(PART, &|_| ());
    let missed = FLOORS_OF_A_PART.missed(&summary);
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}
