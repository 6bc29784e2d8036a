//! The same frames over an asynchronous bus.

use embedded_hal_async::spi::SpiDevice;

use super::{Ad5761, DacError, NO_OPERATION, SET_UP, WRITE_AND_UPDATE, frame, held};
use crate::converter::{Code, MIDSCALE, Scale};

impl<S: SpiDevice> Ad5761<S> {
    /// [`Ad5761::new`] over an asynchronous bus.
    ///
    /// # Errors
    /// The bus's, or [`DacError::Control`].
    pub async fn new_async(mut spi: S, scale: Scale) -> Result<Self, DacError<S::Error>> {
        for each in &SET_UP {
            spi.write(each).await?;
        }
        let mut answer = frame(NO_OPERATION, 0);
        spi.transfer_in_place(&mut answer).await?;
        held(answer)?;
        spi.write(&frame(WRITE_AND_UPDATE, MIDSCALE)).await?;
        Ok(Self { spi, scale })
    }

    /// [`Ad5761::write`] over an asynchronous bus.
    ///
    /// # Errors
    /// The bus's.
    pub async fn write_async(&mut self, value: f32) -> Result<Code, S::Error> {
        let code = self.scale.encode(value);
        self.spi.write(&frame(WRITE_AND_UPDATE, code.code)).await?;
        Ok(code)
    }
}
