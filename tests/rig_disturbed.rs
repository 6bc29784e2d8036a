//! A fault that passes does not blind the monitor: what comes after it is found.

use std::cell::Cell;
use std::rc::Rc;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::health::{Cause, Channel};
use mesh_damper::law::Law;
use mesh_damper::rig::{State, Telemetry};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::actuator::{SensorFault, ServoFault};
use mesh_damper_rig::faults::{Condition, Damaged};
use mesh_damper_rig::{Bench, RigSetup};

const TICK_RATE: f64 = 10_000.0;
/// mm.
const AMPLITUDE: f64 = 0.1;
/// Hz.
const FREQUENCY: f64 = 2.0;
const TICKS: u64 = (TICK_RATE / FREQUENCY) as u64;
/// As many noises are tried.
const SEEDS: u64 = 12;
/// A single bad sample comes in this cycle,
const SPIKE: u64 = 25;
/// and the specimen breaks in this one.
const BREAK: u64 = 30;

/// The two channels, and how large half of their amplitude is, mm and kN.
const CHANNELS: [(Channel, f64); 2] = [(Channel::Displacement, 0.05), (Channel::Force, 0.15)];

struct Test {
    bench: Bench<Damaged, 1, 1>,
    condition: Rc<Cell<Condition>>,
    /// Since the last start.
    tick: u64,
    told: Vec<Cause>,
}

impl Test {
    fn new(cycles: u32, follow: f64, seed: u64) -> Self {
        let (specimen, condition) = Damaged::new(3.0, AMPLITUDE);
        let c = specimen.coefficients();
        let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32).unwrap();
        let programme = Programme::new(TICK_RATE, 1)
            .unwrap()
            .with(Block::sine(AMPLITUDE, FREQUENCY, cycles).unwrap())
            .unwrap();
        let mut setup = RigSetup::new(specimen, AugmentedLaw::new(law), programme, seed);
        setup.settings.health.follow = follow;
        let mut test = Self {
            bench: Bench::new(setup).unwrap(),
            condition,
            tick: 0,
            told: Vec::new(),
        };
        assert!(test.bench.rig.start());
        test
    }

    /// Runs on to the `cycle` of full amplitude; there is one of ramp before.
    fn run_to(&mut self, cycle: u64) {
        while self.tick < (cycle + 1) * TICKS {
            self.step();
        }
    }

    fn step(&mut self) -> Telemetry {
        let telemetry = self.bench.tick();
        self.tick += 1;
        self.told.extend(telemetry.event.map(|event| event.cause));
        telemetry
    }

    fn sensor(&mut self, channel: Channel) -> &mut SensorFault {
        let plant = &mut self.bench.plant;
        match channel {
            Channel::Displacement => &mut plant.displacement_sensor.fault,
            Channel::Force => &mut plant.force_sensor.fault,
        }
    }

    /// One sample of `channel` has `size` added to it.
    fn spike(&mut self, channel: Channel, size: f64) {
        *self.sensor(channel) = SensorFault::Spiking { size, every: 1 };
        self.step();
        *self.sensor(channel) = SensorFault::None;
    }

    /// `part` of the elastic force and of the friction is there.
    fn keep(&self, part: f64) {
        let whole = Condition::NEW;
        self.condition.set(Condition {
            stiffness: part,
            friction: part,
            ..whole
        });
    }
}

#[test]
fn a_break_after_a_spike_is_found() {
    for seed in 1..=SEEDS {
        for (channel, size) in CHANNELS {
            let mut test = Test::new(60, 0.0, seed);
            test.run_to(SPIKE);
            test.spike(channel, size);
            test.run_to(BREAK);
            assert_eq!(test.told, [Cause::SensorSpiking(channel)], "{seed}");
            test.keep(0.8);
            test.run_to(BREAK + 6);
            let expected = [Cause::SensorSpiking(channel), Cause::WireBreakage];
            assert_eq!(test.told, expected, "{seed}");
        }
    }
}

/// In the cycle before the break, in the one that it comes in, and while the monitor judges what it suspects.
#[test]
fn a_spike_next_to_a_break_does_not_hide_it() {
    for (seed, eighth) in (1..).zip(-8..24i64) {
        for (channel, size) in CHANNELS {
            let mut test = Test::new(60, 0.0, seed);
            let breaks = BREAK * TICKS;
            let spikes = breaks.checked_add_signed(eighth * (TICKS / 8) as i64 + 99);
            for tick in 0..(BREAK + 10) * TICKS {
                if tick == breaks {
                    test.keep(0.8);
                }
                if Some(tick) == spikes {
                    test.spike(channel, size);
                } else {
                    test.step();
                }
            }
            test.told.sort_by_key(|cause| cause.number());
            let expected = [Cause::WireBreakage, Cause::SensorSpiking(channel)];
            assert_eq!(test.told, expected, "{eighth} eighths");
        }
    }
}

#[test]
fn a_spike_in_one_run_does_not_blind_the_next() {
    for (channel, size) in CHANNELS {
        let mut test = Test::new(40, 0.0, 3);
        test.run_to(SPIKE);
        test.spike(channel, size);
        while test.bench.rig.state() == State::Running {
            test.step();
        }
        assert_eq!(test.told, [Cause::SensorSpiking(channel)]);
        // The way back to rest.
        for _ in 0..2 * TICKS {
            test.step();
        }
        assert!(test.bench.rig.start());
        test.tick = 0;
        test.run_to(BREAK);
        test.keep(0.8);
        test.run_to(BREAK + 6);
        assert_eq!(test.told.last(), Some(&Cause::WireBreakage));
    }
}

/// The drift stays; it explains a mean that moves, not what else does.
#[test]
fn a_break_after_a_drift_is_found() {
    for seed in 1..=SEEDS {
        let mut test = Test::new(120, 0.0, seed);
        test.run_to(SPIKE);
        // A fortieth of the force's amplitude a cycle.
        *test.sensor(Channel::Force) = SensorFault::Drifting(0.0075 / TICKS as f64);
        test.run_to(SPIKE + 12);
        let drifting = Cause::SensorDrifting(Channel::Force);
        assert_eq!(test.told, [drifting], "{seed}");
        *test.sensor(Channel::Force) = SensorFault::None;
        test.keep(0.6);
        test.run_to(SPIKE + 40);
        assert!(
            test.told.contains(&Cause::WireBreakage),
            "{seed}: {:?}",
            test.told
        );
    }
}

/// Of an actuator whose response changes around a spike or some cycles after it.
#[test]
fn an_actuator_that_lags_after_a_spike_is_found() {
    for (channel, size) in CHANNELS {
        for quarters in [-4, -2, -1, 0, 1, 2, 3, 5, 8, 20i64] {
            let mut test = Test::new(60, 0.0, 1);
            let spikes = SPIKE * TICKS + 99;
            let lags = spikes.checked_add_signed(quarters * (TICKS / 4) as i64);
            for tick in 0..(SPIKE + 10) * TICKS {
                if Some(tick) == lags {
                    test.bench.plant.servo.fault = ServoFault::Lagging(100);
                }
                if tick == spikes {
                    test.spike(channel, size);
                } else {
                    test.step();
                }
            }
            test.told.sort_by_key(|cause| cause.number());
            let expected = [Cause::SensorSpiking(channel), Cause::ActuatorLagging];
            assert_eq!(test.told, expected, "{quarters} quarters of a cycle");
        }
    }
}

/// What a drift of the last run explained is no matter of the next.
#[test]
fn a_preload_shift_after_another_runs_drift_is_found() {
    let mut test = Test::new(40, 0.0, 2);
    test.run_to(SPIKE);
    *test.sensor(Channel::Force) = SensorFault::Drifting(0.0075 / TICKS as f64);
    test.run_to(SPIKE + 12);
    assert_eq!(test.told, [Cause::SensorDrifting(Channel::Force)]);
    *test.sensor(Channel::Force) = SensorFault::None;
    while test.bench.rig.state() == State::Running {
        test.step();
    }
    for _ in 0..2 * TICKS {
        test.step();
    }
    assert!(test.bench.rig.start());
    test.tick = 0;
    test.run_to(BREAK);
    let whole = Condition::NEW;
    test.condition.set(Condition {
        preload: 0.05,
        ..whole
    });
    test.run_to(BREAK + 6);
    assert_eq!(test.told.last(), Some(&Cause::PreloadShift));
}

#[test]
fn the_law_follows_again_after_a_spike() {
    let moved = |spiked: bool| {
        let mut test = Test::new(120, 0.2, 1);
        test.run_to(SPIKE);
        if spiked {
            test.spike(Channel::Force, 0.15);
        }
        for cycle in SPIKE..110 {
            test.keep(1.0 - 0.0005 * (cycle - SPIKE) as f64);
            test.run_to(cycle + 1);
        }
        test.bench.rig.followed().k1
    };
    let (alone, after) = (moved(false), moved(true));
    assert!(alone < -0.01, "{alone}");
    assert!((after - alone).abs() < 0.2 * alone.abs(), "{after} {alone}");
}
