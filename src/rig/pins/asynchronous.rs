//! The same pins for asynchronous sensors and actuators.

use embedded_hal::digital::{InputPin, OutputPin};

use super::{PinError, WithAlive, WithReadBack, WithTrip};
use crate::rig::io::Reading;
use crate::rig::{AsyncActuator, AsyncSensors};

impl<S: AsyncSensors, P: InputPin> AsyncSensors for WithTrip<S, P> {
    type Error = PinError<S::Error, P::Error>;

    async fn read(&mut self) -> Result<Reading, Self::Error> {
        self.sensors.read().await.map_err(PinError::Part)
    }

    async fn is_tripped(&mut self) -> Result<bool, Self::Error> {
        Ok(self.is_active()? || self.sensors.is_tripped().await.map_err(PinError::Part)?)
    }

    async fn restore(&mut self) -> Result<(), Self::Error> {
        self.sensors.restore().await.map_err(PinError::Part)
    }
}

impl<A: AsyncActuator, P: InputPin> AsyncActuator for WithReadBack<A, P> {
    type Error = PinError<A::Error, P::Error>;

    async fn drive(&mut self, value: f32) -> Result<(), Self::Error> {
        self.actuator.drive(value).await.map_err(PinError::Part)
    }

    async fn enable(&mut self, on: bool) -> Result<(), Self::Error> {
        self.actuator.enable(on).await.map_err(PinError::Part)
    }

    async fn verify_drive(&mut self) -> Result<(), Self::Error> {
        self.actuator.verify_drive().await.map_err(PinError::Part)
    }

    async fn verify_enable(&mut self, on: bool) -> Result<(), Self::Error> {
        let verified = self.actuator.verify_enable(on).await;
        verified.map_err(PinError::Part)?;
        self.verify_level(on)
    }

    async fn alive(&mut self) -> Result<(), Self::Error> {
        self.actuator.alive().await.map_err(PinError::Part)
    }

    async fn restore(&mut self) -> Result<(), Self::Error> {
        self.actuator.restore().await.map_err(PinError::Part)
    }
}

impl<A: AsyncActuator, P: OutputPin> AsyncActuator for WithAlive<A, P> {
    type Error = PinError<A::Error, P::Error>;

    async fn drive(&mut self, value: f32) -> Result<(), Self::Error> {
        self.actuator.drive(value).await.map_err(PinError::Part)
    }

    async fn enable(&mut self, on: bool) -> Result<(), Self::Error> {
        self.actuator.enable(on).await.map_err(PinError::Part)
    }

    async fn verify_drive(&mut self) -> Result<(), Self::Error> {
        self.actuator.verify_drive().await.map_err(PinError::Part)
    }

    async fn verify_enable(&mut self, on: bool) -> Result<(), Self::Error> {
        let verified = self.actuator.verify_enable(on).await;
        verified.map_err(PinError::Part)
    }

    async fn alive(&mut self) -> Result<(), Self::Error> {
        self.actuator.alive().await.map_err(PinError::Part)?;
        self.toggle()
    }

    async fn restore(&mut self) -> Result<(), Self::Error> {
        self.actuator.restore().await.map_err(PinError::Part)
    }
}
