//! A rig and a damper emulation on the two SPI parts of [`crate::adc`] and [`crate::dac`].

use core::borrow::{Borrow, BorrowMut};

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

use super::emulation::{DamperEmulationSettings, EmulationController};
use super::io::{Actuator, Reading, Sensors, Wiring};
#[cfg(feature = "async")]
use super::io::{AsyncActuator, AsyncSensors};
use super::rig_controller::RigController;
use super::wired::Blocking;
use super::{DamperEmulation, Rig, RigConfig, RigSettings};
use crate::adc::{AdcError, Ads8688};
use crate::dac::{Ad5761, DacError};
use crate::error::ConfigError;
use crate::fast_law::RunningLaw;
#[cfg(feature = "async")]
use crate::forms::later;
use crate::forms::now;
use crate::sine::{Programme, SineGenerator};
use crate::tick_law::TickLaw;

/// A [`Rig`] on an ADS8688, an AD5761R and a pin, with up to `B` blocks in its programme and up to `N` effects in its law.
pub type SpiRig<A, D, E, const B: usize, const N: usize, X = SineGenerator<B>, L = RunningLaw<N>> =
    Rig<Ads8688<A>, SpiActuator<D, E>, N, X, L>;

/// A [`DamperEmulation`] on an ADS8688, an AD5761R and a pin.
pub type SpiDamperEmulation<A, D, E, L> = DamperEmulation<Ads8688<A>, SpiActuator<D, E>, L>;

/// An actuator that an AD5761R drives and a pin enables.
#[derive(Debug)]
pub struct SpiActuator<D, E> {
    dac: Ad5761<D>,
    enable: E,
}

impl<D, E> SpiActuator<D, E> {
    /// The scale of `dac` is that of the command, in mm, or in kN in a damper emulation. `enable` is high while the actuator may
    /// move.
    pub fn new(dac: Ad5761<D>, enable: E) -> Self {
        Self { dac, enable }
    }
}

/// Failure of a [`SpiActuator`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum SpiActuatorError<D, E> {
    /// The DAC or its bus.
    Dac(D),
    /// The pin.
    Enable(E),
}

/// The two parts in the form of `$wait`.
macro_rules! parts {
    (
        $bus:path, $sensors:ident, $actuator:ident,
        $read:ident, $write:ident, $verify:ident, $restore:ident, $wait:ident $(, $async:tt)?
    ) => {
        impl<A: $bus> $sensors for Ads8688<A> {
            type Error = AdcError<A::Error>;

            #[inline]
            $($async)? fn read(&mut self) -> Result<Reading, Self::Error> {
                Ok($wait!(Ads8688::$read(self))?)
            }

            $($async)? fn restore(&mut self) -> Result<(), Self::Error> {
                $wait!(Ads8688::$restore(self))
            }
        }

        impl<D: $bus, E: OutputPin> $actuator for SpiActuator<D, E> {
            type Error = SpiActuatorError<DacError<D::Error>, E::Error>;

            #[inline]
            $($async)? fn drive(&mut self, value: f32) -> Result<(), Self::Error> {
                match $wait!(self.dac.$write(value)) {
                    Ok(_) => Ok(()),
                    Err(error) => Err(SpiActuatorError::Dac(error.into())),
                }
            }

            #[inline]
            $($async)? fn enable(&mut self, on: bool) -> Result<(), Self::Error> {
                self.enable
                    .set_state(on.into())
                    .map_err(SpiActuatorError::Enable)
            }

            $($async)? fn verify_drive(&mut self) -> Result<(), Self::Error> {
                $wait!(self.dac.$verify()).map_err(SpiActuatorError::Dac)
            }

            $($async)? fn restore(&mut self) -> Result<(), Self::Error> {
                $wait!(self.dac.$restore()).map_err(SpiActuatorError::Dac)
            }
        }
    };
}

parts!(
    SpiDevice, Sensors, Actuator, read, write, verify, restore, now
);
#[cfg(feature = "async")]
parts!(
    embedded_hal_async::spi::SpiDevice,
    AsyncSensors,
    AsyncActuator,
    read_async,
    write_async,
    verify_async,
    restore_async,
    later,
    async
);

impl<A, D, E, const B: usize, const N: usize, P, L>
    Blocking<RigController<N, SineGenerator<B, P>, L>, Ads8688<A>, SpiActuator<D, E>>
where
    A: SpiDevice,
    D: SpiDevice,
    E: OutputPin,
    P: Borrow<Programme<B>>,
    L: BorrowMut<RunningLaw<N>>,
{
    /// Idle, enable line low. The DAC's scale is that of the command in mm. Ticks run at the programme's rate. `programme` and
    /// `law` are either values or references.
    ///
    /// # Errors
    /// A setting that is not finite or out of range; a programme without blocks.
    pub fn new(
        adc: Ads8688<A>,
        dac: Ad5761<D>,
        enable: E,
        settings: &RigSettings,
        programme: P,
        law: L,
    ) -> Result<Self, ConfigError> {
        let config = settings.at(programme.borrow().tick_rate())?;
        Self::with_config(adc, dac, enable, &config, programme, law)
    }

    /// [`Rig::new`] with settings converted for the programme's tick rate.
    ///
    /// # Errors
    /// A programme without blocks.
    pub fn with_config(
        adc: Ads8688<A>,
        dac: Ad5761<D>,
        enable: E,
        config: &RigConfig,
        programme: P,
        law: L,
    ) -> Result<Self, ConfigError> {
        // Calls that may fail come first, so that the rest is built in its final place.
        let generator = SineGenerator::new(programme)?;
        let wiring = wiring(&adc, &dac);
        let controller = RigController::with_exciter(config, &wiring, generator, law);
        Ok(Self::wire(controller, adc, SpiActuator::new(dac, enable)))
    }
}

impl<A, D, E, L> Blocking<EmulationController<L>, Ads8688<A>, SpiActuator<D, E>>
where
    A: SpiDevice,
    D: SpiDevice,
    E: OutputPin,
    L: TickLaw,
{
    /// Idle, enable line low. The DAC's scale is that of the force in kN. `law` is the law or a reference to it.
    ///
    /// # Errors
    /// A setting that is not finite or out of range.
    pub fn new(
        adc: Ads8688<A>,
        dac: Ad5761<D>,
        enable: E,
        settings: &DamperEmulationSettings,
        law: L,
    ) -> Result<Self, ConfigError> {
        let controller = EmulationController::new(settings, &wiring(&adc, &dac), law)?;
        Ok(Self::wire(controller, adc, SpiActuator::new(dac, enable)))
    }
}

fn wiring<A, D>(adc: &Ads8688<A>, dac: &Ad5761<D>) -> Wiring {
    let [displacement, force] = adc.scales();
    Wiring {
        displacement,
        force,
        command: *dac.scale(),
    }
}
