//! Converters of an emulated board, which has none: they answer the drivers according to their datasheets, with values from the
//! link and for the link.

use core::convert::Infallible;
use core::sync::atomic::{AtomicBool, AtomicU16, Ordering::Relaxed};

use embedded_hal::digital::{self, InputPin, OutputPin};
use embedded_hal::spi::{self, ErrorKind, Operation, SpiDevice};

use mesh_damper::adc::Ads8688;
use mesh_damper::dac::Ad5761;
use mesh_damper::effects::CONTROLS;
use mesh_damper::rig::{SpiActuator, Wiring, WithControls, WithTrip};

use crate::board::{Converters, Harnessed};

/// The sensors' values at this tick, and the actuator's.
struct Wires {
    /// Code of the ADC's channel 0.
    displacement: AtomicU16,
    /// Code of channel 1.
    force: AtomicU16,
    /// Code of the DAC.
    command: AtomicU16,
    /// Level of the enable line.
    enabled: AtomicBool,
    /// Whether the stop input is active, and therefore low.
    tripped: AtomicBool,
}

/// The board's wires.
static WIRES: Wires = Wires {
    displacement: AtomicU16::new(0),
    force: AtomicU16::new(0),
    command: AtomicU16::new(0),
    enabled: AtomicBool::new(false),
    tripped: AtomicBool::new(false),
};

/// All three converters of a rig.
pub struct SimulatedConverters;

impl Converters for SimulatedConverters {
    type Sensors = WithTrip<WithControls<Ads8688<Adc>>, Trip>;
    type Actuator = SpiActuator<Dac, Enable>;

    #[inline]
    fn open(wiring: &Wiring) -> Option<(Self::Sensors, Self::Actuator)> {
        let adc = Adc {
            selected: 0,
            ranges: [0; 2],
        };
        let dac = Dac {
            control: 0,
            answer: 0,
        };
        let adc = Ads8688::new(adc, wiring.displacement, wiring.force).ok()?;
        let dac = Ad5761::new(dac, wiring.command).ok()?;
        let sensors = WithControls {
            sensors: adc,
            controls: [0.0; CONTROLS],
        };
        Some((WithTrip::new(sensors, Trip), SpiActuator::new(dac, Enable)))
    }
}

impl Harnessed for SimulatedConverters {
    #[inline]
    fn sense(displacement: u16, force: u16) {
        WIRES.displacement.store(displacement, Relaxed);
        WIRES.force.store(force, Relaxed);
    }

    #[inline]
    fn control(sensors: &mut Self::Sensors, controls: [f32; CONTROLS]) {
        sensors.sensors.controls = controls;
    }

    #[inline]
    fn trip(tripped: bool) {
        WIRES.tripped.store(tripped, Relaxed);
    }

    #[inline]
    fn driven() -> (u16, bool) {
        (WIRES.command.load(Relaxed), WIRES.enabled.load(Relaxed))
    }
}

/// The frame of a transaction with one operation; the drivers use no other kind.
#[inline]
fn one_frame(
    operations: &mut [Operation<'_, u8>],
    answer: impl FnOnce(&[u8]) -> [u8; 4],
) -> Result<(), ErrorKind> {
    match operations {
        [Operation::Write(words)] => {
            answer(words);
        }
        [Operation::TransferInPlace(words)] => {
            let answer = answer(words);
            for (to, from) in words.iter_mut().zip(answer) {
                *to = from;
            }
        }
        _ => return Err(ErrorKind::Other),
    }
    Ok(())
}

/// Address of the first channel's range.
const FIRST_RANGE: u8 = 0x05;

/// An ADS8688 that delivers codes independently of its ranges.
pub struct Adc {
    /// The channel that the next frame converts.
    selected: u8,
    /// Its registers of both channels' ranges; there are no others.
    ranges: [u8; 2],
}

impl spi::ErrorType for Adc {
    type Error = ErrorKind;
}

impl SpiDevice for Adc {
    #[inline]
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        one_frame(operations, |sent| match sent {
            // Converts the channel selected before; the command selects the next.
            [command, _, _, _] => {
                let wire = if self.selected == 0 {
                    &WIRES.displacement
                } else {
                    &WIRES.force
                };
                self.selected = command >> 2 & 0x7;
                let [high, low] = wire.load(Relaxed).to_be_bytes();
                [0, 0, high, low]
            }
            // A register stores the written value, and returns it in the last byte.
            [address, value, _] => {
                let place = usize::from((address >> 1).wrapping_sub(FIRST_RANGE));
                let Some(register) = self.ranges.get_mut(place) else {
                    return [0; 4];
                };
                if address & 1 != 0 {
                    *register = *value;
                }
                [0, 0, *register, 0]
            }
            _ => [0; 4],
        })
    }
}

/// An AD5761R.
pub struct Dac {
    control: u16,
    /// The output of the next frame.
    answer: u16,
}

impl spi::ErrorType for Dac {
    type Error = ErrorKind;
}

impl SpiDevice for Dac {
    #[inline]
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        one_frame(operations, |sent| {
            let &[command, high, low] = sent else {
                return [0; 4];
            };
            let data = u16::from_be_bytes([high, low]);
            let [answer_high, answer_low] = self.answer.to_be_bytes();
            self.answer = 0;
            match command & 0xF {
                0x3 => WIRES.command.store(data, Relaxed),
                0x4 => self.control = data,
                0xB => self.answer = WIRES.command.load(Relaxed),
                0xC => self.answer = self.control,
                _ => {}
            }
            [0, answer_high, answer_low, 0]
        })
    }
}

/// The line that enables the actuator.
pub struct Enable;

impl digital::ErrorType for Enable {
    type Error = Infallible;
}

impl OutputPin for Enable {
    #[inline]
    fn set_low(&mut self) -> Result<(), Infallible> {
        WIRES.enabled.store(false, Relaxed);
        Ok(())
    }
    #[inline]
    fn set_high(&mut self) -> Result<(), Infallible> {
        WIRES.enabled.store(true, Relaxed);
        Ok(())
    }
}

/// The line of an emergency stop, high while all is well.
pub struct Trip;

impl digital::ErrorType for Trip {
    type Error = Infallible;
}

impl InputPin for Trip {
    #[inline]
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(!WIRES.tripped.load(Relaxed))
    }
    #[inline]
    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(WIRES.tripped.load(Relaxed))
    }
}
