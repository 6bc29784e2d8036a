//! Whole programmes on the bench.

use mesh_damper::effects::{AugmentedLaw, CONTROLS};
use mesh_damper::law::Law;
use mesh_damper::rig::{Telemetry, TripCause};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::specimen::{HiddenEffect, Specimen};
use mesh_damper_rig::{
    Bench, Controlled, Plan, Plant, RigRun, RigSetup, SetupError, run_controlled, run_rig,
};

fn law(k1: f32, k3: f32, c: f32, alpha: f32) -> Law<f32> {
    Law::new(k1, k3, c, alpha).unwrap()
}

fn setup(seed: u64) -> RigSetup<Specimen, 4, 4> {
    let specimen = Specimen::of_density(3.0, 0.1).with(HiddenEffect::StickSlip {
        stiffness: 1.0,
        slip_limit: 0.02,
        shape: mesh_damper_rig::specimen::SlipShape::Sharp,
    });
    let programme = Programme::new(10_000.0, 1)
        .and_then(|p| p.with(Block::sine(0.1, 2.0, 3)?))
        .and_then(|p| p.with(Block::sine(0.05, 5.0, 4)?))
        .unwrap();
    let law = AugmentedLaw::new(law(1.0539, 10.5, 0.1114, 0.3969));
    RigSetup::new(specimen, law, programme, seed)
}

fn run(setup: RigSetup<Specimen, 4, 4>) -> RigRun {
    run_rig(setup, |_| {}).unwrap()
}

#[test]
fn the_same_seed_gives_the_same_run_and_another_seed_another() {
    let first = run(setup(5));
    assert_eq!(first, run(setup(5)));
    assert_ne!(first.samples.force, run(setup(6)).samples.force);
}

#[test]
fn a_run_is_the_whole_programme() {
    let setup = setup(1);
    let duration = setup.programme.duration();
    let mut told = Vec::new();
    let run = run_rig(setup, |part| told.push(part)).unwrap();
    assert!(run.faults.is_empty());
    // Ten cycles: ramp, 3, ramp, 4, ramp.
    assert_eq!(run.cycles.len(), 10);
    assert_eq!(run.steady_cycles(0).count(), 3);
    assert_eq!(run.steady_cycles(1).count(), 4);
    assert!((run.ticks as f64 * 1e-4 - duration).abs() < 3e-4);
    // A sample every ten ticks, at 1 kHz.
    assert_eq!(run.samples.len() as u64, run.ticks.div_ceil(10));
    for (index, time) in run.samples.time.iter().enumerate() {
        assert!((time - 1e-3 * index as f64).abs() < 1e-9);
    }
    assert!(told.is_sorted() && told.first() == Some(&0.0) && told.last() == Some(&1.0));
    let recording = run.recording("rig").unwrap();
    assert_eq!(recording.displacement, run.samples.displacement);
    assert_eq!(recording.force, run.samples.force);
    // The crate's estimate is not a measurement.
    assert_eq!(recording.velocity, None);
    assert_eq!(recording.temperature, Some(vec![20.0; run.samples.len()]));
}

/// Eq 13 alone with a specimen with friction joints: the error is theirs.
#[test]
fn what_the_law_lacks_shows_in_every_cycle() {
    let run = run(setup(1));
    for report in run.cycles.iter().filter(|report| !report.ramp) {
        assert!(report.nrmse > 0.05, "{}", report.nrmse);
        assert!(report.measured.energy > report.model.energy);
    }
}

#[test]
fn each_block_runs_with_its_own_coefficients() {
    let mut setup = setup(1);
    setup.block_laws = vec![law(1.0, 0.0, 0.0, 0.5), law(2.0, 0.0, 0.0, 0.5)];
    let run = run(setup);
    for (block, k) in [(0, 1.0), (1, 2.0)] {
        for report in run.steady_cycles(block) {
            // K of a spring, to f32 and the coarseness of the extremes at 2000 ticks per cycle, which both share.
            assert!((report.model.stiffness - k).abs() < 1e-5);
        }
    }
}

#[test]
fn a_run_that_stops_says_why_and_when() {
    let mut setup = setup(1);
    setup.settings.displacement_limit = 0.09;
    let run = run(setup);
    let [(time, fault)] = run.faults[..] else {
        panic!("{:?}", run.faults)
    };
    assert_eq!(fault, TripCause::DisplacementLimit);
    // In the ramp of half a second or the first quarter of the cycle after it.
    assert!(time > 0.1 && time < 0.64, "{time}");
    // It is recorded until the command is back at 0, half a second later.
    let last = run.samples.time.last().unwrap();
    assert!((last - time - 0.5).abs() < 2e-3, "{last}");
    assert_eq!(
        run.samples.command.last().map(|c| c.abs() < 1e-3),
        Some(true)
    );
}

#[test]
fn the_load_cell_is_chosen_for_the_specimen() {
    let soft = setup(1);
    let mut stiff = setup(1);
    stiff = RigSetup::new(
        Specimen::of_density(4.0, 0.25),
        stiff.law,
        stiff.programme,
        1,
    );
    // k1·0.1 + c·1.26^α + joints, twice: about 0.5; and about 2·(0.94 + 0.02 + 0.68).
    assert!((0.4..0.7).contains(&soft.force_sensor.full_scale));
    assert!((2.0..3.5).contains(&stiff.force_sensor.full_scale));
    for setup in [soft, stiff] {
        assert!(setup.settings.force_limit < setup.force_sensor.full_scale);
        // 0.4 % of the RMS, which lies between half of the peak and the peak.
        let peak = setup.force_sensor.full_scale / 2.0;
        let noise = setup.force_sensor.noise / 0.004;
        assert!(noise > 0.5 * peak && noise < peak);
    }
}

/// A bench whose specimen gets a control input of 2.5 at the second index from a given tick on.
struct Switched {
    bench: Bench<Specimen, 4, 4>,
    left: u32,
}

impl Controlled<Specimen> for Switched {
    fn plant(&self) -> &Plant<Specimen> {
        self.bench.plant()
    }
    fn plant_mut(&mut self) -> &mut Plant<Specimen> {
        self.bench.plant_mut()
    }
    fn start(&mut self) -> Result<(), SetupError> {
        self.bench.start()
    }
    fn tick(&mut self) -> Result<Telemetry, SetupError> {
        if self.left == 0 {
            self.bench.plant.controls[1] = 2.5;
        }
        self.left = self.left.saturating_sub(1);
        Controlled::tick(&mut self.bench)
    }
    fn is_enabled(&self) -> bool {
        self.bench.is_enabled()
    }
    fn set_law(&mut self, law: Law<f32>) -> Result<(), SetupError> {
        self.bench.set_law(law)
    }
}

#[test]
fn a_control_input_is_recorded_from_the_start_once_there_is_one() {
    let without = run(setup(1)).samples;
    for place in 0..=CONTROLS {
        assert!(without.control(place).is_empty());
    }
    // A sample every ten ticks: at once, just after sample 99, and with the next one.
    for (left, zeros) in [(0, 0), (991, 100), (1000, 100)] {
        let plan = Plan::of(&setup(1));
        let bench = Bench::new(setup(1)).unwrap();
        let mut switched = Switched { bench, left };
        let samples = run_controlled(&mut switched, &plan, |_| {})
            .unwrap()
            .samples;
        let control = samples.control(1);
        assert_eq!(control.len(), samples.len());
        assert!(control[..zeros].iter().all(|value| *value == 0.0));
        assert!(control[zeros..].iter().all(|value| *value == 2.5));
        for place in [0, 2, 3, CONTROLS] {
            assert!(samples.control(place).is_empty());
        }
        // Neither the law nor this specimen depends on it.
        assert_eq!(samples.force, without.force);
        assert_ne!(samples, without);
    }
}
