//! The rig in closed loop with the simulated actuator and specimen: the motion equals the demand.

mod correction;
mod dead_parts;
mod law;
mod second_run;
mod trips;
mod wired;

use std::f64::consts::TAU;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::error::ConfigError;
use mesh_damper::law::Law;
use mesh_damper::rig::{ClearRefused, RigSettings, StartRefused, State, TripCause};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Bench, RigSetup, TICK_RATE};

type Setup = RigSetup<Specimen, 8, 4>;

fn law_of(specimen: &Specimen) -> Law<f32> {
    let c = specimen.coefficients();
    Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32).unwrap()
}

fn programme(blocks: &[(f64, f64, u32)]) -> Programme<8> {
    blocks.iter().fold(
        Programme::new(TICK_RATE, 1).unwrap(),
        |programme, &(amplitude, frequency, cycles)| {
            programme
                .with(Block::sine(amplitude, frequency, cycles).unwrap())
                .unwrap()
        },
    )
}

fn setup(density: f64, blocks: &[(f64, f64, u32)]) -> Setup {
    let specimen = Specimen::of_density(density, blocks[0].0);
    let law = AugmentedLaw::new(law_of(&specimen));
    RigSetup::new(specimen, law, programme(blocks), 1)
}

fn started(setup: Setup) -> Bench<Specimen, 8, 4> {
    let mut bench = Bench::new(setup).unwrap();
    bench.rig.start().unwrap();
    bench
}

/// Amplitude and phase of the last complete cycle of displacements with their phases, in units of 2⁻³² cycle, at `frequency`, whose
/// period is a whole number of ticks.
fn demodulate(moved: &[(f64, u32)], frequency: f64) -> (f64, f64) {
    let n = (TICK_RATE / frequency).round() as usize;
    let (mut in_phase, mut quadrature) = (0.0, 0.0);
    for &(y, phase) in &moved[moved.len() - n..] {
        let (sin, cos) = (TAU * f64::from(phase) / (1u64 << 32) as f64).sin_cos();
        in_phase += y * sin;
        quadrature += y * cos;
    }
    let scale = 2.0 / n as f64;
    (
        (in_phase * scale).hypot(quadrature * scale),
        quadrature.atan2(in_phase),
    )
}

#[test]
fn amplitude_and_phase_are_as_demanded() {
    // The soft and the stiff end of the table, and both ends of the amplitudes.
    for (density, amplitude) in [(2.0, 0.05), (3.0, 0.1), (4.0, 0.05), (4.0, 0.25)] {
        let blocks: Vec<_> = [0.5, 1.0, 2.0, 5.0, 10.0]
            .map(|frequency| (amplitude, frequency, 6))
            .to_vec();
        let mut bench = started(setup(density, &blocks));
        let mut steady = vec![Vec::new(); blocks.len()];
        let mut truth = steady.clone();
        loop {
            let moved = bench.plant.servo.displacement();
            let telemetry = bench.tick();
            if telemetry.state != State::Running {
                assert_eq!(telemetry.state, State::Done);
                break;
            }
            if !telemetry.ramp {
                let phase = telemetry.phase;
                steady[telemetry.block].push((f64::from(telemetry.displacement), phase));
                truth[telemetry.block].push((moved, phase));
            }
        }
        for (block, &(_, frequency, cycles)) in blocks.iter().enumerate() {
            // A cycle that begins between two ticks has one tick more or less at its ends.
            let ticks = (TICK_RATE / frequency) as usize * cycles as usize;
            assert!(steady[block].len().abs_diff(ticks) <= 1);
            let (measured, phase) = demodulate(&steady[block], frequency);
            let at = format!("{density} g/cm³, {amplitude} mm, {frequency} Hz");
            // Five corrections of gain 0.8, starting from the correction of the previous block, leave 0.2⁵ of the first error and the
            // error due to the specimen's nonlinearity.
            assert!(
                (measured / amplitude - 1.0).abs() < 2e-3,
                "{at}: {measured}"
            );
            assert!(phase.abs() < 2e-3, "{at}: {phase} rad");
            // The sensor's lag, which the rig cannot measure, adds to it. Sampled every h, a lag of T delays by h/(e^(h/T) − 1).
            let delay = 1e-4 / (1e-4f64 / 1.5e-4).exp_m1();
            let (moved, ahead) = demodulate(&truth[block], frequency);
            assert!((moved / amplitude - 1.0).abs() < 2e-3, "{at}: {moved}");
            let lag = TAU * frequency * delay;
            assert!((ahead - lag).abs() < 2e-3, "{at}: {ahead} rad");
        }
    }
}

#[test]
fn a_sensor_offset_and_friction_do_not_shift_the_mean() {
    let mut setup = setup(3.0, &[(0.1, 2.0, 8)]);
    setup.displacement_sensor.offset = 0.02;
    setup.servo.coulomb = 0.02;
    setup.servo.stiction = 0.03;
    let mut bench = started(setup);
    let mut mean = 1.0;
    while bench.rig.state() == State::Running {
        if let Some(report) = bench.tick().report
            && !report.ramp
        {
            mean = report.measured.mean_displacement;
        }
    }
    // 5 1/s over 4 s leaves e⁻²⁰ of 0.02 mm. The mean of 5000 ticks' noise is 1.4e-6 mm; the test allows ten times that.
    assert!(mean.abs() < 2e-5, "{mean}");
}

/// Ticks until the rig stops with this cause. Checks that the line drops in that tick, that the fault is latched, and that the command
/// returns to 0 in `stop_ticks`.
fn stops(bench: &mut Bench<Specimen, 8, 4>, stop_ticks: usize, fault: TripCause) -> usize {
    let mut before = 0.0;
    let mut ticks = 0;
    let last = loop {
        let telemetry = bench.tick();
        ticks += 1;
        if telemetry.state != State::Running {
            break telemetry;
        }
        before = telemetry.command;
        assert!(ticks < 100_000, "does not stop");
    };
    assert_eq!(last.state, State::Faulted(fault));
    assert!(!bench.enabled.get(), "the line drops in the same tick");
    assert_eq!(
        bench.rig.start(),
        Err(StartRefused::Faulted(fault)),
        "and cannot be raised"
    );
    let mut command: f32 = last.command;
    // The return begins at the command of the previous tick at most.
    assert!(command.abs() <= before.abs().max(1.0));
    let step = before.abs().max(command.abs()) / stop_ticks as f32 * 1.001 + 1e-9;
    for tick in 0..stop_ticks + 2 {
        if command != 0.0 {
            assert_eq!(bench.rig.clear(), Err(ClearRefused::Moving));
        }
        let telemetry = bench.tick();
        assert_eq!(telemetry.state, State::Faulted(fault), "latched");
        assert!(!bench.enabled.get());
        let way = command - telemetry.command;
        assert!(way * command >= 0.0 && way.abs() <= step, "{way} at {tick}");
        command = telemetry.command;
    }
    assert_eq!(command, 0.0);
    ticks
}

#[test]
fn settings_are_refused_by_name() {
    let refused = |change: fn(&mut RigSettings)| {
        let mut setup = setup(3.0, &[(0.1, 1.0, 1)]);
        change(&mut setup.settings);
        match Bench::new(setup).err().unwrap() {
            mesh_damper_rig::SetupError::Config(
                ConfigError::NonFinite(field) | ConfigError::OutOfRange { field, .. },
            ) => field,
            other => panic!("{other}"),
        }
    };
    assert_eq!(
        refused(|s| s.displacement_limit = 0.0),
        "displacement_limit"
    );
    assert_eq!(refused(|s| s.force_limit = f64::NAN), "force_limit");
    assert_eq!(refused(|s| s.tracking_limit = -1.0), "tracking_limit");
    assert_eq!(refused(|s| s.trip_ticks = 0), "trip_ticks");
    assert_eq!(refused(|s| s.stop_ticks = 0), "stop_ticks");
    assert_eq!(refused(|s| s.observer_bandwidth = 1e4), "bandwidth");
    assert_eq!(refused(|s| s.observer_damping = 0.0), "damping");
    assert_eq!(refused(|s| s.correction_gain = 1.5), "correction_gain");
    assert_eq!(refused(|s| s.lead = 0.2), "lead");
    assert_eq!(refused(|s| s.glide = 0.0), "glide");
    assert_eq!(refused(|s| s.feedback = 1e3), "feedback");
    assert_eq!(refused(|s| s.clock_rate = 5e3), "clock_rate");
    assert_eq!(refused(|s| s.clock_rate = f64::NAN), "clock_rate");
    let mut empty = setup(3.0, &[(0.1, 1.0, 1)]);
    empty.programme = Programme::new(TICK_RATE, 1).unwrap();
    assert!(Bench::new(empty).is_err());
}
