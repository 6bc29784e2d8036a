//! What the images need of a board, and nothing more.

use mesh_damper::effects::CONTROLS;
use mesh_damper::rig::{Actuator, Sensors, Wiring};

/// A board. Its memories are not here: they stand in the `memory.x` that the linker finds in the working directory.
pub trait Board: 'static {
    /// Clock of the core's SysTick timer, MHz: `bench` counts with it.
    const SYSTICK: u32;
    /// Bytes to and from the harness.
    type Link: Link;
    /// Where log messages go.
    type Log: Log;
    /// ADC, DAC and enable line.
    type Converters: Converters;

    /// Clocks and pins, before anything else of an image, with the actuator disabled. What it takes of the chip's peripherals, the
    /// other parts of the board find in a static of the board's. By default there is nothing to do.
    #[inline]
    fn prepare() {}

    /// The end of an image: of one that did what it was for, or that failed.
    fn exit(success: bool) -> !;

    /// Restarts, as after its supply came: somebody new is at the other end of the link. By default it ends.
    fn reset() -> ! {
        Self::exit(false)
    }
}

/// A board that gives the rig its ticks by itself: by SysTick, at the rate that it is set up for.
#[cfg(target_os = "none")]
pub trait OwnTimer: Board {
    /// The serial port to the harness.
    type Port: Port;
    /// Rate of the counter that [`OwnTimer::clock`] reads, Hz, at least the tick rate. It judges whether ticks are in time, and runs
    /// apart from SysTick.
    const CLOCK: u32;

    /// Starts the counter. The image does so once, before the first tick.
    fn start_clock();

    /// What the counter reads; it wraps at 2³².
    fn clock() -> u32;

    /// Waits for the next interrupt, or for less.
    #[inline]
    fn wait() {
        cortex_m::asm::wfi();
    }
}

/// Bytes to and from the harness: [`crate::PortLink`] over a serial port, say.
pub trait Link {
    /// Opens the link. An image does so once, and again to say why it ends.
    fn open() -> Self;

    /// Waits for what comes next: one frame or more. None where nothing has come for so long that a harness would have asked.
    fn receive<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8];

    /// Sends bytes in one piece.
    fn send(&mut self, bytes: &[u8]);
}

/// A serial port, asked byte by byte.
pub trait Port {
    /// Opens it.
    fn open() -> Self;

    /// A byte that has come.
    fn take(&mut self) -> Option<u8>;

    /// Sends a byte, or says that there is no room yet.
    fn put(&mut self, byte: u8) -> bool;
}

/// The log's channel: RTT, say.
pub trait Log {
    /// Opens the channel, at the first message.
    fn open() -> Self;

    /// Sends a message in one piece, or says that it could not.
    fn send(&mut self, message: &[u8]) -> bool;
}

/// The rig's sensors and its actuator: parts on a bus, as [`mesh_damper::adc`] and [`mesh_damper::dac`] drive them, or what a chip
/// has by itself.
pub trait Converters {
    /// Displacement and force, and what controls the specimen.
    type Sensors: Sensors + 'static;
    /// What drives the actuator, and the line that enables it.
    type Actuator: Actuator + 'static;

    /// Opens them at the scales of `wiring`; none where one of them does not answer. The image does so once.
    fn open(wiring: &Wiring) -> Option<(Self::Sensors, Self::Actuator)>;

    /// A tick without a rig, of a board that gives its ticks itself. Converters that are simulated let their time pass.
    #[inline]
    fn idle() {}

    /// Temperature of the specimen, °C, on a board that gives its ticks itself. Where nobody measures it, 20.
    fn temperature() -> f32 {
        20.0
    }
}

/// Converters whose specimen is the harness: each request for a tick carries the codes that its sensors deliver and its control inputs,
/// and the answer the code that its actuator gets.
pub trait Harnessed: Converters {
    /// Codes of displacement and force that the sensors are to give at this tick. Converters that are wired to a specimen have their own.
    fn sense(displacement: u16, force: u16);

    /// Control inputs that `sensors` are to give at this tick, in the units of the law's effects. Converters that measure them, or
    /// whose specimen has none, have nothing to do.
    #[inline]
    fn control(_sensors: &mut Self::Sensors, _controls: [f32; CONTROLS]) {}

    /// Level of the input that says stop, from now until the next tick. Converters that are wired to one have their own.
    #[inline]
    fn trip(_tripped: bool) {}

    /// Code that the actuator was given, and the level of the enable line.
    fn driven() -> (u16, bool);
}
