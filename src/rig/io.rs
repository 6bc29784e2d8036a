//! Inputs and outputs of a controller at each tick, and the interfaces of sensors and actuators.

use crate::converter::{Sample, Scale};
use crate::effects::CONTROLS;
#[cfg(feature = "async")]
use crate::forms::later;
use crate::forms::now;

/// Sensor values at one tick.
///
/// A value that is not finite counts as a missing measurement, and exceeds every limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reading {
    /// Displacement, mm.
    pub displacement: Sample,
    /// Force, kN.
    pub force: Sample,
    /// Control inputs of the specimen, such as a current, a voltage or a pressure: those of
    /// [`Motion::controls`](crate::effects::Motion::controls), in the units of the law's effects; 0 for an input that does not
    /// exist.
    pub controls: [f32; CONTROLS],
}

/// Command to the actuator until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Command {
    /// Displacement in mm, or force in kN in a damper emulation; within the range of [`Wiring::command`].
    pub value: f32,
    /// Level of the enable line. While it is low, the value is 0 or on its way to 0.
    pub enabled: bool,
}

/// Scales of a controller's three channels. For a converter of another width use the scale of 16 bits over the same range.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wiring {
    /// Scale of the displacement, mm.
    pub displacement: Scale,
    /// Scale of the force, kN.
    pub force: Scale,
    /// Scale of the command, mm, or kN in a damper emulation. A command beyond its ends stops the controller.
    pub command: Scale,
}

/// Sensors of displacement and force, with control inputs from elsewhere: an [`Ads8688`](crate::adc::Ads8688) converts two
/// channels, and another task sets the current through a coil.
#[derive(Clone, Debug)]
pub struct WithControls<S> {
    /// The sensors; the control inputs of their readings are ignored.
    pub sensors: S,
    /// Control inputs for each reading.
    pub controls: [f32; CONTROLS],
}

/// The two traits, and [`WithControls`], in the form of `$wait`.
macro_rules! traits {
    (
        $(#[$about_sensors:meta])* $sensors:ident,
        $(#[$about_actuator:meta])* $actuator:ident, $wait:ident $(, $async:tt)?
    ) => {
        $(#[$about_sensors])*
        pub trait $sensors {
            /// Error of a reading.
            type Error;

            /// Reads displacement, force and control inputs.
            ///
            /// # Errors
            /// Any error of the reading. The controller trips with [`super::TripCause::AdcBus`].
            $($async)? fn read(&mut self) -> Result<Reading, Self::Error>;

            /// Whether an external stop input is active: an emergency stop, a guard, a second controller. It is read at each tick, at a
            /// start and at a clear. While it is active, start and clear are refused, and the controller trips with
            /// [`super::TripCause::External`], a trip cause that stays when the input ends. By default there is no input.
            ///
            /// # Errors
            /// The input cannot be read, which counts as active.
            #[inline]
            $($async)? fn is_tripped(&mut self) -> Result<bool, Self::Error> {
                Ok(false)
            }

            /// Sets up the parts again, which may have lost their supply. Called by a clear, at rest. By default it does nothing.
            ///
            /// # Errors
            /// The parts cannot be set up. The clear is then refused, with [`super::TripCause::AdcBus`].
            #[inline]
            $($async)? fn restore(&mut self) -> Result<(), Self::Error> {
                Ok(())
            }
        }

        $(#[$about_actuator])*
        pub trait $actuator {
            /// Error of the actuator.
            type Error;

            /// Drives `value`, in mm, or in kN of a damper emulation.
            ///
            /// # Errors
            /// The actuator keeps the previous value. The controller trips with [`super::TripCause::DacBus`].
            $($async)? fn drive(&mut self, value: f32) -> Result<(), Self::Error>;

            /// Sets the enable line.
            ///
            /// # Errors
            /// Its level is unknown. The controller trips with [`super::TripCause::EnableLine`].
            $($async)? fn enable(&mut self, on: bool) -> Result<(), Self::Error>;

            /// Reads back the output, without changing it, and checks that it is the last command. Called every [`super::VERIFY_TICKS`]
            /// ticks, after the tick's command. By default the output is assumed to be correct.
            ///
            /// # Errors
            /// The output differs, or cannot be read back. The controller trips with [`super::TripCause::DacBus`].
            #[inline]
            $($async)? fn verify_drive(&mut self) -> Result<(), Self::Error> {
                Ok(())
            }

            /// Reads back the level of the enable line, and checks it. Called every [`super::VERIFY_TICKS`] ticks, and right after each
            /// [`Self::enable`]. By default the level is assumed to be correct.
            ///
            /// # Errors
            /// The level differs, or cannot be read back. The controller trips with [`super::TripCause::EnableLine`].
            #[inline]
            $($async)? fn verify_enable(&mut self, _on: bool) -> Result<(), Self::Error> {
                Ok(())
            }

            /// Signals to an external watchdog that a tick did all of its work. Called at the end of each such tick. By default there is no
            /// watchdog.
            ///
            /// # Errors
            /// The signal failed. The controller ignores this: the watchdog notices it.
            #[inline]
            $($async)? fn alive(&mut self) -> Result<(), Self::Error> {
                Ok(())
            }

            /// Sets up the parts again, which may have lost their supply, with an output of 0. Called by a clear, at rest, with the enable
            /// line low. By default it does nothing.
            ///
            /// # Errors
            /// The parts cannot be set up. The clear is then refused, with [`super::TripCause::DacBus`].
            #[inline]
            $($async)? fn restore(&mut self) -> Result<(), Self::Error> {
                Ok(())
            }
        }

        impl<S: $sensors> $sensors for WithControls<S> {
            type Error = S::Error;

            #[inline]
            $($async)? fn read(&mut self) -> Result<Reading, S::Error> {
                Ok(Reading {
                    controls: self.controls,
                    ..$wait!(self.sensors.read())?
                })
            }

            #[inline]
            $($async)? fn is_tripped(&mut self) -> Result<bool, S::Error> {
                $wait!(self.sensors.is_tripped())
            }

            $($async)? fn restore(&mut self) -> Result<(), S::Error> {
                $wait!(self.sensors.restore())
            }
        }
    };
}

traits!(
    /// Sensors with blocking calls.
    Sensors,
    /// An actuator with blocking calls.
    Actuator,
    now
);
#[cfg(feature = "async")]
traits!(
    /// [`Sensors`] with asynchronous calls.
    #[expect(async_fn_in_trait, reason = "a driver's executor decides whether its futures are sent")]
    AsyncSensors,
    /// [`Actuator`] with asynchronous calls.
    #[expect(async_fn_in_trait, reason = "a driver's executor decides whether its futures are sent")]
    AsyncActuator,
    later,
    async
);
