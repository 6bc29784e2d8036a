//! Rig and damper emulation on converters that deliver anything. Every part fails, stops, starts and is swapped at any moment.

use std::ops::{Deref as _, DerefMut as _};
use std::rc::Rc;

use mesh_damper::adc::Ads8688;
use mesh_damper::converter::Scale;
use mesh_damper::dac::Ad5761;
use mesh_damper::effects::CONTROLS;
use mesh_damper::error::ConfigError;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::health::HealthSettings;
use mesh_damper::rig::{
    ClearRefused, DamperEmulation, DamperEmulationSettings, EmulationController, Rig,
    RigController, RigSettings, SpiActuator, StartRefused, State, Telemetry, Wiring, WithControls,
};
use mesh_damper::sine::{Block, Programme, SineGenerator};

use crate::feed::{Feed, Random};
use crate::law::{EFFECTS, law};
use crate::motion::is_finite;
use crate::wires::{Adc, Dac, Line, Wires};

const BLOCKS: usize = 3;
const ZERO: u16 = 0x8000;

/// The operations of both controllers.
trait Controller {
    fn start(&mut self) -> Result<(), StartRefused>;
    fn stop(&mut self);
    fn external_trip(&mut self);
    fn clear(&mut self) -> Result<(), ClearRefused>;
    fn swap_law(&mut self, law: FastLaw<EFFECTS>);
    fn set_temperature(&mut self, temperature: f32);
    fn set_controls(&mut self, controls: [f32; CONTROLS]);
    fn state(&self) -> State;
    fn driven(&self) -> f32;
    fn tick(&mut self, clock: u32) -> Telemetry;
}

macro_rules! controller {
    ($role:ty) => {
        impl Controller for $role {
            fn start(&mut self) -> Result<(), StartRefused> {
                self.start()
            }
            fn stop(&mut self) {
                self.stop();
            }
            fn external_trip(&mut self) {
                self.external_trip();
            }
            fn clear(&mut self) -> Result<(), ClearRefused> {
                self.clear()
            }
            fn swap_law(&mut self, law: FastLaw<EFFECTS>) {
                self.deref_mut().swap_law(law);
            }
            fn set_temperature(&mut self, temperature: f32) {
                self.deref_mut().set_temperature(temperature);
            }
            fn set_controls(&mut self, controls: [f32; CONTROLS]) {
                self.sensors().controls = controls;
            }
            fn state(&self) -> State {
                self.state()
            }
            fn driven(&self) -> f32 {
                mesh_damper::rig::Controller::driven(self.deref())
            }
            fn tick(&mut self, clock: u32) -> Telemetry {
                self.tick(clock)
            }
        }
    };
}

type Channels = WithControls<Ads8688<Adc>>;
type Driver = SpiActuator<Dac, Line>;

controller!(Rig<Channels, Driver, EFFECTS, SineGenerator<BLOCKS>>);
controller!(DamperEmulation<Channels, Driver, RunningLaw<EFFECTS>>);

/// The wiring of the converters, without a control input, and their scales.
fn wired(adc: Ads8688<Adc>, dac: Ad5761<Dac>, guard: &Guard) -> (Wiring, Channels, Driver) {
    let [displacement, force] = adc.scales();
    let wiring = Wiring {
        displacement,
        force,
        command: guard.command,
    };
    let sensors = WithControls {
        sensors: adc,
        controls: [0.0; CONTROLS],
    };
    let line = Line(guard.wires.clone());
    (wiring, sensors, SpiActuator::new(dac, line))
}

/// The guarantees that hold at every tick, and the state that is needed to check them.
struct Guard {
    wires: Rc<Wires>,
    command: Scale,
    displacement_limit: f32,
    force_limit: f32,
    /// Largest value that is driven, in the command's unit.
    most: f32,
    trip_ticks: u32,
    stop_ticks: u32,
    /// Consecutive ticks beyond the limits of displacement and force.
    exceeded: [u32; 2],
    /// Ticks since the trip on which the DAC accepted the command.
    stopped: u64,
    last: f32,
    /// Clock counts per tick.
    counts: u32,
    /// Whether a tick took no time or the time of two.
    late: bool,
}

impl Guard {
    fn see(&mut self, before: State, now: &Telemetry) {
        for value in [
            now.displacement,
            now.velocity,
            now.measured_force,
            now.model_force,
            now.command,
        ] {
            assert!(value.is_finite(), "{now:?}");
        }
        if let Some(report) = &now.report {
            let finite = is_finite(&report.measured) && is_finite(&report.model);
            assert!(finite && report.nrmse.is_finite(), "{report:?}");
        }
        let driven = self.command.decode(self.wires.driven.get()).value;
        if !self.wires.dac_fails.get() {
            let step = self.command.step().abs();
            assert!((driven - now.command).abs() <= step, "{driven} for {now:?}");
        }
        let step = self.command.step().abs();
        assert!(
            now.command.abs() <= self.most + step,
            "{now:?} beyond {}",
            self.most
        );
        if now.state == State::Running {
            self.see_running(before, now);
        } else {
            self.see_stopped(before, now);
        }
        if let (State::Faulted(first), State::Faulted(second)) = (before, now.state) {
            assert_eq!(first, second, "the first cause stays");
        }
        self.last = now.command;
    }

    /// A start of a controller that was not running was `refused`: the reason matches its state.
    fn see_refusal(&self, state: State, refused: StartRefused) {
        match refused {
            StartRefused::Faulted(cause) => assert_eq!(state, State::Faulted(cause)),
            StartRefused::Moving => assert!(matches!(state, State::Idle | State::Done)),
            StartRefused::Running => panic!("it was not running"),
        }
    }

    fn see_running(&mut self, before: State, now: &Telemetry) {
        assert_eq!(before, State::Running, "only a start makes it run");
        assert!(!self.late, "a late tick stops it");
        assert!(self.wires.enabled.get());
        let beyond = [
            now.displacement.abs() > self.displacement_limit,
            now.measured_force.abs() > self.force_limit,
        ];
        for (count, beyond) in self.exceeded.iter_mut().zip(beyond) {
            *count = if beyond { *count + 1 } else { 0 };
            assert!(*count < self.trip_ticks, "a limit exceeded: {now:?}");
        }
        self.stopped = 0;
    }

    fn see_stopped(&mut self, before: State, now: &Telemetry) {
        self.exceeded = [0; 2];
        if before == State::Running {
            self.stopped = 0;
        }
        if !self.wires.line_fails.get() {
            assert!(!self.wires.enabled.get(), "{now:?}");
        }
        if self.wires.dac_fails.get() {
            return;
        }
        // On the tick of the trip, the DAC may still drive the command in progress.
        let goes_back = now.command.abs() <= self.last.abs();
        assert!(
            before == State::Running || goes_back,
            "{now:?} after {}",
            self.last
        );
        self.stopped += 1;
        // A straight line, in steps that f32 rounds.
        let ticks = f64::from(self.stop_ticks);
        let most = ticks + 3.0 + ticks * ticks / f64::from(1 << 22);
        assert!(
            now.command == 0.0 || (self.stopped as f64) <= most,
            "{now:?}"
        );
    }
}

/// The response to the DAC, on both channels of the ADC.
#[derive(Clone, Copy)]
enum Plant {
    /// Follows, with noise.
    Follows,
    /// No longer moves.
    Stuck,
    /// Moves to one end.
    Runs,
    /// Any code.
    Anything,
}

impl Plant {
    fn sense(self, wires: &Wires, ratio: f64, random: &mut Random) {
        let [displacement, force] = &wires.channels;
        let drawn = random.next();
        match self {
            Self::Follows => {
                let driven = f64::from(wires.driven.get()) - f64::from(ZERO);
                let noise = (drawn % 9) as f64 - 4.0;
                let code = (f64::from(ZERO) + ratio * driven + noise) as u16;
                displacement.set(code.clamp(1, u16::MAX - 1));
                force.set(ZERO.wrapping_add((code.wrapping_sub(ZERO) as i16 / 4) as u16));
            }
            Self::Stuck => {}
            Self::Runs => {
                let code = displacement.get().saturating_add((drawn % 64) as u16);
                displacement.set(code);
            }
            Self::Anything => {
                displacement.set(drawn as u16);
                force.set((drawn >> 16) as u16);
            }
        }
    }
}

/// A rig or an emulation with any settings for `ticks` ticks.
///
/// Every reported number is finite, except the control inputs, which are those of the last reading. The DAC drives the reported
/// command, never beyond its range. A limit that is exceeded for the permitted number of ticks trips the controller. After a trip the
/// enable line is low and the command returns to 0 in the specified time, whatever the input. Returns the number of ticks on which it
/// was running.
pub fn check(script: &[u8], ticks: u32) -> u64 {
    let feed = &mut Feed(script);
    let wires = Rc::new(Wires::default());
    for channel in &wires.channels {
        channel.set(ZERO);
    }
    let [travel, force, command] = if feed.byte() % 4 == 0 {
        [(); 3].map(|()| feed.either(1e-6, 1e6))
    } else {
        [1.0, 5.0, 1.0]
    };
    let [travel, force, command] = [travel, force, command]
        .map(|full_scale| Scale::new(full_scale, 0.0).expect("it is in range"));
    let adc = Adc {
        wires: wires.clone(),
        selected: 0,
        registers: [0; 128],
    };
    let dac = Dac {
        wires: wires.clone(),
        control: 0,
        answer: 0,
    };
    let adc = Ads8688::new(adc, travel, force).expect("its bus is sound");
    let dac = Ad5761::new(dac, command).expect("its bus is sound");
    let guard = Guard {
        wires: wires.clone(),
        command,
        displacement_limit: 0.0,
        force_limit: 0.0,
        most: command.full_scale().abs(),
        trip_ticks: 0,
        stop_ticks: 0,
        exceeded: [0; 2],
        stopped: u64::MAX / 2,
        last: 0.0,
        counts: feed.one_of(&[1, 1, 10, 1001]),
        late: false,
    };
    let is_emulator = feed.byte() % 4 == 0;
    let ran = if is_emulator {
        emulator(feed, adc, dac, guard, script, ticks)
    } else {
        rig(feed, adc, dac, guard, script, ticks)
    };
    // A refused configuration gives nothing to check.
    ran.unwrap_or_default()
}

fn rig(
    feed: &mut Feed<'_>,
    adc: Ads8688<Adc>,
    dac: Ad5761<Dac>,
    mut guard: Guard,
    script: &[u8],
    ticks: u32,
) -> Result<u64, ConfigError> {
    let tick_rate = feed.one_of(&[1e4, 1e4, 1e3, 1e2, 1e5]);
    let settings = if feed.byte().is_multiple_of(2) {
        RigSettings {
            stop_ticks: 200,
            observer_bandwidth: 2e-3 * tick_rate,
            feedback: 5e-4 * tick_rate,
            glide: 50.0 / tick_rate,
            health: HealthSettings {
                learning_cycles: 8,
                follow: 0.5 * feed.part(),
                ..HealthSettings::default()
            },
            ..RigSettings::default()
        }
    } else {
        RigSettings {
            displacement_limit: feed.between(1e-6, 1e4),
            force_limit: feed.between(1e-6, 1e9),
            tracking_limit: feed.between(1e-6, 1e4),
            trip_ticks: feed.between(1.0, 1e3) as u32,
            stop_ticks: feed.between(1.0, 1e4) as u32,
            observer_bandwidth: feed.between(1e-3, 0.1 * tick_rate),
            observer_damping: feed.between(0.3, 3.0),
            correction_gain: feed.part(),
            correction_limit: feed.between(0.01, 10.0),
            lead: 0.1 * feed.part(),
            glide: feed.between(1.0 / tick_rate, 10.0),
            feedback: 0.01 * tick_rate * feed.part(),
            temperature_range: [-273.0 * feed.part(), 2000.0 * feed.part()],
            temperature_rate: feed.between(1e-3, 1e3),
            link_ticks: 0,
            clock_rate: f64::from(guard.counts) * tick_rate,
            health: HealthSettings {
                size: feed.between(0.01, 0.5),
                false_alarm_cycles: feed.between(1e2, 1e9),
                learning_cycles: feed.between(8.0, 1e3) as u32,
                run_in_cycles: feed.between(1.0, 1e6) as u32,
                temperature_slope: 0.1 * feed.part(),
                run_in_size: feed.between(0.01, 1.0),
                follow: 0.5 * feed.part(),
            },
        }
    };
    let mut programme = Programme::<BLOCKS>::new(tick_rate, 1)?;
    for _ in 0..=feed.byte() % BLOCKS as u8 {
        let amplitude = f64::from(guard.command.full_scale().abs()) * feed.between(1e-3, 1.0);
        let mut frequency = || tick_rate * feed.between(1e-3, 0.25);
        let (from, to) = (frequency(), frequency());
        // Sometimes enough cycles for the monitor to learn the normal state.
        let cycles = if feed.byte().is_multiple_of(8) {
            65
        } else {
            1 + u32::from(feed.byte() % 8)
        };
        programme = programme.with(Block::sweep(amplitude, from, to, cycles)?)?;
    }
    let laws = [law(feed, 1.0 / tick_rate), law(feed, 1.0 / tick_rate)].map(FastLaw::new);
    guard.displacement_limit = settings.displacement_limit as f32;
    guard.force_limit = settings.force_limit as f32;
    guard.trip_ticks = settings.trip_ticks;
    guard.stop_ticks = settings.stop_ticks;
    let (wiring, sensors, actuator) = wired(adc, dac, &guard);
    let running = RunningLaw::new(laws[0].clone());
    let controller = RigController::new(&settings, &wiring, programme, running)?;
    let rig = Rig::wire(controller, sensors, actuator);
    Ok(run(rig, guard, &laws, script, ticks))
}

fn emulator(
    feed: &mut Feed<'_>,
    adc: Ads8688<Adc>,
    dac: Ad5761<Dac>,
    mut guard: Guard,
    script: &[u8],
    ticks: u32,
) -> Result<u64, ConfigError> {
    let tick_rate = feed.between(1.0, 1e6);
    let settings = DamperEmulationSettings {
        tick_rate,
        displacement_limit: feed.between(1e-6, 1e4),
        force_limit: feed.between(1e-6, 1e9),
        trip_ticks: feed.between(1.0, 1e3) as u32,
        stop_ticks: feed.between(1.0, 1e4) as u32,
        link_ticks: 0,
        clock_rate: f64::from(guard.counts) * tick_rate,
        observer_bandwidth: feed.between(1e-3, 1.0) * 0.1 * tick_rate,
        observer_damping: feed.between(0.3, 3.0),
        rest_band: feed.part(),
        stuck_ticks: feed.between(1.0, 1e6) as u32,
        temperature_range: [-273.0 * feed.part(), 2000.0 * feed.part()],
        temperature_rate: feed.between(1e-3, 1e3),
        hysteresis: feed.between(1e-9, 1e4),
    };
    let laws = [law(feed, 1.0 / tick_rate), law(feed, 1.0 / tick_rate)].map(FastLaw::new);
    guard.displacement_limit = settings.displacement_limit as f32;
    guard.force_limit = settings.force_limit as f32;
    guard.most = guard.most.min(guard.force_limit);
    guard.trip_ticks = settings.trip_ticks;
    guard.stop_ticks = settings.stop_ticks;
    let (wiring, sensors, actuator) = wired(adc, dac, &guard);
    let running = RunningLaw::new(laws[0].clone());
    let controller = EmulationController::new(&settings, &wiring, running)?;
    let emulator = DamperEmulation::wire(controller, sensors, actuator);
    Ok(run(emulator, guard, &laws, script, ticks))
}

/// Ticks between two events, on average.
const BETWEEN: u64 = 128;

fn run(
    mut controller: impl Controller,
    mut guard: Guard,
    laws: &[FastLaw<EFFECTS>; 2],
    script: &[u8],
    ticks: u32,
) -> u64 {
    let wires = guard.wires.clone();
    let mut random = Random::of(script);
    let mut plant = Plant::Follows;
    let mut ratio = 1.0;
    let mut ran = 0;
    // The first tick is not checked.
    let (mut clock, mut begun) = (u32::MAX - ticks, false);
    // The control inputs of the sensors, and those of the last reading that did not fail.
    let (mut given, mut read) = ([0.0; CONTROLS], [0.0; CONTROLS]);
    controller.start().expect("it is at rest");
    for _ in 0..ticks {
        let drawn = random.next();
        if drawn.is_multiple_of(BETWEEN) {
            match drawn / BETWEEN % 19 {
                0 => plant = Plant::Stuck,
                1 => plant = Plant::Runs,
                2 => plant = Plant::Anything,
                3 => ratio = 2.0 * (drawn >> 32) as f64 / f64::from(u32::MAX),
                4 => wires.adc_fails.set(true),
                5 => wires.dac_fails.set(true),
                6 => wires.line_fails.set(true),
                7 => controller.stop(),
                8 => controller.set_temperature(random.float()),
                9 | 10 => controller.swap_law(laws[(drawn >> 40) as usize % 2].clone()),
                11 => {
                    given = given.map(|_| random.float());
                    controller.set_controls(given);
                }
                12 => guard.late = true,
                13 => {
                    controller.external_trip();
                    assert!(matches!(controller.state(), State::Faulted(_)));
                }
                _ => {
                    plant = Plant::Follows;
                    wires.adc_fails.set(false);
                    wires.dac_fails.set(false);
                    wires.line_fails.set(false);
                }
            }
        }
        // The operator of the rig tries to start it again and again.
        if drawn >> 32 & 0xf == 0 && controller.state() != State::Running {
            let before = controller.state();
            if controller.clear().is_err() {
                assert_eq!(controller.state(), before, "the cause stays");
            }
            match controller.start() {
                Ok(()) => guard.exceeded = [0; 2],
                Err(refused) => guard.see_refusal(controller.state(), refused),
            }
            // The controller drives to the position of the piston before the line rises. If the line does not rise, the command
            // returns from there.
            guard.last = controller.driven();
            guard.stopped = 0;
        }
        plant.sense(&wires, ratio, &mut random);
        let before = controller.state();
        let elapsed = match guard.late {
            false => guard.counts,
            true => guard.counts * 2 * (drawn >> 50 & 1) as u32,
        };
        clock = clock.wrapping_add(elapsed);
        let telemetry = controller.tick(clock);
        guard.late &= begun;
        guard.see(before, &telemetry);
        (guard.late, begun) = (false, true);
        if !wires.adc_fails.get() {
            read = given;
        }
        // As received, including special values: the law clamps them.
        assert_eq!(
            telemetry.controls.map(f32::to_bits),
            read.map(f32::to_bits),
            "{telemetry:?}"
        );
        ran += u64::from(telemetry.state == State::Running);
    }
    ran
}
