//! What the images need of a board, and nothing more.

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiDevice;

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

    /// The end of an image: of one that did what it was for, or that failed.
    fn exit(success: bool) -> !;
}

/// Bytes to and from the harness: a serial port, say, whose idle line ends a frame.
pub trait Link {
    /// Opens the link. An image does so once, and again to say why it ends.
    fn open() -> Self;

    /// Waits for what comes next: one frame or more.
    fn receive<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8];

    /// Sends bytes in one piece.
    fn send(&mut self, bytes: &[u8]);
}

/// The log's channel: RTT, say.
pub trait Log {
    /// Opens the channel, at the first message.
    fn open() -> Self;

    /// Sends a message in one piece, or says that it could not.
    fn send(&mut self, message: &[u8]) -> bool;
}

/// The rig's converters and its enable line.
///
/// The harness is the specimen: each request for a tick carries the codes that its sensors deliver, and the answer the code that
/// its actuator gets.
pub trait Converters {
    /// SPI device of the ADC, an ADS8688.
    type Adc: SpiDevice + 'static;
    /// SPI device of the DAC, an AD5761R.
    type Dac: SpiDevice + 'static;
    /// The line that enables the actuator.
    type Enable: OutputPin + 'static;

    /// Opens them. The image does so once.
    fn open() -> (Self::Adc, Self::Dac, Self::Enable);

    /// Codes of displacement and force that the ADC is to give at this tick. Converters that are wired to a specimen have their own.
    fn sense(displacement: u16, force: u16);

    /// Code that the DAC was given, and the level of the enable line.
    fn driven() -> (u16, bool);
}
