//! A controller with asynchronous sensors and an asynchronous actuator.

use core::future::ready;
use core::ops::{Deref, DerefMut};

use embedded_hal::digital::OutputPin;
use embedded_hal_async::spi::SpiDevice;

use super::Telemetry;
use super::blocking::VERIFY_TICKS;
use super::controller::Controller;
use super::fault::TripCause;
use super::io::{Reading, WithControls};
use super::refusal::{ClearRefused, StartRefused};
use super::spi::{SpiActuator, SpiActuatorError};
use super::state::State;
use crate::adc::{AdcError, Ads8688};
use crate::dac::DacError;

/// [`super::Sensors`] with asynchronous reading.
pub trait AsyncSensors {
    /// Error of a reading.
    type Error;

    /// Reads displacement, force and control inputs.
    ///
    /// # Errors
    /// Any error of the reading. The controller trips with [`TripCause::AdcBus`].
    fn read(&mut self) -> impl Future<Output = Result<Reading, Self::Error>>;

    /// As [`super::Sensors::is_tripped`].
    ///
    /// # Errors
    /// The input cannot be read, which counts as active.
    fn is_tripped(&mut self) -> impl Future<Output = Result<bool, Self::Error>> {
        ready(Ok(false))
    }

    /// As [`super::Sensors::restore`].
    ///
    /// # Errors
    /// The parts cannot be set up. The clear is then refused, with [`TripCause::AdcBus`].
    fn restore(&mut self) -> impl Future<Output = Result<(), Self::Error>> {
        ready(Ok(()))
    }
}

/// An asynchronous [`super::Actuator`].
pub trait AsyncActuator {
    /// Error of the actuator.
    type Error;

    /// Drives `value`, in mm, or in kN of a damper emulation.
    ///
    /// # Errors
    /// The actuator keeps the previous value. The controller trips with [`TripCause::DacBus`].
    fn drive(&mut self, value: f32) -> impl Future<Output = Result<(), Self::Error>>;

    /// Sets the enable line.
    ///
    /// # Errors
    /// Its level is unknown. The controller trips with [`TripCause::EnableLine`].
    fn enable(&mut self, on: bool) -> impl Future<Output = Result<(), Self::Error>>;

    /// As [`super::Actuator::verify_drive`].
    ///
    /// # Errors
    /// The output differs, or cannot be read back. The controller trips with [`TripCause::DacBus`].
    fn verify_drive(&mut self) -> impl Future<Output = Result<(), Self::Error>> {
        ready(Ok(()))
    }

    /// As [`super::Actuator::verify_enable`].
    ///
    /// # Errors
    /// The level differs, or cannot be read back. The controller trips with [`TripCause::EnableLine`].
    fn verify_enable(&mut self, _on: bool) -> impl Future<Output = Result<(), Self::Error>> {
        ready(Ok(()))
    }

    /// As [`super::Actuator::alive`].
    ///
    /// # Errors
    /// The signal failed. The controller ignores this: the watchdog notices it.
    fn alive(&mut self) -> impl Future<Output = Result<(), Self::Error>> {
        ready(Ok(()))
    }

    /// As [`super::Actuator::restore`].
    ///
    /// # Errors
    /// The parts cannot be set up. The clear is then refused, with [`TripCause::DacBus`].
    fn restore(&mut self) -> impl Future<Output = Result<(), Self::Error>> {
        ready(Ok(()))
    }
}

/// [`super::Blocking`] with asynchronous sensors and an asynchronous actuator; the same telemetry, to the last bit.
///
/// The enable line drops within the call that stops the controller. The type dereferences to its controller, for all methods
/// without I/O.
///
/// Await every call to its end. If one was dropped, the actuator's output is unknown: stop with [`Asynchronous::overrun`].
#[derive(Debug)]
pub struct Asynchronous<C, S, A> {
    controller: C,
    sensors: S,
    actuator: A,
    /// The line is low: it accepted its last level, and that was low.
    low: bool,
    /// The last read-back was correct.
    verified: bool,
}

impl<C: Controller, S: AsyncSensors, A: AsyncActuator> Asynchronous<C, S, A> {
    /// Idle, enable line low. `controller` must be at rest, and made for the scales of `sensors` and `actuator`. If the line does
    /// not drop, the first tick or start reports it.
    pub async fn wire(controller: C, sensors: S, actuator: A) -> Self {
        let mut wired = Self {
            controller,
            sensors,
            actuator,
            low: false,
            verified: true,
        };
        wired.low = wired.set_line(false).await;
        wired
    }

    /// Sets the line, and returns whether it took this level.
    async fn set_line(&mut self, on: bool) -> bool {
        self.actuator.enable(on).await.is_ok() && self.actuator.verify_enable(on).await.is_ok()
    }

    /// Sets the line low.
    async fn lower(&mut self) {
        self.low = false;
        self.low = self.set_line(false).await;
        if !self.low {
            self.controller.enable_failed();
        }
    }

    /// Whether the stop input is active, or cannot be read.
    async fn is_tripped(&mut self) -> bool {
        !matches!(self.sensors.is_tripped().await, Ok(false))
    }

    /// [`Controller::start`]; the enable line rises.
    ///
    /// # Errors
    /// Those of [`Controller::start`]; an external trip that is active; an enable line that does not rise.
    pub async fn start(&mut self) -> Result<(), StartRefused> {
        if self.is_tripped().await {
            self.controller.external_trip();
        }
        self.settle().await;
        let started = self.controller.start();
        // A start that is refused may have stopped the controller.
        self.settle().await;
        started?;
        self.low = false;
        // When the line rises, the command is the piston's position.
        if self.actuator.drive(self.controller.driven()).await.is_err() {
            self.controller.command_failed();
            self.lower().await;
            return Err(StartRefused::Faulted(TripCause::DacBus));
        }
        if self.set_line(true).await {
            return Ok(());
        }
        self.controller.enable_failed();
        self.lower().await;
        Err(StartRefused::Faulted(TripCause::EnableLine))
    }

    /// [`Controller::stop`]; the enable line drops.
    pub async fn stop(&mut self) {
        self.controller.stop();
        self.settle().await;
    }

    /// [`Controller::overrun`]; the enable line drops.
    pub async fn overrun(&mut self) {
        self.controller.overrun();
        self.settle().await;
    }

    /// [`Controller::external_trip`]; the enable line drops.
    pub async fn external_trip(&mut self) {
        self.controller.external_trip();
        self.settle().await;
    }

    /// Sets the line low if it must be low and is not.
    async fn settle(&mut self) {
        if self.controller.state() != State::Running && !self.low {
            self.lower().await;
        }
    }

    /// [`Controller::clear`], after setting up sensors and actuator again.
    ///
    /// # Errors
    /// Those of [`Controller::clear`]; an external trip that is active; an enable line that does not drop; a part that cannot be
    /// set up, or whose output is then wrong. The trip cause stays.
    pub async fn clear(&mut self) -> Result<(), ClearRefused> {
        self.controller.may_clear()?;
        if self.is_tripped().await {
            return Err(ClearRefused::Faulted(TripCause::External));
        }
        self.lower().await;
        if !self.low {
            return Err(ClearRefused::Faulted(TripCause::EnableLine));
        }
        if self.sensors.restore().await.is_err() {
            return Err(ClearRefused::Faulted(TripCause::AdcBus));
        }
        self.verified =
            self.actuator.restore().await.is_ok() && self.actuator.verify_drive().await.is_ok();
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
    pub async fn tick(&mut self, clock: u32) -> Telemetry {
        if self.is_tripped().await {
            self.controller.external_trip();
        }
        let late = self.controller.late_ticks();
        let reading = self.sensors.read().await.ok();
        let read = reading.is_some();
        let mut seen = self.controller.tick(reading, clock);
        let in_time = self.controller.late_ticks() == late;
        let command = seen.to_drive();
        if !command.enabled && !self.low {
            self.lower().await;
            seen.state = self.controller.state();
        }
        let driven = self.actuator.drive(command.value).await.is_ok();
        if !driven {
            self.fail().await;
        }
        let due = (seen.tick as u32).is_multiple_of(VERIFY_TICKS);
        if due {
            self.verify().await;
        }
        if due || !driven {
            seen.command = self.controller.driven();
            seen.state = self.controller.state();
        }
        let line = self.low || seen.state == State::Running;
        if read && in_time && driven && line && self.verified {
            // A watchdog without a signal acts by itself.
            let _ = self.actuator.alive().await;
        }
        seen
    }

    /// The actuator did not accept the command.
    async fn fail(&mut self) {
        self.controller.command_failed();
        self.settle().await;
    }

    /// Reads back the output, and the level of the line if it accepted the last one.
    async fn verify(&mut self) {
        let driven = self.actuator.verify_drive().await.is_ok();
        if !driven {
            self.controller.command_unverified();
            self.settle().await;
        }
        let on = self.controller.state() == State::Running;
        let line = !on && !self.low || self.actuator.verify_enable(on).await.is_ok();
        if !line {
            self.low = false;
            self.controller.enable_failed();
            self.settle().await;
        }
        self.verified = driven && line;
    }

    /// The sensors.
    pub fn sensors(&mut self) -> &mut S {
        &mut self.sensors
    }
}

impl<C, S, A> Deref for Asynchronous<C, S, A> {
    type Target = C;

    fn deref(&self) -> &C {
        &self.controller
    }
}

impl<C, S, A> DerefMut for Asynchronous<C, S, A> {
    fn deref_mut(&mut self) -> &mut C {
        &mut self.controller
    }
}

impl<A: SpiDevice> AsyncSensors for Ads8688<A> {
    type Error = AdcError<A::Error>;

    async fn read(&mut self) -> Result<Reading, Self::Error> {
        Ok(self.read_async().await?)
    }

    async fn restore(&mut self) -> Result<(), Self::Error> {
        self.restore_async().await
    }
}

impl<S: AsyncSensors> AsyncSensors for WithControls<S> {
    type Error = S::Error;

    async fn read(&mut self) -> Result<Reading, S::Error> {
        let reading = self.sensors.read().await?;
        Ok(Reading {
            controls: self.controls,
            ..reading
        })
    }

    async fn is_tripped(&mut self) -> Result<bool, S::Error> {
        self.sensors.is_tripped().await
    }

    async fn restore(&mut self) -> Result<(), S::Error> {
        self.sensors.restore().await
    }
}

impl<D: SpiDevice, E: OutputPin> AsyncActuator for SpiActuator<D, E> {
    type Error = SpiActuatorError<DacError<D::Error>, E::Error>;

    async fn drive(&mut self, value: f32) -> Result<(), Self::Error> {
        match self.dac.write_async(value).await {
            Ok(_) => Ok(()),
            Err(error) => Err(SpiActuatorError::Dac(error.into())),
        }
    }

    async fn verify_drive(&mut self) -> Result<(), Self::Error> {
        let verified = self.dac.verify_async().await;
        verified.map_err(SpiActuatorError::Dac)
    }

    async fn restore(&mut self) -> Result<(), Self::Error> {
        let restored = self.dac.restore_async().await;
        restored.map_err(SpiActuatorError::Dac)
    }

    async fn enable(&mut self, on: bool) -> Result<(), Self::Error> {
        let set = self.enable.set_state(on.into());
        set.map_err(SpiActuatorError::Enable)
    }
}
