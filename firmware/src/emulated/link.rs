//! Link and log of an image in the emulator: the pipes between harness and emulator.

use super::file::{File, Mode};
use super::semihosting::exit;
use crate::board::{Link, Log};

/// Standard input and output of the emulator.
pub struct Pipes {
    requests: File,
    answers: File,
}

impl Link for Pipes {
    fn open() -> Self {
        Self {
            requests: File::open(c"/dev/stdin", Mode::Read),
            answers: File::open(c"/dev/stdout", Mode::Write),
        }
    }

    /// Nothing arrives after the harness is gone, and the emulator ends with it.
    #[inline]
    fn receive<'b>(&mut self, buffer: &'b mut [u8]) -> &'b [u8] {
        let bytes = self.requests.read(buffer);
        if bytes.is_empty() {
            exit(true);
        }
        bytes
    }

    #[inline]
    fn send(&mut self, bytes: &[u8]) {
        if !self.answers.write(bytes) {
            exit(false);
        }
    }
}

/// Standard error of the emulator.
pub struct StandardError(File);

impl Log for StandardError {
    fn open() -> Self {
        Self(File::open(c"/dev/stderr", Mode::Write))
    }

    fn send(&mut self, message: &[u8]) -> bool {
        self.0.write(message)
    }
}
