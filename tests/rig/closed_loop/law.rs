//! The law next to the specimen: its force is close to the measured one, it receives the fraction of a cycle, and a swapped law takes
//! over at the end of a cycle.

use mesh_damper::effects::{AugmentedLaw, Drift, Effect, Offset, StickSlip};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::law::Law;
use mesh_damper::rig::State;
use mesh_damper_rig::Bench;

use super::{law_of, setup, started};

#[test]
fn the_specimens_own_law_is_near_its_force() {
    let mut bench = started(setup(2.5, &[(0.1, 1.0, 4), (0.1, 2.0, 4)]));
    let mut reports = Vec::new();
    while bench.rig.state() == State::Running {
        reports.extend(bench.tick().report);
    }
    // A ramp before each block and one after the last.
    let numbers: Vec<_> = reports.iter().map(|r| (r.cycle, r.block, r.ramp)).collect();
    let expected: Vec<_> = (0..11)
        .map(|n: u32| (n, usize::from(n >= 5), [0, 5, 10].contains(&n)))
        .collect();
    assert_eq!(numbers, expected);
    let settled: Vec<_> = reports
        .iter()
        .filter(|r| !r.ramp && r.cycle % 5 > 1)
        .collect();
    assert_eq!(settled.len(), 6);
    for report in settled {
        // Noise of the force channel 0.004; the reversals, where the observer smooths the effect of the friction in the specimen
        // on the piston, about 0.01 more.
        assert!(
            report.nrmse > 0.003 && report.nrmse < 0.02,
            "{}",
            report.nrmse
        );
        // Noise of 0.004·F_rms widens the measured force's range by about 4σ at each end: 0.032·F_rms of 2.8·F_rms.
        let ratio = report.measured.stiffness / report.model.stiffness;
        assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
        let energies = report.measured.energy / report.model.energy;
        assert!((energies - 1.0).abs() < 5e-3, "{energies}");
    }
}

#[test]
fn another_law_takes_over_at_the_end_of_the_cycle_and_not_before() {
    let zero = FastLaw::new(AugmentedLaw::new(Law::new(0.0, 0.0, 0.0, 0.5).unwrap()));
    for asked_at in [7_321, 12_000] {
        let mut bench = started(setup(3.0, &[(0.2, 2.0, 5)]));
        for _ in 0..asked_at {
            bench.tick();
        }
        let cycle = bench.tick().cycle;
        bench.rig.swap_law(zero.clone());
        let mut ticks = 0;
        loop {
            let telemetry = bench.tick();
            if telemetry.cycle != cycle {
                assert_eq!(telemetry.cycle, cycle + 1);
                assert_eq!(telemetry.model_force, 0.0);
                let report = telemetry.report.unwrap();
                assert!(report.model.force_max > 0.1, "the old law's cycle is whole");
                break;
            }
            ticks += 1;
            assert_ne!(telemetry.model_force, 0.0);
            assert_eq!(
                *bench.rig.law().augmented().law(),
                law_of(bench.plant.servo.specimen())
            );
        }
        // 5000 ticks a cycle; the first telemetry is of tick 0.
        assert_eq!(ticks, 5000 - asked_at % 5000 - 1);
        assert_eq!(*bench.rig.law(), zero);
    }
    // A swap for the same law changes nothing, including the stuck elements. The state of other effects starts at rest.
    let joints = Effect::StickSlip(StickSlip::new(&[(3.0, 0.02)]).unwrap());
    let offset = Effect::Offset(Offset::new(0.125).unwrap());
    let mut setup = setup(3.0, &[(0.2, 2.0, 5)]);
    setup.law = setup.law.with(joints).unwrap();
    let same = setup.law.clone();
    let other = AugmentedLaw::new(*same.law())
        .with(offset)
        .and_then(|law| law.with(joints))
        .unwrap();
    let mut plain = started(setup.clone());
    let mut swapped = started(setup.clone());
    let mut changed = started(setup);
    for tick in 0..15_000 {
        if tick == 7_000 {
            swapped.rig.swap_law(FastLaw::new(same.clone()));
            changed.rig.swap_law(FastLaw::new(other.clone()));
        }
        let expected = plain.tick().model_force;
        assert_eq!(swapped.tick().model_force, expected);
        let force = changed.tick().model_force;
        if tick < 10_000 {
            assert_eq!(force, expected);
        } else if tick == 10_000 {
            // At phase 0 the joints are stretched to their limit by 3 kN/mm·0.02 mm; at rest their force is 0.
            assert!(
                (expected - force - 0.06 + 0.125).abs() < 1e-6,
                "{expected} {force}"
            );
        }
    }
}

/// k·(1 − e^(−n/N))·y, for a law that has only a drift.
#[test]
fn the_law_gets_the_fraction_of_each_cycle() {
    let mut setup = setup(3.0, &[(0.1, 2.0, 4)]);
    let drift = Effect::Drift(Drift::new(1.0, 2.0).unwrap());
    let none = Law::new(0.0, 0.0, 0.0, 0.5).unwrap();
    setup.law = AugmentedLaw::new(none).with(drift).unwrap();
    let mut bench = started(setup);
    let mut compared = 0;
    loop {
        let telemetry = bench.tick();
        if telemetry.state != State::Running {
            break;
        }
        if telemetry.displacement.abs() < 0.05 {
            continue;
        }
        let cycles = f64::from(telemetry.cycle) + f64::from(telemetry.phase) / 4_294_967_296.0;
        let part = f64::from(telemetry.model_force / telemetry.displacement);
        let expected = -(-cycles / 2.0).exp_m1();
        assert!((part - expected).abs() < 0.02, "{part} after {cycles}");
        compared += 1;
    }
    assert!(compared > 10_000);
}

#[test]
fn a_law_swapped_before_the_start_runs_from_the_first_tick() {
    let zero = FastLaw::new(AugmentedLaw::new(Law::new(0.0, 0.0, 0.0, 0.5).unwrap()));
    let mut bench = Bench::new(setup(3.0, &[(0.2, 10.0, 1)])).unwrap();
    bench.rig.swap_law(zero.clone());
    bench.tick();
    bench.rig.start().unwrap();
    assert_eq!(*bench.rig.law(), zero);
    while bench.rig.state() == State::Running {
        assert_eq!(bench.tick().model_force, 0.0);
    }
}
