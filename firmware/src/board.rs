//! The requirements of the images on a board.

use mesh_damper::effects::CONTROLS;
use mesh_damper::rig::{Actuator, Sensors, Wiring};

/// A board. Its memories are not described here: they are in the `memory.x` that the linker finds in the working directory.
pub trait Board: 'static {
    /// Clock of the core's SysTick timer, MHz: `bench` counts with it.
    const SYSTICK: u32;
    /// Bytes to and from the harness.
    type Link: Link;
    /// Channel of log messages.
    type Log: Log;
    /// ADC, DAC and enable line.
    type Converters: Converters;

    /// Sets up clocks and pins before anything else in an image, with the actuator disabled. It stores the chip's peripherals that
    /// it takes in a static of the board, where the other parts of the board find them. By default there is nothing to do.
    #[inline]
    fn prepare() {}

    /// Ends the image, after success or failure.
    fn exit(success: bool) -> !;

    /// Restarts as after power-on: the other end of the link is new. By default it ends.
    fn reset() -> ! {
        Self::exit(false)
    }
}

/// A board that generates the rig's ticks itself: with SysTick, at the rate of the rig's setup.
#[cfg(target_os = "none")]
pub trait OwnTimer: Board {
    /// The serial port to the harness.
    type Port: Port;
    /// Rate of the counter that [`OwnTimer::clock`] reads, Hz, at least the tick rate. It checks whether ticks are in time, and
    /// runs independently of SysTick.
    const CLOCK: u32;

    /// Starts the counter. The image calls this once, before the first tick.
    fn start_clock();

    /// The counter's value; it wraps at 2³².
    fn clock() -> u32;

    /// Waits for the next interrupt, or shorter.
    #[inline]
    fn wait() {
        cortex_m::asm::wfi();
    }
}

/// Bytes to and from the harness: for example [`crate::PortLink`] over a serial port.
pub trait Link {
    /// Opens the link. An image calls this once, and again to report why it ends.
    fn open() -> Self;

    /// Waits for the next data: one frame or more. Empty if nothing arrived for so long that a harness would have asked.
    fn receive<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8];

    /// Sends bytes without interruption.
    fn send(&mut self, bytes: &[u8]);
}

/// A serial port, polled byte by byte.
pub trait Port {
    /// Opens it.
    fn open() -> Self;

    /// The next received byte, if there is one.
    fn take(&mut self) -> Option<u8>;

    /// Sends a byte, or reports that there is no room yet.
    fn put(&mut self, byte: u8) -> bool;
}

/// The log's channel, for example RTT.
pub trait Log {
    /// Opens the channel, at the first message.
    fn open() -> Self;

    /// Sends a message without interruption, or reports that it could not.
    fn send(&mut self, message: &[u8]) -> bool;
}

/// The rig's sensors and its actuator: parts on a bus, driven by [`mesh_damper::adc`] and [`mesh_damper::dac`], or built into the
/// chip.
pub trait Converters {
    /// Displacement, force and the control inputs of the specimen.
    type Sensors: Sensors + 'static;
    /// The driver of the actuator, and the line that enables it.
    type Actuator: Actuator + 'static;

    /// Opens them at the scales of `wiring`; none if one of them does not answer. The image calls this once.
    fn open(wiring: &Wiring) -> Option<(Self::Sensors, Self::Actuator)>;

    /// A tick without a rig, on a board that generates its ticks itself. Simulated converters let their time pass.
    #[inline]
    fn idle() {}

    /// Temperature of the specimen, °C, on a board that generates its ticks itself. 20 if it is not measured.
    fn temperature() -> f32 {
        20.0
    }
}

/// Converters whose specimen is simulated by the harness. Each request for a tick carries the codes of its sensors and its control
/// inputs, and the answer carries the code for its actuator.
pub trait Harnessed: Converters {
    /// Codes of displacement and force for the sensors at this tick. Converters wired to a specimen have their own.
    fn sense(displacement: u16, force: u16);

    /// Control inputs for `sensors` at this tick, in the units of the law's effects. Converters that measure them, or whose
    /// specimen has none, do nothing here.
    #[inline]
    fn control(_sensors: &mut Self::Sensors, _controls: [f32; CONTROLS]) {}

    /// Level of the stop input, from now until the next tick. Converters that are wired to one have their own.
    #[inline]
    fn trip(_tripped: bool) {}

    /// The code given to the actuator, and the level of the enable line.
    fn driven() -> (u16, bool);
}
