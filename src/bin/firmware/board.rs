//! All that is the emulated board's: where it differs from a real one, this module is what to replace.
//!
//! - [`Link`]: bytes to and from the harness, over semihosting; on a board a serial port, whose idle line ends a frame.
//! - [`Log`]: where log messages go; on a board RTT.
//! - [`Adc`], [`Dac`], [`Enable`]: on a board SPI and a pin by its HAL, and no [`WIRES`]: ticks come from a timer then, not
//!   from the link.
//! - [`stack_used`]: needs nothing but the linker's symbols.

#[path = "file.rs"]
mod file;
#[path = "parts.rs"]
mod parts;
#[path = "../emulated/semihosting.rs"]
mod semihosting;

pub use parts::{Adc, Dac, Enable, WIRES};
pub use semihosting::exit;

use file::{File, Mode};

/// Bytes to and from the harness.
pub struct Link {
    requests: File,
    answers: File,
}

impl Link {
    /// To the process that started the emulator, by the pipes that it gave it as standard input and output.
    pub fn open() -> Self {
        Self {
            requests: File::open(c"/dev/stdin", Mode::Read),
            answers: File::open(c"/dev/stdout", Mode::Write),
        }
    }

    /// Waits for what comes next. Nothing comes once the harness is gone, and the emulator ends with it.
    #[inline]
    pub fn receive<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        let bytes = self.requests.read(buffer);
        if bytes.is_empty() {
            exit(true);
        }
        bytes
    }

    /// Sends a frame in one piece.
    #[inline]
    pub fn send(&mut self, frame: &[u8]) {
        if !self.answers.write(frame) {
            exit(false);
        }
    }
}

/// The log's channel.
pub struct Log(File);

impl Log {
    /// To the emulator's standard error.
    pub fn open() -> Self {
        Self(File::open(c"/dev/stderr", Mode::Write))
    }

    /// Sends a message in one piece, or says that it could not.
    pub fn send(&mut self, message: &[u8]) -> bool {
        self.0.write(message)
    }
}

/// What cortex-m-rt fills the stack with before `main`.
const PAINT: u32 = 0xCCCC_CCCC;

/// Most bytes of stack used since the start.
pub fn stack_used() -> u32 {
    unsafe extern "C" {
        static _stack_end: u32;
        static _stack_start: u32;
    }
    let mut word = &raw const _stack_end;
    let top = &raw const _stack_start;
    // SAFETY: from the linker's end of the variables to the beginning of the stack it is memory of nobody else.
    while word < top && unsafe { word.read_volatile() } == PAINT {
        word = word.wrapping_add(1);
    }
    (top as u32).wrapping_sub(word as u32)
}
