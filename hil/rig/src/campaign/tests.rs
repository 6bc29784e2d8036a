//! Each attack changes signals and specimen as documented, and each trial follows from its number.

use std::cell::Cell;

use mesh_damper::health::Channel;

use super::action::{Action, HealthyRig, Running, damage};
use super::names::Names;
use super::*;
use crate::Plant;
use crate::actuator::ServoFault;
use crate::signals::{Interference, OnChannel};

/// With channels of 1 and 4 V, and limits at 1.5 and 6 V.
const HEALTHY: HealthyRig = HealthyRig {
    amplitude: 0.1,
    frequency: 10.0,
    force: 0.3,
    tick: 1e-4,
    units: [0.1, 0.075],
    limits: [0.15, 0.45],
};

fn at(kind: Change, size: f64) -> Injected {
    Injected {
        kind,
        size,
        begins: 0.0,
        lasts: None,
    }
}

/// The specimen this many cycles after the attack.
fn damaged(kind: Change, size: f64, cycles: f64) -> Condition {
    let condition = Cell::new(Condition::NEW);
    let tick = (cycles * 1000.0) as u64;
    damage(
        &[Running::new(at(kind, size), 0, None, &HEALTHY)],
        tick,
        &HEALTHY,
        &condition,
    );
    condition.get()
}

fn on_force(kind: fn(Channel) -> Change, size: f64) -> OnChannel {
    match kind(Channel::Force).action(size, &HEALTHY) {
        Action::Signal(Interference::Channel(Channel::Force, on)) => on,
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_kind_does_something_and_is_called_something() {
    for kind in Change::all() {
        for &size in kind.sizes() {
            let is_of_specimen = kind.facts().element == Element::Specimen;
            let is_damage = matches!(kind.action(size, &HEALTHY), Action::Damage(_));
            assert_eq!(is_damage, is_of_specimen, "{kind:?}");
            let is_damaged = damaged(kind, size, 30.0) != Condition::NEW;
            assert_eq!(is_damaged, is_of_specimen, "{kind:?}");
            assert_ne!(kind.names(size), Names::of(&[], &[]), "{kind:?}");
        }
    }
}

#[test]
fn sizes_of_signals_are_over_what_the_healthy_rig_shows() {
    assert_eq!(
        on_force(Change::GainStep, -0.4),
        OnChannel::Gain {
            factor: 0.6,
            ticks: 0.0
        }
    );
    let OnChannel::Gain { factor, ticks } = on_force(Change::GainDrift, 0.005) else {
        panic!("a drift is a gain");
    };
    // By 0.5 % in the 1000 ticks of a cycle.
    assert!(((factor - 1.0) / ticks * 1000.0 - 0.005).abs() < 1e-12);
    let hum = OnChannel::Hum {
        volts: 0.2,
        frequency: 50.0,
    };
    assert_eq!(on_force(Change::Hum, 0.05), hum);
    assert_eq!(on_force(Change::Spike, 0.5), OnChannel::Spike(2.0));
    let OnChannel::Open(rms) = on_force(Change::Open, 0.005) else {
        panic!("it is open");
    };
    assert!((rms - 0.0512).abs() < 1e-12);
    assert_eq!(
        on_force(Change::Frozen, 1.0),
        OnChannel::Frozen(20.48 / 65536.0)
    );
    let OnChannel::ClampedOneIn { volts, every } = on_force(Change::Ringing, 10.0) else {
        panic!("it is clamped");
    };
    assert!((volts - 5.4).abs() < 1e-12 && every == 10);
}

#[test]
fn a_specimen_is_damaged_by_as_much_as_it_says() {
    let parts = |condition: Condition| (condition.stiffness, condition.friction);
    assert_eq!(parts(damaged(Change::Break, 0.25, 1.0)), (0.75, 0.75));
    assert_eq!(parts(damaged(Change::FrictionRise, 0.5, 1.0)), (1.0, 1.5));
    assert_eq!(parts(damaged(Change::Stiffened, 4.0, 1.0)), (5.0, 5.0));
    assert_eq!(parts(damaged(Change::Removed, 1.0, 1.0)), (0.0, 0.0));
    // One wire at once, one more with each cycle, and no more than two fifths.
    for (cycles, broken) in [(0.5, 0.01), (3.5, 0.04), (100.0, 0.4)] {
        let left = damaged(Change::WiresOneByOne, 0.01, cycles).stiffness;
        assert!((1.0 - left - broken).abs() < 1e-12, "{cycles}: {left}");
    }
    let gap = damaged(Change::Backlash, 0.005, 10.0).gap;
    assert!((gap - 0.05 * 0.1).abs() < 1e-12);
    assert_eq!(damaged(Change::Seized, 20.0, 0.0).added_stiffness, 20.0);
    // At its largest speed it drives with half of the largest force.
    let damping = damaged(Change::NegativeDamping, 0.5, 0.0).added_damping;
    let speed = std::f64::consts::TAU * 10.0 * 0.1;
    assert!((damping * speed + 0.15).abs() < 1e-12);
}

#[test]
fn attacks_on_the_plant_begin_and_end() {
    let trial = adversary(1);
    let prepared = trial.prepare().unwrap();
    let mut plant: Plant<Damaged> = Plant::new(&prepared.setup).unwrap();
    let mut dead = Running::new(at(Change::ServoDead, 1.0), 5, Some(7), &HEALTHY);
    let reversed = Change::Reversed(Channel::Displacement);
    let mut reversed = Running::new(at(reversed, 1.0), 6, Some(8), &HEALTHY);
    let mut seen = Vec::new();
    for tick in 0..10 {
        dead.at(tick, &mut plant);
        reversed.at(tick, &mut plant);
        plant.sense();
        let sensed = plant.signals.sensed();
        let is_reversed = sensed.arrived[0] == -sensed.put_out[0];
        seen.push((plant.servo.fault == ServoFault::Dead, is_reversed));
    }
    assert_eq!(seen[4], (false, false));
    assert_eq!(seen[5..8], [(true, false), (true, true), (false, true)]);
    assert_eq!(seen[8], (false, false));
}

#[test]
fn a_number_is_a_trial() {
    for seed in 0..200 {
        let trial = adversary(seed);
        assert_eq!(trial, adversary(seed));
        assert_ne!(trial, adversary(seed + 1));
        assert!((1..=4).contains(&trial.changes.len()));
        let cycles = f64::from(trial.blocks.iter().sum::<u32>());
        assert!(trial.changes.iter().all(|attack| attack.begins < cycles));
        let Headroom {
            displacement,
            force,
            tracking,
        } = trial.close.unwrap().headroom;
        let close = |part: f64| (1.2..=2.0).contains(&part);
        assert!([displacement, force, tracking].into_iter().all(close));
    }
    let campaign = Campaign::whole();
    let pairs = pairs::drawn_pairs(&campaign, 50);
    assert_eq!(pairs, pairs::drawn_pairs(&campaign, 50));
    assert!(pairs.iter().all(|trial| trial.changes.len() == 2));
}

#[test]
fn attacks_alone_are_at_every_moment_specimen_noise_and_with_both_laws() {
    let campaign = Campaign::whole();
    let all = campaign.trials();
    let kind = Change::Hum(Channel::Force);
    let these: Vec<_> = all
        .iter()
        .filter(|trial| trial.set == Set::Single && trial.changes[0].kind == kind)
        .collect();
    assert_eq!(these.len(), kind.sizes().len() * 4 * 4 * 3);
    let following = these.iter().filter(|trial| trial.follow > 0.0).count();
    assert_eq!(2 * following, these.len());
    // The monitor has learned, and has as long to find it as the attack allows.
    for trial in &these {
        let attack = &trial.changes[0];
        assert!((24.0..25.0).contains(&attack.begins));
        assert!(f64::from(trial.blocks[0]) > attack.begins + kind.facts().within);
    }
}
