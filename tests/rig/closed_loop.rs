//! The rig in closed loop with the simulated actuator and specimen.

use std::cell::Cell;
use std::f64::consts::TAU;
use std::rc::Rc;

use mesh_damper::adc::Ads8688;
use mesh_damper::converter::Scale;
use mesh_damper::dac::{Ad5761, OUTPUT_RANGE};
use mesh_damper::effects::{AugmentedLaw, Drift, Effect, Offset, StickSlip};
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::health::{Channel, HealthCause};
use mesh_damper::law::Law;
use mesh_damper::rig::{
    ClearRefused, Rig, RigSettings, SpiRig, StartRefused, State, Telemetry, TripCause,
};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::actuator::{
    AdcPins, DacPins, SensorFault, ServoFault, SimulatedAd5761, SimulatedAds8688,
};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Bench, RigSetup};
use proptest::prelude::*;

use crate::Ticks;

const TICK_RATE: f64 = 10_000.0;

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

/// Amplitude and phase of the last whole cycle of displacements with their phases, 2³² to the cycle, at `frequency`,
/// which has a whole number of ticks.
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
    // The soft and the stiff end of the table, both ends of the amplitudes.
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
            // A cycle that begins between two ticks has one more or one less at its ends.
            let ticks = (TICK_RATE / frequency) as usize * cycles as usize;
            assert!(steady[block].len().abs_diff(ticks) <= 1);
            let (measured, phase) = demodulate(&steady[block], frequency);
            let at = format!("{density} g/cm³, {amplitude} mm, {frequency} Hz");
            // Five corrections of gain 0.8, begun from what the block before has learned, leave 0.2⁵ of the first error
            // and what the specimen's nonlinearity adds to it.
            assert!(
                (measured / amplitude - 1.0).abs() < 2e-3,
                "{at}: {measured}"
            );
            assert!(phase.abs() < 2e-3, "{at}: {phase} rad");
            // The sensor's lag, which nobody on the rig can see, comes on top: sampled every h, a lag of T delays by
            // h/(e^(h/T) − 1).
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
    // 5 1/s over 4 s leaves e⁻²⁰ of 0.02 mm; the mean of 5000 ticks' noise is 1.4e-6 mm, ten of those.
    assert!(mean.abs() < 2e-5, "{mean}");
}

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
        // Noise of the force channel 0.004; the reversals, where the observer smooths what friction in the specimen
        // does to the piston, about 0.01 more.
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

/// Ticks until the rig stops, and the telemetry of that tick; then holds it to what stopping means.
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
    // The command of the tick before is the most that the way back begins from.
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
fn limits_stop_the_rig_within_their_ticks() {
    let blocks = [(0.2, 1.0, 5)];
    let trip = 7;
    let limited = |change: fn(&mut RigSettings)| {
        let mut setup = setup(3.0, &blocks);
        setup.settings.trip_ticks = trip;
        setup.settings.stop_ticks = 1000;
        change(&mut setup.settings);
        setup
    };
    for (setup, fault, over) in [
        (
            limited(|s| s.displacement_limit = 0.1),
            TripCause::DisplacementLimit,
            (|t: &Telemetry| t.displacement.abs() > 0.1) as fn(&Telemetry) -> bool,
        ),
        (
            limited(|s| s.force_limit = 0.2),
            TripCause::ForceLimit,
            |t: &Telemetry| t.measured_force.abs() > 0.2,
        ),
    ] {
        // The same run without stopping tells when the limit had been exceeded for so long: a tick within it takes back an eighth of one
        // beyond.
        let mut free = setup.clone();
        free.settings.trip_ticks = 1_000_000;
        let mut free = started(free);
        let mut beyond = 0u32;
        let mut expected = 0;
        while beyond < 8 * trip {
            beyond = if over(&free.tick()) {
                beyond + 8
            } else {
                beyond.saturating_sub(1)
            };
            expected += 1;
        }
        assert!(expected > 100);
        assert_eq!(stops(&mut started(setup), 1000, fault), expected);
    }
}

#[test]
fn a_dead_actuator_is_a_tracking_fault() {
    let mut setup = setup(3.0, &[(0.2, 1.0, 5)]);
    setup.settings.tracking_limit = 0.1;
    let mut bench = started(setup);
    // 1.25 cycles in, at the crest.
    for _ in 0..12_500 {
        assert_eq!(bench.tick().state, State::Running);
    }
    bench.plant.servo.fault = ServoFault::Dead;
    let ticks = stops(&mut bench, 5000, TripCause::TrackingLimit);
    // cos φ has fallen by half at a sixth of a cycle, 1667 ticks; and 10 ticks to trip.
    assert!((1667..1800).contains(&ticks), "{ticks}");
}

#[test]
fn a_stuck_sensor_is_lost_before_it_is_far_off() {
    for force in [false, true] {
        let mut bench = started(setup(3.0, &[(0.2, 1.0, 5)]));
        // 1.25 cycles in, at the crest of both.
        for _ in 0..12_500 {
            assert_eq!(bench.tick().state, State::Running);
        }
        let (sensor, fault) = if force {
            (&mut bench.plant.force_sensor, TripCause::ForceLost)
        } else {
            (
                &mut bench.plant.displacement_sensor,
                TripCause::DisplacementLost,
            )
        };
        sensor.fault = SensorFault::Stuck;
        let ticks = stops(&mut bench, 5000, fault);
        // cos φ has fallen by 0.3 after 1266 ticks. The force comes in faster: at its crest friction turns round.
        let expected = if force { 10..1266 } else { 1260..1290 };
        assert!(expected.contains(&ticks), "{ticks}");
    }
}

/// Its event is told once, until events are cleared.
#[test]
fn a_sensor_that_is_lost_again_stops_the_rig_again() {
    let mut bench = Bench::new(setup(3.0, &[(0.2, 1.0, 5)])).unwrap();
    for told in [true, false] {
        bench.plant.force_sensor.fault = SensorFault::None;
        bench.rig.start().unwrap();
        for _ in 0..12_500 {
            assert_eq!(bench.tick().state, State::Running);
        }
        bench.plant.force_sensor.fault = SensorFault::DroppedOut;
        let mut events = 0;
        while bench.rig.state() == State::Running {
            events += usize::from(bench.tick().event.is_some());
        }
        assert_eq!(bench.rig.state(), State::Faulted(TripCause::ForceLost));
        assert_eq!((events, bench.rig.events().len()), (usize::from(told), 1));
        for _ in 0..5000 {
            bench.tick();
        }
        bench.rig.clear().unwrap();
    }
}

/// At the tick that finds it.
#[test]
fn an_event_is_told_at_once() {
    let mut bench = started(setup(3.0, &[(0.1, 2.0, 12)]));
    let mut told = Vec::new();
    for tick in 0..55_000 {
        if tick == 30_000 {
            bench.plant.servo.fault = ServoFault::Lagging(100);
        }
        let before = bench.rig.events().len();
        let event = bench.tick().event;
        assert_eq!(event.as_slice(), &bench.rig.events()[before..]);
        told.extend(event.map(|event| event.cause));
    }
    assert_eq!(told, [HealthCause::ActuatorLagging]);
}

#[test]
fn an_actuator_dead_from_the_start_is_noticed_in_the_ramp_or_after_a_cycle() {
    // A ramp and a cycle of 5000 ticks each; the tick that ends it is the first of the next. A ramp of one cycle is too short to tell, unless it goes far.
    for (amplitude, most) in [(0.05, 10_001), (0.1, 10_001), (0.25, 5_000)] {
        let mut bench = Bench::new(setup(3.0, &[(amplitude, 2.0, 5)])).unwrap();
        bench.plant.servo.fault = ServoFault::Dead;
        bench.rig.start().unwrap();
        let ticks = stops(&mut bench, 5000, TripCause::NoResponse);
        assert!(ticks <= most, "{ticks} at {amplitude}");
    }
}

#[test]
fn a_sensor_dead_from_the_start_is_noticed_in_the_ramp() {
    for amplitude in [0.05, 0.1, 0.25] {
        let mut bench = Bench::new(setup(3.0, &[(amplitude, 2.0, 5)])).unwrap();
        bench.plant.displacement_sensor.fault = SensorFault::DroppedOut;
        bench.rig.start().unwrap();
        let ticks = stops(&mut bench, 5000, TripCause::DisplacementLost);
        assert!(ticks < 1_250, "{ticks}: a quarter of the ramp");
    }
}

#[test]
fn an_open_sensor_is_a_clipped_channel_at_once() {
    for force in [false, true] {
        let mut bench = started(setup(3.0, &[(0.2, 1.0, 5)]));
        for _ in 0..12_000 {
            bench.tick();
        }
        let (sensor, fault, channel) = if force {
            let sensor = &mut bench.plant.force_sensor;
            (sensor, TripCause::ForceClipped, Channel::Force)
        } else {
            let sensor = &mut bench.plant.displacement_sensor;
            (
                sensor,
                TripCause::DisplacementClipped,
                Channel::Displacement,
            )
        };
        sensor.fault = SensorFault::Open;
        assert_eq!(stops(&mut bench, 5000, fault), 1);
        let [event] = bench.rig.events() else {
            panic!("{:?}", bench.rig.events());
        };
        assert_eq!(event.cause, HealthCause::SensorClipped(channel));
    }
}

#[test]
fn a_command_beyond_the_dac_stops_the_rig() {
    let mut setup = setup(3.0, &[(0.2, 1.0, 5)]);
    setup.command_range = 0.15;
    stops(&mut started(setup), 5000, TripCause::CommandClipped);
}

#[test]
fn the_command_is_what_the_dac_drives() {
    let mut bench = started(setup(3.0, &[(0.2, 1.0, 5)]));
    for _ in 0..12_345 {
        bench.tick();
    }
    let written = bench.tick().command;
    bench.dac.bus_failing.set(true);
    for _ in 0..10 {
        assert_eq!(bench.tick().command, written);
        assert_eq!(bench.rig.clear(), Err(ClearRefused::Moving));
    }
    // ±0.15 mm end at 0x0000 below and 0xFFFF above, a step short of it.
    let mut setup = setup(3.0, &[(0.2, 1.0, 5)]);
    setup.command_range = 0.15;
    let mut bench = started(setup);
    let clipped = loop {
        let telemetry = bench.tick();
        if telemetry.state != State::Running {
            break telemetry.command;
        }
    };
    let driven = bench.dac.volts.get() / OUTPUT_RANGE * 0.15;
    assert!((f64::from(clipped) - driven).abs() < 1e-8, "{clipped}");
    assert!(clipped.abs() > 0.14);
}

#[test]
fn bus_errors_stop_the_rig_at_once() {
    for adc in [true, false] {
        let mut bench = started(setup(3.0, &[(0.2, 1.0, 5)]));
        for _ in 0..12_345 {
            bench.tick();
        }
        // A tick over which the plant stands still.
        let moved = bench.rig.tick(bench.plant.clock).displacement;
        bench.plant.clock += 1;
        let (flag, fault) = if adc {
            (&bench.adc.bus_failing, TripCause::AdcBus)
        } else {
            (&bench.dac.bus_failing, TripCause::DacBus)
        };
        flag.set(true);
        let telemetry = bench.tick();
        assert_eq!(telemetry.state, State::Faulted(fault));
        assert!(!bench.enabled.get());
        if adc {
            assert_eq!(telemetry.displacement, moved, "the last reading stays");
        }
        bench.adc.bus_failing.set(false);
        bench.dac.bus_failing.set(false);
        stops(&mut bench, 5000, fault);
        assert_eq!(bench.dac.volts.get(), 0.0);
        // Cleared, it can be started again and runs to its end.
        bench.rig.clear().unwrap();
        assert_eq!(bench.rig.state(), State::Idle);
        bench.rig.start().unwrap();
        while bench.rig.state() == State::Running {
            bench.tick();
        }
        assert_eq!(bench.rig.state(), State::Done);
        assert!(!bench.enabled.get());
    }
}

#[test]
fn it_can_be_stopped_and_runs_again() {
    let mut bench = started(setup(3.0, &[(0.2, 5.0, 5)]));
    assert_eq!(bench.rig.start(), Err(StartRefused::Running));
    assert_eq!(bench.rig.clear(), Err(ClearRefused::NoFault));
    for _ in 0..3000 {
        assert!(bench.tick().state == State::Running && bench.enabled.get());
    }
    bench.rig.stop();
    assert!(bench.rig.state() == State::Idle && !bench.enabled.get());
    assert_eq!(bench.rig.start(), Err(StartRefused::Moving));
    assert_eq!(bench.rig.clear(), Err(ClearRefused::NoFault));
    for _ in 0..5001 {
        bench.tick();
    }
    bench.rig.start().unwrap();
    assert_eq!(bench.tick().cycle, 0);
}

#[test]
fn a_fault_on_the_way_back_does_not_prolong_it() {
    let mut setup = setup(3.0, &[(0.2, 2.0, 5)]);
    setup.settings.stop_ticks = 1000;
    let mut bench = started(setup);
    for _ in 0..6_000 {
        bench.tick();
    }
    bench.rig.stop();
    for tick in 1..=1001 {
        if tick == 900 {
            bench.plant.displacement_sensor.fault = SensorFault::Open;
        }
        let command = bench.tick().command;
        assert!(tick > 990 || command != 0.0, "{tick}");
        // One more where the differences' rounding leaves a rest.
        assert!(tick <= 1000 || command == 0.0, "{command}");
    }
    let fault = TripCause::DisplacementClipped;
    assert_eq!(bench.rig.state(), State::Faulted(fault));
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
    // Swapping for the same law changes nothing, stuck elements included; for other effects they begin at rest.
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
            // At phase 0 the joints are stretched to their limit by 3 kN/mm·0.02 mm; at rest they give nothing.
            assert!(
                (expected - force - 0.06 + 0.125).abs() < 1e-6,
                "{expected} {force}"
            );
        }
    }
}

/// k·(1 − e^(−n/N))·y, for a law of nothing but a drift.
#[test]
fn the_law_is_told_of_every_part_of_a_cycle() {
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

/// A line whose calls fail while `fails` says so.
#[derive(Clone, Default)]
struct FailingLine {
    fails: Rc<Cell<bool>>,
    high: Rc<Cell<bool>>,
}

impl FailingLine {
    fn set(&self, high: bool) -> Result<(), embedded_hal::digital::ErrorKind> {
        if self.fails.get() {
            return Err(embedded_hal::digital::ErrorKind::Other);
        }
        self.high.set(high);
        Ok(())
    }
}

impl embedded_hal::digital::ErrorType for FailingLine {
    type Error = embedded_hal::digital::ErrorKind;
}

impl embedded_hal::digital::OutputPin for FailingLine {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        self.set(false)
    }
    fn set_high(&mut self) -> Result<(), Self::Error> {
        self.set(true)
    }
}

type WiredRig = SpiRig<SimulatedAds8688, SimulatedAd5761, FailingLine, 8, 1>;

/// Both converters' full scales are 1 mm and 1 kN.
fn wired(
    (adc, dac): (&Rc<AdcPins>, &Rc<DacPins>),
    line: FailingLine,
    settings: &RigSettings,
    programme: Programme<8>,
    law: AugmentedLaw<f32, 1>,
) -> WiredRig {
    let unit = Scale::new(1.0, 0.0).unwrap();
    Rig::new(
        Ads8688::new(SimulatedAds8688::new(adc.clone()), unit, unit).unwrap(),
        Ad5761::new(SimulatedAd5761::new(dac.clone()), unit).unwrap(),
        line,
        settings,
        programme,
        RunningLaw::new(FastLaw::new(law)),
    )
    .unwrap()
}

fn elastic() -> AugmentedLaw<f32, 1> {
    AugmentedLaw::new(Law::new(1.0, 0.0, 0.0, 0.0).unwrap())
}

/// A rig on `line` whose sensors always read 0.
fn rig_on(line: FailingLine) -> WiredRig {
    wired(
        (&Rc::default(), &Rc::default()),
        line,
        &RigSettings::default(),
        programme(&[(0.1, 1.0, 1)]),
        elastic(),
    )
}

/// Telemetry of 0.05 mm at 2 Hz on an actuator that gives `gain` of the command `delay` ticks later.
fn on_an_actuator(gain: f64, delay: usize, frequency: f64, cycles: u32) -> Vec<Telemetry> {
    let (adc, dac) = (Rc::<AdcPins>::default(), Rc::<DacPins>::default());
    let settings = RigSettings {
        correction_gain: 0.5,
        correction_limit: 10.0,
        feedback: 0.0,
        ..RigSettings::default()
    };
    let mut rig = wired(
        (&adc, &dac),
        FailingLine::default(),
        &settings,
        programme(&[(0.05, frequency, cycles)]),
        elastic(),
    );
    rig.start().unwrap();
    let mut way = std::collections::VecDeque::from(vec![0.0; delay]);
    let mut run = Vec::new();
    let mut ticks = Ticks::default();
    while rig.state() == State::Running {
        way.push_back(gain * dac.volts.get() / OUTPUT_RANGE);
        let volts = way.pop_front().unwrap() * mesh_damper::adc::INPUT_RANGE;
        // A force in proportion.
        adc.volts[0].set(volts);
        adc.volts[1].set(volts);
        run.push(rig.tick(ticks.next()));
    }
    assert_eq!(rig.state(), State::Done);
    run
}

#[test]
fn what_the_correction_leaves_falls_by_the_same_part_each_cycle() {
    let run = on_an_actuator(0.9, 100, 2.0, 6);
    let errors: Vec<_> = (1..6)
        .map(|cycle| {
            let moved: Vec<_> = run
                .iter()
                .filter(|t| t.cycle == cycle)
                .map(|t| (f64::from(t.displacement), t.phase))
                .collect();
            let (amplitude, phase) = demodulate(&moved, 2.0);
            (
                1.0 - amplitude / 0.05 * phase.cos(),
                amplitude / 0.05 * phase.sin(),
            )
        })
        .collect();
    // The dead time of 10 ms.
    let phase = TAU * 2.0 * 0.01;
    assert!((errors[0].1 + 0.9 * phase.sin()).abs() < 2e-3, "{errors:?}");
    for two in errors.windows(2) {
        // 1 − Y is halved by a gain of 0.5. Glide and dead time, 15 ms of the 500 ms, still show the cycle before: 3 % of
        // what it was, doubled where the sine is at its crest; and the ADC's noise-free step is 3e-5 mm of 0.05 mm.
        let tolerance = |before: f64| 0.06 * before.abs() + 6e-4;
        assert!(
            (two[1].0 - 0.5 * two[0].0).abs() < tolerance(two[0].0),
            "{errors:?}"
        );
        assert!(
            (two[1].1 - 0.5 * two[0].1).abs() < tolerance(two[0].1),
            "{errors:?}"
        );
    }
}

#[test]
fn the_correction_stays_within_its_limits() {
    // A gain of 0.15 asks for 6.7, and gets 5.
    let run = on_an_actuator(0.15, 0, 2.0, 12);
    let peak = run.iter().map(|t| t.command.abs()).fold(0.0, f32::max);
    assert!((peak / 0.05 - 5.0).abs() < 0.01, "{peak}");
    // A dead time of 0.2 s at 0.5 Hz asks for 0.19 s of lead, and gets 0.1: the command where the demand is 0.
    let run = on_an_actuator(1.0, 2000, 0.5, 12);
    let lead = run
        .iter()
        .filter(|t| t.phase == 0 && !t.ramp)
        .map(|t| t.command / (0.05 * TAU as f32 * 0.5))
        .fold(0.0, f32::max);
    assert!((lead / 0.1 - 1.0).abs() < 0.01, "{lead}");
}

#[test]
fn a_second_run_begins_as_the_first() {
    // A displacement that reads 0 but for the noise of a step, which says that the channel lives: the observer sees what its
    // feed-forward leaves, some 1e-4 mm, and the joints slip at 1e-5 mm. The force reads about 0.01 kN, as much as the
    // joints give.
    let adc = Rc::<AdcPins>::default();
    let flicker = |tick: usize| {
        let step = (tick % 2) as f64 / 32_768.0;
        adc.volts[0].set(step * mesh_damper::adc::INPUT_RANGE);
        adc.volts[1].set((0.01 + step) * mesh_damper::adc::INPUT_RANGE);
    };
    let joints = Effect::StickSlip(StickSlip::new(&[(1000.0, 1e-5)]).unwrap());
    let make = || {
        wired(
            (&adc, &Rc::default()),
            FailingLine::default(),
            &RigSettings::default(),
            programme(&[(0.1, 2.0, 1)]),
            elastic().with(joints).unwrap(),
        )
    };
    let (mut first, mut second) = (make(), make());
    let (mut firsts, mut seconds) = (Ticks::default(), Ticks::default());
    second.start().unwrap();
    for tick in 0..3_000 {
        flicker(tick);
        second.tick(seconds.next());
    }
    second.stop();
    for tick in 0..10_000 {
        flicker(tick);
        first.tick(firsts.next());
        second.tick(seconds.next());
    }
    first.start().unwrap();
    second.start().unwrap();
    for tick in 0..=5_000 {
        flicker(tick);
        let (a, b) = (first.tick(firsts.next()), second.tick(seconds.next()));
        assert_eq!((a.command, a.cycle, a.phase), (b.command, b.cycle, b.phase));
        // The observer's memory of the first run is e⁻⁵⁰ and less.
        let difference = (a.model_force - b.model_force).abs();
        assert!(difference < 1e-5, "{difference} at {tick}");
        if let (Some(a), Some(b)) = (a.report, b.report) {
            assert_eq!(a.model.ticks, b.model.ticks);
            assert!((a.nrmse - b.nrmse).abs() < 1e-4 && a.nrmse > 0.1);
        }
        assert_eq!(a.report.is_some(), b.report.is_some());
        assert_eq!(a.report.is_some(), tick == 5_000);
    }
}

#[test]
fn a_second_run_counts_its_own_ticks_beyond_a_limit() {
    let adc = Rc::<AdcPins>::default();
    let mut rig = wired(
        (&adc, &Rc::default()),
        FailingLine::default(),
        // The piston is far off, and may start there.
        &RigSettings {
            tracking_limit: 1.0,
            ..RigSettings::default()
        },
        programme(&[(0.1, 2.0, 1)]),
        elastic(),
    );
    adc.volts[0].set(0.53 * mesh_damper::adc::INPUT_RANGE);
    let mut ticks = Ticks::default();
    for _ in 0..3 {
        rig.start().unwrap();
        // One less than would trip.
        for _ in 0..9 {
            assert_eq!(rig.tick(ticks.next()).state, State::Running);
        }
        rig.stop();
        for _ in 0..5_002 {
            rig.tick(ticks.next());
        }
    }
}

#[test]
fn a_line_that_cannot_be_raised_is_a_fault() {
    let line = FailingLine::default();
    let mut rig = rig_on(line.clone());
    line.fails.set(true);
    let refused = StartRefused::Faulted(TripCause::EnableLine);
    assert_eq!(rig.start(), Err(refused));
    assert_eq!(rig.state(), State::Faulted(TripCause::EnableLine));
    assert_eq!(rig.tick(0).command, 0.0);
}

#[test]
fn a_line_that_does_not_drop_is_tried_until_it_does() {
    let line = FailingLine::default();
    let mut rig = rig_on(line.clone());
    rig.start().unwrap();
    let mut ticks = Ticks::default();
    rig.tick(ticks.next());
    line.fails.set(true);
    rig.stop();
    for _ in 0..3 {
        let state = rig.tick(ticks.next()).state;
        assert_eq!(state, State::Faulted(TripCause::EnableLine));
        assert!(line.high.get());
    }
    line.fails.set(false);
    rig.tick(ticks.next());
    assert!(!line.high.get());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Whatever fails, whenever: the line is low from that tick on, and the command goes to 0 and stays.
    #[test]
    fn any_failure_at_any_time_ends_at_rest(at in 0usize..4_000, what in 0usize..4, heals in any::<bool>()) {
        let mut setup = setup(3.5, &[(0.15, 10.0, 3)]);
        setup.settings.stop_ticks = 500;
        let mut bench = started(setup);
        for _ in 0..at {
            bench.tick();
        }
        let fail = |bench: &mut Bench<Specimen, 8, 4>, on: bool| match what {
            0 => bench.adc.bus_failing.set(on),
            1 => bench.dac.bus_failing.set(on),
            2 => bench.plant.displacement_sensor.fault = if on { SensorFault::Open } else { SensorFault::None },
            _ => bench.plant.force_sensor.fault = if on { SensorFault::Open } else { SensorFault::None },
        };
        fail(&mut bench, true);
        let first = bench.tick();
        prop_assert!(matches!(first.state, State::Faulted(_)));
        fail(&mut bench, !heals);
        for tick in 0..1000 {
            let telemetry = bench.tick();
            prop_assert_eq!(telemetry.state, first.state);
            prop_assert!(!bench.enabled.get());
            prop_assert!(telemetry.command.abs() <= first.command.abs());
            // Through a bus that does not heal nothing reaches the DAC.
            if tick > 500 && (what != 1 || heals) {
                prop_assert_eq!(telemetry.command, 0.0);
            }
        }
    }
}

#[test]
fn a_lost_link_and_a_late_tick_stop_the_rig() {
    let mut setup = setup(3.0, &[(0.2, 1.0, 5)]);
    setup.settings.link_ticks = 20;
    setup.settings.stop_ticks = 1000;
    let mut linked = started(setup.clone());
    // As long as somebody is heard it runs; from the last time on for so many ticks.
    for tick in 0..12_000 {
        if tick % 20 == 0 {
            linked.rig.exchange();
        }
        assert_eq!(linked.tick().state, State::Running, "tick {tick}");
    }
    linked.rig.exchange();
    assert_eq!(stops(&mut linked, 1000, TripCause::LinkLost), 21);
    // A link that is back clears nothing.
    linked.rig.exchange();
    assert_eq!(linked.tick().state, State::Faulted(TripCause::LinkLost));
    linked.rig.clear().unwrap();
    linked.rig.start().unwrap();
    assert_eq!(linked.tick().state, State::Running);

    setup.settings.link_ticks = 0;
    let mut late = started(setup);
    for _ in 0..12_000 {
        assert_eq!(late.tick().state, State::Running, "nobody is linked");
    }
    late.rig.overrun();
    assert!(!late.enabled.get(), "before the next tick");
    for _ in 0..1001 {
        assert_eq!(late.rig.clear(), Err(ClearRefused::Moving));
        let refused = StartRefused::Faulted(TripCause::TickOverrun);
        assert_eq!(late.rig.start(), Err(refused));
        let telemetry = late.tick();
        assert_eq!(telemetry.state, State::Faulted(TripCause::TickOverrun));
        assert!(!late.enabled.get());
    }
    assert_eq!(late.tick().command, 0.0);
    late.rig.clear().unwrap();
    // At rest there is nothing to stop.
    late.rig.overrun();
    assert_eq!(late.rig.state(), State::Idle);
}
