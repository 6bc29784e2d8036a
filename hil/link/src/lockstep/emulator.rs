//! The emulator as a process, and the bytes to and from it.
//!
//! The image opens the pipes that the harness gave the emulator as its standard input and output. Frames go through them. If the
//! board can share its memory and has a processor to itself, frames go through memory, and the pipes only wake a sleeping end. When
//! the harness ends for any reason, the system closes its end of the pipes. The image then reads an end of file and ends the
//! emulator.

use std::io::{ErrorKind, Read as _, Write as _};
use std::path::Path;
use std::process::{ChildStdin, ChildStdout, Stdio};

use mesh_damper_output::error::InputError;
use mesh_damper_output::process::Process;

use super::LinkError;
use super::log::{LogDecoder, LogThread};
use super::memory::SharedMemory;
use super::pin::Pin;
use super::watchdog::Watchdog;
use crate::image::Board;

/// Bytes to and from an image, in the pieces in which they are sent.
pub trait Wire {
    /// Sends a frame.
    ///
    /// # Errors
    /// The other end is gone.
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError>;

    /// Waits for the next bytes, and returns how many of them it wrote to `buffer`; 0 after so long a silence that the bytes sent
    /// must be lost.
    ///
    /// # Errors
    /// The other end is gone.
    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, LinkError>;

    /// Number of times that a request is sent before the other end counts as absent. A request that arrives twice does no harm,
    /// because it is carried out once.
    fn most_tries(&self) -> u32 {
        1000
    }

    /// The error if there is no answer.
    fn silence(&self) -> LinkError {
        LinkError::Silent
    }
}

/// An emulator that runs an image. It ends when this is dropped.
#[derive(Debug)]
pub struct Emulator {
    process: Process,
    requests: ChildStdin,
    answers: ChildStdout,
    way: Way,
    log: LogThread,
    pin: Pin,
}

/// The way of frames.
#[derive(Debug)]
enum Way {
    /// The two pipes.
    Pipes(Watchdog),
    Memory(SharedMemory),
}

impl Emulator {
    /// Starts `elf` on `board`.
    ///
    /// # Errors
    /// The emulator is missing, or does not start.
    pub fn start(elf: &Path, board: Board, log: LogDecoder) -> Result<Self, InputError> {
        let failed = |error: std::io::Error| {
            let remedy = "check that qemu-system-arm runs by itself";
            InputError::new("the emulator", format!("does not start: {error}"), remedy)
        };
        let pin = Pin::of_emulator();
        let memory = match board.shares_memory() && pin.is_apart() {
            true => Some(SharedMemory::new().map_err(failed)?),
            false => None,
        };
        let mut command = board.emulator(elf)?;
        command
            .args(memory.iter().flat_map(SharedMemory::arguments))
            .args(["-semihosting-config", "enable=on,target=native"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut process = Process::start(&mut command).map_err(failed)?;
        pin.of_harness(true);
        let (Some(requests), Some(answers), Some(errors)) = (
            process.stdin.take(),
            process.stdout.take(),
            process.stderr.take(),
        ) else {
            unreachable!("all three are piped");
        };
        Ok(Self {
            way: match memory {
                Some(memory) => Way::Memory(memory),
                None => Way::Pipes(Watchdog::over(&requests).map_err(failed)?),
            },
            process,
            requests,
            answers,
            log: log.follow(errors),
            pin,
        })
    }

    /// The emulator's process number.
    pub fn id(&self) -> u32 {
        self.process.id()
    }

    /// Why there are no more answers.
    fn ended(&mut self) -> LinkError {
        let status = match self.process.wait() {
            Ok(status) => status.to_string(),
            Err(error) => error.to_string(),
        };
        let said = self.log.end();
        LinkError::Ended { status, said }
    }
}

impl Wire for Emulator {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        let sent = match &mut self.way {
            Way::Pipes(_) => self.requests.write_all(frame),
            Way::Memory(memory) => {
                memory.send(frame);
                Ok(())
            }
        };
        sent.map_err(|_| self.ended())
    }

    fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, LinkError> {
        let came = match &mut self.way {
            Way::Pipes(watchdog) => {
                watchdog.wait_begins();
                let came = self.answers.read(buffer);
                watchdog.wait_ends();
                came.and_then(|came| match came {
                    0 => Err(ErrorKind::UnexpectedEof.into()),
                    came => Ok(came),
                })
            }
            Way::Memory(memory) => {
                let came = memory.receive(buffer, &mut self.requests, &mut self.answers);
                if let Some(apart) = memory.judge() {
                    self.pin.of_harness(apart);
                }
                came
            }
        };
        match came {
            Ok(came) => Ok(came),
            Err(error) if error.kind() == ErrorKind::Interrupted => Ok(0),
            _ => Err(self.ended()),
        }
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // The log ends with the process.
        self.process.end();
        self.log.end();
    }
}
