//! The controllers without I/O, called directly, and with sensors and actuators that know no SPI.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use mesh_damper::converter::{Sample, Scale};
use mesh_damper::effects::{AugmentedLaw, CONTROLS, Effect, Motion, StickSlip};
use mesh_damper::fast_law::{Adaptation, FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::rig::{
    Actuator, AnyExciter, Blocking, Controller, DamperEmulation, DamperEmulationSettings,
    EmulationController, Reading, Rig, RigController, RigSettings, Sensors, StartRefused, State,
    Telemetry, TripCause, Wiring, WithControls,
};
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper::tick_law::TickLaw;
use mesh_damper_rig::actuator::{SensorFault, adc_code, dac_volts};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Bench, EmulatorBench, EmulatorSetup, RigSetup};

use crate::Ticks;

const TICK_RATE: f64 = 10_000.0;

fn unit() -> Scale {
    Scale::new(1.0, 0.0).unwrap()
}

fn units() -> Wiring {
    Wiring {
        displacement: unit(),
        force: unit(),
        command: unit(),
    }
}

fn elastic() -> AugmentedLaw<f32, 1> {
    AugmentedLaw::new(Law::new(1.0, 0.0, 0.0, 0.0).unwrap())
}

fn programme(cycles: u32) -> Programme<2> {
    let programme = Programme::new(TICK_RATE, 1).unwrap();
    programme
        .with(Block::sine(0.2, 10.0, cycles).unwrap())
        .unwrap()
        .with(Block::sine(0.1, 20.0, cycles).unwrap())
        .unwrap()
}

/// What the ADC of a bench gives at this tick.
fn reading(wiring: &Wiring, volts: [f64; 2]) -> Reading {
    let [displacement, force] = volts.map(adc_code);
    Reading {
        displacement: wiring.displacement.decode(displacement),
        force: wiring.force.decode(force),
        controls: [0.0; CONTROLS],
    }
}

/// What happens to a run at half of it.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Halfway {
    Nothing,
    AdcFails,
    DacFails,
    SensorOpens,
    Late,
    Stopped,
}

/// Closed over the simulated specimen, the rig on its simulated converters; beside it the controller is given what the ADC
/// converts, and gives what the DAC and the line get.
#[test]
fn called_directly_it_is_the_rig_on_its_converters() {
    for (halfway, expected) in [
        (Halfway::Nothing, State::Done),
        (Halfway::AdcFails, State::Faulted(TripCause::AdcBus)),
        (Halfway::DacFails, State::Faulted(TripCause::DacBus)),
        (
            Halfway::SensorOpens,
            State::Faulted(TripCause::DisplacementClipped),
        ),
        (Halfway::Late, State::Faulted(TripCause::TickOverrun)),
        (Halfway::Stopped, State::Idle),
    ] {
        let specimen = Specimen::of_density(3.0, 0.2);
        let c = specimen.coefficients();
        let law = Law::new(c.k1 as f32, c.k3 as f32, c.c as f32, c.alpha as f32).unwrap();
        let law = AugmentedLaw::<f32, 1>::new(law);
        let mut setup = RigSetup::<_, 2, 1>::new(specimen, law, programme(6), 1);
        setup.settings.stop_ticks = 500;
        setup.settings.health.follow = 0.1;
        let scale = |full_scale| Scale::new(full_scale, 0.0).unwrap();
        let wiring = Wiring {
            displacement: scale(setup.displacement_sensor.full_scale),
            force: scale(setup.force_sensor.full_scale),
            command: scale(setup.command_range),
        };
        let mut direct = RigController::new(
            &setup.settings,
            &wiring,
            setup.programme.clone(),
            RunningLaw::new(FastLaw::new(setup.law.clone())),
        )
        .unwrap();
        let mut bench = Bench::new(setup).unwrap();
        bench.rig.start().unwrap();
        direct.start().unwrap();
        let mut reports = 0;
        for tick in 0..16_000 {
            let failing = (6000..6010).contains(&tick);
            bench
                .adc
                .bus_failing
                .set(failing && halfway == Halfway::AdcFails);
            bench
                .dac
                .bus_failing
                .set(failing && halfway == Halfway::DacFails);
            if tick == 6000 {
                match halfway {
                    Halfway::SensorOpens => {
                        bench.plant.displacement_sensor.fault = SensorFault::Open;
                    }
                    Halfway::Late => {
                        bench.rig.overrun();
                        direct.overrun();
                    }
                    Halfway::Stopped => {
                        bench.rig.stop();
                        direct.stop();
                    }
                    _ => {}
                }
            }
            direct.set_temperature(bench.plant.temperature() as f32);
            let one = bench.tick();
            let volts = [bench.adc.volts[0].get(), bench.adc.volts[1].get()];
            let read = (!bench.adc.bus_failing.get()).then(|| reading(&wiring, volts));
            let seen = direct.tick(read, tick);
            let command = seen.to_drive();
            let mut enabled = command.enabled;
            if bench.dac.bus_failing.get() {
                direct.command_failed();
                enabled = false;
            } else {
                let driven = dac_volts(wiring.command.encode(command.value).code);
                assert_eq!(driven, bench.dac.volts.get(), "{halfway:?}, tick {tick}");
            }
            let two = Telemetry {
                command: direct.driven(),
                state: direct.state(),
                ..seen
            };
            assert_eq!(one, two, "{halfway:?}, tick {tick}");
            assert_eq!(enabled, bench.enabled.get(), "{halfway:?}, tick {tick}");
            reports += u32::from(one.report.is_some());
        }
        assert_eq!(direct.state(), expected);
        assert_eq!(direct.events(), bench.rig.events());
        assert!(reports >= 4, "{halfway:?}: {reports}");
    }
}

#[test]
fn a_damper_called_directly_is_the_one_on_its_converters() {
    let slider = StickSlip::new(&[(0.5, 0.02)]).unwrap();
    let law = AugmentedLaw::<f32, 2>::new(Law::new(1.5, 20.0, 0.05, 0.3).unwrap())
        .with(Effect::StickSlip(slider))
        .unwrap();
    let setup = EmulatorSetup::new(law);
    let wiring = Wiring {
        displacement: unit(),
        force: Scale::new(setup.force_range, 0.0).unwrap(),
        command: Scale::new(setup.force_range, 0.0).unwrap(),
    };
    let law = RunningLaw::new(FastLaw::new(setup.law.clone()));
    let mut direct = EmulationController::new(&setup.settings, &wiring, law).unwrap();
    let mut bench = EmulatorBench::new(setup).unwrap();
    bench.emulator.start().unwrap();
    direct.start().unwrap();
    let mut reports = 0;
    for tick in 0..20_000 {
        let displacement = 0.2 * (1e-3 * std::f64::consts::TAU * f64::from(tick)).sin();
        let one = bench.tick(displacement).telemetry;
        let volts = [bench.adc.volts[0].get(), bench.adc.volts[1].get()];
        let two = direct.tick(Some(reading(&wiring, volts)), tick);
        assert_eq!(one, two, "tick {tick}");
        let driven = dac_volts(wiring.command.encode(two.to_drive().value).code);
        assert_eq!(driven, bench.dac.volts.get());
        reports += u32::from(one.report.is_some());
    }
    assert!(reports > 10, "{reports}");
}

/// What was asked of an actuator, in order.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Call {
    Drive(f32),
    Enable(bool),
}

/// An actuator that a timer drives, without codes and without a bus, whose calls fail when they are told to.
#[derive(Clone, Default)]
struct Timer(Rc<RefCell<Calls>>);

#[derive(Default)]
struct Calls {
    made: Vec<Call>,
    /// What it drives.
    value: f32,
    drive_fails: bool,
    enable_fails: bool,
}

impl Actuator for Timer {
    type Error = ();

    fn drive(&mut self, value: f32) -> Result<(), ()> {
        let mut calls = self.0.borrow_mut();
        calls.made.push(Call::Drive(value));
        if calls.drive_fails {
            return Err(());
        }
        calls.value = value;
        Ok(())
    }

    fn enable(&mut self, on: bool) -> Result<(), ()> {
        let mut calls = self.0.borrow_mut();
        calls.made.push(Call::Enable(on));
        if calls.enable_fails { Err(()) } else { Ok(()) }
    }
}

impl Timer {
    /// What was asked since this was asked last.
    fn calls(&self) -> Vec<Call> {
        std::mem::take(&mut self.0.borrow_mut().made)
    }
}

/// An ADC of 12 bits on the chip, beside the timer: what is driven moves at once, with a force in proportion.
struct OnChip {
    timer: Timer,
    scales: [Scale; 2],
}

impl Sensors for OnChip {
    type Error = Infallible;

    fn read(&mut self) -> Result<Reading, Infallible> {
        let value = self.timer.0.borrow().value;
        let [displacement, force] = self.scales;
        // Half a volt to the millimetre and the kilonewton, around half of its range.
        let code = |value: f32| ((0.5 * (value + 1.0)) * 4096.0).round() as u16;
        Ok(Reading {
            displacement: displacement.decode_narrow::<12>(code(value)),
            force: force.decode_narrow::<12>(code(0.9 * value)),
            controls: [0.0; CONTROLS],
        })
    }
}

fn on_chip(cycles: u32) -> (Timer, Rig<OnChip, Timer, 1, SineGenerator<2>>) {
    let timer = Timer::default();
    let settings = RigSettings {
        stop_ticks: 4,
        ..RigSettings::default()
    };
    let law = RunningLaw::new(FastLaw::new(elastic()));
    let controller = RigController::new(&settings, &units(), programme(cycles), law).unwrap();
    let sensors = OnChip {
        timer: timer.clone(),
        scales: [unit(); 2],
    };
    let rig = Rig::wire(controller, sensors, timer.clone());
    assert_eq!(timer.calls(), [Call::Enable(false)]);
    (timer, rig)
}

#[test]
fn an_adc_on_the_chip_runs_a_rig() {
    let (timer, mut rig) = on_chip(5);
    let mut ticks = Ticks::default();
    rig.start().unwrap();
    let mut cycles = Vec::new();
    while rig.state() == State::Running {
        cycles.extend(rig.tick(ticks.next()).report);
    }
    assert_eq!(rig.state(), State::Done);
    let whole: Vec<_> = cycles.iter().filter(|cycle| !cycle.ramp).collect();
    assert_eq!(whole.len(), 10);
    for cycle in whole {
        // A step of 12 bits is 0.5 % of the smaller amplitude.
        let stiffness = cycle.measured.stiffness;
        assert!((stiffness - 0.9).abs() < 5e-3, "{stiffness}");
        assert!((cycle.nrmse - 1.0 / 9.0).abs() < 0.01, "{}", cycle.nrmse);
    }
    // Once high, once low, and a command each tick.
    let lines: Vec<_> = timer
        .calls()
        .into_iter()
        .filter(|call| matches!(call, Call::Enable(_)))
        .collect();
    assert_eq!(lines, [Call::Enable(true), Call::Enable(false)]);
}

#[test]
fn an_actuator_that_fails_is_disabled_in_that_tick() {
    let (timer, mut rig) = on_chip(5);
    let mut ticks = Ticks::default();
    rig.start().unwrap();
    let mut before = 0.0;
    for _ in 0..1500 {
        before = rig.tick(ticks.next()).command;
    }
    assert!(before != 0.0);
    timer.calls();
    timer.0.borrow_mut().drive_fails = true;
    let seen = rig.tick(ticks.next());
    assert_eq!(seen.state, State::Faulted(TripCause::DacBus));
    assert_eq!(seen.command, before, "the command before is what it drives");
    let [Call::Drive(tried), Call::Enable(false)] = timer.calls()[..] else {
        panic!("driven, then disabled");
    };
    assert_ne!(tried, before);
    // From there it goes back to 0 as soon as it is driven again, in four ticks and one.
    timer.0.borrow_mut().drive_fails = false;
    for part in [0.75, 0.5, 0.25, 0.0] {
        assert_eq!(rig.tick(ticks.next()).command, part * before);
    }
    assert_eq!(
        rig.start(),
        Err(StartRefused::Faulted(TripCause::DacBus)),
        "until it is cleared"
    );
    rig.clear().unwrap();
}

#[test]
fn a_trip_disables_before_the_next_command_is_driven() {
    let (timer, mut rig) = on_chip(5);
    let mut ticks = Ticks::default();
    rig.start().unwrap();
    for _ in 0..1500 {
        rig.tick(ticks.next());
    }
    rig.overrun();
    assert_eq!(timer.calls().last(), Some(&Call::Enable(false)));
    rig.tick(ticks.next());
    let [Call::Drive(_)] = timer.calls()[..] else {
        panic!("it is disabled already");
    };
    // A line that does not drop is tried at each tick, before the command.
    let (timer, mut rig) = on_chip(5);
    let mut ticks = Ticks::default();
    rig.start().unwrap();
    for _ in 0..1500 {
        rig.tick(ticks.next());
    }
    timer.0.borrow_mut().enable_fails = true;
    rig.stop();
    assert_eq!(rig.state(), State::Faulted(TripCause::EnableLine));
    timer.calls();
    for _ in 0..3 {
        rig.tick(ticks.next());
        let [Call::Enable(false), Call::Drive(_)] = timer.calls()[..] else {
            panic!("tried again, then driven");
        };
    }
}

/// A law that is the sum of its control inputs, for each mm.
struct Controlled;

impl TickLaw for Controlled {
    fn force(&mut self, motion: &Motion<f32>) -> f32 {
        motion.displacement * motion.controls.iter().sum::<f32>()
    }
    fn rest(&mut self) {}
    fn boundary(&mut self) -> bool {
        false
    }
    fn follow(&mut self, _: Adaptation) {}
    fn followed(&self) -> Adaptation {
        Adaptation::default()
    }
    fn parts(&self, _: &Motion<f32>) -> [f32; 3] {
        [0.0; 3]
    }
}

#[test]
fn control_inputs_reach_the_law_and_the_telemetry() {
    let settings = DamperEmulationSettings::default();
    let mut damper = EmulationController::new(&settings, &units(), Controlled).unwrap();
    let at = |controls| Reading {
        displacement: unit().decode(0xA000),
        force: Sample::default(),
        controls,
    };
    let said = |seen: Telemetry| (seen.model_force, seen.controls);
    // 0xA000 is 0.25 mm.
    let given = [1.0, 0.0, 0.5, 0.0];
    assert_eq!(said(damper.tick(Some(at(given)), 0)), (0.375, given));
    // Where reading fails, the last ones stay.
    assert_eq!(said(damper.tick(None, 1)), (0.375, given));
    assert_eq!(damper.state(), State::Faulted(TripCause::AdcBus));
    let none = [0.0; CONTROLS];
    assert_eq!(said(damper.tick(Some(at(none)), 2)), (0.0, none));

    // Beside sensors that have none.
    let timer = Timer::default();
    timer.0.borrow_mut().value = 0.25;
    let sensors = WithControls {
        sensors: OnChip {
            timer: timer.clone(),
            scales: [unit(); 2],
        },
        controls: [0.0, 2.0, 0.0, 0.0],
    };
    let damper = EmulationController::new(&settings, &units(), Controlled).unwrap();
    let mut damper: DamperEmulation<_, _, _> = Blocking::wire(damper, sensors, timer.clone());
    assert_eq!(said(damper.tick(0)), (0.5, [0.0, 2.0, 0.0, 0.0]));
    damper.sensors().controls[1] = 4.0;
    // At rest it has driven 0.
    timer.0.borrow_mut().value = 0.25;
    assert_eq!(said(damper.tick(1)), (1.0, [0.0, 4.0, 0.0, 0.0]));
}

/// At rest, while it runs, and where reading fails, which stops it.
#[test]
fn a_rig_tells_its_control_inputs_whatever_it_does() {
    let config = RigSettings::default().at(TICK_RATE).unwrap();
    let generator = SineGenerator::new(programme(2)).unwrap();
    let law = RunningLaw::new(FastLaw::new(elastic()));
    let mut rig = RigController::with_exciter(&config, &units(), generator, law);
    let read = |number: u16| Reading {
        displacement: unit().decode(0x8000),
        force: unit().decode(0x8000),
        controls: [0.0, 1.0, 2.0, 3.0].map(|place| place + f32::from(number)),
    };
    let at_rest = rig.tick(Some(read(1)), 1);
    assert_eq!(
        (at_rest.state, at_rest.controls),
        (State::Idle, [1.0, 2.0, 3.0, 4.0])
    );
    rig.start().unwrap();
    for number in 2..10 {
        let seen = rig.tick(Some(read(number)), number.into());
        assert_eq!(
            (seen.state, seen.controls),
            (State::Running, read(number).controls)
        );
    }
    let failed = rig.tick(None, 10);
    assert_eq!(
        (failed.state, failed.controls),
        (State::Faulted(TripCause::AdcBus), read(9).controls)
    );
}

/// An exciter that is chosen when the rig is set up makes no difference to the sines.
#[test]
fn a_chosen_exciter_is_the_same_controller() {
    let config = RigSettings::default().at(TICK_RATE).unwrap();
    let law = || RunningLaw::new(FastLaw::new(elastic()));
    let generator = || SineGenerator::new(programme(2)).unwrap();
    let mut one = RigController::with_exciter(&config, &units(), generator(), law());
    let chosen: AnyExciter<2> = AnyExciter::Programme(generator());
    let mut two = RigController::with_exciter(&config, &units(), chosen, law());
    one.start().unwrap();
    two.start().unwrap();
    let mut ticks = Ticks::default();
    let mut displacement = unit().decode(0x8000);
    while one.state() == State::Running {
        let read = Reading {
            displacement,
            force: displacement,
            controls: [0.0; CONTROLS],
        };
        let clock = ticks.next();
        let seen = one.tick(Some(read), clock);
        assert_eq!(seen, two.tick(Some(read), clock));
        displacement = unit().decode(unit().encode(seen.command).code);
    }
    assert_eq!(one.state(), State::Done);
}

/// What is called by a reference is what it refers to: here a link that is heard, or not.
#[test]
fn a_borrowed_controller_is_the_one_that_it_borrows() {
    fn run(mut damper: impl Controller, heard: bool) -> State {
        let mut clock = Ticks::default();
        damper.start().unwrap();
        let at_rest = Scale::new(1.0, 0.0).unwrap().encode(0.01).code;
        let mut state = damper.state();
        for tick in 0..100 {
            if heard {
                damper.exchange();
            }
            let codes = [at_rest + tick % 2, at_rest];
            let [displacement, force] = codes.map(|code| unit().decode(code));
            let controls = [0.0; CONTROLS];
            let read = Reading {
                displacement,
                force,
                controls,
            };
            state = damper.tick(Some(read), clock.next()).state;
        }
        state
    }
    for heard in [true, false] {
        let settings = DamperEmulationSettings {
            link_ticks: 20,
            ..DamperEmulationSettings::default()
        };
        let law = RunningLaw::new(FastLaw::new(elastic()));
        let mut damper = EmulationController::new(&settings, &units(), law).unwrap();
        let expected = if heard {
            State::Running
        } else {
            State::Faulted(TripCause::LinkLost)
        };
        assert_eq!(run(&mut damper, heard), expected);
    }
}
