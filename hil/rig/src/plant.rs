//! The plant of a controller: sensors, actuator and specimen.

use mesh_damper::dac::OUTPUT_RANGE;
use mesh_damper::effects::CONTROLS;

use super::bench::{RigSetup, SetupError};
use crate::actuator::{Sensor, Servo};
use crate::signals::Signals;
use crate::specimen::DamperForce;

/// The simulated side of a rig. Its fields are public, so that a test can make any part fail.
#[derive(Debug)]
pub struct Plant<S> {
    /// The actuator with the specimen.
    pub servo: Servo<S>,
    /// The displacement channel.
    pub displacement_sensor: Sensor,
    /// The force channel.
    pub force_sensor: Sensor,
    /// Control inputs of the specimen, as the controller gets them at each tick, in the units of the law's effects; 0 unless set.
    pub controls: [f32; CONTROLS],
    /// Reading of an independent clock, in ticks; wraps. A tick that takes longer counts as several.
    pub clock: u32,
    /// The emergency stop next to the rig is pressed.
    pub tripped: bool,
    /// Interference with the signals between the plant and the controller.
    pub signals: Signals,
    /// The steps of the last tick.
    passed: Vec<Passed>,
    millimetres_per_volt: f64,
}

/// State after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// True displacement, mm.
    pub displacement: f64,
    /// True force, kN.
    pub force: f64,
    /// Level of the enable line at the servo.
    pub enabled: bool,
}

impl<S: DamperForce + Clone> Plant<S> {
    /// The plant of `setup`, at rest.
    ///
    /// # Errors
    /// The error of a part that rejects its settings.
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

    /// Voltages that arrive from the sensors of displacement and force, V. If the specimen has a control input, it becomes the
    /// first one of the plant.
    pub fn sense(&mut self) -> (f64, f64) {
        if let Some(control) = self.servo.specimen().control() {
            self.controls[0] = control as f32;
        }
        let displacement = self.displacement_sensor.sample(self.servo.displacement());
        let force = self.force_sensor.sample(self.servo.force());
        let time = self.servo.time();
        self.signals.channels([displacement, force], time).into()
    }

    /// The temperature for the controller, °C.
    pub fn shown_temperature(&mut self) -> f32 {
        let true_one = self.temperature();
        self.signals.temperature(true_one)
    }

    /// The control inputs for the controller, in the units of the law's effects.
    pub fn shown_controls(&self) -> [f32; CONTROLS] {
        self.signals.controls(self.controls)
    }

    /// Length of a step, s: a tick of the controller for which it was made.
    pub fn step(&self) -> f64 {
        self.servo.step()
    }

    /// Temperature of the specimen, °C.
    pub fn temperature(&self) -> f64 {
        self.servo.specimen().temperature()
    }

    /// Advances the actuator by one tick, at `volts` of command and this level of the enable line.
    pub fn advance(&mut self, volts: f64, enabled: bool) {
        self.clock = self.clock.wrapping_add(1);
        self.servo
            .advance(volts * self.millimetres_per_volt, enabled);
    }

    /// Advances the plant until the controller's next tick, however late that is, with the controller's `volts` of command and
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
