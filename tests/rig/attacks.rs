//! Faults that nobody injects by name: they act on the signals and on the specimen, over twelve seeds of noise each.

use std::cell::Cell;
use std::f64::consts::TAU;
use std::rc::Rc;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::health::{Channel, Event, HealthCause};
use mesh_damper::law::Law;
use mesh_damper::rig::{State, Telemetry, TripCause};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::faults::{Condition, Damaged};
use mesh_damper_rig::{Bench, RigSetup, TICK_RATE};

const SEEDS: u64 = 12;
const AMPLITUDE: f64 = 0.1;
const FREQUENCY: f64 = 2.0;
/// V at a channel's full scale.
const FULL: f64 = 10.24;
/// Cycles after the start at which attacks begin, the ramp included.
const BEGINS: f64 = 31.0;

/// What an attack may touch at a tick.
struct Attacked<'a> {
    /// Cycles since the start.
    cycle: f64,
    tick: u64,
    /// V of displacement and force, and what the amplitude of each is.
    volts: [&'a mut f64; 2],
    amplitudes: [f64; 2],
    temperature: &'a mut f64,
    condition: &'a mut Condition,
}

impl Attacked<'_> {
    fn is_on(&self) -> bool {
        self.cycle >= BEGINS
    }
}

struct Rig {
    bench: Bench<Damaged, 16, 1>,
    condition: Rc<Cell<Condition>>,
    amplitudes: [f64; 2],
    /// kN.
    force_limit: f64,
    tick: u64,
}

/// How a run went.
struct Run {
    events: Vec<(f64, Event)>,
    state: State,
    /// Cycles until it stopped or was over.
    cycles: f64,
    /// Largest true displacement over what is demanded.
    furthest: f64,
    /// Most ticks on end with a force beyond 1.01 times its limit.
    beyond: u32,
}

impl Run {
    fn causes(&self) -> Vec<HealthCause> {
        self.events.iter().map(|(_, event)| event.cause).collect()
    }

    /// The first event from where attacks begin, and its cycle.
    fn first(&self) -> (f64, Event) {
        let mut events = self.events.iter().filter(|(cycle, _)| *cycle >= BEGINS);
        *events.next().expect("an event")
    }
}

impl Rig {
    fn new(blocks: u32, cycles: u32, seed: u64) -> Self {
        Self::limited(blocks, cycles, seed, 1.9)
    }

    /// With a limit of the force of so many times its amplitude.
    fn limited(blocks: u32, cycles: u32, seed: u64, limit: f64) -> Self {
        let (specimen, condition) = Damaged::new(3.0, AMPLITUDE);
        let c = specimen.coefficients();
        let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32).unwrap();
        let mut programme = Programme::new(TICK_RATE, 1).unwrap();
        for _ in 0..blocks {
            let block = Block::sine(AMPLITUDE, FREQUENCY, cycles).unwrap();
            programme = programme.with(block).unwrap();
        }
        let w = TAU * FREQUENCY;
        let force = (0..100)
            .map(|step| (TAU * f64::from(step) / 100.0).sin_cos())
            .map(|(sin, cos)| c.force(AMPLITUDE * sin, AMPLITUDE * w * cos).abs())
            .fold(0.0, f64::max);
        let mut setup = RigSetup::new(specimen, AugmentedLaw::new(law), programme, seed);
        setup.settings.force_limit = limit * force;
        let amplitudes = [
            AMPLITUDE / setup.displacement_sensor.full_scale * FULL,
            force / setup.force_sensor.full_scale * FULL,
        ];
        let mut bench = Bench::new(setup).unwrap();
        bench.rig.start().unwrap();
        Self {
            bench,
            condition,
            amplitudes,
            force_limit: limit * force,
            tick: 0,
        }
    }

    fn tick(&mut self, mut attack: impl FnMut(&mut Attacked<'_>)) -> (f64, Telemetry) {
        let bench = &mut self.bench;
        let cycle = self.tick as f64 * FREQUENCY / TICK_RATE;
        let (mut displacement, mut force) = bench.plant.sense();
        let mut condition = self.condition.get();
        let mut temperature = condition.temperature;
        attack(&mut Attacked {
            cycle,
            tick: self.tick,
            volts: [&mut displacement, &mut force],
            amplitudes: self.amplitudes,
            temperature: &mut temperature,
            condition: &mut condition,
        });
        self.condition.set(condition);
        bench.adc.volts[0].set(displacement);
        bench.adc.volts[1].set(force);
        bench.rig.set_temperature(temperature as f32);
        let seen = bench.rig.tick(bench.plant.clock);
        bench
            .plant
            .advance(bench.dac.volts.get(), bench.enabled.get());
        self.tick += 1;
        (cycle, seen)
    }

    fn run(&mut self, mut attack: impl FnMut(&mut Attacked<'_>)) -> Run {
        let limit = self.force_limit;
        let mut run = Run {
            events: Vec::new(),
            state: State::Running,
            cycles: 0.0,
            furthest: 0.0,
            beyond: 0,
        };
        let mut beyond = 0;
        while run.state == State::Running {
            let (cycle, seen) = self.tick(&mut attack);
            run.events.extend(seen.event.map(|event| (cycle, event)));
            run.state = seen.state;
            run.cycles = cycle;
            let servo = &self.bench.plant.servo;
            run.furthest = run.furthest.max(servo.displacement().abs() / AMPLITUDE);
            beyond = if servo.force().abs() > 1.01 * limit {
                beyond + 1
            } else {
                0
            };
            run.beyond = run.beyond.max(beyond);
        }
        run
    }
}

/// A run of 45 cycles under `attack`.
fn run(seed: u64, attack: impl FnMut(&mut Attacked<'_>)) -> Run {
    Rig::new(1, 45, seed).run(attack)
}

/// Noise of −0.5 to 0.5, other at each tick.
fn noise(tick: u64) -> f64 {
    let mut x = tick.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 32;
    (x >> 11) as f64 / (1u64 << 53) as f64 - 0.5
}

#[test]
fn a_force_channel_that_shows_no_force_stops_the_rig_within_a_cycle() {
    for seed in 0..SEEDS {
        let mut frozen = None;
        let runs = [
            run(seed, |a| {
                if a.is_on() {
                    *a.volts[1] = 0.05 * noise(a.tick);
                }
            }),
            run(seed, |a| {
                if a.is_on() {
                    let at = *frozen.get_or_insert(*a.volts[1]);
                    *a.volts[1] = at + 3.0 * noise(a.tick) * 2.0 * FULL / 65_536.0;
                }
            }),
            run(seed, |a| {
                if a.is_on() {
                    a.condition.stiffness = 0.0;
                    a.condition.friction = 0.0;
                }
            }),
        ];
        for run in runs {
            assert_eq!(run.state, State::Faulted(TripCause::ForceLost));
            assert!(run.cycles - BEGINS < 1.0, "{}", run.cycles);
            let lost = [
                HealthCause::SensorDroppedOut(Channel::Force),
                HealthCause::SpecimenAbsent,
            ];
            let (_, event) = *run.events.last().unwrap();
            assert_eq!([Some(event.cause), event.or], lost.map(Some));
        }
    }
}

#[test]
fn a_force_that_never_was_stops_the_rig_in_its_ramp() {
    for seed in 0..SEEDS {
        let mut at = 0.0;
        let mut attack = |a: &mut Attacked<'_>| {
            *a.volts[1] = 0.05 * noise(a.tick);
            at = a.cycle;
        };
        let run = run(seed, &mut attack);
        assert_eq!(run.state, State::Faulted(TripCause::ForceLost));
        assert!(run.cycles < 2.0, "{}", run.cycles);
        let (_, event) = run.events[0];
        assert_eq!(event.cause, HealthCause::SpecimenAbsent);
        assert_eq!(
            event.or,
            Some(HealthCause::SensorDroppedOut(Channel::Force))
        );
    }
}

/// Three times the force, and a channel that shows nothing, or less than the limit, in one tick of ten.
#[test]
fn one_good_sample_in_ten_does_not_hold_a_limit_off() {
    for seed in 0..SEEDS {
        for good in [0.0, 0.8] {
            let limit = 1.5;
            let mut rig = Rig::limited(1, 45, seed, limit);
            let run = rig.run(|a| {
                if a.is_on() {
                    a.condition.stiffness = 2.5;
                    a.condition.friction = 2.5;
                    // The range is twice the amplitude, and clips beyond that.
                    let most = limit * a.amplitudes[1];
                    let shown = if a.tick.is_multiple_of(10) {
                        good * most
                    } else {
                        1.25 * most
                    };
                    *a.volts[1] = a.volts[1].clamp(-shown, shown);
                }
            });
            assert!(matches!(run.state, State::Faulted(_)), "{:?}", run.state);
            // Ten ticks, one of ten that takes back an eighth of one, and the lag of the channel.
            assert!(run.beyond <= 20, "{}", run.beyond);
        }
    }
}

#[test]
fn a_displacement_that_fades_stops_the_rig_before_it_goes_a_third_too_far() {
    for seed in 0..SEEDS {
        // In the run-in, over 100 cycles; and at once.
        for over in [100.0, 0.0] {
            let run = Rig::new(1, 150, seed).run(|a| {
                let part = if over > 0.0 {
                    ((a.cycle - BEGINS) / over).clamp(0.0, 1.0)
                } else {
                    f64::from(u8::from(a.is_on()))
                };
                *a.volts[0] *= 1.0 - 0.4 * part;
            });
            assert_eq!(run.state, State::Faulted(TripCause::CorrectionLimit));
            assert!(run.furthest < 1.34, "{}", run.furthest);
            let (_, event) = *run.events.last().unwrap();
            assert_eq!(event.cause, HealthCause::SensorGain(Channel::Displacement));
        }
    }
}

/// Two fifths too little from the start: in the first cycles what it asks for is told beside no correction.
#[test]
fn a_displacement_that_shows_too_little_from_the_start_stops_the_rig_in_the_first_cycles() {
    for seed in 0..SEEDS {
        let run = Rig::new(1, 30, seed).run(|a| *a.volts[0] *= 0.6);
        assert_eq!(run.state, State::Faulted(TripCause::CorrectionLimit));
        assert!(run.cycles < 6.0, "{}", run.cycles);
        let (_, event) = *run.events.last().unwrap();
        assert_eq!(event.cause, HealthCause::SensorGain(Channel::Displacement));
        assert!((0.5..0.7).contains(&event.value), "{event:?}");
    }
}

/// What was learned beside a bad channel is not driven beside the mended one.
#[test]
fn a_repaired_rig_starts_from_neutral() {
    for gain in [0.85, 0.6] {
        let mut rig = Rig::new(1, 20, 1);
        rig.run(|a| *a.volts[0] *= if a.cycle > 5.0 { gain } else { 1.0 });
        rig.bench.rig.stop();
        for _ in 0..6000 {
            rig.tick(|_| {});
        }
        let _ = rig.bench.rig.clear();
        rig.bench.rig.clear_events();
        rig.bench.rig.start().unwrap();
        rig.tick = 0;
        let run = rig.run(|_| {});
        assert_eq!(run.state, State::Done);
        assert!(run.furthest < 1.03, "{gain}: {}", run.furthest);
    }
}

/// The largest speed is that of the way to the start, 0.25 mm in half a second.
#[test]
fn a_start_where_the_piston_is_not_goes_there_slowly() {
    let mut rig = Rig::new(1, 3, 1);
    // A stop at the crest leaves the piston where it is.
    rig.run_until_crest();
    rig.bench.rig.stop();
    for _ in 0..6000 {
        rig.tick(|_| {});
    }
    let left = rig.bench.plant.servo.displacement();
    assert!(left.abs() > 0.05, "{left}");
    rig.bench.rig.start().unwrap();
    // For its dead time of a millisecond the servo sees the command of before: what that moves it by.
    for _ in 0..200 {
        rig.tick(|_| {});
    }
    assert!((rig.bench.plant.servo.displacement() - left).abs() < 0.015);
    let mut fastest = 0.0f64;
    for _ in 0..4000 {
        let (_, seen) = rig.tick(|_| {});
        assert_eq!(seen.state, State::Running);
        fastest = fastest.max(rig.bench.plant.servo.velocity().abs());
    }
    let way = left.abs() / 0.5;
    assert!(fastest < 1.1 * way, "{fastest} mm/s of {way}");
    rig.tick = 0;
    assert_eq!(rig.run(|_| {}).state, State::Done);
}

impl Rig {
    fn run_until_crest(&mut self) {
        // A ramp, and a cycle and a quarter.
        for _ in 0..(2.25 * TICK_RATE / FREQUENCY) as u32 {
            self.tick(|_| {});
        }
    }
}

#[test]
fn no_temperature_hides_a_break() {
    let shown: [fn(f64) -> f64; 5] = [
        // For one tick, and for good.
        |cycle| {
            if (25.5..25.501).contains(&cycle) {
                f64::NAN
            } else {
                20.0
            }
        },
        |cycle| if cycle > 25.0 { f64::NAN } else { 20.0 },
        |cycle| if cycle > 25.0 { 1372.0 } else { 20.0 },
        |cycle| if cycle > BEGINS { f64::INFINITY } else { 20.0 },
        |cycle| if cycle > BEGINS { 50.0 } else { 20.0 },
    ];
    for seed in 0..SEEDS {
        for shown in shown {
            let run = run(seed, |a| {
                *a.temperature = shown(a.cycle);
                if a.is_on() {
                    a.condition.stiffness = 0.8;
                    a.condition.friction = 0.8;
                }
            });
            let causes = run.causes();
            let expected = [
                HealthCause::TemperatureImplausible,
                HealthCause::WireBreakage,
            ];
            assert_eq!(causes, expected, "{seed}");
            let (cycle, _) = *run.events.last().unwrap();
            assert!(cycle - BEGINS < 5.0, "{cycle}");
        }
    }
}

#[test]
fn what_rises_is_called_what_it_is() {
    for seed in 0..SEEDS {
        for (stiffness, friction, cause) in [
            (1.0, 1.2, HealthCause::FrictionRise),
            (1.0, 1.5, HealthCause::FrictionRise),
            (1.2, 1.0, HealthCause::Stiffening),
        ] {
            let run = run(seed, |a| {
                if a.is_on() {
                    a.condition.stiffness = stiffness;
                    a.condition.friction = friction;
                }
            });
            let (cycle, event) = run.first();
            assert_eq!(event.cause, cause, "{seed}");
            assert!(cycle - BEGINS < 5.0);
        }
    }
}

/// 50 Hz on either channel.
#[test]
fn hum_is_no_damage() {
    for seed in 0..SEEDS {
        for (channel, name, part) in [
            (0, Channel::Displacement, 0.02),
            (0, Channel::Displacement, 0.1),
            (1, Channel::Force, 0.05),
            (1, Channel::Force, 0.2),
        ] {
            let run = run(seed, |a| {
                if a.is_on() {
                    let hum = (TAU * 50.0 * a.tick as f64 / TICK_RATE).sin();
                    *a.volts[channel] += part * a.amplitudes[channel] * hum;
                }
            });
            assert_eq!(
                run.causes(),
                [HealthCause::SensorNoisy(name)],
                "{part}, {seed}"
            );
        }
    }
}

/// While hum is in every cycle none is watched, until it is taken for normal. What broke meanwhile is not.
#[test]
fn a_break_behind_hum_is_told_once_the_hum_is_normal() {
    for seed in 0..SEEDS {
        for (channel, part) in [(0, 0.05), (1, 0.2)] {
            for broken in [1.0, 0.7] {
                let run = Rig::new(1, 80, seed).run(|a| {
                    if a.is_on() {
                        let hum = (TAU * 50.0 * a.tick as f64 / TICK_RATE).sin();
                        *a.volts[channel] += part * a.amplitudes[channel] * hum;
                    }
                    if a.cycle > BEGINS + 6.0 {
                        a.condition.stiffness = broken;
                        a.condition.friction = broken;
                    }
                });
                let causes = run.causes();
                assert!(
                    matches!(causes[0], HealthCause::SensorNoisy(_)),
                    "{causes:?}"
                );
                let broke = HealthCause::WireBreakage;
                let expected = if broken < 1.0 {
                    vec![broke]
                } else {
                    Vec::new()
                };
                assert_eq!(causes[1..], expected, "{channel}, {seed}");
            }
        }
    }
}

#[test]
fn a_break_while_it_learns_is_a_loss() {
    for seed in 0..SEEDS {
        let run = run(seed, |a| {
            if a.cycle > 11.0 {
                a.condition.stiffness = 0.8;
                a.condition.friction = 0.8;
            }
        });
        let (cycle, event) = run.events[0];
        assert_eq!(event.cause, HealthCause::WireBreakage);
        // Three of the least size that is to be found.
        assert!((event.limit - 0.15).abs() < 1e-6, "{event:?}");
        assert!(
            (event.value + 0.2).abs() < 0.03 && cycle < 15.0,
            "{event:?} in {cycle}"
        );
    }
}

#[test]
fn short_blocks_of_one_motion_are_watched_as_one() {
    for seed in 0..SEEDS {
        let run = Rig::new(12, 12, seed).run(|a| {
            if a.cycle > 60.0 {
                a.condition.stiffness = 0.7;
                a.condition.friction = 0.7;
            }
        });
        assert_eq!(run.state, State::Done);
        assert_eq!(run.causes(), [HealthCause::WireBreakage]);
        assert!(run.first().0 < 66.0);
        // So little that it would be no more than a run-in in a block that is learned anew.
        let run = Rig::new(12, 12, seed).run(|a| {
            if a.cycle > 60.0 {
                a.condition.stiffness = 0.9;
                a.condition.friction = 0.9;
            }
        });
        assert_eq!(run.causes(), [HealthCause::WireBreakage]);
        let healthy = Rig::new(12, 12, seed).run(|_| {});
        assert_eq!(healthy.causes(), []);
    }
}

/// A specimen of 1.6 times its law, which loses as much more of the law's force as it is more of it. By 8 °C in 40 cycles: 5 % of the law's.
#[test]
fn warmth_is_no_fault_of_a_specimen_that_is_more_than_its_law() {
    for seed in 0..SEEDS {
        let run = Rig::new(1, 80, seed).run(|a| {
            let warming = 8.0 * ((a.cycle - BEGINS) / 2.0).clamp(0.0, 1.0);
            a.condition.stiffness = 1.6;
            a.condition.friction = 1.6;
            a.condition.warm_loss = 0.004;
            a.condition.temperature = 20.0 + warming;
            *a.temperature = a.condition.temperature;
        });
        // Its size is told at the start.
        let told = run.causes();
        assert!(
            told.iter().all(|cause| matches!(
                cause,
                HealthCause::LawMismatch | HealthCause::RunIn | HealthCause::Temperature
            )),
            "{told:?}"
        );
    }
}

#[test]
fn a_run_in_hides_no_more_than_a_run_in() {
    for seed in 0..2 {
        let run = Rig::new(1, 200, seed).run(|a| {
            let part = 1.0 - 0.4 * ((a.cycle - 21.0) / 170.0).clamp(0.0, 1.0);
            a.condition.stiffness = part;
            a.condition.friction = part;
        });
        let (cycle, event) = run.events[0];
        assert_eq!(event.cause, HealthCause::WireBreakage);
        // 15 % of it, of which a third is gone when it has learned.
        assert!(cycle < 110.0, "{cycle}");
    }
}

#[test]
fn what_is_wrong_from_the_start_is_told_in_the_first_cycles() {
    for seed in 0..SEEDS {
        let reversed = run(seed, |a| *a.volts[1] = -*a.volts[1]);
        let (cycle, event) = reversed.events[0];
        assert_eq!(event.cause, HealthCause::SensorReversed(Channel::Force));
        assert!(cycle < 5.0, "{cycle}");
        let halved = run(seed, |a| *a.volts[1] *= 0.5);
        let (cycle, event) = halved.events[0];
        assert_eq!(event.cause, HealthCause::LawMismatch);
        assert_eq!(event.or, Some(HealthCause::SensorGain(Channel::Force)));
        assert!(cycle < 5.0, "{cycle}");
        // The channels are swapped, or the displacement is reversed: a limit stops it.
        let mut swapped = run(seed, |a| {
            let [displacement, force] = &mut a.volts;
            std::mem::swap(*displacement, *force);
        });
        assert!(matches!(swapped.state, State::Faulted(_)) && swapped.cycles < 3.0);
        swapped = run(seed, |a| *a.volts[0] = -*a.volts[0]);
        assert!(matches!(swapped.state, State::Faulted(_)) && swapped.cycles < 3.0);
    }
}
