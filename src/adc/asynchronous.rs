//! The same frames over an asynchronous bus.

use embedded_hal_async::spi::SpiDevice;

use super::{
    AdcError, Ads8688, RANGES, RESET, SELECT_DISPLACEMENT, SELECT_FORCE, conversion_frame, held,
    register_frames, result_of,
};
use crate::converter::Scale;
use crate::rig::Reading;

impl<S: SpiDevice> Ads8688<S> {
    /// [`Ads8688::new`] over an asynchronous bus.
    ///
    /// # Errors
    /// An error of the bus, or [`AdcError::Register`].
    pub async fn new_async(
        spi: S,
        displacement: Scale,
        force: Scale,
    ) -> Result<Self, AdcError<S::Error>> {
        let mut part = Self::unset(spi, displacement, force);
        part.restore_async().await?;
        Ok(part)
    }

    /// [`Ads8688::restore`] over an asynchronous bus.
    ///
    /// # Errors
    /// An error of the bus, or [`AdcError::Register`].
    pub async fn restore_async(&mut self) -> Result<(), AdcError<S::Error>> {
        self.in_step = false;
        self.spi.write(&[RESET, 0, 0, 0]).await?;
        for (address, value) in RANGES {
            let [write, mut read] = register_frames(address, value);
            self.spi.write(&write).await?;
            self.spi.transfer_in_place(&mut read).await?;
            held(address, value, read)?;
        }
        Ok(())
    }

    /// [`Ads8688::read`] over an asynchronous bus. Dropping the call before it completes has the same effect as a bus error.
    ///
    /// # Errors
    /// An error of the bus.
    pub async fn read_async(&mut self) -> Result<Reading, S::Error> {
        if !self.in_step {
            self.convert_async(SELECT_DISPLACEMENT).await?;
        }
        self.in_step = false;
        let displacement = self.convert_async(SELECT_FORCE).await?;
        let force = self.convert_async(SELECT_DISPLACEMENT).await?;
        self.in_step = true;
        Ok(self.reading(displacement, force))
    }

    async fn convert_async(&mut self, select: u8) -> Result<u16, S::Error> {
        let mut frame = conversion_frame(select);
        self.spi.transfer_in_place(&mut frame).await?;
        Ok(result_of(frame))
    }
}
