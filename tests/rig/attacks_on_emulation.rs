//! A damper emulation with wrong sensors, with a dead actuator, with a swapped law, and at rest.

use std::f64::consts::TAU;

use mesh_damper::adc::INPUT_RANGE;
use mesh_damper::effects::{AugmentedLaw, Effect, Temperature};
use mesh_damper::fast_law::FastLaw;
use mesh_damper::health::HealthCause;
use mesh_damper::law::Law;
use mesh_damper::rig::{Controller as _, State, Telemetry, TripCause};
use mesh_damper_rig::{EmulatorBench, EmulatorSetup};

const TICK_RATE: f64 = 10_000.0;

fn law(k1: f32, c: f32, alpha: f32) -> AugmentedLaw<f32, 2> {
    AugmentedLaw::new(Law::new(k1, 0.0, c, alpha).unwrap())
}

/// Running, with a displacement channel that has 1e-4 mm of noise.
fn started(law: AugmentedLaw<f32, 2>, seed: u64) -> EmulatorBench<2> {
    let mut setup = EmulatorSetup::new(law);
    setup.displacement_sensor.noise = 1e-4;
    setup.seed = seed;
    let mut bench = EmulatorBench::new(setup).unwrap();
    bench.emulator.start().unwrap();
    bench
}

/// 0.2 mm at 2 Hz.
fn motion(tick: u32) -> f64 {
    0.2 * (TAU * 2.0 * f64::from(tick) / TICK_RATE).sin()
}

/// A tick with these sensor values, mm and kN, of ±1 mm and ±5 kN.
fn shown(bench: &mut EmulatorBench<2>, displacement: f64, force: f64) -> Telemetry {
    bench.adc.volts[0].set(displacement * INPUT_RANGE);
    bench.adc.volts[1].set(force / 5.0 * INPUT_RANGE);
    let seen = bench.emulator.tick(bench.clock);
    bench.clock += 1;
    seen
}

#[test]
fn a_displacement_that_is_frozen_stops_it_within_a_second() {
    let mut bench = started(law(2.0, 0.1, 0.4), 1);
    let mut stopped = None;
    for tick in 0..11_000 {
        let driven = f64::from(bench.emulator.driven());
        let seen = shown(&mut bench, 0.195, driven);
        if seen.state != State::Running {
            stopped = Some((tick, seen.state));
            break;
        }
    }
    let (tick, state) = stopped.unwrap();
    assert_eq!(state, State::Faulted(TripCause::DisplacementLost));
    assert!((9_990..10_010).contains(&tick), "{tick}");
    assert!(!bench.enabled.get());
}

/// The measured force stays at 0, or at its previous value, with a command of up to 0.5 kN.
#[test]
fn an_actuator_that_is_dead_stops_it_within_a_cycle() {
    for stands in [0.0, 0.3] {
        let mut bench = started(law(2.0, 0.1, 0.4), 1);
        for tick in 0..10_000 {
            assert_eq!(bench.tick(motion(tick)).telemetry.state, State::Running);
        }
        let mut ticks = 0;
        let state = loop {
            let seen = shown(
                &mut bench,
                motion(10_000 + ticks),
                stands + 1e-3 * f64::from(ticks % 3),
            );
            ticks += 1;
            if seen.state != State::Running {
                break seen.state;
            }
            assert!(ticks < 5000, "it runs on beside {stands} kN");
        };
        assert_eq!(state, State::Faulted(TripCause::NoResponse));
    }
}

/// By 40° of phase, at 10 Hz, with a law that has only friction: this force lags most.
#[test]
fn an_actuator_that_lags_goes_on() {
    let mut bench = started(law(0.0, 0.5, 0.2), 1);
    let lag = (40.0 / 360.0 / 10.0 * TICK_RATE) as usize;
    let mut commands = std::collections::VecDeque::from(vec![0.0; lag]);
    for tick in 0..30_000u32 {
        commands.push_back(f64::from(bench.emulator.driven()));
        let force = commands.pop_front().unwrap();
        let y = 0.2 * (TAU * 10.0 * f64::from(tick) / TICK_RATE).sin() + 1e-4 * f64::from(tick % 3);
        assert_eq!(shown(&mut bench, y, force).state, State::Running, "{tick}");
    }
}

/// Laws that once chattered with 0.33 kN and 1660 changes of sign a second.
#[test]
fn at_rest_it_does_not_chatter() {
    for (c, alpha) in [(0.66, 0.16), (0.1, 0.4), (0.3, 0.0)] {
        for seed in 0..4 {
            let mut bench = started(law(1.0, c, alpha), seed);
            // A motion that ends at the crest, and then rest.
            for tick in 0..21_250 {
                bench.tick(motion(tick));
            }
            let at = motion(21_250);
            let (mut square, mut early) = (0.0, 0.0f64);
            for tick in 0..30_000 {
                let command = f64::from(bench.tick(at).telemetry.command) - at;
                if tick >= 10_000 {
                    square += command * command;
                }
                // Rest begins after 0.05 s. From then on the remaining friction decays in 0.5 s.
                match tick {
                    1000 => early = command,
                    3250 => assert!((command - 0.5 * early).abs() < 0.05 * early.abs() + 1e-3),
                    _ => {}
                }
            }
            assert!(early.abs() > 0.05 * f64::from(c), "{early}");
            // The remainder is the spring's force due to the noise: 1e-4 kN.
            let rms = (square / 20_000.0f64).sqrt();
            assert!(rms < 3e-4, "{rms} kN of c {c}, α {alpha}");
            assert_eq!(bench.emulator.state(), State::Running);
            // The motion starts again, and the friction acts at once.
            let mut most = 0.0f64;
            for tick in 0..1250 {
                let y = motion(21_250 + tick);
                most = most.max((bench.tick(y).force - y).abs());
            }
            assert!(most > 0.9 * f64::from(c), "{most} kN of {c}");
            // After rests that are too short for the force to decay, the friction is no larger than before.
            let fastest = 0.2 * TAU * 2.0f64;
            let law = f64::from(c) * fastest.powf(alpha.into());
            let mut most = 0.0f64;
            for tick in 0..10_000 {
                let y = motion(22_500 + tick);
                most = most.max((bench.tick(y).force - y).abs());
                if tick % 2500 == 1250 {
                    for _ in 0..1000 {
                        bench.tick(y);
                    }
                }
            }
            assert!(most < 1.05 * law, "{most} kN of {law}");
        }
    }
}

/// c changes from 0.05 to 1 kN in the middle of a motion: the force changes over half a second.
#[test]
fn a_swap_of_the_law_has_no_step() {
    let mut bench = started(law(1.0, 0.05, 0.3), 1);
    let mut last = 0.0;
    let mut most = [0.0f64; 2];
    for tick in 0..40_000 {
        if tick == 20_100 {
            bench.emulator.swap_law(FastLaw::new(law(1.0, 1.0, 0.3)));
        }
        let seen = bench.tick(motion(tick));
        assert_eq!(seen.telemetry.state, State::Running);
        let step = (seen.force - last).abs();
        last = seen.force;
        // Starts when the force is fully ramped in. The law takes over at the next crossing, and acts fully half a second later.
        match tick {
            10_000..20_100 => most[0] = most[0].max(step),
            // Friction reverses at a crest, where its own law has a step.
            20_100..24_000 if motion(tick).abs() < 0.19 => most[1] = most[1].max(step),
            _ => {}
        }
    }
    let [before, after] = most;
    assert!(after < 3.0 * before, "{after} kN in a tick after {before}");
    // At the end the new law acts fully.
    let expected = 1.0 * (0.2 * TAU * 2.0f64).powf(0.3);
    let at_zero = bench.tick(motion(40_000)).force;
    assert!((at_zero - expected).abs() < 0.05, "{at_zero} of {expected}");
}

#[test]
fn no_temperature_drives_a_force_that_is_none() {
    let warm = Effect::Temperature(Temperature::new(0.01, 20.0).unwrap());
    for temperature in [1372.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        let mut cold = started(law(2.0, 0.1, 0.4).with(warm).unwrap(), 1);
        let mut hot = started(law(2.0, 0.1, 0.4).with(warm).unwrap(), 1);
        let mut events = Vec::new();
        for tick in 0..15_000 {
            if tick == 10_000 {
                hot.emulator.set_temperature(temperature);
            }
            let (cold, hot) = (cold.tick(motion(tick)), hot.tick(motion(tick)));
            assert_eq!(cold.force.to_bits(), hot.force.to_bits(), "{temperature}");
            events.extend(hot.telemetry.event);
        }
        let [event] = events[..] else {
            panic!("{events:?}");
        };
        assert_eq!(event.cause, HealthCause::TemperatureImplausible);
    }
}
