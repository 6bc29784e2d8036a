//! Damage of the specimen is found at any temperature, in any run-in or block, and identified correctly.

use mesh_damper::health::HealthCause;
use mesh_damper::rig::State;

use super::{BEGINS, Rig, SEEDS, run};

#[test]
fn no_temperature_hides_a_break() {
    let shown: [fn(f64) -> f64; 5] = [
        // For one tick, and permanently.
        |cycle| {
            if (25.5..25.501).contains(&cycle) {
                f64::NAN
            } else {
                20.0
            }
        },
        |cycle| if cycle > 25.0 { f64::NAN } else { 20.0 },
        |cycle| if cycle > 25.0 { 1372.0 } else { 20.0 },
        |cycle| if cycle > BEGINS { f64::INFINITY } else { 20.0 },
        |cycle| if cycle > BEGINS { 50.0 } else { 20.0 },
    ];
    for seed in 0..SEEDS {
        for shown in shown {
            let run = run(seed, |a| {
                *a.temperature = shown(a.cycle);
                if a.is_on() {
                    a.condition.stiffness = 0.8;
                    a.condition.friction = 0.8;
                }
            });
            let causes = run.causes();
            let expected = [
                HealthCause::TemperatureImplausible,
                HealthCause::WireBreakage,
            ];
            assert_eq!(causes, expected, "{seed}");
            let (cycle, _) = *run.events.last().unwrap();
            assert!(cycle - BEGINS < 5.0, "{cycle}");
        }
    }
}

#[test]
fn a_rise_of_friction_and_stiffening_have_their_names() {
    for seed in 0..SEEDS {
        for (stiffness, friction, cause) in [
            (1.0, 1.2, HealthCause::FrictionRise),
            (1.0, 1.5, HealthCause::FrictionRise),
            (1.2, 1.0, HealthCause::Stiffening),
        ] {
            let run = run(seed, |a| {
                if a.is_on() {
                    a.condition.stiffness = stiffness;
                    a.condition.friction = friction;
                }
            });
            let (cycle, event) = run.first();
            assert_eq!(event.cause, cause, "{seed}");
            assert!(cycle - BEGINS < 5.0);
        }
    }
}

#[test]
fn a_break_while_it_learns_is_a_loss() {
    for seed in 0..SEEDS {
        let run = run(seed, |a| {
            if a.cycle > 11.0 {
                a.condition.stiffness = 0.8;
                a.condition.friction = 0.8;
            }
        });
        let (cycle, event) = run.events[0];
        assert_eq!(event.cause, HealthCause::WireBreakage);
        // Three times the smallest size that must be found.
        assert!((event.limit - 0.15).abs() < 1e-6, "{event:?}");
        assert!(
            (event.value + 0.2).abs() < 0.03 && cycle < 15.0,
            "{event:?} in {cycle}"
        );
    }
}

#[test]
#[ignore = "half a minute: in the full tier"]
fn short_blocks_of_one_motion_are_watched_as_one() {
    for seed in 0..SEEDS {
        let run = Rig::new(12, 12, seed).run(|a| {
            if a.cycle > 60.0 {
                a.condition.stiffness = 0.7;
                a.condition.friction = 0.7;
            }
        });
        assert_eq!(run.state, State::Done);
        assert_eq!(run.causes(), [HealthCause::WireBreakage]);
        assert!(run.first().0 < 66.0);
        // A loss that would be no more than a run-in in a block that is learned again.
        let run = Rig::new(12, 12, seed).run(|a| {
            if a.cycle > 60.0 {
                a.condition.stiffness = 0.9;
                a.condition.friction = 0.9;
            }
        });
        assert_eq!(run.causes(), [HealthCause::WireBreakage]);
        let healthy = Rig::new(12, 12, seed).run(|_| {});
        assert_eq!(healthy.causes(), []);
    }
}

/// A specimen with 1.6 times the force of its law, and with a loss that is larger in the same proportion. 8 °C in 40 cycles: 5 % of
/// the law's force.
#[test]
fn warmth_is_no_fault_of_a_specimen_that_is_more_than_its_law() {
    for seed in 0..SEEDS {
        let run = Rig::new(1, 80, seed).run(|a| {
            let warming = 8.0 * ((a.cycle - BEGINS) / 2.0).clamp(0.0, 1.0);
            a.condition.stiffness = 1.6;
            a.condition.friction = 1.6;
            a.condition.warm_loss = 0.004;
            a.condition.temperature = 20.0 + warming;
            *a.temperature = a.condition.temperature;
        });
        // Its size is reported at the start.
        let reported = run.causes();
        assert!(
            reported.iter().all(|cause| matches!(
                cause,
                HealthCause::LawMismatch | HealthCause::RunIn | HealthCause::Temperature
            )),
            "{reported:?}"
        );
    }
}

#[test]
fn a_run_in_hides_no_more_than_a_run_in() {
    for seed in 0..2 {
        let run = Rig::new(1, 200, seed).run(|a| {
            let part = 1.0 - 0.4 * ((a.cycle - 21.0) / 170.0).clamp(0.0, 1.0);
            a.condition.stiffness = part;
            a.condition.friction = part;
        });
        let (cycle, event) = run.events[0];
        assert_eq!(event.cause, HealthCause::WireBreakage);
        // The permitted run-in is 15 %, a third of which is gone when learning ends.
        assert!(cycle < 110.0, "{cycle}");
    }
}
