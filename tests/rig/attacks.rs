//! Attacks: faults without a name, which act on the signals and on the specimen, over twelve seeds of noise each.

mod restart;
mod signals;
mod specimen;

use std::cell::Cell;
use std::f64::consts::TAU;
use std::rc::Rc;

use mesh_damper::effects::AugmentedLaw;
use mesh_damper::health::{Event, HealthCause};
use mesh_damper::law::Law;
use mesh_damper::rig::{State, Telemetry};
use mesh_damper::sine::{Block, Programme};
use mesh_damper_rig::campaign::{Condition, Damaged};
use mesh_damper_rig::{Bench, RigSetup, TICK_RATE};

const SEEDS: u64 = 12;
const AMPLITUDE: f64 = 0.1;
const FREQUENCY: f64 = 2.0;
/// Voltage at a channel's full scale, V.
const FULL: f64 = 10.24;
/// Cycles after the start at which attacks begin, the ramp included.
const BEGINS: f64 = 31.0;

/// The signals and the condition that an attack may change at a tick.
struct Attacked<'a> {
    /// Cycles since the start.
    cycle: f64,
    tick: u64,
    /// Voltages of displacement and force, V, and the amplitude of each.
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

/// The result of a run.
struct Run {
    events: Vec<(f64, Event)>,
    state: State,
    /// Cycles until the trip or the end of the run.
    cycles: f64,
    /// Largest true displacement over the demanded one.
    furthest: f64,
    /// Most consecutive ticks with a force beyond 1.01 times its limit.
    beyond: u32,
}

impl Run {
    fn causes(&self) -> Vec<HealthCause> {
        self.events.iter().map(|(_, event)| event.cause).collect()
    }

    /// The first event after the start of the attack, and its cycle.
    fn first(&self) -> (f64, Event) {
        let mut events = self.events.iter().filter(|(cycle, _)| *cycle >= BEGINS);
        *events.next().expect("an event")
    }
}

impl Rig {
    fn new(blocks: u32, cycles: u32, seed: u64) -> Self {
        Self::limited(blocks, cycles, seed, 1.9)
    }

    /// With a force limit of `limit` times its amplitude.
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

/// Noise of −0.5 to 0.5 that differs at each tick.
fn noise(tick: u64) -> f64 {
    let mut x = tick.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x ^= x >> 29;
    x = x.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x ^= x >> 32;
    (x >> 11) as f64 / (1u64 << 53) as f64 - 0.5
}

impl Rig {
    fn run_until_crest(&mut self) {
        // A ramp, and a cycle and a quarter.
        for _ in 0..(2.25 * TICK_RATE / FREQUENCY) as u32 {
            self.tick(|_| {});
        }
    }
}
