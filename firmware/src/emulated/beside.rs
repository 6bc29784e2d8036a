//! Converters of a board on its own timer, whose specimen is simulated outside the emulator.
//!
//! At each tick the emulator's standard output receives the actuator's state, and its standard input delivers the sensors' values.
//! No time of the board passes in between.
//!
//! ```text
//! out   u16 code of the DAC   u8 level of the enable line   u8 0   u32 the board's clock
//! in    u16 code of the displacement   u16 of the force   f32 temperature, °C   4 × f32 control inputs   u8 whether the stop is pressed
//! ```
//! Numbers are little-endian.

use core::sync::atomic::{AtomicU32, AtomicUsize, Ordering::Relaxed};

use mesh_damper::effects::CONTROLS;
use mesh_damper::frame::Reader;
use mesh_damper::rig::{Reading, Sensors, Wiring, WithAlive};

use super::clock::clock;
use super::converters::SimulatedConverters;
use super::file::{File, Mode};
use super::semihosting::exit;
use super::watchdog::Watchdog;
use crate::board::{Converters, Harnessed as _};

/// Bytes of the sensors' values.
const DELIVERED: usize = 9 + 4 * CONTROLS;

/// All three converters of a rig.
pub struct BesideConverters;

type Simulated = <SimulatedConverters as Converters>::Sensors;

/// °C, as bits.
static TEMPERATURE: AtomicU32 = AtomicU32::new(0);

impl Converters for BesideConverters {
    type Sensors = BesideSensors;
    type Actuator = WithAlive<<SimulatedConverters as Converters>::Actuator, Watchdog>;

    fn open(wiring: &Wiring) -> Option<(Self::Sensors, Self::Actuator)> {
        let (simulated, actuator) = SimulatedConverters::open(wiring)?;
        let sensors = BesideSensors {
            simulated,
            pipes: Pipes::open(),
        };
        Some((sensors, WithAlive::new(actuator, Watchdog::new())))
    }

    fn idle() {
        // Nobody needs the values.
        Pipes::open().pass();
    }

    fn temperature() -> f32 {
        f32::from_bits(TEMPERATURE.load(Relaxed))
    }
}

/// Handles of standard output and input, once they are open.
static OUTPUT: AtomicUsize = AtomicUsize::new(usize::MAX);
static INPUT: AtomicUsize = AtomicUsize::new(usize::MAX);

/// Pipes to and from the simulation of the specimen.
struct Pipes {
    driven: File,
    delivered: File,
}

impl Pipes {
    fn open() -> Self {
        Self {
            driven: File::shared(&OUTPUT, c"/dev/stdout", Mode::Write),
            delivered: File::shared(&INPUT, c"/dev/stdin", Mode::Read),
        }
    }

    /// Sends the actuator's state since the last tick, and receives the sensors' values. If nobody simulates the specimen any more,
    /// the emulator ends.
    fn pass(&mut self) -> [u8; DELIVERED] {
        let (code, enabled) = SimulatedConverters::driven();
        let [low, high] = code.to_le_bytes();
        let [c0, c1, c2, c3] = clock().to_le_bytes();
        let driven = [low, high, enabled.into(), 0, c0, c1, c2, c3];
        if !self.driven.write(&driven) {
            exit(true);
        }
        let mut bytes = [0; DELIVERED];
        let mut came = 0;
        while let Some(missing) = bytes.get_mut(came..).filter(|missing| !missing.is_empty()) {
            match self.delivered.read(missing).len() {
                0 => exit(true),
                more => came += more,
            }
        }
        bytes
    }
}

/// The sensors.
pub struct BesideSensors {
    simulated: Simulated,
    pipes: Pipes,
}

impl BesideSensors {
    /// Copies the values into the wires, or none of them if they are incomplete.
    fn take(&mut self, reader: &mut Reader<'_>) -> Option<()> {
        let (displacement, force) = (reader.u16()?, reader.u16()?);
        TEMPERATURE.store(reader.u32()?, Relaxed);
        let controls = reader.words()?.map(f32::from_bits);
        SimulatedConverters::sense(displacement, force);
        SimulatedConverters::control(&mut self.simulated, controls);
        SimulatedConverters::trip(reader.u8()? != 0);
        Some(())
    }
}

impl Sensors for BesideSensors {
    type Error = <Simulated as Sensors>::Error;

    #[inline]
    fn read(&mut self) -> Result<Reading, Self::Error> {
        let delivered = self.pipes.pass();
        self.take(&mut Reader(&delivered));
        self.simulated.read()
    }

    #[inline]
    fn is_tripped(&mut self) -> Result<bool, Self::Error> {
        self.simulated.is_tripped()
    }

    #[inline]
    fn restore(&mut self) -> Result<(), Self::Error> {
        self.simulated.restore()
    }
}
