//! The fault campaign, a part of it: the requirements on the rig's monitor.

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::fast_law::{Adaptation, FastLaw};
use mesh_damper::health::HealthCause;
use mesh_damper::law::Law;
use mesh_damper::rig::State;
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::campaign::{
    Attacks, Campaign, Change, Condition, Damaged, FOLLOW, Healthy, Surroundings, missed,
};
use mesh_damper_rig::{Bench, RigSetup, TICK_RATE};

/// `cargo hil faults --check` is the whole. Attacks have their own test.
#[test]
fn a_part_of_the_campaign_meets_the_requirement() {
    let campaign = Campaign {
        attacks: Attacks::default(),
        ..Campaign::part()
    };
    assert_eq!(campaign.known, Change::known());
    let summary = campaign.run(&|| ()).unwrap();
    let kinds: Vec<Change> = summary.kinds.iter().map(|one| one.kind).collect();
    let run = |kind: &Change| kinds.contains(kind);
    assert!(Change::known().iter().all(run) && kinds.len() > 30);
    let missed = missed(&summary);
    assert!(missed.is_empty(), "{}", missed.join("\n"));
    let within = summary
        .slow
        .iter()
        .filter(|one| one.change.is_within())
        .count();
    assert!(within > 0 && within < summary.slow.len());
    // It settles by 10 %, and later warming changes it by 5 %: both are reported, and neither is an alarm.
    let settling = |healthy: &&Healthy| healthy.surroundings == Surroundings::Settling;
    assert_eq!(summary.healthy.len(), Surroundings::ALL.len() * 6);
    for healthy in summary.healthy.iter().filter(settling) {
        let noted: Vec<&str> = healthy
            .noted
            .iter()
            .map(|(_, cause)| cause.as_str())
            .collect();
        assert_eq!(noted, ["RunIn", "Temperature"], "{healthy:?}");
    }
}

fn law_of(specimen: &Damaged, part: f64) -> AugmentedLaw<f32, 1> {
    let c = specimen.coefficients();
    let [k1, k3, friction] = [c.k1, c.k3, c.c].map(|value| (part * value) as f32);
    AugmentedLaw::new(Law::new(k1, k3, friction, c.alpha as f32).unwrap())
}

/// A law that takes over in the middle of a block is not a change of the specimen, and ends the adaptation.
#[test]
fn a_better_law_in_the_middle_of_a_block_is_no_fault() {
    for follow in [0.0, FOLLOW] {
        let (specimen, condition) = Damaged::new(3.0, 0.1);
        let block = Block::sine(0.1, 10.0, 100).unwrap();
        let programme = Programme::<1>::new(TICK_RATE, 1)
            .unwrap()
            .with(block)
            .unwrap();
        let better = FastLaw::new(law_of(&specimen, 1.0));
        let mut setup = RigSetup::new(specimen.clone(), law_of(&specimen, 1.2), programme, 1);
        setup.settings.health.follow = follow;
        let mut bench = Bench::new(setup).unwrap();
        bench.rig.start().unwrap();
        let (mut named, mut followed) = (Vec::new(), Vec::new());
        while bench.rig.state() == State::Running {
            let telemetry = bench.tick();
            named.extend(telemetry.event.map(|event| (telemetry.cycle, event.cause)));
            if let Some(report) = telemetry.report {
                followed.push(report.followed);
                match report.cycle {
                    40 => bench.rig.swap_law(better.clone()),
                    70 => condition.set(Condition {
                        stiffness: 0.9,
                        friction: 0.9,
                        ..Condition::NEW
                    }),
                    _ => {}
                }
            }
        }
        // The law takes over with the end of cycle 41.
        let far = |followed: &Adaptation| followed.k1 < -0.01 && followed.c < -0.01;
        assert_eq!(far(&followed[41]), follow > 0.0, "{:?}", followed[41]);
        assert_eq!(followed[42], Adaptation::default());
        let &[(cycle, cause)] = &named[..] else {
            panic!("{named:?}");
        };
        assert_eq!(cause, HealthCause::WireBreakage);
        assert!((72..76).contains(&cycle), "{cycle}");
        // A break is not adapted to: the adaptation changes by no more than noise causes in the cycle before it is suspected.
        let (then, end) = (followed[70], followed[followed.len() - 2]);
        assert!((end.k1 - then.k1).abs() < 2.5e-3, "{then:?}, {end:?}");
        assert!(follow == 0.0 || end != Adaptation::default());
    }
}
