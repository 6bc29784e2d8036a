//! The rig's tick, with converters simulated in memory, and the accumulator that finds its cycles by itself.

use core::cell::Cell;
use core::convert::Infallible;

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::spi::{self, Operation, SpiDevice};
use mesh_damper::adc::Ads8688;
use mesh_damper::converter::{MIDSCALE, Scale};
use mesh_damper::crossing::CrossingAccumulator;
use mesh_damper::cycle::Cycle;
use mesh_damper::dac::Ad5761;
use mesh_damper::effects::AugmentedLaw;
use mesh_damper::fast_law::{FastLaw, RunningLaw};
use mesh_damper::health::HealthSettings;
use mesh_damper::rig::{Rig, RigSettings, SpiRig, State, Telemetry};
use mesh_damper::sine::{Block, Programme};
use mesh_damper::table::PAPER;

use super::Refused;
use super::tally::{Meter, Moments, When};
use super::tick::{FREQUENCY, TICK_RATE};

/// mm
const AMPLITUDE: f64 = 0.1;
/// Cycles at full amplitude: those in which the monitor settles and learns, and as many in which it watches.
const CYCLES: u32 = 36;

/// Selects the ADC's second channel.
const SECOND: u8 = 0xC4;

/// Both converters. The ADC reads the DAC's code as the displacement, and the specimen's force on its other channel.
#[derive(Default)]
struct Wire {
    code: Cell<u16>,
    force: Cell<u16>,
    /// Whether the ADC's last frame selected the force.
    second: Cell<bool>,
    control: Cell<u16>,
    /// The DAC's output at its next frame.
    answer: Cell<u16>,
    /// The ADC register that was written last.
    register: Cell<u8>,
}

struct AdcBus<'a>(&'a Wire);
struct DacBus<'a>(&'a Wire);
struct Line;

impl spi::ErrorType for AdcBus<'_> {
    type Error = Infallible;
}

impl SpiDevice for AdcBus<'_> {
    #[inline]
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        for operation in operations {
            match operation {
                Operation::TransferInPlace([select, _, high, low]) => {
                    let second = self.0.second.replace(*select == SECOND);
                    let channel = if second { &self.0.force } else { &self.0.code };
                    [*high, *low] = channel.get().to_be_bytes();
                }
                // The driver reads the value that it wrote last.
                Operation::Write([_, value, _]) => self.0.register.set(*value),
                Operation::TransferInPlace([_, _, value]) => *value = self.0.register.get(),
                _ => {}
            }
        }
        Ok(())
    }
}

impl spi::ErrorType for DacBus<'_> {
    type Error = Infallible;
}

impl SpiDevice for DacBus<'_> {
    #[inline]
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        for operation in operations {
            match operation {
                Operation::Write([0x3, high, low]) => {
                    self.0.code.set(u16::from_be_bytes([*high, *low]));
                }
                Operation::Write([0x4, high, low]) => {
                    self.0.control.set(u16::from_be_bytes([*high, *low]));
                }
                Operation::Write([0xC, ..]) => self.0.answer.set(self.0.control.get()),
                Operation::TransferInPlace([command, high, low]) => {
                    [*high, *low] = self.0.answer.get().to_be_bytes();
                    if *command == 0xB {
                        self.0.answer.set(self.0.code.get());
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }
}

impl digital::ErrorType for Line {
    type Error = Infallible;
}

impl OutputPin for Line {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

struct Running<'a> {
    rig: SpiRig<AdcBus<'a>, DacBus<'a>, Line, 1, 1>,
    /// Ticks of a timer without losses.
    clock: u32,
    telemetry: Option<Telemetry>,
}

extern "C" fn tick(running: &mut Running, _: f32, _: f32) -> f32 {
    let telemetry = running.rig.tick(running.clock);
    running.clock = running.clock.wrapping_add(1);
    let force = telemetry.model_force;
    running.telemetry = Some(telemetry);
    force
}

extern "C" fn crossing(accumulator: &mut Measured, displacement: f32, force: f32) -> f32 {
    accumulator.cycle = accumulator.crossing.update(displacement, force);
    force
}

struct Measured {
    crossing: CrossingAccumulator,
    cycle: Option<Cycle>,
}

/// # Errors
/// None: every value is in its range and nothing stops the rig.
pub fn run(meter: &mut impl Meter) -> Result<(), Refused> {
    let wire = Wire::default();
    wire.code.set(MIDSCALE);
    wire.force.set(MIDSCALE);
    let (travel, force) = (Scale::new(0.512, 0.0)?, Scale::new(0.512, 0.0)?);
    let adc = Ads8688::new(AdcBus(&wire), travel, force).map_err(|_| Refused)?;
    let dac = Ad5761::new(DacBus(&wire), Scale::new(0.5, 0.0)?).map_err(|_| Refused)?;
    let block = Block::sine(AMPLITUDE, FREQUENCY, CYCLES)?;
    let programme = Programme::new(TICK_RATE, 1)?.with(block)?;
    let law = FastLaw::new(AugmentedLaw::new(PAPER.lookup(3.0, AMPLITUDE as f32).law));
    let law = RunningLaw::new(law);
    let settings = RigSettings {
        health: HealthSettings {
            follow: 0.1,
            ..HealthSettings::default()
        },
        ..RigSettings::default()
    };
    let rig = Rig::new(adc, dac, Line, &settings, programme, law)?;
    let mut running = Running {
        rig,
        clock: 0,
        telemetry: None,
    };
    running.rig.start().map_err(|_| Refused)?;
    let mut measured = Measured {
        crossing: CrossingAccumulator::new(0.1 * AMPLITUDE as f32)?,
        cycle: None,
    };
    let mut moments = Moments::default();
    let mut crossings = Moments::default();
    let mut cycles = 0;
    loop {
        let result = meter.call(tick, &mut running, 0.0, 0.0);
        let Some(now) = running.telemetry else {
            return Err(Refused);
        };
        // The specimen behaves exactly like the law.
        wire.force.set(force.encode(now.model_force).code);
        match now.state {
            State::Running => {}
            State::Done => break,
            State::Idle | State::Faulted(_) => return Err(Refused),
        }
        let when = When::of(false, now.ramp, now.cycle != cycles);
        cycles = now.cycle;
        moments.add(when, result, now.report.map(|report| report.model).as_ref());

        let result = meter.call(
            crossing,
            &mut measured,
            now.displacement,
            now.measured_force,
        );
        let when = When::of(false, now.ramp, measured.cycle.is_some());
        crossings.add(when, result, measured.cycle.as_ref());
    }
    moments.report(meter, "rig/tick");
    crossings.report(meter, "crossing/update");
    Ok(())
}
