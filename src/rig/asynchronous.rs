//! A controller with sensors and an actuator that are awaited.

use core::ops::{Deref, DerefMut};

use embedded_hal::digital::OutputPin;
use embedded_hal_async::spi::SpiDevice;

use super::Telemetry;
use super::controller::Controller;
use super::fault::TripCause;
use super::io::{Reading, WithControls};
use super::refusal::{ClearRefused, StartRefused};
use super::spi::{SpiActuator, SpiActuatorError};
use super::state::State;
use crate::adc::Ads8688;

/// [`super::Sensors`] whose reading is awaited.
pub trait AsyncSensors {
    /// Why there is no reading.
    type Error;

    /// Displacement, force and control inputs of now.
    ///
    /// # Errors
    /// Whatever keeps it from reading. The controller stops with [`TripCause::AdcBus`].
    fn read(&mut self) -> impl Future<Output = Result<Reading, Self::Error>>;
}

/// An [`super::Actuator`] that is awaited.
pub trait AsyncActuator {
    /// Why it did not do as it was told.
    type Error;

    /// Drives `value`, in mm, or in kN of a damper emulation.
    ///
    /// # Errors
    /// Where the actuator goes on with the value before. The controller stops with [`TripCause::DacBus`].
    fn drive(&mut self, value: f32) -> impl Future<Output = Result<(), Self::Error>>;

    /// Sets the enable line.
    ///
    /// # Errors
    /// Where its level is unknown. The controller stops with [`TripCause::EnableLine`].
    fn enable(&mut self, on: bool) -> impl Future<Output = Result<(), Self::Error>>;
}

/// [`super::Blocking`] with sensors and an actuator that are awaited; the same telemetry, to the last bit.
///
/// The enable line drops within the call that stops it. It dereferences to its controller, for all that does no I/O.
///
/// A call is to be awaited to its end. Where one was dropped before, nobody knows what is driven:
/// [`Asynchronous::overrun`] stops it.
#[derive(Debug)]
pub struct Asynchronous<C, S, A> {
    controller: C,
    sensors: S,
    actuator: A,
    /// The line took the last level that it was given, and that was low.
    low: bool,
}

impl<C: Controller, S: AsyncSensors, A: AsyncActuator> Asynchronous<C, S, A> {
    /// Idle, enable line low. `controller` is at rest, and made for the scales of `sensors` and `actuator`. A line that does not
    /// drop is a fault at the first tick or start.
    pub async fn wire(controller: C, sensors: S, mut actuator: A) -> Self {
        let low = actuator.enable(false).await.is_ok();
        Self {
            controller,
            sensors,
            actuator,
            low,
        }
    }

    /// Sets the line low.
    async fn lower(&mut self) {
        self.low = false;
        self.low = self.actuator.enable(false).await.is_ok();
        if !self.low {
            self.controller.enable_failed();
        }
    }

    /// [`Controller::start`]; the enable line rises.
    ///
    /// # Errors
    /// Those of [`Controller::start`]; an enable line that does not rise.
    pub async fn start(&mut self) -> Result<(), StartRefused> {
        self.settle().await;
        self.controller.start()?;
        self.low = false;
        if self.actuator.enable(true).await.is_ok() {
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

    /// A line that is to be low is.
    async fn settle(&mut self) {
        if self.controller.state() != State::Running && !self.low {
            self.lower().await;
        }
    }

    /// [`Controller::clear`].
    ///
    /// # Errors
    /// Those of [`Controller::clear`]; an enable line that does not drop.
    pub async fn clear(&mut self) -> Result<(), ClearRefused> {
        self.controller.clear()?;
        self.lower().await;
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
    pub async fn tick(&mut self) -> Telemetry {
        let reading = self.sensors.read().await.ok();
        let seen = self.controller.tick(reading);
        let command = seen.to_drive();
        if !command.enabled && !self.low {
            self.lower().await;
        }
        if self.actuator.drive(command.value).await.is_err() {
            self.controller.command_failed();
            self.settle().await;
        }
        Telemetry {
            command: self.controller.driven(),
            state: self.controller.state(),
            ..seen
        }
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
    type Error = A::Error;

    async fn read(&mut self) -> Result<Reading, A::Error> {
        self.read_async().await
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
}

impl<D: SpiDevice, E: OutputPin> AsyncActuator for SpiActuator<D, E> {
    type Error = SpiActuatorError<D::Error, E::Error>;

    async fn drive(&mut self, value: f32) -> Result<(), Self::Error> {
        let written = self.dac.write_async(value).await;
        written.map(|_| ()).map_err(SpiActuatorError::Dac)
    }

    async fn enable(&mut self, on: bool) -> Result<(), Self::Error> {
        let set = self.enable.set_state(on.into());
        set.map_err(SpiActuatorError::Enable)
    }
}
