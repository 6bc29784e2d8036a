//! Attacks on the rig, a part of the campaign's: hazards that it must prevent, and requirements on its monitor.

use mesh_damper::health::{Channel, HealthCause};
use mesh_damper_rig::campaign::{
    Behind, Campaign, Change, Close, Headroom, Injected, Quantity, Said, Set, Summary, Trial,
    adversary, forgeries, missed, run_trial,
};

/// `cargo hil faults --check` is the whole.
#[test]
fn a_part_of_the_attacks_meets_the_requirement() {
    let campaign = Campaign {
        known: Vec::new(),
        healthy_cycles: 0,
        ..Campaign::part()
    };
    let summary = campaign.run(&|| ()).unwrap();
    assert!(summary.attacks.trials() > 100);
    let missed = missed(&summary);
    assert!(missed.is_empty(), "{}", missed.join("\n"));
    // The monitor finds every cause: here, or as a known change or in the healthy runs of `faults.rs`.
    let reports = summary.attacks.outcomes.all().flat_map(|one| &one.named);
    let named = reports.flat_map(|(_, said)| match said {
        Said::Event(cause, or) => [Some(*cause), *or],
        _ => [None; 2],
    });
    let known = Change::known().into_iter().filter_map(Change::cause);
    let healthy = [HealthCause::RunIn, HealthCause::Temperature];
    let found: Vec<HealthCause> = named.flatten().chain(known).chain(healthy).collect();
    for cause in HealthCause::ALL {
        assert!(
            found.contains(&cause),
            "no change of the campaign brings up {cause:?}"
        );
    }
}

#[test]
fn the_adversary_does_the_same_twice() {
    let run = |seed| run_trial(&adversary(seed)).unwrap();
    let once: Vec<_> = (0..6).map(run).collect();
    let twice: Vec<_> = (0..6).map(run).collect();
    assert_eq!(once, twice);
    let attacks = Summary::of(once, Vec::new(), Vec::new(), Vec::new()).attacks;
    assert_eq!(attacks.trials(), 6);
    assert_eq!(attacks.adversary.trials + attacks.adversary.hidden, 6);
}

fn attack(kind: Change, size: f64, begins: f64) -> Injected {
    Injected {
        kind,
        size,
        begins,
        lasts: None,
    }
}

fn close(headroom: f64) -> Option<Close> {
    Some(Close {
        headroom: Headroom::of_all(headroom),
        range: 2.0,
    })
}

fn trial(changes: Vec<Injected>) -> Trial {
    Trial {
        set: Set::Adversary,
        changes,
        density: 3.0,
        amplitude: 0.1,
        frequency: 10.0,
        noise: 0.004,
        follow: 0.0,
        blocks: vec![12],
        run_in: 200,
        close: close(1.5),
        seed: 1,
    }
}

/// Behind a force channel with two fifths of its gain a specimen gives three times its force: 2 times the limit, of which 0.8 is
/// shown.
#[test]
fn a_hazard_behind_a_constant_gain_is_seen_and_told_apart() {
    let less = attack(Change::GainFromStart(Channel::Force), -0.6, -2.0);
    let stiff = attack(Change::Stiffened, 2.0, 6.3);
    let outcome = run_trial(&trial(vec![less, stiff])).unwrap();
    let force = |behind| {
        let hazards = outcome.hazards.iter();
        hazards
            .filter(move |one| one.quantity == Quantity::Force && one.behind == behind)
            .map(|one| one.factor)
            .next_back()
    };
    let factor = force(Behind::ConstantGain).unwrap();
    assert!((1.8..2.1).contains(&factor), "{outcome:?}");
    assert_eq!(force(Behind::Other), None, "{outcome:?}");
}

#[test]
fn a_healthy_rig_is_in_no_hazardous_state_within_the_closest_limits() {
    for (frequency, density, amplitude) in [(5.0, 3.0, 0.1), (8.0, 2.0, 0.25), (8.0, 4.0, 0.05)] {
        let quiet = Trial {
            frequency,
            density,
            amplitude,
            close: close(1.2),
            ..trial(Vec::new())
        };
        let outcome = run_trial(&quiet).unwrap();
        assert!(!outcome.found && outcome.hazards.is_empty(), "{outcome:?}");
        assert_eq!(outcome.stopped, None);
    }
}

/// Four per word.
#[test]
fn every_word_of_the_settings_is_forged() {
    let all = forgeries().unwrap();
    let words = all.iter().map(|one| one.word).max().unwrap() + 1;
    assert_eq!(all.len(), 4 * words);
    assert!(words > 20, "{words}");
}
