//! A controller with its sensors and its actuator, in blocking calls.

use core::ops::{Deref, DerefMut};

use super::Telemetry;
use super::controller::Controller;
use super::fault::TripCause;
use super::io::{Actuator, Sensors};
use super::refusal::{ClearRefused, StartRefused};
use super::state::State;

/// Number of ticks between read-backs of the command and the enable line, where the parts support them: 1.6 ms at 10 kHz. An
/// actuator whose DAC fell to 0 V has moved little by then, because it lags by several milliseconds itself. The DAC's read-back
/// takes 72 clocks, on average five per tick.
pub const VERIFY_TICKS: u32 = 16;

/// The [`Controller`] `C` between the [`Sensors`] `S` and the [`Actuator`] `A`.
///
/// The enable line drops within the call that stops the controller. The type dereferences to its controller, for all methods
/// without I/O.
#[derive(Debug)]
// The controller comes first, so that its fields of every tick are within the offset of a load.
#[repr(C)]
pub struct Blocking<C, S, A> {
    controller: C,
    sensors: S,
    actuator: A,
    /// The line is low: it accepted its last level, and that was low.
    low: bool,
    /// The last read-back was correct.
    verified: bool,
}

impl<C: Controller, S: Sensors, A: Actuator> Blocking<C, S, A> {
    /// Idle, enable line low. `controller` must be at rest, and made for the scales of `sensors` and `actuator`. If the line does
    /// not drop, the first tick or start reports it.
    // Inlined, so that the controller is built in its final place.
    #[inline(always)]
    pub fn wire(controller: C, sensors: S, actuator: A) -> Self {
        let mut wired = Self {
            controller,
            sensors,
            actuator,
            low: false,
            verified: true,
        };
        wired.low = wired.set_line(false);
        wired
    }

    /// Sets the line, and returns whether it took this level.
    fn set_line(&mut self, on: bool) -> bool {
        self.actuator.enable(on).is_ok() && self.actuator.verify_enable(on).is_ok()
    }

    /// Sets the line low.
    #[inline(never)]
    fn lower(&mut self) {
        self.low = self.set_line(false);
        if !self.low {
            self.controller.enable_failed();
        }
    }

    /// Whether the stop input is active, or cannot be read.
    #[inline]
    fn is_tripped(&mut self) -> bool {
        !matches!(self.sensors.is_tripped(), Ok(false))
    }

    /// [`Controller::start`]; the enable line rises.
    ///
    /// # Errors
    /// Those of [`Controller::start`]; an external trip that is active; an enable line that does not rise.
    pub fn start(&mut self) -> Result<(), StartRefused> {
        if self.is_tripped() {
            self.controller.external_trip();
        }
        self.settle();
        let started = self.controller.start();
        // A start that is refused may have stopped the controller.
        self.settle();
        started?;
        self.low = false;
        // When the line rises, the command is the piston's position.
        if self.actuator.drive(self.controller.driven()).is_err() {
            self.controller.command_failed();
            self.lower();
            return Err(StartRefused::Faulted(TripCause::DacBus));
        }
        if self.set_line(true) {
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

    /// [`Controller::external_trip`]; the enable line drops.
    pub fn external_trip(&mut self) {
        self.controller.external_trip();
        self.settle();
    }

    /// Sets the line low if it must be low and is not.
    fn settle(&mut self) {
        if self.controller.state() != State::Running && !self.low {
            self.lower();
        }
    }

    /// [`Controller::clear`], after setting up sensors and actuator again.
    ///
    /// # Errors
    /// Those of [`Controller::clear`]; an external trip that is active; an enable line that does not drop; a part that cannot be
    /// set up, or whose output is then wrong. The trip cause stays.
    pub fn clear(&mut self) -> Result<(), ClearRefused> {
        self.controller.may_clear()?;
        if self.is_tripped() {
            return Err(ClearRefused::Faulted(TripCause::External));
        }
        self.lower();
        if !self.low {
            return Err(ClearRefused::Faulted(TripCause::EnableLine));
        }
        if self.sensors.restore().is_err() {
            return Err(ClearRefused::Faulted(TripCause::AdcBus));
        }
        self.verified = self.actuator.restore().is_ok() && self.actuator.verify_drive().is_ok();
        if !self.verified {
            return Err(ClearRefused::Faulted(TripCause::DacBus));
        }
        self.controller.clear()
    }

    /// [`Controller::exchange`].
    pub fn exchange(&mut self) {
        self.controller.exchange();
    }

    /// State of the controller.
    pub fn state(&self) -> State {
        self.controller.state()
    }

    /// [`Controller::late_ticks`].
    pub fn late_ticks(&self) -> u32 {
        self.controller.late_ticks()
    }

    /// One tick, at which the counter of [`Controller::tick`] reads `clock`: see [`super`] for its deadline. If the line did not
    /// drop, this is tried again.
    pub fn tick(&mut self, clock: u32) -> Telemetry {
        if self.is_tripped() {
            self.controller.external_trip();
        }
        let late = self.controller.late_ticks();
        let reading = self.sensors.read().ok();
        let read = reading.is_some();
        let mut seen = self.controller.tick(reading, clock);
        let in_time = self.controller.late_ticks() == late;
        let command = seen.to_drive();
        if !command.enabled && !self.low {
            self.lower();
            seen.state = self.controller.state();
        }
        let driven = self.actuator.drive(command.value).is_ok();
        if !driven {
            self.fail();
        }
        let due = (seen.tick as u32).is_multiple_of(VERIFY_TICKS);
        if due {
            self.verify();
        }
        if due || !driven {
            seen.command = self.controller.driven();
            seen.state = self.controller.state();
        }
        let line = self.low || seen.state == State::Running;
        if read && in_time && driven && line && self.verified {
            // A watchdog without a signal acts by itself.
            let _ = self.actuator.alive();
        }
        seen
    }

    /// The actuator did not accept the command.
    #[cold]
    #[inline(never)]
    fn fail(&mut self) {
        self.controller.command_failed();
        self.settle();
    }

    /// Reads back the output, and the level of the line if it accepted the last one.
    #[inline(never)]
    fn verify(&mut self) {
        let driven = self.actuator.verify_drive().is_ok();
        if !driven {
            self.controller.command_unverified();
            self.settle();
        }
        let on = self.controller.state() == State::Running;
        let line = !on && !self.low || self.actuator.verify_enable(on).is_ok();
        if !line {
            self.low = false;
            self.controller.enable_failed();
            self.settle();
        }
        self.verified = driven && line;
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
