//! Control inputs reach the law and the telemetry.

use mesh_damper::converter::Sample;
use mesh_damper::effects::{CONTROLS, Motion};
use mesh_damper::fast_law::{Adaptation, FastLaw, RunningLaw};
use mesh_damper::rig::{
    Blocking, Controller as _, DamperEmulation, DamperEmulationSettings, EmulationController,
    Reading, RigController, RigSettings, State, Telemetry, TripCause, WithControls,
};
use mesh_damper::sine::SineGenerator;
use mesh_damper::tick_law::TickLaw;
use mesh_damper_rig::TICK_RATE;

use crate::controller::programme;
use crate::on_chip::{OnChip, Timer};
use crate::support::{elastic, unit, units};

/// A law whose force is the displacement in mm times the sum of its control inputs.
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
    // If a reading fails, the previous values stay.
    assert_eq!(said(damper.tick(None, 1)), (0.375, given));
    assert_eq!(damper.state(), State::Faulted(TripCause::AdcBus));
    let none = [0.0; CONTROLS];
    assert_eq!(said(damper.tick(Some(at(none)), 2)), (0.0, none));

    // With sensors that have no control inputs.
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

/// At rest, while it runs, and when a reading fails, which trips it.
#[test]
fn a_rig_reports_its_control_inputs_in_every_state() {
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
