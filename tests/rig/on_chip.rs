//! A rig with sensors and an actuator without SPI: a narrow ADC on the chip, and a timer as the actuator's output.

use std::cell::RefCell;
use std::convert::Infallible;
use std::rc::Rc;

use mesh_damper::converter::Scale;
use mesh_damper::effects::CONTROLS;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::rig::{
    Actuator, Reading, Rig, RigController, RigSettings, Sensors, StartRefused, State, TripCause,
};
use mesh_damper::sine::SineGenerator;

use crate::controller::programme;
use crate::support::{Ticks, elastic, unit, units};

/// A call to an actuator.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Call {
    Drive(f32),
    Enable(bool),
}

/// An actuator that a timer drives, without codes and without a bus, whose calls fail on demand.
#[derive(Clone, Default)]
pub struct Timer(pub Rc<RefCell<Calls>>);

#[derive(Default)]
pub struct Calls {
    made: Vec<Call>,
    /// The driven value.
    pub value: f32,
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
    /// The calls since the last call of this function.
    fn calls(&self) -> Vec<Call> {
        std::mem::take(&mut self.0.borrow_mut().made)
    }
}

/// An ADC of 12 bits on the chip of the timer: the piston follows the driven value at once, with a force in proportion.
pub struct OnChip {
    pub timer: Timer,
    pub scales: [Scale; 2],
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
    // Once high, once low, and a command at each tick.
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
    assert_eq!(seen.command, before, "it still drives the last command");
    let [Call::Drive(tried), Call::Enable(false)] = timer.calls()[..] else {
        panic!("driven, then disabled");
    };
    assert_ne!(tried, before);
    // The command stays there until the output works again, and then returns to 0 in four ticks.
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
    // If the line does not drop, the rig tries again at each tick, before the command.
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
