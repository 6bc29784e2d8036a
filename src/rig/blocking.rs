//! A controller with its sensors and its actuator, in calls that wait for them.

use core::ops::{Deref, DerefMut};

use super::Telemetry;
use super::controller::Controller;
use super::fault::TripCause;
use super::io::{Actuator, Sensors};
use super::refusal::{ClearRefused, StartRefused};
use super::state::State;

/// The [`Controller`] `C` between the [`Sensors`] `S` and the [`Actuator`] `A`.
///
/// The enable line drops within the call that stops it. It dereferences to its controller, for all that does no I/O.
#[derive(Debug)]
// The controller comes first: what every tick needs of it is then within reach of a load's offset.
#[repr(C)]
pub struct Blocking<C, S, A> {
    controller: C,
    sensors: S,
    actuator: A,
    /// The line took the last level that it was given, and that was low.
    low: bool,
}

impl<C: Controller, S: Sensors, A: Actuator> Blocking<C, S, A> {
    /// Idle, enable line low. `controller` is at rest, and made for the scales of `sensors` and `actuator`. A line that does not
    /// drop is a fault at the first tick or start.
    // Inlined, so that the controller is built where it will be.
    #[inline(always)]
    pub fn wire(controller: C, sensors: S, mut actuator: A) -> Self {
        let low = actuator.enable(false).is_ok();
        Self {
            controller,
            sensors,
            actuator,
            low,
        }
    }

    /// Sets the line low.
    #[inline(never)]
    fn lower(&mut self) {
        self.low = self.actuator.enable(false).is_ok();
        if !self.low {
            self.controller.enable_failed();
        }
    }

    /// [`Controller::start`]; the enable line rises.
    ///
    /// # Errors
    /// Those of [`Controller::start`]; an enable line that does not rise.
    pub fn start(&mut self) -> Result<(), StartRefused> {
        self.settle();
        self.controller.start()?;
        self.low = false;
        if self.actuator.enable(true).is_ok() {
            return Ok(());
        }
        self.controller.enable_failed();
        self.lower();
        Err(StartRefused::Faulted(TripCause::EnableLine))
    }

    /// [`Controller::stop`]; the enable line drops.
    pub fn stop(&mut self) {
        self.controller.stop();
        self.settle();
    }

    /// [`Controller::overrun`]; the enable line drops.
    pub fn overrun(&mut self) {
        self.controller.overrun();
        self.settle();
    }

    /// A line that is to be low is.
    fn settle(&mut self) {
        if self.controller.state() != State::Running && !self.low {
            self.lower();
        }
    }

    /// [`Controller::clear`].
    ///
    /// # Errors
    /// Those of [`Controller::clear`]; an enable line that does not drop.
    pub fn clear(&mut self) -> Result<(), ClearRefused> {
        self.controller.clear()?;
        self.lower();
        match self.controller.state() {
            State::Faulted(cause) => Err(ClearRefused::Faulted(cause)),
            _ => Ok(()),
        }
    }

    /// [`Controller::exchange`].
    pub fn exchange(&mut self) {
        self.controller.exchange();
    }

    /// What it is doing.
    pub fn state(&self) -> State {
        self.controller.state()
    }

    /// One tick: see [`super`] for its deadline. A line that did not drop is tried again.
    pub fn tick(&mut self) -> Telemetry {
        let mut seen = self.controller.tick(self.sensors.read().ok());
        let command = seen.to_drive();
        if !command.enabled && !self.low {
            self.lower();
            seen.state = self.controller.state();
        }
        if self.actuator.drive(command.value).is_err() {
            self.fail();
            seen.command = self.controller.driven();
            seen.state = self.controller.state();
        }
        seen
    }

    /// The actuator did not take the command.
    #[cold]
    #[inline(never)]
    fn fail(&mut self) {
        self.controller.command_failed();
        self.settle();
    }

    /// The sensors.
    pub fn sensors(&mut self) -> &mut S {
        &mut self.sensors
    }
}

impl<C, S, A> Deref for Blocking<C, S, A> {
    type Target = C;

    fn deref(&self) -> &C {
        &self.controller
    }
}

impl<C, S, A> DerefMut for Blocking<C, S, A> {
    fn deref_mut(&mut self) -> &mut C {
        &mut self.controller
    }
}
