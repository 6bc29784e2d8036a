//! Faults on the image's rig, compared with the same in this process.

mod emulated;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::health::Channel;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme};
use mesh_damper_link::image::{Board, FIRMWARE};
use mesh_damper_link::lockstep::{Image, run_attack_on, run_rig_on, run_trial_on};
use mesh_damper_rig::faults::{
    AttackKind, AttackTrial, Campaign, Condition, Damaged, FOLLOW, InjectedFault, Trial, adversary,
    run_attack, run_trial,
};
use mesh_damper_rig::{RigSetup, TICK_RATE, run_rig};

/// A fault of each group, one of them slow: the image's monitor gives the same results as the one in this process, to the last bit.
#[test]
fn faults_come_out_on_the_image_as_in_this_process() {
    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    let trials = Campaign::on_image().trials();
    for (kind, follow) in [
        (InjectedFault::WireBreakage, FOLLOW),
        (InjectedFault::ForceStuck, 0.0),
        (InjectedFault::ForceDrifting, FOLLOW),
        (InjectedFault::ActuatorLagging, 0.0),
    ] {
        let of_this = |trial: &&Trial| trial.kind == kind && trial.follow == follow;
        let trial = trials.iter().rfind(of_this).unwrap();
        let mut image = Image::start(Board::Mps2An386, Box::new(|_| {})).unwrap();
        let outcome = run_trial_on(&mut image, trial).unwrap();
        assert_eq!(outcome, run_trial(trial).unwrap());
        assert!(outcome.right && outcome.in_time(), "{outcome:?}");
    }
}

/// Interference with the channels, temperature, output and clock acts on the image's rig as on the one in this process, and so do
/// the trials of an adversary.
#[test]
fn attacks_come_out_on_the_image_as_in_this_process() {
    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    let alone = Campaign::on_image().attack_trials().over_a_link().singles;
    let mut trials = vec![adversary(3)];
    for kind in [
        AttackKind::StuckBit(Channel::Force),
        AttackKind::TemperatureNoise,
        AttackKind::DacGain,
        AttackKind::Stall,
    ] {
        let of_this = |trial: &&AttackTrial| trial.attacks[0].kind == kind;
        trials.extend(alone.iter().find(of_this).cloned());
    }
    assert_eq!(trials.len(), 5);
    for trial in &trials {
        let mut image = Image::start(Board::Mps2An386, Box::new(|_| {})).unwrap();
        let outcome = run_attack_on(&mut image, trial).unwrap();
        assert_eq!(outcome, run_attack(trial).unwrap());
    }
}

/// A specimen that settles, with adaptation: every cycle of it, and the adaptation, to the last bit.
#[test]
fn a_law_follows_on_the_image_as_in_this_process() {
    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    let setup = || {
        let (specimen, condition) = Damaged::new(3.0, 0.1);
        condition.set(Condition {
            stiffness: 0.9,
            ..Condition::NEW
        });
        let block = Block::sine(0.1, 20.0, 60).unwrap();
        let programme = Programme::<1>::new(TICK_RATE, 1).unwrap();
        let programme = programme.with(block).unwrap();
        let c = specimen.coefficients();
        let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32).unwrap();
        let law = AugmentedLaw::<f32, 1>::new(law);
        let mut setup = RigSetup::new(specimen, law, programme, 1);
        setup.settings.health.follow = FOLLOW;
        setup
    };
    let here = run_rig(setup(), |_| {}).unwrap();
    let mut image = Image::start(Board::Mps2An386, Box::new(|_| {})).unwrap();
    let there = run_rig_on(&mut image, setup(), |_| {}).unwrap();
    assert_eq!(here.cycles, there.cycles);
    let far = here.steady_cycles(0).last().unwrap().followed;
    assert!(far.k1 < -0.03 && far.c.abs() < 0.01, "{far:?}");
}
