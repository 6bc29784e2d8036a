//! Limits, clipped commands, bus errors, a lost link and a late tick: the line drops in that tick and the command goes to 0.

use mesh_damper::dac::OUTPUT_RANGE;
use mesh_damper::rig::{ClearRefused, RigSettings, StartRefused, State, Telemetry, TripCause};
use mesh_damper_rig::Bench;
use mesh_damper_rig::actuator::SensorFault;
use mesh_damper_rig::specimen::Specimen;
use proptest::prelude::*;

use super::{setup, started, stops};

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
        // The same run without a trip shows when the limit has been exceeded for long enough: a tick within the limit reduces the
        // count by an eighth of a tick.
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
fn a_command_beyond_the_dac_stops_the_rig() {
    let mut setup = setup(3.0, &[(0.2, 1.0, 5)]);
    setup.command_range = 0.15;
    stops(&mut started(setup), 5000, TripCause::CommandClipped);
}

#[test]
fn the_reported_command_is_the_one_that_the_dac_drives() {
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
    // ±0.15 mm ends at 0x0000 on the lower side and at 0xFFFF, one step before it, on the upper side.
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
        // A tick during which the plant stands still.
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
        // After a clear it can start again and runs to its end.
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
        // One more tick if rounding of the differences leaves a remainder.
        assert!(tick <= 1000 || command == 0.0, "{command}");
    }
    let fault = TripCause::DisplacementClipped;
    assert_eq!(bench.rig.state(), State::Faulted(fault));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Any failure at any time: the line is low from that tick on, and the command goes to 0 and stays there.
    #[test]
    fn any_failure_at_any_time_ends_at_rest(at in 0usize..4_000, failing in 0usize..4, heals in any::<bool>()) {
        let mut setup = setup(3.5, &[(0.15, 10.0, 3)]);
        setup.settings.stop_ticks = 500;
        let mut bench = started(setup);
        for _ in 0..at {
            bench.tick();
        }
        let fail = |bench: &mut Bench<Specimen, 8, 4>, on: bool| match failing {
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
            // A bus that does not recover passes nothing to the DAC.
            if tick > 500 && (failing != 1 || heals) {
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
    // It runs while the link is heard, and for `link_ticks` after the last time.
    for tick in 0..12_000 {
        if tick % 20 == 0 {
            linked.rig.exchange();
        }
        assert_eq!(linked.tick().state, State::Running, "tick {tick}");
    }
    linked.rig.exchange();
    assert_eq!(stops(&mut linked, 1000, TripCause::LinkLost), 21);
    // A restored link clears nothing.
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
