//! A controller with its sensors and its actuator, in blocking and in asynchronous calls.

use core::ops::{Deref, DerefMut};

use super::Telemetry;
use super::controller::Controller;
use super::fault::TripCause;
use super::io::{Actuator, Sensors};
#[cfg(feature = "async")]
use super::io::{AsyncActuator, AsyncSensors};
use super::refusal::{ClearRefused, StartRefused};
use super::state::State;
#[cfg(feature = "async")]
use crate::forms::later;
use crate::forms::now;

/// Number of ticks between read-backs of the command and the enable line, where the parts support them: 1.6 ms at 10 kHz. An
/// actuator whose DAC fell to 0 V has moved little by then, because it lags by several milliseconds itself. The DAC's read-back
/// takes 72 clocks, on average five per tick.
pub const VERIFY_TICKS: u32 = 16;

/// The type and its calls in the form of `$wait`.
macro_rules! wired {
    ($(#[$about:meta])* $wired:ident, $sensors:ident, $actuator:ident, $wait:ident $(, $async:tt)?) => {
        $(#[$about])*
        #[derive(Debug)]
        // The controller comes first, so that its fields of every tick are within the offset of a load.
        #[repr(C)]
        pub struct $wired<C, S, A> {
            controller: C,
            sensors: S,
            actuator: A,
            /// The line is low: it accepted its last level, and that was low.
            low: bool,
            /// The last read-back was correct.
            verified: bool,
        }

        impl<C: Controller, S: $sensors, A: $actuator> $wired<C, S, A> {
            /// Idle, enable line low. `controller` must be at rest, and made for the scales of `sensors` and `actuator`. If the line does
            /// not drop, the first tick or start reports it.
            // Inlined, so that the controller is built in its final place.
            #[inline(always)]
            pub $($async)? fn wire(controller: C, sensors: S, actuator: A) -> Self {
                let mut wired = Self {
                    controller,
                    sensors,
                    actuator,
                    low: false,
                    verified: true,
                };
                wired.low = $wait!(wired.set_line(false));
                wired
            }

            /// Sets the line, and returns whether it took this level.
            $($async)? fn set_line(&mut self, on: bool) -> bool {
                $wait!(self.actuator.enable(on)).is_ok() && $wait!(self.actuator.verify_enable(on)).is_ok()
            }

            /// Sets the line low.
            #[inline(never)]
            $($async)? fn lower(&mut self) {
                self.low = $wait!(self.set_line(false));
                if !self.low {
                    self.controller.enable_failed();
                }
            }

            /// Whether the stop input is active, or cannot be read.
            #[inline]
            $($async)? fn is_tripped(&mut self) -> bool {
                !matches!($wait!(self.sensors.is_tripped()), Ok(false))
            }

            /// [`Controller::start`]; the enable line rises.
            ///
            /// # Errors
            /// Those of [`Controller::start`]; an external trip that is active; an enable line that does not rise.
            pub $($async)? fn start(&mut self) -> Result<(), StartRefused> {
                if $wait!(self.is_tripped()) {
                    self.controller.external_trip();
                }
                $wait!(self.settle());
                let started = self.controller.start();
                // A start that is refused may have stopped the controller.
                $wait!(self.settle());
                started?;
                self.low = false;
                // When the line rises, the command is the piston's position.
                if $wait!(self.actuator.drive(self.controller.driven())).is_err() {
                    self.controller.command_failed();
                    $wait!(self.lower());
                    return Err(StartRefused::Faulted(TripCause::DacBus));
                }
                if $wait!(self.set_line(true)) {
                    return Ok(());
                }
                self.controller.enable_failed();
                $wait!(self.lower());
                Err(StartRefused::Faulted(TripCause::EnableLine))
            }

            /// [`Controller::stop`]; the enable line drops.
            pub $($async)? fn stop(&mut self) {
                self.controller.stop();
                $wait!(self.settle());
            }

            /// [`Controller::overrun`]; the enable line drops.
            pub $($async)? fn overrun(&mut self) {
                self.controller.overrun();
                $wait!(self.settle());
            }

            /// [`Controller::external_trip`]; the enable line drops.
            pub $($async)? fn external_trip(&mut self) {
                self.controller.external_trip();
                $wait!(self.settle());
            }

            /// Sets the line low if it must be low and is not.
            $($async)? fn settle(&mut self) {
                if self.controller.state() != State::Running && !self.low {
                    $wait!(self.lower());
                }
            }

            /// [`Controller::clear`], after setting up sensors and actuator again.
            ///
            /// # Errors
            /// Those of [`Controller::clear`]; an external trip that is active; an enable line that does not drop; a part that cannot be
            /// set up, or whose output is then wrong. The trip cause stays.
            pub $($async)? fn clear(&mut self) -> Result<(), ClearRefused> {
                self.controller.may_clear()?;
                if $wait!(self.is_tripped()) {
                    return Err(ClearRefused::Faulted(TripCause::External));
                }
                $wait!(self.lower());
                if !self.low {
                    return Err(ClearRefused::Faulted(TripCause::EnableLine));
                }
                if $wait!(self.sensors.restore()).is_err() {
                    return Err(ClearRefused::Faulted(TripCause::AdcBus));
                }
                self.verified = $wait!(self.actuator.restore()).is_ok() && $wait!(self.actuator.verify_drive()).is_ok();
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
            pub $($async)? fn tick(&mut self, clock: u32) -> Telemetry {
                if $wait!(self.is_tripped()) {
                    self.controller.external_trip();
                }
                let late = self.controller.late_ticks();
                let reading = $wait!(self.sensors.read()).ok();
                let read = reading.is_some();
                let mut seen = self.controller.tick(reading, clock);
                let in_time = self.controller.late_ticks() == late;
                let command = seen.to_drive();
                if !command.enabled && !self.low {
                    $wait!(self.lower());
                    seen.state = self.controller.state();
                }
                let driven = $wait!(self.actuator.drive(command.value)).is_ok();
                if !driven {
                    $wait!(self.fail());
                }
                let due = (seen.tick as u32).is_multiple_of(VERIFY_TICKS);
                if due {
                    $wait!(self.verify());
                }
                if due || !driven {
                    seen.command = self.controller.driven();
                    seen.state = self.controller.state();
                }
                let line = self.low || seen.state == State::Running;
                if read && in_time && driven && line && self.verified {
                    // A watchdog without a signal acts by itself.
                    let _ = $wait!(self.actuator.alive());
                }
                seen
            }

            /// The actuator did not accept the command.
            #[cold]
            #[inline(never)]
            $($async)? fn fail(&mut self) {
                self.controller.command_failed();
                $wait!(self.settle());
            }

            /// Reads back the output, and the level of the line if it accepted the last one.
            #[inline(never)]
            $($async)? fn verify(&mut self) {
                let driven = $wait!(self.actuator.verify_drive()).is_ok();
                if !driven {
                    self.controller.command_unverified();
                    $wait!(self.settle());
                }
                let on = self.controller.state() == State::Running;
                let line = !on && !self.low || $wait!(self.actuator.verify_enable(on)).is_ok();
                if !line {
                    self.low = false;
                    self.controller.enable_failed();
                    $wait!(self.settle());
                }
                self.verified = driven && line;
            }

            /// The sensors.
            pub fn sensors(&mut self) -> &mut S {
                &mut self.sensors
            }
        }

        impl<C, S, A> Deref for $wired<C, S, A> {
            type Target = C;

            fn deref(&self) -> &C {
                &self.controller
            }
        }

        impl<C, S, A> DerefMut for $wired<C, S, A> {
            fn deref_mut(&mut self) -> &mut C {
                &mut self.controller
            }
        }
    };
}

wired!(
    /// The [`Controller`] `C` between the [`Sensors`] `S` and the [`Actuator`] `A`.
    ///
    /// The enable line drops within the call that stops the controller. The type dereferences to its controller, for all methods
    /// without I/O.
    Blocking,
    Sensors,
    Actuator,
    now
);
#[cfg(feature = "async")]
wired!(
    /// [`Blocking`] with asynchronous sensors and an asynchronous actuator; the same telemetry, to the last bit.
    ///
    /// The enable line drops within the call that stops the controller. The type dereferences to its controller, for all methods
    /// without I/O.
    ///
    /// Await every call to its end. If one was dropped, the actuator's output is unknown: stop with [`Asynchronous::overrun`].
    Asynchronous,
    AsyncSensors,
    AsyncActuator,
    later,
    async
);
