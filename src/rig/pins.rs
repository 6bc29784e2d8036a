//! Pins that supervise a rig, for any sensors and any actuator: an external trip, a read-back of the enable line, and an alive
//! signal.

use embedded_hal::digital::{InputPin, OutputPin, PinState};

use super::io::{Actuator, Reading, Sensors};
#[cfg(feature = "async")]
use super::io::{AsyncActuator, AsyncSensors};
#[cfg(feature = "async")]
use crate::forms::later;
use crate::forms::now;

/// Failure of a part with an additional pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum PinError<T, P> {
    /// The sensors or the actuator.
    Part(T),
    /// The pin.
    Pin(P),
    /// The pin is at the other level.
    Level,
}

/// Sensors with a stop input: see [`Sensors::is_tripped`].
///
/// The pin is sampled once per tick, and a pulse shorter than a tick may be missed. The source must hold its level, as the relay of
/// an emergency stop does.
#[derive(Clone, Debug)]
pub struct WithTrip<S, P> {
    /// The sensors.
    pub sensors: S,
    /// The input.
    pub pin: P,
    /// Its level at which the input is active.
    pub active: PinState,
}

impl<S, P> WithTrip<S, P> {
    /// Active low. With a source that holds the line high while all is well, and a pull-down at the pin, a broken wire is a stop.
    pub fn new(sensors: S, pin: P) -> Self {
        Self {
            sensors,
            pin,
            active: PinState::Low,
        }
    }
}

impl<S, P: InputPin> WithTrip<S, P> {
    #[inline]
    fn is_active<T>(&mut self) -> Result<bool, PinError<T, P::Error>> {
        is_at(&mut self.pin, self.active)
    }
}

/// Whether `pin` is at `level`.
#[inline]
fn is_at<T, P: InputPin>(pin: &mut P, level: PinState) -> Result<bool, PinError<T, P::Error>> {
    let high = pin.is_high().map_err(PinError::Pin)?;
    Ok(high == (level == PinState::High))
}

/// An actuator whose enable line is read back: see [`Actuator::verify_enable`].
///
/// The pin must sense the line as close to the actuator as possible, so that the read-back covers the driver and the wire. It must
/// follow the line within the time between two calls, about 1 µs, which a relay's contact does not.
#[derive(Clone, Debug)]
pub struct WithReadBack<A, P> {
    /// The actuator.
    pub actuator: A,
    /// The input at the line.
    pub pin: P,
    /// Its level while the actuator is enabled.
    pub enabled: PinState,
}

impl<A, P> WithReadBack<A, P> {
    /// High while the actuator is enabled. For an inverting part, such as an optocoupler, set [`WithReadBack::enabled`] to low.
    pub fn new(actuator: A, pin: P) -> Self {
        Self {
            actuator,
            pin,
            enabled: PinState::High,
        }
    }
}

impl<A, P: InputPin> WithReadBack<A, P> {
    #[inline]
    fn verify_level<T>(&mut self, on: bool) -> Result<(), PinError<T, P::Error>> {
        if is_at(&mut self.pin, self.enabled)? == on {
            Ok(())
        } else {
            Err(PinError::Level)
        }
    }
}

/// An actuator with an alive signal: its pin toggles at the end of each tick that did all of its work. See [`Actuator::alive`].
///
/// An external watchdog cuts the actuator's power if the level has not changed for some ticks. It should wait for at least three,
/// because one late tick must not trigger it, and should require edges, because a stuck level is no sign of life.
#[derive(Clone, Debug)]
pub struct WithAlive<A, P> {
    /// The actuator.
    pub actuator: A,
    /// The output to the watchdog.
    pub pin: P,
    level: bool,
}

impl<A, P> WithAlive<A, P> {
    /// The first complete tick sets `pin` high.
    pub fn new(actuator: A, pin: P) -> Self {
        Self {
            actuator,
            pin,
            level: false,
        }
    }
}

impl<A, P: OutputPin> WithAlive<A, P> {
    #[inline]
    fn toggle<T>(&mut self) -> Result<(), PinError<T, P::Error>> {
        let level = !self.level;
        self.pin.set_state(level.into()).map_err(PinError::Pin)?;
        self.level = level;
        Ok(())
    }
}

/// What the pins add, in the form of `$wait`.
macro_rules! pins {
    ($sensors:ident, $actuator:ident, $wait:ident $(, $async:tt)?) => {
        impl<S: $sensors, P: InputPin> $sensors for WithTrip<S, P> {
            type Error = PinError<S::Error, P::Error>;

            #[inline]
            $($async)? fn read(&mut self) -> Result<Reading, Self::Error> {
                $wait!(self.sensors.read()).map_err(PinError::Part)
            }

            #[inline]
            $($async)? fn is_tripped(&mut self) -> Result<bool, Self::Error> {
                Ok(self.is_active()? || $wait!(self.sensors.is_tripped()).map_err(PinError::Part)?)
            }

            $($async)? fn restore(&mut self) -> Result<(), Self::Error> {
                $wait!(self.sensors.restore()).map_err(PinError::Part)
            }
        }

        impl<A: $actuator, P: InputPin> $actuator for WithReadBack<A, P> {
            type Error = PinError<A::Error, P::Error>;

            #[inline]
            $($async)? fn drive(&mut self, value: f32) -> Result<(), Self::Error> {
                $wait!(self.actuator.drive(value)).map_err(PinError::Part)
            }

            #[inline]
            $($async)? fn enable(&mut self, on: bool) -> Result<(), Self::Error> {
                $wait!(self.actuator.enable(on)).map_err(PinError::Part)
            }

            $($async)? fn verify_drive(&mut self) -> Result<(), Self::Error> {
                $wait!(self.actuator.verify_drive()).map_err(PinError::Part)
            }

            $($async)? fn verify_enable(&mut self, on: bool) -> Result<(), Self::Error> {
                $wait!(self.actuator.verify_enable(on)).map_err(PinError::Part)?;
                self.verify_level(on)
            }

            #[inline]
            $($async)? fn alive(&mut self) -> Result<(), Self::Error> {
                $wait!(self.actuator.alive()).map_err(PinError::Part)
            }

            $($async)? fn restore(&mut self) -> Result<(), Self::Error> {
                $wait!(self.actuator.restore()).map_err(PinError::Part)
            }
        }

        impl<A: $actuator, P: OutputPin> $actuator for WithAlive<A, P> {
            type Error = PinError<A::Error, P::Error>;

            #[inline]
            $($async)? fn drive(&mut self, value: f32) -> Result<(), Self::Error> {
                $wait!(self.actuator.drive(value)).map_err(PinError::Part)
            }

            #[inline]
            $($async)? fn enable(&mut self, on: bool) -> Result<(), Self::Error> {
                $wait!(self.actuator.enable(on)).map_err(PinError::Part)
            }

            $($async)? fn verify_drive(&mut self) -> Result<(), Self::Error> {
                $wait!(self.actuator.verify_drive()).map_err(PinError::Part)
            }

            $($async)? fn verify_enable(&mut self, on: bool) -> Result<(), Self::Error> {
                $wait!(self.actuator.verify_enable(on)).map_err(PinError::Part)
            }

            #[inline]
            $($async)? fn alive(&mut self) -> Result<(), Self::Error> {
                $wait!(self.actuator.alive()).map_err(PinError::Part)?;
                self.toggle()
            }

            $($async)? fn restore(&mut self) -> Result<(), Self::Error> {
                $wait!(self.actuator.restore()).map_err(PinError::Part)
            }
        }
    };
}

pins!(Sensors, Actuator, now);
#[cfg(feature = "async")]
pins!(AsyncSensors, AsyncActuator, later, async);
