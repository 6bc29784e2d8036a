//! The same frames over an asynchronous bus.

use embedded_hal_async::spi::SpiDevice;

use super::{
    Ad5761, DacError, NO_OPERATION, READ_CONTROL, READ_OUTPUT, SET_UP, WRITE_AND_UPDATE, drives,
    frame, held, sound,
};
use crate::converter::{Code, Scale};

impl<S: SpiDevice> Ad5761<S> {
    /// [`Ad5761::new`] over an asynchronous bus.
    ///
    /// # Errors
    /// An error of the bus, or [`DacError::Control`].
    pub async fn new_async(spi: S, scale: Scale) -> Result<Self, DacError<S::Error>> {
        let mut part = Self::unset(spi, scale);
        part.set_up_async().await?;
        Ok(part)
    }

    async fn set_up_async(&mut self) -> Result<(), DacError<S::Error>> {
        for each in &SET_UP {
            self.spi.write(each).await?;
        }
        held(self.transfer_async(NO_OPERATION).await?)?;
        self.write_async(0.0).await?;
        Ok(())
    }

    /// [`Ad5761::restore`] over an asynchronous bus.
    ///
    /// # Errors
    /// An error of the bus, or [`DacError::Control`].
    pub async fn restore_async(&mut self) -> Result<(), DacError<S::Error>> {
        match self.verify_async().await {
            Ok(()) => Ok(()),
            Err(_) => self.set_up_async().await,
        }
    }

    /// [`Ad5761::verify`] over an asynchronous bus.
    ///
    /// # Errors
    /// An error of the bus, [`DacError::Control`], [`DacError::Status`] or [`DacError::Output`].
    pub async fn verify_async(&mut self) -> Result<(), DacError<S::Error>> {
        self.spi.write(&frame(READ_CONTROL, 0)).await?;
        let control = self.transfer_async(READ_OUTPUT).await?;
        let output = self.transfer_async(NO_OPERATION).await?;
        held(control)?;
        sound(control)?;
        drives(self.code, output)
    }

    async fn transfer_async(&mut self, command: u8) -> Result<[u8; 3], S::Error> {
        let mut frame = frame(command, 0);
        self.spi.transfer_in_place(&mut frame).await?;
        Ok(frame)
    }

    /// [`Ad5761::write`] over an asynchronous bus.
    ///
    /// # Errors
    /// An error of the bus.
    pub async fn write_async(&mut self, value: f32) -> Result<Code, S::Error> {
        let code = self.scale.encode(value);
        self.spi.write(&frame(WRITE_AND_UPDATE, code.code)).await?;
        self.code = code.code;
        Ok(code)
    }
}
