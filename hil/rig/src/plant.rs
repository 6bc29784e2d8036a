//! What a controller works on: sensors, actuator and specimen.

use mesh_damper::dac::OUTPUT_RANGE;
use mesh_damper::effects::CONTROLS;

use super::bench::{RigSetup, SetupError};
use crate::actuator::{Sensor, Servo};
use crate::signals::Signals;
use crate::specimen::DamperForce;

/// The simulated side of a rig. Everything is public, so that a test can have any of it fail.
#[derive(Debug)]
pub struct Plant<S> {
    /// The actuator with the specimen.
    pub servo: Servo<S>,
    /// The displacement channel.
    pub displacement_sensor: Sensor,
    /// The force channel.
    pub force_sensor: Sensor,
    /// Control inputs that the specimen is under, as the controller is given them at each tick, in the units of the law's effects; 0
    /// unless set.
    pub controls: [f32; CONTROLS],
    /// What a clock says that nobody on the rig can stop, in ticks; wraps. A tick that takes longer has more than one.
    pub clock: u32,
    /// The emergency stop beside the rig is pressed.
    pub tripped: bool,
    /// What acts on the signals between all that and the controller.
    pub signals: Signals,
    /// The steps of the last tick.
    passed: Vec<Passed>,
    millimetres_per_volt: f64,
}

/// Where a step has led to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// True displacement, mm.
    pub displacement: f64,
    /// True force, kN.
    pub force: f64,
    /// Level of the enable line that reached the servo.
    pub enabled: bool,
}

impl<S: DamperForce + Clone> Plant<S> {
    /// Of `setup`, at rest.
    ///
    /// # Errors
    /// What one of the parts refuses.
    pub fn new<const B: usize, const N: usize>(
        setup: &RigSetup<S, B, N>,
    ) -> Result<Self, SetupError> {
        let step = 1.0 / setup.programme.tick_rate();
        let sensor = |config, stream| Sensor::new(config, step, setup.seed, stream);
        Ok(Self {
            servo: Servo::new(setup.servo, step, setup.specimen.clone())?,
            displacement_sensor: sensor(setup.displacement_sensor, 0)?,
            force_sensor: sensor(setup.force_sensor, 1)?,
            controls: [0.0; CONTROLS],
            clock: 0,
            tripped: false,
            signals: Signals::new(setup.seed),
            passed: Vec::new(),
            millimetres_per_volt: setup.command_range / OUTPUT_RANGE,
        })
    }

    /// What arrives of what the sensors of displacement and force put out, V. A control input that the specimen is under by itself
    /// is the first.
    pub fn sense(&mut self) -> (f64, f64) {
        if let Some(control) = self.servo.specimen().control() {
            self.controls[0] = control as f32;
        }
        let displacement = self.displacement_sensor.sample(self.servo.displacement());
        let force = self.force_sensor.sample(self.servo.force());
        let time = self.servo.time();
        self.signals.channels([displacement, force], time).into()
    }

    /// The temperature that the controller is given, °C.
    pub fn shown_temperature(&mut self) -> f32 {
        let true_one = self.temperature();
        self.signals.temperature(true_one)
    }

    /// The control inputs that the controller is given, in the units of the law's effects.
    pub fn shown_controls(&self) -> [f32; CONTROLS] {
        self.signals.controls(self.controls)
    }

    /// Time of a step, s: a tick of the controller that it was made for.
    pub fn step(&self) -> f64 {
        self.servo.step()
    }

    /// Temperature of the specimen, °C.
    pub fn temperature(&self) -> f64 {
        self.servo.specimen().temperature()
    }

    /// The actuator's way over one tick, at `volts` of command and this level of the enable line.
    pub fn advance(&mut self, volts: f64, enabled: bool) {
        self.clock = self.clock.wrapping_add(1);
        self.servo
            .advance(volts * self.millimetres_per_volt, enabled);
    }

    /// The plant's way until the controller's next tick, however late that comes, with the controller's `volts` of command and
    /// level of the enable line.
    pub fn drive(&mut self, volts: f64, enabled: bool) {
        let (volts, enabled) = self.signals.output(volts, enabled);
        self.passed.clear();
        for _ in 0..self.signals.steps() {
            self.advance(volts, enabled);
            self.passed.push(Passed {
                displacement: self.servo.displacement(),
                force: self.servo.force(),
                enabled,
            });
        }
    }

    /// The steps of the last [`Plant::drive`].
    pub fn passed(&self) -> &[Passed] {
        &self.passed
    }
}
