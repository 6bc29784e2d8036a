//! What measures the specimen, what drives the actuator, and the pins that supervise both.

use embedded_hal_bus::spi::{ExclusiveDevice, NoDelay};
use mesh_damper::adc::Ads8688;
use mesh_damper::dac::Ad5761;
use mesh_damper::rig::{SpiActuator, Wiring, WithAlive, WithReadBack, WithTrip};
use mesh_damper_firmware::Converters;
use stm32f4xx_hal::gpio::{Input, Output, PA4, PB0, PB1, PB5, PB6, PB12};
use stm32f4xx_hal::pac::{SPI1, SPI2};
use stm32f4xx_hal::spi::Spi;

use crate::handed::Handed;

/// SPI1 with the chip select of the ADS8688, and SPI2 with that of the AD5761R.
pub type AdcBus = ExclusiveDevice<Spi<SPI1>, PA4<Output>, NoDelay>;
pub type DacBus = ExclusiveDevice<Spi<SPI2>, PB12<Output>, NoDelay>;

/// What `board.rs` makes them of.
pub struct Parts {
    pub adc: AdcBus,
    pub dac: DacBus,
    /// High where the actuator may move.
    pub enable: PB1<Output>,
    /// The level at the enable line's far end.
    pub read_back: PB0<Input>,
    /// High while all is well.
    pub trip: PB5<Input>,
    /// To the external watchdog.
    pub alive: PB6<Output>,
}

/// From the start to the set-up.
pub static PARTS: Handed<Parts> = Handed::new();

/// The board's.
pub struct OwnConverters;

impl Converters for OwnConverters {
    type Sensors = WithTrip<Ads8688<AdcBus>, PB5<Input>>;
    type Actuator =
        WithAlive<WithReadBack<SpiActuator<DacBus, PB1<Output>>, PB0<Input>>, PB6<Output>>;

    fn open(wiring: &Wiring) -> Option<(Self::Sensors, Self::Actuator)> {
        let parts = PARTS.take()?;
        // Each part is asked for what it was set to: a line that is held is no part.
        let adc = Ads8688::new(parts.adc, wiring.displacement, wiring.force).ok()?;
        let dac = Ad5761::new(parts.dac, wiring.command).ok()?;
        let actuator = WithReadBack::new(SpiActuator::new(dac, parts.enable), parts.read_back);
        Some((
            WithTrip::new(adc, parts.trip),
            WithAlive::new(actuator, parts.alive),
        ))
    }
}
