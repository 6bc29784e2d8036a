//! The controllers without I/O, called directly, behave as the ones with their converters.

use mesh_damper::converter::Scale;
use mesh_damper::effects::{AugmentedLaw, CONTROLS, Effect, StickSlip};
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::law::Law;
use mesh_damper::rig::{
    AnyExciter, Controller, DamperEmulationSettings, EmulationController, Reading, RigController,
    RigSettings, State, Telemetry, TripCause, Wiring,
};
use mesh_damper::sine::{Block, Programme, SineGenerator};
use mesh_damper_rig::actuator::{SensorFault, adc_code, dac_volts};
use mesh_damper_rig::specimen::Specimen;
use mesh_damper_rig::{Bench, EmulatorBench, EmulatorSetup, RigSetup, TICK_RATE};

use crate::support::{Ticks, elastic, unit, units};

pub fn programme(cycles: u32) -> Programme<2> {
    let programme = Programme::new(TICK_RATE, 1).unwrap();
    programme
        .with(Block::sine(0.2, 10.0, cycles).unwrap())
        .unwrap()
        .with(Block::sine(0.1, 20.0, cycles).unwrap())
        .unwrap()
}

/// The reading from a bench's ADC at this tick.
fn reading(wiring: &Wiring, volts: [f64; 2]) -> Reading {
    let [displacement, force] = volts.map(adc_code);
    Reading {
        displacement: wiring.displacement.decode(displacement),
        force: wiring.force.decode(force),
        controls: [0.0; CONTROLS],
    }
}

/// The event at half of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Halfway {
    Nothing,
    AdcFails,
    DacFails,
    SensorOpens,
    Late,
    Stopped,
}

/// The rig closes its loop over the simulated specimen and converters. The controller that is called directly receives the readings
/// of the same ADC. Its command and enable level must equal those at the DAC and the line.
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

/// The choice of the exciter at set-up makes no difference to the sines.
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

/// A call through a reference reaches the controller: here it reports that the link was heard, or does not.
#[test]
fn a_borrowed_controller_is_the_one_that_it_borrows() {
    fn run(mut damper: impl Controller, heard: bool) -> State {
        let mut clock = Ticks::default();
        damper.start().unwrap();
        let at_rest = unit().encode(0.01).code;
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
