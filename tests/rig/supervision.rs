//! Supervision of ticks, converters and lines, for a rig with blocking calls and for one with awaited calls.

mod twins;

use mesh_damper::adc::INPUT_RANGE;
use mesh_damper::converter::Scale;
use mesh_damper::dac::OUTPUT_RANGE;
use mesh_damper::error::ConfigError;
use mesh_damper::rig::{
    ClearRefused, DamperEmulationSettings, EmulationController, RigSettings, StartRefused, State,
    TripCause, VERIFY_TICKS, Wiring,
};
use mesh_damper_rig::{Bench, EmulatorBench, EmulatorSetup, RigSetup};

use twins::{Awaited, Fixture, Supervised, Waiting, elastic, programme};

/// Runs a test with both rigs.
macro_rules! both {
    ($($(#[$doc:meta])* fn $name:ident<R>($fixture:ident) $body:block)+) => {
        $(
            $(#[$doc])*
            #[test]
            fn $name() {
                fn check<R: Supervised>() {
                    let $fixture = |change: fn(&mut RigSettings)| Fixture::<R>::with(change);
                    $body
                }
                check::<Waiting>();
                check::<Awaited>();
            }
        )+
    };
}

/// Settings of a clock of 1 MHz: 1000 counts to each tick of 1 kHz.
fn clocked(settings: &mut RigSettings) {
    settings.clock_rate = 1e6;
}

fn faulted(cause: TripCause) -> State {
    State::Faulted(cause)
}

const LATE: State = State::Faulted(TripCause::TickOverrun);
const EXTERNAL: State = State::Faulted(TripCause::External);

both! {
    /// The timer continues during a stall; its interrupt is taken once at the end.
    fn a_stall_of_500_ticks_stops_it<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(300);
        rig.clock += 500;
        assert_eq!(rig.tick().state, LATE);
        assert!(!rig.line.level.get());
        assert_eq!(rig.rig.late_ticks(), 1);
        rig.comes_to_rest();
        rig.rig.clear().unwrap();
        assert_eq!(rig.rig.late_ticks(), 1, "a clear leaves the count");
        rig.rig.start().unwrap();
        rig.runs(300);
    }

    /// By its own ticks a timer is always in time; by the processor's clock it is not.
    fn a_timer_at_half_or_twice_its_rate_is_seen_by_another_clock<R>(fixture) {
        for counts in [2000, 500 - 1, 1501] {
            let mut rig = fixture(clocked);
            // 1 % off, and with some jitter.
            for tick in 0..300 {
                assert_eq!(rig.tick_after(990 + 10 * (tick % 3)).state, State::Running);
            }
            assert_eq!(rig.tick_after(counts).state, LATE, "{counts}");
            assert!(!rig.line.level.get());
        }
        let mut blind = fixture(|_| {});
        blind.runs(300);
    }

    fn a_tick_called_twice_stops_it<R>(fixture) {
        for clocked in [|_: &mut RigSettings| {}, clocked as fn(&mut RigSettings)] {
            let mut rig = fixture(clocked);
            rig.runs(300);
            assert_eq!(rig.tick_after(0).state, LATE);
            assert!(!rig.line.level.get());
        }
    }

    /// At rest a late tick is counted but causes no trip, and neither does a wrap of the counter.
    fn late_ticks_are_counted_at_rest<R>(fixture) {
        let mut rig = fixture(clocked);
        rig.rig.stop();
        rig.clock = u32::MAX - 10_500;
        rig.tick_after(0);
        for _ in 0..5 {
            rig.tick_after(1000);
        }
        assert_eq!((rig.rig.state(), rig.rig.late_ticks()), (State::Idle, 0));
        rig.tick_after(7000);
        assert_eq!((rig.rig.state(), rig.rig.late_ticks()), (State::Idle, 1));
        rig.rig.start().unwrap();
        rig.runs(300);
        assert_eq!(rig.rig.late_ticks(), 1);
    }

    fn an_external_trip_latches<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(300);
        rig.trip.level.set(false);
        assert_eq!(rig.tick().state, EXTERNAL);
        assert!(!rig.line.level.get());
        rig.trip.level.set(true);
        rig.comes_to_rest();
        assert_eq!(rig.rig.state(), EXTERNAL, "the input is over, the trip is not");
        assert_eq!(rig.rig.start(), Err(StartRefused::Faulted(TripCause::External)));
        rig.rig.clear().unwrap();
        rig.rig.start().unwrap();
        rig.runs(300);
        // At rest too.
        rig.rig.stop();
        rig.trip.level.set(false);
        assert_eq!(rig.tick().state, EXTERNAL);
    }

    /// The line never rises, not even briefly.
    fn an_active_trip_refuses_a_start_and_a_clear<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.rig.stop();
        rig.comes_to_rest();
        let rises = rig.line.rises.get();
        rig.trip.level.set(false);
        let refused = Err(StartRefused::Faulted(TripCause::External));
        assert_eq!(rig.rig.start(), refused);
        assert_eq!(rig.rig.state(), EXTERNAL);
        let refused = Err(ClearRefused::Faulted(TripCause::External));
        for _ in 0..3 {
            assert_eq!(rig.rig.clear(), refused);
            assert_eq!(rig.rig.state(), EXTERNAL);
            rig.tick();
        }
        rig.trip.level.set(true);
        rig.rig.clear().unwrap();
        assert_eq!(rig.line.rises.get(), rises);
        rig.rig.start().unwrap();
        assert_eq!(rig.line.rises.get(), rises + 1);
        // If the trip is activated during a run, a start reports the reason of its refusal and stops the rig at once.
        rig.trip.level.set(false);
        assert_eq!(rig.rig.start(), Err(StartRefused::Faulted(TripCause::External)));
        assert!(!rig.line.level.get());
        assert_eq!(rig.line.rises.get(), rises + 1);
    }

    /// The controller detects the reason during the start.
    fn the_line_does_not_rise_for_a_start_that_is_refused<R>(_fixture) {
        let mut rig = Fixture::<R>::scaled(Scale::new(0.1, 0.0).unwrap());
        rig.adc.volts[0].set(0.2 * INPUT_RANGE);
        rig.rig.tick(1);
        let cause = TripCause::CommandClipped;
        assert_eq!(rig.rig.start(), Err(StartRefused::Faulted(cause)));
        assert_eq!((rig.rig.state(), rig.rig.driven()), (faulted(cause), 0.0));
        assert_eq!(rig.line.rises.get(), 0);
    }

    /// The first cause stays, and the clear reports its obstacle.
    fn an_active_trip_keeps_another_cause<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(300);
        rig.rig.overrun();
        rig.comes_to_rest();
        rig.trip.level.set(false);
        assert_eq!(rig.rig.clear(), Err(ClearRefused::Faulted(TripCause::External)));
        assert_eq!(rig.tick().state, LATE);
    }

    fn a_trip_input_that_cannot_be_read_is_a_trip<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(300);
        rig.trip.fails.set(true);
        assert_eq!(rig.tick().state, EXTERNAL);
        assert!(!rig.line.level.get());
        rig.comes_to_rest();
        assert_eq!(rig.rig.clear(), Err(ClearRefused::Faulted(TripCause::External)));
        rig.trip.fails.set(false);
        rig.rig.clear().unwrap();
    }

    fn a_trip_by_call_latches_in_any_state<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(300);
        rig.rig.external_trip();
        assert_eq!(rig.rig.state(), EXTERNAL);
        assert!(!rig.line.level.get(), "before the next tick");
        rig.comes_to_rest();
        rig.rig.clear().unwrap();
        rig.rig.external_trip();
        assert_eq!(rig.rig.state(), EXTERNAL);
    }

    /// Idle, running, and stopped by a cause that has passed.
    fn it_is_alive_on_each_whole_tick<R>(fixture) {
        let mut rig = fixture(|_| {});
        assert_eq!(rig.alive_in(300), 300);
        rig.rig.stop();
        assert_eq!(rig.alive_in(300), 300);
        rig.trip.level.set(false);
        assert_eq!(rig.alive_in(300), 300, "the watchdog guards the processor");
        rig.trip.level.set(true);
        rig.rig.clear().unwrap();
        rig.rig.start().unwrap();
        rig.clock += 1;
        assert_eq!(rig.alive_in(1), 0, "a late tick");
        assert_eq!(rig.alive_in(300), 300);
    }

    fn it_is_not_alive_where_a_part_fails<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(300);
        for _ in 0..2 {
            rig.adc.bus_failing.set(true);
            assert_eq!(rig.alive_in(40), 0);
            rig.adc.bus_failing.set(false);
            assert_eq!(rig.alive_in(40), 40);
            rig.dac.bus_failing.set(true);
            assert_eq!(rig.alive_in(40), 0);
            rig.dac.bus_failing.set(false);
            // Until the correct register is read back.
            let alive = rig.alive_in(40);
            assert!(alive > 40 - VERIFY_TICKS && alive < 40, "{alive}");
            assert_eq!(rig.alive_in(40), 40);
        }
        rig.comes_to_rest();
        rig.rig.clear().unwrap();
        rig.rig.start().unwrap();
        rig.runs(40);
        // A line that cannot be set low.
        rig.line.fails.set(true);
        rig.rig.stop();
        assert_eq!(rig.rig.state(), faulted(TripCause::EnableLine));
        assert_eq!(rig.alive_in(40), 0);
        rig.line.fails.set(false);
        assert!(rig.alive_in(40) > 40 - VERIFY_TICKS);
        // The watchdog detects a failure of the alive pin.
        rig.signal.fails.set(true);
        assert_eq!(rig.alive_in(40), 0);
    }

    /// It may lose its supply at any time, also at rest. From then on it outputs 0 V for any command.
    fn a_dac_that_lost_its_supply_is_seen_and_set_up_again<R>(fixture) {
        for at in 300..300 + VERIFY_TICKS {
            for idle in [false, true] {
                let mut rig = fixture(|_| {});
                if idle {
                    rig.rig.stop();
                }
                for _ in 0..at {
                    rig.tick();
                }
                rig.dac.unpowered.set(true);
                rig.tick();
                rig.dac.unpowered.set(false);
                let mut seen = 1;
                while rig.rig.state() == if idle { State::Idle } else { State::Running } {
                    rig.tick();
                    seen += 1;
                }
                assert_eq!(rig.rig.state(), faulted(TripCause::DacBus));
                assert!(!rig.line.level.get());
                assert!(seen <= VERIFY_TICKS, "{seen} ticks from {at}");
                assert_eq!(rig.alive_in(100), 0, "the DAC drives a wrong value");
                rig.comes_to_rest();
                rig.rig.clear().unwrap();
                assert_eq!(rig.alive_in(100), 100);
                rig.rig.start().unwrap();
                rig.runs(100);
                let driven = rig.dac.volts.get() / OUTPUT_RANGE;
                let command = f64::from(rig.rig.driven());
                assert!(command.abs() > 1e-3 && (driven - command).abs() < 1e-4);
            }
        }
    }

    fn a_dac_without_supply_refuses_the_clear<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(300);
        rig.dac.unpowered.set(true);
        for _ in 0..VERIFY_TICKS {
            rig.tick();
        }
        assert_eq!(rig.rig.state(), faulted(TripCause::DacBus));
        rig.comes_to_rest();
        let refused = Err(ClearRefused::Faulted(TripCause::DacBus));
        assert_eq!(rig.rig.clear(), refused);
        assert_eq!(rig.rig.state(), faulted(TripCause::DacBus));
        rig.dac.unpowered.set(false);
        rig.rig.clear().unwrap();
    }

    /// The read-back does not delay the return to 0.
    fn a_dac_that_stays_dead_does_not_hold_the_way_back<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(1050);
        rig.dac.unpowered.set(true);
        while rig.tick().state == State::Running {}
        assert_eq!(rig.rig.state(), faulted(TripCause::DacBus));
        let mut last = rig.rig.driven();
        assert!(last.abs() > 0.05, "{last}");
        for _ in 0..51 {
            rig.tick();
            let now = rig.rig.driven();
            assert!(now.abs() < last.abs() || now == 0.0);
            last = now;
        }
        assert_eq!(last, 0.0, "within stop_ticks and one");
    }

    /// 0 V at both inputs is within the range; a line at low level reads as the end of the range.
    fn an_adc_that_lost_its_supply_is_seen_and_set_up_again<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(300);
        rig.adc.unpowered.set(true);
        assert_eq!(rig.tick().state, faulted(TripCause::DisplacementClipped));
        rig.comes_to_rest();
        let refused = Err(ClearRefused::Faulted(TripCause::AdcBus));
        assert_eq!(rig.rig.clear(), refused);
        rig.adc.unpowered.set(false);
        rig.rig.clear().unwrap();
        rig.rig.start().unwrap();
        rig.runs(300);
    }

    /// The DAC's output is 2 V at a command of 0. It has this value from the start, and the sine begins there.
    fn a_zero_of_the_dac_is_no_step<R>(_fixture) {
        let mut rig = Fixture::<R>::scaled(Scale::new(1.0, 0.2).unwrap());
        let zero = 0.2 * OUTPUT_RANGE;
        // Half a code.
        let step = 0.5 * OUTPUT_RANGE / 32_768.0;
        assert!((rig.dac.volts.get() - zero).abs() <= step);
        let mut last = rig.dac.volts.get();
        rig.rig.start().unwrap();
        let mut most: f64 = 0.0;
        for _ in 0..100 {
            rig.tick();
            most = most.max((rig.dac.volts.get() - last).abs());
            last = rig.dac.volts.get();
        }
        // 0.2 mm at 5 Hz, corrected by feedback: 0.0063 mm a tick, 0.063 V.
        assert!(most > 0.01 && most < 0.1, "{most} V in a tick");
        // A clear does not change the output.
        rig.rig.overrun();
        rig.comes_to_rest();
        rig.rig.clear().unwrap();
        assert!((rig.dac.volts.get() - zero).abs() <= step);
    }

    fn a_line_that_sticks_high_is_found_as_it_is_lowered<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.runs(300);
        rig.line.stuck.set(true);
        rig.rig.stop();
        assert_eq!(rig.rig.state(), faulted(TripCause::EnableLine));
        assert_eq!(rig.alive_in(40), 0);
        rig.comes_to_rest();
        assert_eq!(rig.rig.clear(), Err(ClearRefused::Faulted(TripCause::EnableLine)));
        rig.line.stuck.set(false);
        rig.tick();
        assert!(!rig.line.level.get());
        rig.rig.clear().unwrap();
    }

    fn a_line_that_sticks_low_is_found_as_it_is_raised<R>(fixture) {
        let mut rig = fixture(|_| {});
        rig.rig.stop();
        rig.comes_to_rest();
        rig.line.stuck.set(true);
        let refused = Err(StartRefused::Faulted(TripCause::EnableLine));
        assert_eq!(rig.rig.start(), refused);
        assert_eq!(rig.rig.state(), faulted(TripCause::EnableLine));
    }

    /// It falls while it should be high, or rises while it should be low, because of another device on it.
    fn a_line_that_changes_by_itself_is_seen<R>(fixture) {
        for at in 300..300 + VERIFY_TICKS {
            for idle in [false, true] {
                let mut rig = fixture(|_| {});
                if idle {
                    rig.rig.stop();
                }
                for _ in 0..at {
                    rig.tick();
                }
                rig.line.level.set(idle);
                let mut seen = 0;
                while rig.rig.state() == if idle { State::Idle } else { State::Running } {
                    rig.tick();
                    seen += 1;
                }
                assert_eq!(rig.rig.state(), faulted(TripCause::EnableLine));
                assert!(seen <= VERIFY_TICKS, "{seen} ticks from {at}");
                assert!(!rig.line.level.get());
            }
        }
    }
}

/// On the simulated plant: a clock that no part of the rig can stop, and an emergency stop.
#[test]
fn a_plant_that_moves_two_ticks_on_in_one_stops_the_bench() {
    let bench = || {
        let specimen = mesh_damper_rig::specimen::Specimen::of_density(3.0, 0.1);
        let setup = RigSetup::<_, 2, 1>::new(specimen, elastic(), programme(10_000.0), 1);
        let mut bench = Bench::new(setup).unwrap();
        bench.rig.start().unwrap();
        for _ in 0..1000 {
            assert_eq!(bench.tick().state, State::Running);
        }
        bench
    };
    let mut stalls = bench();
    stalls.plant.advance(0.0, true);
    assert_eq!(stalls.tick().state, LATE);
    let mut pressed = bench();
    pressed.plant.tripped = true;
    assert_eq!(pressed.tick().state, EXTERNAL);
    let mut stuck = bench();
    stuck.stuck.set(true);
    stuck.rig.stop();
    assert_eq!(stuck.rig.state(), faulted(TripCause::EnableLine));
    let mut reset = bench();
    reset.dac.unpowered.set(true);
    let ticks = (1..).find(|_| reset.tick().state != State::Running);
    assert_eq!(reset.rig.state(), faulted(TripCause::DacBus));
    assert!(ticks.unwrap() <= VERIFY_TICKS);
    let before = reset.alive.get();
    reset.tick();
    assert_eq!(reset.alive.get(), before);
}

/// A damper emulation has the same supervision.
#[test]
fn a_late_tick_stops_an_emulation() {
    let setup = EmulatorSetup::new(elastic());
    let mut bench = EmulatorBench::new(setup).unwrap();
    bench.emulator.start().unwrap();
    for _ in 0..100 {
        assert_eq!(bench.tick(0.0).telemetry.state, State::Running);
    }
    bench.clock += 1;
    assert_eq!(bench.tick(0.0).telemetry.state, LATE);
    assert_eq!(bench.emulator.late_ticks(), 1);
    let unit = Scale::new(1.0, 0.0).unwrap();
    let wiring = Wiring {
        displacement: unit,
        force: unit,
        command: unit,
    };
    let settings = DamperEmulationSettings {
        clock_rate: 9_999.0,
        ..DamperEmulationSettings::default()
    };
    let law =
        mesh_damper::fast_law::RunningLaw::new(mesh_damper::fast_law::FastLaw::new(elastic()));
    let refused = EmulationController::new(&settings, &wiring, law).err();
    assert!(matches!(
        refused,
        Some(ConfigError::OutOfRange {
            field: "clock_rate",
            ..
        })
    ));
}
