//! Faults on the image's rig, compared with the same in this process.

mod emulated;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::health::Channel;
use mesh_damper::law::Law;
use mesh_damper::sine::{Block, Programme};
use mesh_damper_link::image::{Board, FIRMWARE};
use mesh_damper_link::lockstep::{Image, run_rig_on, run_trial_on};
use mesh_damper_rig::campaign::{
    Campaign, Change, Condition, Damaged, FOLLOW, Naming, Set, Trial, adversary, run_trial,
};
use mesh_damper_rig::{RigSetup, TICK_RATE, run_rig};

/// A known change of each group, one of them slow: the image's monitor gives the same results as the one in this process, to the
/// last bit. Interference with the channels, temperature, output and clock acts alike on both, and so do the trials of an adversary.
#[test]
fn trials_come_out_on_the_image_as_in_this_process() {
    if emulated::image(&FIRMWARE, Board::Mps2An386).is_none() {
        return;
    }
    let mut all = Campaign::on_image().trials();
    all.retain(Trial::is_possible_over_a_link);
    let of_kind = |kind: Change| move |trial: &&Trial| trial.changes[0].kind == kind;
    let mut trials = vec![adversary(3)];
    for (kind, follow) in [
        (Change::WireBreakage, FOLLOW),
        (Change::ForceStuck, 0.0),
        (Change::ForceDrifting, FOLLOW),
        (Change::ActuatorLagging, 0.0),
    ] {
        let of_this = |trial: &&Trial| of_kind(kind)(trial) && trial.follow == follow;
        trials.extend(all.iter().rfind(of_this).cloned());
    }
    for kind in [
        Change::StuckBit(Channel::Force),
        Change::TemperatureNoise,
        Change::DacGain,
        Change::Stall,
    ] {
        let is_single = |trial: &&Trial| trial.set == Set::Single;
        let mut these = all.iter().filter(is_single);
        trials.extend(these.find(of_kind(kind)).cloned());
    }
    assert_eq!(trials.len(), 9);
    for trial in &trials {
        let mut image = Image::start(Board::Mps2An386, Box::new(|_| {})).unwrap();
        let outcome = run_trial_on(&mut image, trial).unwrap();
        assert_eq!(outcome, run_trial(trial).unwrap());
        if trial.is_known() {
            let is_right = outcome.naming == Naming::Right;
            assert!(is_right && outcome.in_time, "{outcome:?}");
        }
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
