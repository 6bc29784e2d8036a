//! What goes into a controller and comes out of it at each tick, and the parts that deliver and take it.

use crate::converter::{Sample, Scale};
use crate::effects::CONTROLS;

/// What the sensors say at one tick.
///
/// A value that is not finite counts as a missing measurement, and exceeds every limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Reading {
    /// mm.
    pub displacement: Sample,
    /// kN.
    pub force: Sample,
    /// Control inputs of the specimen, such as a current, a voltage or a pressure: those of
    /// [`Motion::controls`](crate::effects::Motion::controls), in the units of the law's effects; 0 where there is none.
    pub controls: [f32; CONTROLS],
}

/// What the actuator is to do until the next tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Command {
    /// mm, or kN of a damper emulation; within the range of [`Wiring::command`].
    pub value: f32,
    /// Level of the enable line. Where it is low the value is on its way to 0, or there.
    pub enabled: bool,
}

/// Scales of the three channels that a controller is wired to. Of a converter of another width, that of 16 bits over the same
/// range.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Wiring {
    /// Of the displacement, mm.
    pub displacement: Scale,
    /// Of the force, kN.
    pub force: Scale,
    /// Of the command, mm, or kN of a damper emulation. A command beyond its ends stops the controller.
    pub command: Scale,
}

/// Sensors that are read in a call that waits for them.
pub trait Sensors {
    /// Why there is no reading.
    type Error;

    /// Displacement, force and control inputs of now.
    ///
    /// # Errors
    /// Whatever keeps it from reading. The controller stops with [`super::TripCause::AdcBus`].
    fn read(&mut self) -> Result<Reading, Self::Error>;

    /// Whether an input from outside says stop: an emergency stop, a guard, a second controller. It is asked at each tick, at a start
    /// and at a clear, and neither of these is done while it says so. The controller stops with [`super::TripCause::External`],
    /// which stays when the input is over. By default there is none.
    ///
    /// # Errors
    /// Where the input cannot be read, which counts as a stop.
    #[inline]
    fn is_tripped(&mut self) -> Result<bool, Self::Error> {
        Ok(false)
    }

    /// Sets the parts up again, which may have lost their supply: called by a clear, at rest. By default there is nothing to do.
    ///
    /// # Errors
    /// What keeps them from working: the clear is refused then, with [`super::TripCause::AdcBus`].
    #[inline]
    fn restore(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// An actuator that is driven in calls that wait for it.
pub trait Actuator {
    /// Why it did not do as it was told.
    type Error;

    /// Drives `value`, in mm, or in kN of a damper emulation.
    ///
    /// # Errors
    /// Where the actuator goes on with the value before. The controller stops with [`super::TripCause::DacBus`].
    fn drive(&mut self, value: f32) -> Result<(), Self::Error>;

    /// Sets the enable line.
    ///
    /// # Errors
    /// Where its level is unknown. The controller stops with [`super::TripCause::EnableLine`].
    fn enable(&mut self, on: bool) -> Result<(), Self::Error>;

    /// Reads back that what was driven last is driven, without a change of it: called every [`super::VERIFY_TICKS`] ticks, after
    /// the tick's command. By default it is taken for so.
    ///
    /// # Errors
    /// Where it is not so, or cannot be read back. The controller stops with [`super::TripCause::DacBus`].
    #[inline]
    fn verify_drive(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Reads back that the enable line is at this level: called every [`super::VERIFY_TICKS`] ticks, and right after each
    /// [`Actuator::enable`]. By default it is taken for so.
    ///
    /// # Errors
    /// Where it is not so, or cannot be read back. The controller stops with [`super::TripCause::EnableLine`].
    #[inline]
    fn verify_enable(&mut self, _on: bool) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Tells an external watchdog that a tick did all it had to: called at the end of each that did. By default there is none.
    ///
    /// # Errors
    /// Where it could not. Nothing follows from that: the watchdog sees it.
    #[inline]
    fn alive(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Sets the parts up again, which may have lost their supply, to drive 0: called by a clear, at rest, with the enable line
    /// low. By default there is nothing to do.
    ///
    /// # Errors
    /// What keeps them from working: the clear is refused then, with [`super::TripCause::DacBus`].
    #[inline]
    fn restore(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// Sensors of displacement and force, with control inputs that somebody else knows: an [`Ads8688`](crate::adc::Ads8688) converts
/// two channels, and the current through a coil is what another task sets.
#[derive(Clone, Debug)]
pub struct WithControls<S> {
    /// The sensors; the control inputs of their readings do not count.
    pub sensors: S,
    /// What each reading has in the place of them.
    pub controls: [f32; CONTROLS],
}

impl<S: Sensors> Sensors for WithControls<S> {
    type Error = S::Error;

    #[inline]
    fn read(&mut self) -> Result<Reading, S::Error> {
        Ok(Reading {
            controls: self.controls,
            ..self.sensors.read()?
        })
    }

    #[inline]
    fn is_tripped(&mut self) -> Result<bool, S::Error> {
        self.sensors.is_tripped()
    }

    fn restore(&mut self) -> Result<(), S::Error> {
        self.sensors.restore()
    }
}
